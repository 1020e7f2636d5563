//! Peaks, troughs and slopes of a line of grey levels, each with the template around it (the paper's S1).
#![allow(clippy::needless_range_loop, reason = "words of several rows at one number")]

use crate::front_end::camera_view::Row;
use crate::lanes::rows::FLIP;
use crate::lanes::{ONES, add, max, select_ge, splat, sub};
use crate::matching::extremum::parabola;

/// Widest template, px.
pub(super) const MAX_WIDTH: usize = 9;
/// Rows of that template above its middle.
const MIDDLE: usize = 4;
/// Grey levels are in 1/8.
pub(super) const ONE: i16 = 8;
/// Least step between neighbours that counts as one, grey levels.
const LEAST_LEVELS: u32 = 2;
/// The same in 1/8.
const LEAST_STEP: i16 = 2 * ONE;

/// What a line does at an extremum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Shape {
    /// No extremum here.
    #[default]
    None,
    Peak,
    Trough,
    /// The middle of a peak or trough of several equal pixels, along rows only.
    Plateau,
    /// The steepest point of a rising segment: its first bright pixel.
    Rise,
    /// The steepest point of a falling one.
    Fall,
}

impl Shape {
    /// The shape at the third of four neighbours on a line.
    fn of([first, before, here, after]: [i16; 4]) -> Self {
        let [earlier, rise, later] = [before - first, here - before, after - here];
        let steep = |a: i16, b: i16, c: i16| b >= LEAST_STEP && b > a && b >= c;
        match (rise >= LEAST_STEP, later <= -LEAST_STEP, rise <= -LEAST_STEP, later >= LEAST_STEP) {
            (true, true, ..) => Self::Peak,
            (.., true, true) => Self::Trough,
            _ if steep(earlier, rise, later) => Self::Rise,
            _ if steep(-earlier, -rise, -later) => Self::Fall,
            _ => Self::None,
        }
    }
}

/// An extremum of a line and the template of `N` pixels around it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extremum<const N: usize> {
    pub(super) column: u16,
    pub(super) shape: Shape,
    /// By how much it lies right of its pixel, 1/16 px.
    pub(super) fraction: i8,
    /// The values less their mean, times `N`: 1/8 grey level.
    template: [i16; N],
}

impl<const N: usize> Extremum<N> {
    const NONE: Self = Self { column: 0, shape: Shape::None, fraction: 0, template: [0; N] };

    /// Sum of the distances of the differences from their mean, times `N`: in 1/8 grey level, at most 9 * 2 * 9 * 2040.
    #[inline(always)]
    pub(super) fn difference(&self, other: &Self) -> i32 {
        crate::count::evaluations(1);
        let pairs = self.template.iter().zip(&other.template);
        pairs.map(|(&a, &b)| (i32::from(a) - i32::from(b)).abs()).sum()
    }
}

/// The template of values.
#[inline(always)]
fn template<const N: usize>(values: [i16; N]) -> [i16; N] {
    let sum: i16 = values.iter().sum();
    values.map(|value| WIDTHS[N] * value - sum)
}

/// Widths of templates as numbers to count with.
pub(super) const WIDTHS: [i16; MAX_WIDTH + 1] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9];

/// The extrema of one line, left to right.
#[derive(Debug, Clone)]
pub(super) struct Extrema<const N: usize, const BLOCKS: usize> {
    list: [[Extremum<N>; 4]; BLOCKS],
    len: usize,
}

impl<const N: usize, const BLOCKS: usize> Extrema<N, BLOCKS> {
    pub(super) const fn new() -> Self {
        Self { list: [[Extremum::NONE; 4]; BLOCKS], len: 0 }
    }

    pub(super) fn as_slice(&self) -> &[Extremum<N>] {
        &self.list.as_flattened()[..self.len]
    }

    #[inline(always)]
    fn push(&mut self, extremum: Extremum<N>) {
        if let Some(place) = self.list.as_flattened_mut().get_mut(self.len) {
            *place = extremum;
            self.len += 1;
        }
    }

