//! Rectification's innermost loops: pixels between two rows and between columns, four at once by one place; and rows copied.
//!
//! The emulated chip's rows are held against those of portable code on the host.
#![allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "a run is a few pixels")]

/// Pixels that share a place.
pub(crate) const RUN: usize = 4;
/// Pixels that are made at once.
pub(crate) const SEGMENT: usize = 8 * RUN;
/// Rows between which places go straight.
pub(crate) const KNOT_ROWS: usize = 1 << KNOT_BITS;
/// The same as a power of 2.
pub(crate) const KNOT_BITS: u32 = 4;

/// Where the runs of a segment lie in one direction, 1/65536 px.
///
/// Place of the first run; from a run to the next one; by how much that grows from a pair of runs to the next one.
pub(crate) type Curve = [i32; 3];

/// Places of the eight runs.
#[inline(always)]
pub(crate) const fn places([first, mut step, bend]: Curve) -> [i32; 8] {
    let mut places = [first; 8];
    let mut k = 1;
    while k < 8 {
        places[k] = places[k - 1].wrapping_add(step);
        if k.is_multiple_of(2) {
            step = step.wrapping_add(bend);
        }
        k += 1;
    }
    places
}

/// Part of how a segment's runs lie and how that changes from row to row. Only [`start`], [`aim`] and [`skip`] make one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Number(i32);

impl Number {
    pub(crate) const NONE: Self = Self(0);
}

/// Numbers of a segment.
pub(crate) const LEN: usize = 13;

/// A segment's runs: for the next row place and step across, place and step down; by how much these grow from row to row; both
/// bends; how far above and below the first run the others lie at most; by how much the bend down grows.
pub(crate) type Segment = [Number; LEN];

/// Stands for "too far above": such a segment is not made at once.
const FAR: i32 = -(1 << 30);

/// The curves across and down of the next row.
#[inline(always)]
pub(crate) const fn curves(segment: &Segment) -> [Curve; 2] {
    let [x, x_step, y, y_step, _, _, _, _, x_bend, y_bend, ..] = *segment;
    [[x.0, x_step.0, x_bend.0], [y.0, y_step.0, y_bend.0]]
}

/// A segment that stays as it is from row to row; it is not made before it is aimed.
pub(crate) const fn start([[x, x_step, x_bend], [y, y_step, y_bend]]: [Curve; 2]) -> Segment {
    let numbers = [x, x_step, y, y_step, 0, 0, 0, 0, x_bend, y_bend, FAR, 0, 0];
    let mut segment = [Number::NONE; LEN];
    let mut i = 0;
    while i < LEN {
        segment[i] = Number(numbers[i]);
        i += 1;
    }
    segment
}

/// Least and greatest place of a curve's runs beside its first one, some more.
#[inline(always)]
pub(crate) fn beside([_, step, bend]: Curve) -> [i32; 2] {
    // After k pairs a run lies at `2 k step + k (k - 1) bend`, the one that follows it at `(2 k + 1) step + k^2 bend`: from
    // the line to the last of them at most 3.15 bends away.
    let end = 7 * step + 9 * bend;
    let beyond = 4 * bend.abs();
    [end.min(0) - beyond, end.max(0) + beyond]
}

/// Goes on from the next row so that [`KNOT_ROWS`] rows later the curves are `knot`, but the bend across at once; of a camera whose
/// last column is `last`. Until then the segment may be made, and no longer.
#[inline(always)]
pub(crate) fn aim<const WIDTH: usize>(segment: &mut Segment, knot: [Curve; 2], last: u16) {
    let [across, down] = curves(segment);
    let [to_across, to_down] = knot;
    let growth = |from: i32, to: i32| (to - from) >> KNOT_BITS;
    let end = |from: i32, growth: i32| from + KNOT_ROWS as i32 * growth;
    let x_growth = [0, 1].map(|k| growth(across[k], to_across[k]));
    let y_growth = [0, 1, 2].map(|k| growth(down[k], to_down[k]));
    // All places go straight from row to row: what holds at both ends holds between them.
    let bend = to_across[2];
    let ends = [[across[0], across[1]], [0, 1].map(|k| end(across[k], x_growth[k]))];
    let is_inside = are_within(ends, bend, last) && usize::from(last) < WIDTH;
    let [[a, b], [c, d]] = [down, [0, 1, 2].map(|k| end(down[k], y_growth[k]))].map(beside);
    let [least, most] = [a.min(c), b.max(d)];
    let least = if is_inside && most - least < MOST_APART << 16 { least } else { FAR };
    let [a, b, c] = y_growth;
    let values = [x_growth[0], x_growth[1], a, b, bend, down[2], least, most, c];
    segment.iter_mut().skip(4).zip(values).for_each(|(number, value)| number.0 = value);
}

