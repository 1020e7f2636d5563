//! The rows of a row of cells of 4 columns, as what was decided of each cell.
//!
//! Pairs of cells go together, 64 at most; columns that fill no pair are one by themselves, filled up by the last pixel. First come the [`confidences`]
//! of all its cells, then their [`disparities`]. All rows have the same confidences, and the same difference to the row above
//! them; a row alone is its own lower row.
//!
//! Codes are whole bytes: prefix codes would be a fifth shorter, but take a third more instructions.

use super::writer::Writer;
use crate::lanes::cell_codes::{Listed, MOST};
use crate::lanes::sub_halves;
use crate::{Disparity, DisparityRow};

mod confidences;
mod disparities;

/// Columns of two cells.
const PAIR: usize = 8;
/// Pairs of cells that go together.
const PAIRS: usize = MOST / 2;

/// What stands before some cells: the last column.
#[derive(Clone, Copy)]
struct Before {
    disparity: i16,
    confidence: u8,
}

impl Before {
    /// Of a row's first cell.
    const NONE: Self = Self { disparity: 0, confidence: 0 };
}

/// Writes rows of the same width; how many bytes they are. `None` if there is not so much room, if they differ in confidence, if
/// they do not go on as they begin, or if something in the first two is unknown: then they are not those of a row of cells.
pub(super) fn write(rows: &[DisparityRow<'_>], room: &mut [u8]) -> Option<usize> {
    let (&upper, below) = rows.split_first()?;
    let &lower = below.first().unwrap_or(&upper);
    // Most rows that are none of cells show it here.
    if upper.disparity.iter().step_by(16).any(|&disparity| disparity == Disparity::UNKNOWN) {
        return None;
    }
    for three in rows.windows(3) {
        if let [above, here, below] = three
            && !goes_on([above, here, below])
        {
            return None;
        }
    }
    let (mut writer, mut before, mut listed) = (Writer::new(room), Before::NONE, Listed::NONE);
    let [(upper_sure, upper_sure_rest), (lower_sure, lower_sure_rest)] =
        [upper.confidence, lower.confidence].map(<[u8]>::as_chunks::<PAIR>);
    let [(upper, upper_rest), (lower, lower_rest)] =
        [upper.disparity, lower.disparity].map(<[Disparity]>::as_chunks::<PAIR>);
    let mut write = |sure: [&[[u8; PAIR]]; 2], rows: [&[[Disparity; PAIR]]; 2]| {
        confidences::write(sure, before.confidence, &mut writer)?;
        disparities::write(rows.map(<[_]>::as_flattened), before.disparity, &mut listed, &mut writer)?;
        if let (&[.., [.., disparity]], &[.., [.., confidence]]) = (rows[0], sure[0]) {
            before = Before { disparity: disparity.into_bits(), confidence };
        }
        Some(())
    };
    let sures = upper_sure.chunks(PAIRS).zip(lower_sure.chunks(PAIRS));
    for (sure, rows) in sures.zip(upper.chunks(PAIRS).zip(lower.chunks(PAIRS))) {
        write(sure.into(), rows.into())?;
    }
    if let Some((sure, rows)) = filled_up([upper_sure_rest, lower_sure_rest]).zip(filled_up([upper_rest, lower_rest])) {
        write(sure.each_ref().map(core::slice::from_ref), rows.each_ref().map(core::slice::from_ref))?;
    }
    Some(writer.count())
}

/// Reads the `nth` row, from 0 at the top; `None` if the bytes are not exactly rows of this width.
pub(super) fn read(mut bytes: &[u8], nth: u8, disparity: &mut [Disparity], confidence: &mut [u8]) -> Option<()> {
    let mut before = Before::NONE;
    let whole = disparity.len() / PAIR * PAIR;
    let (disparity, rest) = disparity.split_at_mut_checked(whole)?;
    let (confidence, rest_sure) = confidence.split_at_mut_checked(whole)?;
    let groups = disparity.chunks_mut(PAIR * PAIRS).zip(confidence.chunks_mut(PAIR * PAIRS));
    let rest = (!rest.is_empty()).then_some((rest, rest_sure));
    for (disparity, confidence) in groups.chain(rest) {
        confidences::read(&mut bytes, &mut before.confidence, confidence)?;
        disparities::read(&mut bytes, nth, &mut before.disparity, disparity)?;
    }
    bytes.is_empty().then_some(())
}

/// Whether a row has as much more than the one above it as that has more than the one above, and their confidence.
fn goes_on([above, here, below]: [&DisparityRow<'_>; 3]) -> bool {
    let [(above, above_rest), (middle, middle_rest), (under, under_rest)] =
        [above, here, below].map(|row| row.disparity.as_chunks::<4>());
    let cells = above.iter().zip(middle).zip(under);
    let goes_on = cells.fold(0, |differs, ((&above, &middle), &under)| {
        let [above, middle, under] = [above, middle, under].map(words_of);
        differs
            | sub_halves(middle[0], above[0]) ^ sub_halves(under[0], middle[0])
            | sub_halves(middle[1], above[1]) ^ sub_halves(under[1], middle[1])
    });
    let rise = |above: &Disparity, below: &Disparity| below.into_bits().wrapping_sub(above.into_bits());
    let mut rest = above_rest.iter().zip(middle_rest).zip(under_rest);
    let (sure, rest_sure) = here.confidence.as_chunks::<4>();
    let (sure_below, rest_below) = below.confidence.as_chunks::<4>();
    let other =
        sure.iter().zip(sure_below).fold(0, |other, (&a, &b)| other | u32::from_le_bytes(a) ^ u32::from_le_bytes(b));
    goes_on | other == 0
        && rest.all(|((above, middle), under)| rise(above, middle) == rise(middle, under))
        && rest_sure == rest_below
}

/// The columns that fill no pair of cells, if there are any, filled up by the last one.
fn filled_up<T: Copy>(rows: [&[T]; 2]) -> Option<[[T; PAIR]; 2]> {
    let [upper, lower] = rows.map(|rest| {
        let &last = rest.last()?;
        Some(core::array::from_fn(|i| rest.get(i).copied().unwrap_or(last)))
    });
    Some([upper?, lower?])
}

/// The columns of a cell, two in a word.
#[inline(always)]
fn words_of(row: [Disparity; 4]) -> [u32; 2] {
    let [a, b, c, d] = row.map(|disparity| u32::from(disparity.into_bits().cast_unsigned()));
    [a | b << 16, c | d << 16]
}
