//! The rows of a row of cells, as what was decided of each cell.
//!
//! First come the confidences of all cells, then of each cell three numbers, all by prefix codes ([`Codes`]):
//!
//! 1. *shape*: what lies between the middle of the cell and its outer columns, 1/16 px. With `far` so much the columns are
//!    0, `far - near`, `far + near`, `2 far` above the first, `near` being a third of `far`, rounded. The escape says that the
//!    columns do not lie so: at a jump, or where a part of the cell is hidden; then three more *values* follow, the steps to
//!    the second, third and fourth column.
//! 2. *value*: the upper left pixel less the pixel before it, 1/16 px; before the row is 0. After the escape 12 bits follow;
//!    if these are 0x800, 16 more.
//! 3. *down*: half of what a row has more than the one above it. There are three codes: for cells after one with less
//!    than none, with none and with more. After the escape 16 bits follow for each column, a row less the one above it.
//!
//! A *confidence* is told as an eighth of what it is more than that of the column before. There are two codes, for cells
//! after one with a change and with none. After the escape 4 bits follow. If they are 8, all four confidences do, a byte each; else
//!    the lower three are set for the second, third and fourth column if they have not the first one's. A bit is set if the
//!    first one's is another than the column's before, which follows then; if a column has another than the first, a bit is
//!    set if it is no [`GUESS`], and then it follows.
//!
//! All rows have the same confidences, and the same difference to the row above them. A row alone is its own lower row. The
//! last cell is filled up by the last pixel.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "disparities have 16 bits, and what is cut out of a word is meant"
)]

use super::bits::{BitReader, Codes};
use crate::lanes::cell_codes::{
    Bits, Code, ConfidenceCodes, Confidences, Disparities, DisparityCodes, Entry, Shape, put_confidences,
    put_disparities, words_of,
};
use crate::lanes::smoothing::word;
use crate::lanes::sub_halves;
use crate::{Disparity, DisparityRow};

/// Numbers that have a code, either side of 0, and the escape.
const fn codes(most: usize) -> usize {
    2 * most + 2
}

const VALUE: Codes<{ codes(20) }> = Codes::of([
    10, 10, 10, 10, 10, 10, 10, 10, 9, 9, 8, 8, 8, 7, 6, 6, 5, 4, 4, 3, 2, 3, 4, 4, 5, 6, 6, 7, 8, 8, 8, 9, 9, 10, 10,
    10, 10, 10, 10, 10, 10, 4,
]);
const SHAPE: Codes<{ codes(10) }> = Codes::of([10, 10, 9, 8, 7, 6, 5, 4, 4, 3, 2, 3, 3, 4, 5, 6, 7, 8, 9, 10, 10, 4]);
/// After less than none, none, and more.
const DOWN: [Codes<{ codes(6) }>; 3] = [
    Codes::of([11, 9, 6, 5, 3, 1, 2, 5, 5, 7, 8, 11, 11, 11]),
    Codes::of([10, 10, 7, 6, 5, 3, 1, 2, 5, 6, 6, 8, 10, 10]),
    Codes::of([11, 10, 8, 7, 5, 5, 2, 2, 2, 3, 5, 6, 9, 11]),
];
/// After a change, and after none.
const CONFIDENCE: [Codes<{ codes(12) }>; 2] = [
    Codes::of([11, 11, 10, 8, 7, 6, 6, 6, 6, 6, 5, 4, 1, 3, 4, 5, 6, 6, 6, 7, 8, 8, 10, 11, 11, 5]),
    Codes::of([10, 10, 10, 9, 8, 8, 7, 6, 6, 6, 5, 3, 1, 3, 5, 6, 6, 7, 6, 6, 7, 8, 8, 9, 10, 5]),
];
/// What hidden pixels mostly have.
const GUESS: u8 = 8;
/// A confidence that is the one before, in either code.
const NO_CHANGE: Code = Code::new(0, 1);
const _: () = assert!(CONFIDENCE[0].at(12).is(NO_CHANGE) && CONFIDENCE[1].at(12).is(NO_CHANGE));
/// Says that all confidences of a cell follow.
const ALL: u32 = 8;
/// A pixel that is not known.
const UNKNOWN: i32 = Disparity::UNKNOWN.into_bits() as i32;
/// Steps of confidence that have a code.
const STEP: i32 = 8;
/// Says that a value needs 16 bits; the least number of 12.
const WIDE: i32 = -0x800;