/// Goes on to the row below without making this one.
#[inline(always)]
pub(crate) fn skip(segment: &mut Segment) {
    let [x, x_step, y, y_step, a, b, c, d, _, bend, _, _, e] = segment;
    for (number, growth) in [(x, a), (x_step, b), (y, c), (y_step, d), (bend, e)] {
        number.0 = number.0.wrapping_add(growth.0);
    }
}

/// Whether runs from either place on, in steps that begin with the place's own, read columns 0 to `last` only.
#[inline(always)]
const fn are_within([[a, a_step], [b, b_step]]: [[i32; 2]; 2], bend: i32, last: u16) -> bool {
    // No place, no step is negative then, none that comes later, and nothing overflows.
    let four = bend.wrapping_mul(4);
    let numbers = a | a_step | a_step.wrapping_add(four) | b | b_step | b_step.wrapping_add(four);
    if numbers.cast_unsigned() >> 27 != 0 || bend.wrapping_add(1 << 20).cast_unsigned() >> 21 != 0 {
        return false;
    }
    // After k pairs the second run lies at `a + (2 k + 1) a_step + k^2 bend`.
    let (a, b) = (a + 7 * a_step, b + 7 * b_step);
    let eighth = if a > b { a } else { b } + 9 * bend;
    (eighth >> 16) + 4 <= last as i32
}

/// Most rows that [`make`] takes.
pub(crate) const MAX_ROWS: usize = 128;
/// A segment lies between rows that are so many px apart, or a little fewer.
pub(super) const MOST_APART: i32 = 4;

/// Rows of a camera: row `y` is at place `y % rows.len()`, of those from `first` to `last`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View<'a, const WIDTH: usize> {
    pub(crate) rows: &'a [[u8; WIDTH]],
    pub(crate) first: i32,
    pub(crate) last: i32,
}

/// Makes a row of segments, which go on to the row below; how many of them, up to the first one that does not lie within the view or
/// lies between too many rows.
#[inline(always)]
pub(crate) fn make<const WIDTH: usize>(
    segments: &mut [Segment],
    view: View<'_, WIDTH>,
    out: &mut [[u8; SEGMENT]],
) -> usize {
    let View { rows, first, last } = view;
    let len = i32::try_from(rows.len().min(MAX_ROWS + 1)).unwrap_or(0);
    if len == 0 || rows.len() > MAX_ROWS || first < 0 || last - first >= len || last >= 1 << 14 {
        return 0;
    }
    // Row at the first place.
    let turn = first - first % len;
    #[cfg(haarline_dsp)]
    let made = super::cortex_m::make_rows(segments, rows, [first, last, turn, turn + len], out);
    #[cfg(not(haarline_dsp))]
    let made = portable(segments, rows, [first, last, turn, turn + len], out);
    made
}

/// First and last row, those at the first place, before and after a turn.
pub(super) type Rows = [i32; 4];

#[cfg(any(not(haarline_dsp), test))]
fn portable<const WIDTH: usize>(
    segments: &mut [Segment],
    rows: &[[u8; WIDTH]],
    [first, last, turn, next_turn]: Rows,
    out: &mut [[u8; SEGMENT]],
) -> usize {
    for (nth, (segment, out)) in segments.iter_mut().zip(&mut *out).enumerate() {
        let [across, down] = curves(segment);
        let [least, most] = [10, 11].map(|i: usize| segment[i].0.wrapping_add(down[0]));
        if least < first << 16 || most >= last << 16 {
            return nth;
        }
        let turn = if least >= next_turn << 16 { next_turn } else { turn };
        for ((run, x), y) in out.as_chunks_mut::<RUN>().0.iter_mut().zip(places(across)).zip(places(down)) {
            let place = usize::try_from((y >> 16) - turn).unwrap_or(0);
            let [above, below] = [place, place + 1].map(|place| &rows[place % rows.len()]);
            *run = mix_run(above, below, x, y.cast_unsigned() >> 12 & 15).unwrap_or_default();
        }
        skip(segment);
    }
    segments.len().min(out.len())
}

