//! The stage: rows as they come in, rectified pairs out, a bounded ring of rows in between.

use super::lens::Reach;
use super::plan::Plan;
use super::ring::Ring;
use super::{LensTable, Ramp, Rectification};
use crate::lanes::lens_runs::{Number, copy};
use crate::{ConfigError, RowError, ScanlinePair};

/// Fraction bits of a place.
const FRAC_BITS: u32 = 16;
/// Columns that share an interpolation weight.
const RUN: usize = 4;

/// A row that comes out of rectification.
#[derive(Debug, Clone, Copy)]
pub struct RectifiedRow<'a> {
    /// Which row of the left view it is, from 0.
    pub y: u32,
    /// The rectified pair; `None` where a row that it needs was lost or lies outside of the right view.
    pub pair: Option<ScanlinePair<'a>>,
}

/// Brings the rows of two cameras together: offset, roll and scale by a [`Ramp`] and whole columns, or full lens tables.
///
/// By a ramp, rows are those of the left view; the right view is interpolated between two rows, with
/// one weight for four columns, and the left one is softened alike. Where a corner of a row lies outside of the right view, that view's first or
/// last row stands there; a row whose middle does is missed.
///
/// By lens tables both views are interpolated between rows and columns, four columns at a time: each row comes out as soon as
/// all that both views need of it is there. Where lenses shrink, a row may come out before the camera's row of the same
/// number, and two with one push. What lies outside of a view shows that view's border.
///
/// `ROWS` is the capacity for the rows of both views together that wait ([`Rectification::rows_needed`]), at most 128 a
/// view; `WIDTH` the greatest width, px. It holds `WIDTH * (ROWS + 2)` bytes, and 0.7 KB of a lens table's row. A row comes
/// out at most [`Rectifier::waiting_rows`] rows after it came.
///
/// # Examples
/// ```
/// use haarline::rectify::{Ramp, Rectifier};
/// use haarline::ScanlinePair;
/// let half_a_row = Ramp { rows_q16: 1 << 15, ..Ramp::default() };
/// let mut rectifier = Rectifier::<8, 64>::new([64, 3], half_a_row.into())?;
/// let mut right = vec![];
/// for y in [10, 20, 30] {
///     let pair = ScanlinePair { left: &[y; 64], right: &[y; 64] };
///     rectifier.push(pair, &mut |row| right.extend(row.pair.map(|pair| pair.right[0]))).unwrap();
/// }
/// rectifier.finish(&mut |row| right.extend(row.pair.map(|pair| pair.right[0])));
/// assert_eq!(right, [15, 25, 30]); // half a row below the last one that one stands
/// # Ok::<(), haarline::ConfigError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Rectifier<const ROWS: usize, const WIDTH: usize> {
    pub(super) size: [u16; 2],
    ramp: Ramp,
    columns: i16,
    pub(super) lenses: Option<[LensTable; 2]>,
    /// Rows that an answer waits, and how many of each view the ring holds.
    waits: usize,
    pub(super) left: Ring,
    pub(super) right: Ring,
    pub(super) rows: [[u8; WIDTH]; ROWS],
    /// The rectified rows of the left and the right view; of a ramp those of the right and the left one.
    pub(super) out: [[u8; WIDTH]; 2],
    /// Rows of this frame that came or were missed.
    pub(super) came: u32,
    /// Whether one of them was missed.
    pub(super) is_damaged: bool,
    /// Of lens tables the next row to come out, where its segments lie in both views, and how far down they reach.
    pub(super) next: u32,
    pub(super) segments: [Number; WIDTH],
    pub(super) reaches: [Reach; 2],
    /// First and last row of each view that the next row needs.
    pub(super) needed: [[u32; 2]; 2],
}

/// Whole rows that a place in 1/65536 px reaches to.
pub(super) const fn floor(q16: i32) -> i32 {
    q16 >> FRAC_BITS
}

const fn ceil(q16: i32) -> i32 {
    -((-q16) >> FRAC_BITS)
}

impl<const ROWS: usize, const WIDTH: usize> Rectifier<ROWS, WIDTH> {
    /// For views of `size` px that are put right by `rectification`.
    ///
    /// # Errors
    /// If the width is over the capacity, a figure is out of its range, lens tables are those of another size, or more rows
    /// must wait than the ring holds.
    pub fn new(size: [u16; 2], rectification: Rectification) -> Result<Self, ConfigError> {
        let mut rectifier = Self::of(Plan::new(size, rectification, [ROWS, WIDTH])?);
        rectifier.start();
        Ok(rectifier)
    }