    /// Finds the extrema of a line along a row. Those whose template leaves the view are left out.
    #[inline(never)]
    pub(super) fn find_along(&mut self, values: &[i16]) {
        self.len = 0;
        let push = |extrema: &mut Self, x: usize, shape: Shape| {
            let around = x.checked_sub(N / 2).and_then(|first| values.get(first..)?.first_chunk::<N>());
            if let (Some(&around), Ok(column)) = (around, u16::try_from(x)) {
                let fraction = i8::try_from(fraction(values, x, shape)).unwrap_or(0);
                extrema.push(Extremum { column, shape, fraction, template: template(around) });
            }
        };
        // First column of the run of equal values.
        let mut start = usize::from(values.first() != values.get(1));
        for (x, around) in (2..).zip(values.windows(4)) {
            let [first, before, here, after] = [around[0], around[1], around[2], around[3]];
            let shape = Shape::of([first, before, here, after]);
            if shape != Shape::None {
                push(self, x, shape);
            }
            if here != before {
                start = x;
            } else if here != after && start > 0 {
                let edge = values[start - 1];
                let [rise, fall] = [here - edge, here - after];
                if rise.min(fall) >= LEAST_STEP || rise.max(fall) <= -LEAST_STEP {
                    let middle = usize::midpoint(start, x);
                    // What begins the plateau is no rise or fall of its own.
                    if self.as_slice().last().is_some_and(|last| usize::from(last.column) == middle) {
                        self.len -= 1;
                    }
                    push(self, middle, Shape::Plateau);
                }
            }
        }
    }

    /// Finds the extrema of the lines down the columns in the row in the middle of `rows`.
    #[inline(never)]
    pub(super) fn find_down(&mut self, rows: [&Row<BLOCKS>; MAX_WIDTH], width: usize) {
        self.len = 0;
        let words = width.div_ceil(4);
        let is_one = |step: u32| select_ge(step, splat(LEAST_LEVELS), ONES, 0);
        for i in 1..=words {
            let at = |y: usize| rows[y][i] ^ FLIP;
            let (before, here) = (at(MIDDLE - 1), at(MIDDLE));
            let (rise, fall) = (sub(here, before), sub(before, here));
            if rise | fall == 0 {
                continue;
            }
            let (first, after) = (at(MIDDLE - 2), at(MIDDLE + 1));
            let (up, down) = (is_one(rise), is_one(fall));
            let (sinks, climbs) = (sub(here, after), sub(after, here));
            let (peaks, troughs) = (up & is_one(sinks), down & is_one(climbs));
            // A step that is greater than the one before and no less than the one after.
            let steep = |step: u32, earlier: u32, later: u32| select_ge(step, max(add(earlier, ONES), later), ONES, 0);
            let rises = up & !peaks & steep(rise, sub(before, first), climbs);
            let falls = down & !troughs & steep(fall, sub(first, before), sinks);
            let mut shapes = peaks | troughs | rises | falls;
            while shapes != 0 {
                let bits = shapes.trailing_zeros();
                shapes &= shapes - 1;
                let has = |lanes: u32| lanes >> bits & 1 == 1;
                let shape = match (has(peaks), has(troughs), has(rises)) {
                    (true, ..) => Shape::Peak,
                    (_, true, _) => Shape::Trough,
                    (.., true) => Shape::Rise,
                    _ => Shape::Fall,
                };
                let column = 4 * (i - 1) + bits as usize / 8;
                if column < width
                    && let Ok(column) = u16::try_from(column)
                {
                    let values = core::array::from_fn(|k| pixel(at(MIDDLE - N / 2 + k), bits) * ONE);
                    self.push(Extremum { column, shape, fraction: 0, template: template(values) });
                }
            }
        }
    }
}

/// The byte of a word that begins at a bit.
#[inline(always)]
pub(super) const fn pixel(word: u32, bit: u32) -> i16 {
    (word >> bit & 0xff) as i16
}