/// A run at a place, with the weight of the lower row; `None` where it lies beyond the rows.
#[inline(always)]
pub(crate) fn mix_run(above: &[u8], below: &[u8], at: i32, down: u32) -> Option<[u8; RUN]> {
    let x = usize::try_from(at >> 16).ok()?;
    Some(mix(five(above, x)?, five(below, x)?, [at.cast_unsigned() >> 12 & 15, down]))
}

/// Columns `x` to `x + 3` and the same one further right.
#[inline(always)]
fn five(row: &[u8], x: usize) -> Option<[u32; 2]> {
    let [a, b, c, d, e] = *row.get(x..)?.first_chunk::<{ RUN + 1 }>()?;
    Some([u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([b, c, d, e])])
}

/// Four pixels between two rows and between columns, two in the lanes of a word at once.
#[inline(always)]
pub(crate) const fn mix(above: [u32; 2], below: [u32; 2], [across, down]: [u32; 2]) -> [u8; RUN] {
    const LANES: u32 = 0x00FF_00FF;
    const HALF: u32 = 0x0080_0080;
    let up = 16 - down;
    // Columns 0 and 2, 1 and 3, 2 and 4; at most 255 * 16 in a lane.
    let first = (above[0] & LANES) * up + (below[0] & LANES) * down;
    let second = (above[0] >> 8 & LANES) * up + (below[0] >> 8 & LANES) * down;
    let third = (above[1] >> 8 & LANES) * up + (below[1] >> 8 & LANES) * down;
    // At most 255 * 256 + 128, below 2^16.
    let back = 16 - across;
    let even = first * back + second * across + HALF;
    let odd = second * back + third * across + HALF;
    (even >> 8 & LANES | odd & !LANES).to_le_bytes()
}