    /// By a plan of this capacity, not started. In line, so that the rows are made where they stay.
    #[inline(always)]
    pub(super) const fn of(Plan { size, rectification, waits, rows: [left, right] }: Plan) -> Self {
        let Rectification { ramp, columns, lenses, .. } = rectification;
        Self {
            size,
            ramp,
            columns,
            lenses,
            waits,
            left: Ring::new(0, left),
            right: Ring::new(left, right),
            rows: [[0; WIDTH]; ROWS],
            out: [[0; WIDTH]; 2],
            came: 0,
            is_damaged: false,
            next: 0,
            segments: [Number::NONE; WIDTH],
            reaches: [Reach::NONE; 2],
            needed: [[0; 2]; 2],
        }
    }

    /// So many rows after a row came it comes out, at most.
    #[must_use]
    pub const fn waiting_rows(&self) -> usize {
        self.waits
    }

    /// Begins a frame.
    pub fn start(&mut self) {
        (self.came, self.is_damaged) = (0, false);
        self.left.clear();
        self.right.clear();
        self.start_lenses();
    }

    /// Takes the next rows of both cameras.
    ///
    /// # Errors
    /// If they have another width than configured; they do not count then.
    pub fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(RectifiedRow<'_>)) -> Result<(), RowError> {
        pair.check(self.size[0])?;
        for (ring, row) in [(&mut self.left, pair.left), (&mut self.right, pair.right)] {
            ring.set(self.came, true);
            let place = self.rows.get_mut(ring.first + ring.place(self.came));
            if let Some(place) = place.and_then(|place| place.get_mut(..row.len())) {
                copy(row, place);
            }
        }
        self.advance(sink);
        Ok(())
    }