/// What a row is written with: the codes of cells all of which have one, ...
static CONFIDENCES: ConfidenceCodes = confidence_codes();
static DISPARITIES: DisparityCodes = disparity_codes();
/// ... and of those that have not.
static VALUES: Codes<{ codes(20) }> = VALUE;
static SHAPES: Codes<{ codes(10) }> = SHAPE;
static DOWNS: [Codes<{ codes(6) }>; 3] = DOWN;
static STEPS: [Codes<{ codes(12) }>; 2] = CONFIDENCE;

const fn confidence_codes() -> ConfidenceCodes {
    let mut tables = [[Entry::NONE; 32]; 2];
    let mut i = 0;
    while i < 2 * 25 {
        let (steady, step) = (i / 25, i % 25);
        let next = ConfidenceCodes::next(step == 12);
        tables[steady][step + 16 - 12] = Entry::new(CONFIDENCE[steady].at(step), next);
        i += 1;
    }
    ConfidenceCodes(tables)
}

const fn disparity_codes() -> DisparityCodes {
    let mut value = [Entry::NONE; 64];
    let mut i = 0;
    while i <= 40 {
        value[i + 32 - 20] = Entry::new(VALUE.at(i), 0);
        i += 1;
    }
    let mut shape = [Shape { inner: 0, code: Entry::NONE }; 64];
    let mut i = 0;
    while i <= 20 {
        let [_, b, c, _] = columns(i as i32 - 10);
        shape[2 * i + 32 - 20] = Shape { inner: word([c as u16, b as u16]), code: Entry::new(SHAPE.at(i), 0) };
        i += 1;
    }
    let mut down = [[Entry::NONE; 32]; 3];
    let mut i = 0;
    while i < 3 * 13 {
        let (before, half) = (i / 13, i % 13);
        let next = DisparityCodes::next(down_index(half as i32 - 6));
        down[before][2 * half + 16 - 12] = Entry::new(DOWN[before].at(half), next);
        i += 1;
    }
    DisparityCodes { value, down, shape, escape: VALUE.escape() }
}