/// Copies a row; as many columns as both have.
#[inline(always)]
pub(crate) fn copy(row: &[u8], to: &mut [u8]) {
    #[cfg(haarline_dsp)]
    let (row, to) = super::cortex_m::copy_words(row, to);
    to.iter_mut().zip(row).for_each(|(to, &pixel)| *to = pixel);
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    fn rows<const ROWS: usize, const WIDTH: usize>() -> [[u8; WIDTH]; ROWS] {
        core::array::from_fn(|y| core::array::from_fn(|x| (x * x * 37 + y * x * 91).to_le_bytes()[0]))
    }

    /// A segment whose curves do not change.
    fn still(curves: [Curve; 2], last: u16) -> Segment {
        let mut segment = start(curves);
        aim::<80>(&mut segment, curves, last);
        segment
    }

    #[test]
    fn pixels_are_mixed_bilinearly() {
        let rows: [[u8; 80]; 5] = rows();
        let [across, down] = [[2 << 16 | 5 << 12, 4 << 16 | 3 << 11, -900], [8 << 16 | 10 << 12, 1 << 12, 40]];
        let mut segments = [still([across, down], 79)];
        let mut out = [[0; SEGMENT]];
        // Row 8 is at place 3: the table turns between rows 9 and 10.
        assert_eq!(make(&mut segments, View { rows: &rows, first: 7, last: 11 }, &mut out), 1);
        for ((run, x), y) in out[0].chunks(RUN).zip(places(across)).zip(places(down)) {
            for (i, &found) in (0..).zip(run) {
                let [x, y] = [x, y].map(|place| f64::from(place >> 12) / 16.0);
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the view")]
                let [column, line] = [x as usize + i, y as usize];
                let row = |row: &[u8]| {
                    f64::from(row[column]) + (f64::from(row[column + 1]) - f64::from(row[column])) * x.fract()
                };
                let [above, below] = [line, line + 1].map(|line| row(&rows[line % 5]));
                let wanted = above + (below - above) * y.fract();
                assert!((f64::from(found) - wanted).abs() <= 0.5 + 1e-9, "{x} {y}, {i}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn what_reaches_beyond_the_columns_is_not_made() {
        let is_made = |at, step, bend| {
            let mut segments = [still([[at, step, bend], [1 << 16, 0, 0]], 39)];
            let made = make(&mut segments, View { rows: &[[7; 40]; 4], first: 0, last: 3 }, &mut [[0; SEGMENT]]) == 1;
            assert_eq!(made, are_within([[at, step]; 2], bend, 39));
            made
        };
        assert!(is_made(0, 4 << 16, 0) && is_made(7 << 16, 4 << 16, 0) && is_made(3 << 16, 4 << 16, -99));
        assert!(!is_made(-1, 4 << 16, 0) && !is_made(8 << 16, 4 << 16, 0) && !is_made(0, 4 << 16, 1 << 16));
        assert!(!is_made(0, 1 << 28, 0) && !is_made(1 << 28, 4 << 16, 0) && !is_made(0, 4 << 16, -(1 << 16) - 1));
        // A row narrower than it was said to be.
        let curves = [[0, 4 << 16, 0], [1 << 16, 0, 0]];
        let mut segment = start(curves);
        aim::<40>(&mut segment, curves, 40);
        assert_eq!(make(&mut [segment], View { rows: &[[7; 40]; 4], first: 0, last: 3 }, &mut [[0; SEGMENT]]), 0);
    }

    #[test]
    fn what_reaches_beyond_the_rows_is_not_made() {
        let made = |at: i32, step: i32, first: i32, last: i32| {
            let mut segments = [still([[0, 4 << 16, 0], [at, step, 0]], 79)];
            make(&mut segments, View { rows: &rows::<6, 80>(), first, last }, &mut [[0; SEGMENT]])
        };
        assert_eq!([made(3 << 16, 0, 3, 4), made(4 << 16, 0, 3, 4), made((3 << 16) - 1, 0, 3, 4)], [1, 0, 0]);
        assert_eq!([made(3 << 16, 9000, 3, 4), made(3 << 16, 9400, 3, 4), made(3 << 16, -1, 3, 4)], [1, 0, 0]);
        assert_eq!([made(3 << 16, 0, -1, 4), made(3 << 16, 0, 0, 6), made(3 << 16, 50_000, 1, 6)], [0, 0, 0]);
        assert_eq!(
            make(&mut [start([[0; 3]; 2])], View { rows: &[[7; 80]; 4], first: 0, last: 3 }, &mut [[0; SEGMENT]]),
            0
        );
    }

    proptest! {
        #[test]
        fn the_bounds_hold_all_runs(
            from in prop::array::uniform3(-60_000..60_000_i32), to in prop::array::uniform3(-60_000..60_000_i32),
        ) {
            let mut segment = start([[0, 4 << 16, 0], from]);
            aim::<80>(&mut segment, [[0, 4 << 16, 0], to], 79);
            let [least, most] = [10, 11].map(|i: usize| segment[i].0);
            for _ in 0..KNOT_ROWS {
                let down = curves(&segment)[1];
                for place in places(down) {
                    prop_assert!(least == FAR || (least..=most).contains(&(place - down[0])), "{place} {least} {most}");
                }
                skip(&mut segment);
            }
        }

        #[test]
        fn this_target_equals_portable_code(
            curves in prop::collection::vec(
                (0..3_i32 << 16, 200_000..300_000_i32, -300..300_i32, 5 << 16..12_i32 << 16, -20_000..20_000_i32, -2000..2000_i32), 3),
            first in 0..7_i32, extreme in any::<bool>(),
        ) {
            let mut rows: [[u8; 80]; 9] = rows();
            if extreme {
                rows.as_flattened_mut().iter_mut().for_each(|pixel| *pixel = if *pixel < 128 { 0 } else { 255 });
            }
            let mut segments: Vec<Segment> =
                curves.iter().map(|&(a, b, c, d, e, f)| still([[a, b, c], [d, e, f]], 79)).collect();
            let mut same = segments.clone();
            let view = View { rows: &rows, first, last: first + 8 };
            let (mut a, mut b) = ([[0; SEGMENT]; 3], [[0; SEGMENT]; 3]);
            for _ in 0..4 {
                let turn = first - first % 9;
                let made = portable(&mut same, &rows, [first, first + 8, turn, turn + 9], &mut b);
                prop_assert_eq!(make(&mut segments, view, &mut a), made);
                prop_assert!(a == b && segments == same);
            }
        }
    }

    #[test]
    fn rows_are_copied_as_far_as_both_go() {
        let row: [u8; 70] = core::array::from_fn(|x| x.to_le_bytes()[0]);
        for (first, len) in [(0, 70), (1, 64), (3, 15), (2, 33), (0, 0)] {
            let mut to = [0xff; 70];
            copy(&row[first..first + len], &mut to[1..66]);
            let end = 1 + len.min(65);
            assert_eq!(to[1..end], row[first..][..len.min(65)]);
            assert!(to[0] == 0xff && to[end..].iter().all(|&byte| byte == 0xff));
        }
    }
}