    /// The next rows were lost.
    pub fn miss(&mut self, sink: &mut dyn FnMut(RectifiedRow<'_>)) {
        self.left.set(self.came, false);
        self.right.set(self.came, false);
        self.is_damaged = true;
        self.advance(sink);
    }

    /// The three newest rows of either view as they came, if they are there and what comes out is interpolated.
    pub(crate) fn newest_three(&self) -> Option<[[&[u8]; 3]; 2]> {
        if self.lenses.is_none() && !self.ramp.is_between_rows() {
            return None;
        }
        let newest = [self.came.checked_sub(3)?, self.came.checked_sub(2)?, self.came.checked_sub(1)?];
        let views = [&self.left, &self.right];
        let are_there = views.into_iter().all(|ring| newest.into_iter().all(|y| ring.has(y)));
        let width = self.size[0].into();
        are_there.then(|| views.map(|ring| newest.map(|y| ring.row(&self.rows, y, width))))
    }

    /// Rows of this frame that came or were missed.
    pub(crate) const fn came(&self) -> u32 {
        self.came
    }

    /// Ends the frame: the rows that wait come out.
    pub fn finish(&mut self, sink: &mut dyn FnMut(RectifiedRow<'_>)) {
        if self.lenses.is_some() {
            self.finish_lenses(sink);
        } else {
            let waits = u32::try_from(self.waits).unwrap_or(u32::MAX);
            for y in self.came.saturating_sub(waits)..self.came {
                self.emit(y, sink);
            }
        }
        self.start();
    }

    fn advance(&mut self, sink: &mut dyn FnMut(RectifiedRow<'_>)) {
        self.came += 1;
        if self.lenses.is_some() {
            return self.advance_lenses(sink);
        }
        let ready = usize::try_from(self.came).unwrap_or(usize::MAX).checked_sub(self.waits + 1);
        if let Some(y) = ready.and_then(|y| u32::try_from(y).ok()) {
            self.emit(y, sink);
        }
    }

    fn emit(&mut self, y: u32, sink: &mut dyn FnMut(RectifiedRow<'_>)) {
        let width = usize::from(self.size[0]);
        let middle = self.place_q16(0, y);
        const HALF: i32 = 1 << (FRAC_BITS - 1);
        let has_middle = self.is_in_view(floor(middle + HALF)) || self.is_in_view(ceil(middle - HALF));
        let has_pair = self.left.has(y) && has_middle && self.interpolate(y);
        let is_softened = has_pair && self.ramp.is_between_rows();
        if is_softened {
            self.soften(y);
        }
        let as_it_came = self.left.row(&self.rows, y, width);
        let [right, softened] = self.out.each_ref().map(|out| out.get(..width).unwrap_or(&[]));
        let left = if is_softened { softened } else { as_it_came };
        sink(RectifiedRow { y, pair: has_pair.then_some(ScanlinePair { left, right }) });
    }

    /// Softens a row of the left view about as much as interpolation softens the right one: where the one is sharp and the
    /// other is not, they do not match.
    fn soften(&mut self, y: u32) {
        let (width, edge) = (usize::from(self.size[0]), i32::from(self.size[0]) - 1);
        let (rows, ring) = (&self.rows, &self.left);
        let here = ring.row(rows, y, width);
        let beside = |row: Option<u32>| {
            let row = row.filter(|&row| row < self.came && ring.has(row));
            row.map_or(here, |row| ring.row(rows, row, width))
        };
        let (above, below) = (beside(y.checked_sub(1)), beside(y.checked_add(1)));
        let mut place = self.place_q16(3 - edge, y);
        let step = self.ramp.roll_q16 * 4;
        let fours = [above, here, below].map(|row| row.as_chunks::<RUN>());
        let Some(out) = self.out[1].get_mut(..width) else { return };
        let (runs, rest) = out.as_chunks_mut::<RUN>();
        let beside = fours[0].0.iter().zip(fours[2].0);
        for ((run, here), (above, below)) in runs.iter_mut().zip(fours[1].0).zip(beside) {
            *run = soften_four(*above, *here, *below, softness(place));
            place += step;
        }
        let [above, here, below] = fours.map(|(_, rest)| core::array::from_fn(|i| rest.get(i).copied().unwrap_or(0)));
        let softened = soften_four(above, here, below, softness(place));
        rest.iter_mut().zip(softened).for_each(|(pixel, softened)| *pixel = softened);
    }

    /// Where the right view has that row, 1/65536 px, at twice that distance from its middle column.
    fn place_q16(&self, twice_x: i32, y: u32) -> i32 {
        let y = i32::try_from(y).unwrap_or(0);
        (y << FRAC_BITS) + self.ramp.displacement_q16([twice_x, 2 * y + 1 - i32::from(self.size[1])])
    }

    /// Whether the row is one of those that came.
    fn is_in_view(&self, row: i32) -> bool {
        u32::try_from(row).is_ok_and(|row| row < self.came)
    }

    /// Makes a row of the right view; whether all that it needs was there.
    fn interpolate(&mut self, y: u32) -> bool {
        let last = i32::try_from(self.came).unwrap_or(i32::MAX) - 1;
        let edge = i32::from(self.size[0]) - 1;
        let ends = [self.place_q16(-edge, y), self.place_q16(edge, y)];
        let clamp = |row: i32| u32::try_from(row.clamp(0, last)).unwrap_or(0);
        let reach = clamp(floor(ends[0].min(ends[1])))..=clamp(ceil(ends[0].max(ends[1])));
        if !reach.into_iter().all(|row| self.right.has(row)) {
            return false;
        }
        let width = usize::from(self.size[0]);
        let mut place = self.place_q16(3 - edge, y);
        let step = self.ramp.roll_q16 * 4;
        let (rows, right) = (&self.rows, &self.right);
        let Some(out) = self.out[0].get_mut(..width) else { return false };
        let row = |row: i32| right.row(rows, clamp(row), width);
        // The two rows that the runs lie between, as long as these stay the same.
        let mut at = floor(place);
        let (mut above, mut below) = (row(at), row(at + 1));
        let (runs, rest) = out.as_chunks_mut::<RUN>();
        let mut x = 0;
        for run in runs {
            if floor(place) != at {
                at = floor(place);
                (above, below) = (row(at), row(at + 1));
            }
            if let (Some(above), Some(below)) = (four(above, x), four(below, x)) {
                *run = mix_four(*above, *below, (place >> 8 & 255).unsigned_abs());
            }
            x += RUN;
            place += step;
        }
        let last = |row: &'_ [u8]| {
            row.get(x..).map_or([0; RUN], |rest| core::array::from_fn(|i| rest.get(i).copied().unwrap_or(0)))
        };
        let mixed = mix_four(last(row(floor(place))), last(row(floor(place) + 1)), (place >> 8 & 255).unsigned_abs());
        rest.iter_mut().zip(mixed).for_each(|(pixel, mixed)| *pixel = mixed);
        shift(out, self.columns);
        true
    }
}

/// Four pixels each of two rows mixed, `weight` / 256 of the lower one: two pixels in the lanes of a word at once.
const fn mix_four(above: [u8; RUN], below: [u8; RUN], weight: u32) -> [u8; RUN] {
    const LANES: u32 = 0x00FF_00FF;
    const HALF: u32 = 0x0080_0080;
    let (above, below) = (u32::from_le_bytes(above), u32::from_le_bytes(below));
    // A lane is at most 255 * 256 + 128, below 2^16.
    let even = (above & LANES) * (256 - weight) + (below & LANES) * weight + HALF;
    let odd = (above >> 8 & LANES) * (256 - weight) + (below >> 8 & LANES) * weight + HALF;
    (even >> 8 & LANES | odd & !LANES).to_le_bytes()
}

/// What the rows above and below each count, 1/256, where the right view is interpolated at this place: the product of both
/// weights. (As soft as that interpolation would be a half; views that were interpolated before profit from more.)
const fn softness(place: i32) -> u32 {
    let weight = (place >> 8 & 255).unsigned_abs();
    (weight * (256 - weight)) >> 8
}

/// Four pixels of three rows mixed, `weight` / 256 of the upper and of the lower one each, at most a quarter.
const fn soften_four(above: [u8; RUN], here: [u8; RUN], below: [u8; RUN], weight: u32) -> [u8; RUN] {
    const LANES: u32 = 0x00FF_00FF;
    const HALF: u32 = 0x0080_0080;
    let (above, here, below) = (u32::from_le_bytes(above), u32::from_le_bytes(here), u32::from_le_bytes(below));
    let rest = 256 - 2 * weight;
    // A lane is at most 255 * 256 + 128, below 2^16.
    let even = ((above & LANES) + (below & LANES)) * weight + (here & LANES) * rest + HALF;
    let odd = ((above >> 8 & LANES) + (below >> 8 & LANES)) * weight + (here >> 8 & LANES) * rest + HALF;
    (even >> 8 & LANES | odd & !LANES).to_le_bytes()
}

/// The four pixels of a row from `x` on.
fn four(row: &[u8], x: usize) -> Option<&[u8; RUN]> {
    row.get(x..x + RUN)?.first_chunk()
}

/// Moves a row left by `columns`, its border pixels repeated.
fn shift(row: &mut [u8], columns: i16) {
    let by = usize::from(columns.unsigned_abs()).min(row.len());
    let (first, last) = (row.first().copied().unwrap_or(0), row.last().copied().unwrap_or(0));
    let kept = row.len() - by;
    match columns {
        1.. => {
            row.copy_within(by.., 0);
            row.iter_mut().skip(kept).for_each(|pixel| *pixel = last);
        }
        0 => {}
        _ => {
            row.copy_within(..kept, by);
            row.iter_mut().take(by).for_each(|pixel| *pixel = first);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    const WIDTH: u16 = 40;

    /// A row's pixels as a float picture of that row has them: any function of place, linear in y.
    fn pixel(x: i32, y: f64) -> f64 {
        40.0 + f64::from(x % 7) + 3.0 * y
    }

    fn play(ramp: Ramp, columns: i16, height: u16, lost: &[u16]) -> Vec<(u32, Option<Vec<u8>>)> {
        let mut rectifier =
            Rectifier::<80, 48>::new([WIDTH, height], Rectification { columns, ..ramp.into() }).unwrap();
        let mut rows = Vec::new();
        let mut note = |row: RectifiedRow<'_>| {
            rows.push((row.y, row.pair.map(|pair| pair.right.to_vec())));
        };
        rectifier.start();
        for y in 0..height {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rounded, in range")]
            let row: Vec<u8> = (0..i32::from(WIDTH)).map(|x| pixel(x, f64::from(y)).round() as u8).collect();
            if lost.contains(&y) {
                rectifier.miss(&mut note);
            } else {
                rectifier.push(ScanlinePair { left: &row, right: &row }, &mut note).unwrap();
            }
        }
        rectifier.finish(&mut note);
        rows
    }

    proptest! {
        #[test]
        fn every_row_comes_out_once_and_shows_what_the_ramp_says(
            rows_q16 in -(12 << 16)..12 << 16, roll_q16 in -3000..3000, scale_q16 in -2000..2000,
        ) {
            let (ramp, height) = (Ramp { rows_q16, roll_q16, scale_q16 }, 44);
            let rows = play(ramp, 0, height, &[]);
            prop_assert!(rows.iter().map(|row| row.0).eq(0..u32::from(height)));
            for (y, right) in rows {
                let twice_y = 2 * i32::try_from(y).unwrap() + 1 - i32::from(height);
                let place = |x: i32| {
                    let twice_x = 2 * x + 1 - i32::from(WIDTH);
                    f64::from(y) + f64::from(ramp.displacement_q16([twice_x, twice_y])) / 65_536.0
                };
                let last = f64::from(height) - 1.0;
                let middle = (place(19) + place(20)) / 2.0;
                prop_assert!(right.is_some() || middle < 0.0 || middle > last, "row {y}: {middle}");
                for (x, found) in (0..).zip(right.unwrap_or_default()) {
                    let wanted = pixel(x, place(x).clamp(0.0, last));
                    // One weight for four columns: up to 1.5 columns of roll, and two roundings.
                    let most = 1.5 * f64::from(roll_q16.abs()) / 65_536.0 * 3.0 + 1.1;
                    prop_assert!((f64::from(found) - wanted).abs() <= most, "{x}, {y}: {found}, {wanted}");
                }
            }
        }
    }

    #[test]
    fn a_lost_row_takes_those_that_need_it() {
        let half = Ramp { rows_q16: 3 << 15, ..Ramp::default() };
        let rows = play(half, 0, 12, &[5]);
        let missed: Vec<u32> = rows.iter().filter(|row| row.1.is_none()).map(|row| row.0).collect();
        // Rows 3 and 4 need right row 5, row 5 has no left one; what the last one shows lies outside.
        assert_eq!(missed, [3, 4, 5, 11]);
    }

    #[test]
    fn the_left_view_is_softened_as_the_right_one_is_interpolated() {
        let lefts = |ramp: Ramp| {
            let mut rectifier = Rectifier::<8, 48>::new([WIDTH, 5], ramp.into()).unwrap();
            let mut lefts = Vec::new();
            let mut note = |row: RectifiedRow<'_>| {
                lefts.extend(row.pair.map(|pair| (pair.left[0], pair.left[39])));
            };
            for y in 0..5 {
                let row = [if y == 2 { 228 } else { 100 }; WIDTH as usize];
                rectifier.push(ScanlinePair { left: &row, right: &row }, &mut note).unwrap();
            }
            rectifier.finish(&mut note);
            lefts
        };
        // A quarter of a step of 128 from either side.
        let half = Ramp { rows_q16: 1 << 15, ..Ramp::default() };
        let wanted = [(100, 100), (132, 132), (164, 164), (132, 132), (100, 100)];
        assert_eq!(lefts(half), wanted);
        assert_eq!(lefts(Ramp::whole(0)), [100, 100, 228, 100, 100].map(|grey| (grey, grey)));
        // Turned about the middle: a whole row off at the border, hence sharp there.
        let turned = Ramp { roll_q16: 65_536 / 20, ..Ramp::default() };
        let row = lefts(turned)[2];
        assert!(row.0 > 200 && row.1 > 200, "{row:?}");
    }

    #[test]
    fn whole_offsets_copy_rows_and_columns() {
        for (rows, columns) in [(3, 0), (-3, 2), (0, -5)] {
            for (y, right) in play(Ramp::whole(rows), columns, 10, &[]) {
                let source = i64::from(y) + i64::from(rows);
                let Some(right) = right else {
                    assert!(!(0..10).contains(&source));
                    continue;
                };
                for (x, found) in (0..).zip(right) {
                    let column = (x + i32::from(columns)).clamp(0, i32::from(WIDTH) - 1);
                    assert_eq!(f64::from(found), pixel(column, f64::from(i32::try_from(source).unwrap())));
                }
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_refused_with_the_rows_needed() {
        let new =
            |ramp| Rectifier::<21, 48>::new([WIDTH, 30], Rectification::from(ramp)).map(|stage| stage.waiting_rows());
        assert_eq!(new(Ramp::whole(9)), Ok(9));
        assert_eq!(new(Ramp::whole(-18 + 8)), Ok(0));
        let steep = Ramp { rows_q16: 12 << 16, roll_q16: 6554, scale_q16: 0 };
        assert_eq!(new(steep), Ok(14));
        let wide = Ramp { scale_q16: 6554, ..steep };
        let needed = wide.rows_needed([WIDTH, 30]);
        assert_eq!(new(wide), Err(ConfigError::RingRows { needed: u16::try_from(needed).unwrap(), rows: 21 }));
        assert_eq!(new(Ramp { roll_q16: 7000, ..steep }), Err(ConfigError::RowOffset { max_rows: 16 }));
    }
}