/// By how much an extremum lies right of its pixel, 1/16 px: vertex of the parabola through the values of a peak, through
/// the steps of a rise.
fn fraction(values: &[i16], x: usize, shape: Shape) -> i32 {
    let value = |x: Option<usize>| x.and_then(|x| values.get(x)).copied().map_or(0, i32::from);
    let [far, before, here, after] = [x.checked_sub(2), x.checked_sub(1), Some(x), Some(x + 1)].map(value);
    match shape {
        Shape::Peak => parabola(-before, -here, -after),
        Shape::Trough => parabola(before, here, after),
        Shape::Rise => parabola(far - before, before - here, here - after),
        Shape::Fall => parabola(before - far, here - before, after - here),
        Shape::Plateau | Shape::None => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    #[test]
    fn each_shape_is_told_from_the_others() {
        let cases = [
            ([0, 80, 160, 80], Shape::Peak),
            ([160, 80, 0, 80], Shape::Trough),
            ([0, 2, 80, 82], Shape::Rise),
            ([82, 80, 2, 0], Shape::Fall),
            ([0, 40, 80, 120], Shape::None),
            ([5, 5, 5, 5], Shape::None),
            ([0, 0, 12, 0], Shape::None),
        ];
        for (values, shape) in cases {
            assert_eq!(Shape::of(values), shape, "{values:?}");
        }
    }

    fn found(extrema: &Extrema<3, 4>) -> Vec<(u16, Shape)> {
        extrema.as_slice().iter().map(|extremum| (extremum.column, extremum.shape)).collect()
    }

    #[test]
    fn a_plateau_is_the_middle_of_equal_pixels_above_or_below_their_neighbours() {
        let mut extrema = Extrema::<3, 4>::new();
        extrema.find_along(&[0, 90, 90, 90, 0, 0, 0, 70, 70, 200, 200, 200]);
        let plateaus: Vec<u16> =
            found(&extrema).into_iter().filter(|(_, shape)| *shape == Shape::Plateau).map(|(x, _)| x).collect();
        assert_eq!(plateaus, [2, 5]);
    }

    #[test]
    fn lines_down_the_columns_have_the_shapes_of_their_values() {
        let columns: [[u8; 4]; 8] = [
            [0, 10, 20, 10],
            [20, 10, 0, 10],
            [0, 2, 20, 22],
            [22, 20, 2, 0],
            [0, 10, 20, 30],
            [5, 5, 5, 5],
            [0, 0, 255, 0],
            [7, 7, 8, 8],
        ];
        let row = |y: usize| {
            let word = |x: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| columns[x + i][y])) ^ FLIP;
            [0, word(0), word(4), 0]
        };
        let rows = [0, 0, 0, 1, 2, 3, 3, 3, 3].map(row);
        let mut extrema = Extrema::<3, 4>::new();
        extrema.find_down(rows.each_ref(), 8);
        let expected: Vec<(u16, Shape)> = (0..)
            .zip(columns)
            .map(|(x, column)| (x, Shape::of(column.map(|value| i16::from(value) * ONE))))
            .filter(|(_, shape)| *shape != Shape::None)
            .collect();
        assert_eq!(found(&extrema), expected);
    }

    #[test]
    fn envelopes_that_differ_by_an_offset_do_not_differ() {
        let of = |values| Extremum { template: template(values), ..Extremum::NONE };
        assert_eq!(of([40, 90, 20]).difference(&of([140, 190, 120])), 0);
        // Differences 0, 0, -3 lie 1, 1 and 2 from their mean, 3 times that.
        assert_eq!(of([40, 90, 20]).difference(&of([40, 90, 23])), 12);
    }

    #[test]
    fn a_template_that_leaves_the_view_is_none() {
        let values = [0, 80, 0, 80, 0, 80, 0, 80, 0];
        let mut short = Extrema::<3, 4>::new();
        short.find_along(&values);
        assert_eq!(found(&short).len(), 6, "from column 2 to column 7");
        let mut long = Extrema::<9, 4>::new();
        long.find_along(&values);
        assert!(long.as_slice().iter().map(|extremum| extremum.column).eq([4]));
    }
}