/// The columns of a cell of a shape, less the first.
const fn columns(far: i32) -> [i32; 4] {
    let near = (2 * far + 3).div_euclid(6);
    [0, far - near, far + near, 2 * far]
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
    let mut bits = Bits::new(room.as_chunks_mut().0);
    let sure = [upper.confidence, lower.confidence];
    let mut state = Confidences { before: 0, is_steady: false };
    let put = |rows, state: &mut _, bits: &mut _| put_confidences(rows, &CONFIDENCES, state, bits);
    write_cells(sure, &mut state, &mut bits, put, write_confidences)?;
    let mut state = Disparities { before: 0, down: 1 };
    let put = |rows, state: &mut _, bits: &mut _| put_disparities(rows, &DISPARITIES, state, bits);
    write_cells([upper.disparity, lower.disparity], &mut state, &mut bits, put, write_odd)?;
    bits.finish()
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

/// All cells of two rows: by `put` those that have codes, one after the other, by `write` those that may have none.
#[inline(always)]
fn write_cells<'a, 'r, T: Copy, S>(
    rows: [&'a [T]; 2],
    state: &mut S,
    bits: &mut Bits<'r>,
    put: impl Fn([&'a [[T; 4]]; 2], &mut S, &mut Bits<'r>) -> usize,
    write: impl Fn([[T; 4]; 2], &mut S, &mut Bits<'r>) -> Option<()>,
) -> Option<()> {
    let [(mut upper, upper_rest), (mut lower, lower_rest)] = rows.map(|row| row.as_chunks::<4>());
    let last = filled_up(upper_rest).zip(filled_up(lower_rest));
    loop {
        let done = put([upper, lower], state, bits);
        (upper, lower) = (upper.get(done..)?, lower.get(done..)?);
        let Some(((&upper_cell, upper_rest), (&lower_cell, lower_rest))) = upper.split_first().zip(lower.split_first())
        else {
            break;
        };
        write([upper_cell, lower_cell], state, bits)?;
        (upper, lower) = (upper_rest, lower_rest);
    }
    last.map_or(Some(()), |(upper, lower)| write([upper, lower], state, bits))
}

/// The two rows of a cell, and what the lower one has more.
#[derive(Clone, Copy)]
struct Cell {
    upper: [u32; 2],
    lower: [u32; 2],
    down: [u32; 2],
}

impl Cell {
    #[inline(always)]
    fn of(upper: [u32; 2], lower: [u32; 2]) -> Self {
        Self { upper, lower, down: [sub_halves(lower[0], upper[0]), sub_halves(lower[1], upper[1])] }
    }

    #[inline(always)]
    fn first(&self) -> i32 {
        i32::from(self.upper[0] as u16 as i16)
    }

    #[inline(always)]
    fn last(&self) -> i32 {
        self.upper[1].cast_signed() >> 16
    }

    /// Its shape, if that has a code.
    fn shape(&self) -> Option<Code> {
        let far = half(self.last() - self.first())?;
        let code = SHAPES.get(far)?;
        let first = self.first();
        (columns_of(self.upper) == columns(far).map(|above| first + above)).then_some(code)
    }

    /// What all columns of the lower row have more, if it is the same.
    fn rise(&self) -> Option<i32> {
        let [a, b] = self.down;
        (a == b && a == a.rotate_left(16)).then_some(i32::from(a as u16 as i16))
    }
}

/// Half of an even number.
const fn half(number: i32) -> Option<i32> {
    if number % 2 == 0 { Some(number / 2) } else { None }
}

/// Which of the codes comes after a *down*: that after less than none, none, or more.
const fn down_index(rise: i32) -> usize {
    (rise.signum() + 1) as usize
}

/// A cell of which not everything may have a code.
#[inline(never)]
fn write_odd([upper, lower]: [[Disparity; 4]; 2], state: &mut Disparities, bits: &mut Bits<'_>) -> Option<()> {
    let cell = Cell::of(words_of(upper), words_of(lower));
    if has_unknown(cell.upper) || has_unknown(cell.lower) {
        return None;
    }
    let step = cell.first() - state.before;
    if let Some(shape) = cell.shape() {
        bits.put(shape)?;
        write_value(step, bits)?;
    } else {
        bits.put(SHAPES.escape())?;
        write_value(step, bits)?;
        let [a, b, c, d] = columns_of(cell.upper);
        [b - a, c - b, d - c].into_iter().try_for_each(|step| write_value(step, bits))?;
    }
    let downs = DOWNS.get(state.down)?;
    let rise = cell.rise();
    if let Some(code) = rise.and_then(half).and_then(|half| downs.get(half)) {
        bits.put(code)?;
    } else {
        bits.put(downs.escape())?;
        for pair in cell.down {
            bits.put(Code::new(pair & 0xffff, 16))?;
            bits.put(Code::new(pair >> 16, 16))?;
        }
    }
    *state = Disparities { before: cell.last(), down: rise.map_or(1, down_index) };
    Some(())
}

/// The last cell of a row, filled up by its last pixel.
fn filled_up<T: Copy>(rest: &[T]) -> Option<[T; 4]> {
    let &last = rest.last()?;
    Some(core::array::from_fn(|i| rest.get(i).copied().unwrap_or(last)))
}

/// The columns of a cell.
fn columns_of([left, right]: [u32; 2]) -> [i32; 4] {
    [left, left >> 16, right, right >> 16].map(|column| i32::from(column as u16 as i16))
}

fn has_unknown(row: [u32; 2]) -> bool {
    columns_of(row).contains(&UNKNOWN)
}

/// A value, code or escape.
#[inline(never)]
fn write_value(step: i32, bits: &mut Bits<'_>) -> Option<()> {
    if let Some(code) = VALUES.get(step) {
        return bits.put(code);
    }
    bits.put(VALUES.escape())?;
    if (WIDE + 1..-WIDE).contains(&step) {
        return bits.put(Code::new(step.cast_unsigned() & 0xfff, 12));
    }
    bits.put(Code::new(WIDE.cast_unsigned() & 0xfff, 12))?;
    bits.put(Code::new(step.cast_unsigned() & 0xffff, 16))
}

/// Confidences of a cell, which may have no code; `None` if the rows differ.
#[inline(never)]
fn write_confidences([upper, lower]: [[u8; 4]; 2], state: &mut Confidences, bits: &mut Bits<'_>) -> Option<()> {
    if upper != lower {
        return None;
    }
    let Confidences { before, is_steady } = *state;
    let codes = STEPS.get(usize::from(is_steady))?;
    let change = i32::from(upper[0]) - i32::from(before);
    let is_uniform = upper == [upper[0]; 4];
    match codes.get(change / STEP) {
        Some(code) if is_uniform && change % STEP == 0 => bits.put(code)?,
        _ => {
            bits.put(codes.escape())?;
            write_each(before.into(), upper, bits)?;
        }
    }
    *state = Confidences { before: upper[3], is_steady: change == 0 && is_uniform };
    Some(())
}

/// Confidences after the escape.
fn write_each(before: u32, confidence: [u8; 4], bits: &mut Bits<'_>) -> Option<()> {
    let first = confidence[0];
    let other = confidence.into_iter().find(|&other| other != first);
    if confidence.into_iter().any(|one| one != first && Some(one) != other) {
        bits.put(Code::new(ALL, 4))?;
        return confidence.into_iter().try_for_each(|one| bits.put(Code::new(one.into(), 8)));
    }
    bits.put(Code::new((1..4).map(|i| u32::from(confidence[i] != first) << (i - 1)).sum(), 4))?;
    if u32::from(first) == before {
        bits.put(Code::new(0, 1))?;
    } else {
        bits.put(Code::new(1 | u32::from(first) << 1, 9))?;
    }
    match other {
        Some(GUESS) => bits.put(Code::new(0, 1)),
        Some(other) => bits.put(Code::new(1 | u32::from(other) << 1, 9)),
        None => Some(()),
    }
}

/// Reads the `nth` row, from 0 at the top; `None` if the bytes are not exactly rows of this width.
pub(super) fn read(bytes: &[u8], nth: u8, disparity: &mut [Disparity], confidence: &mut [u8]) -> Option<()> {
    let mut reader = BitReader::new(bytes);
    let (mut before, mut is_steady) = (0, false);
    for cell in confidence.chunks_mut(4) {
        let change = reader.number(&CONFIDENCE[usize::from(is_steady)])?;
        is_steady = change == Some(0);
        let sure = match change {
            Some(change) => [u8::try_from(i32::from(before) + STEP * change).ok()?; 4],
            None => read_confidences(before, &mut reader)?,
        };
        before = sure[3];
        cell.copy_from_slice(&sure[..cell.len()]);
    }
    let (mut before, mut downs) = (0, 1);
    for cell in disparity.chunks_mut(4) {
        let shape = reader.number(&SHAPE)?;
        let mut column = before + read_value(&mut reader)?;
        let mut upper = shape.map_or([column; 4], |far| columns(far).map(|above| column + above));
        if shape.is_none() {
            for later in &mut upper[1..] {
                column = i32::from((column + read_value(&mut reader)?) as i16);
                *later = column;
            }
        }
        let upper = upper.map(|column| column as i16);
        before = upper[3].into();
        let mut down = [0; 4];
        if let Some(half) = reader.number(&DOWN[downs])? {
            downs = (half.signum() + 1) as usize;
            down = [2 * half as i16; 4];
        } else {
            for down in &mut down {
                *down = reader.take(16)? as u16 as i16;
            }
            let is_even = down == [down[0]; 4];
            downs = if is_even { down_index(down[0].into()) } else { 1 };
        }
        for ((to, from), down) in cell.iter_mut().zip(upper).zip(down) {
            *to = Disparity::from_bits(from.wrapping_add(down.wrapping_mul(nth.into())));
        }
    }
    reader.is_done().then_some(())
}

fn read_value(reader: &mut BitReader<'_>) -> Option<i32> {
    if let Some(step) = reader.number(&VALUE)? {
        return Some(step);
    }
    let step = (reader.take(12)? << 20).cast_signed() >> 20;
    // Between any two disparities there is a step of 16 bits, that wraps around.
    if step == WIDE { Some((reader.take(16)? as u16 as i16).into()) } else { Some(step) }
}

fn read_confidences(before: u8, reader: &mut BitReader<'_>) -> Option<[u8; 4]> {
    let others = reader.take(4)?;
    if others == ALL {
        let mut sure = [0; 4];
        for one in &mut sure {
            *one = reader.take(8)? as u8;
        }
        return Some(sure);
    }
    let mut unless = |usual: u8| Some(if reader.take(1)? == 0 { usual } else { reader.take(8)? as u8 });
    let first = unless(before)?;
    let other = if others == 0 { first } else { unless(GUESS)? };
    Some(core::array::from_fn(|i| if others << 1 >> i & 1 == 1 { other } else { first }))
}
