//! The method `envelope`: intensity envelopes of both views, matched (the paper's S1).
#![allow(clippy::needless_range_loop, reason = "words of several rows at one number")]

use crate::answer::confidence::Merit;
use crate::answer::linkage::{Links, PointRows};
use crate::front_end::camera_view::Row;
use crate::lanes::rows::FLIP;
use crate::lanes::{ONES, add, max, select_ge, splat, sub};
use crate::matching::extremum::{Minimum, parabola};
use crate::method::sparse::{LEAST_REACH, Points, Sparse, SparseRows};
use crate::stage::{Stage, StageClock, Untimed};
use crate::{Config, ConfigError};

/// Widest template, px.
const MAX_WIDTH: usize = 9;
/// Smoothed rows that are kept: the widest template down a column, and one more.
const ROWS: usize = MAX_WIDTH + 1;
/// Rows of that template above its middle.
const MIDDLE: usize = 4;
/// Links of an envelope, which few others support: single envelopes are wrong half of the time.
const LINKS: Links = Links { least: 8, share: 6 };
/// Grey levels are in 1/8.
const ONE: i16 = 8;
/// Bits of a column; differences have 19.
const COLUMN_BITS: u32 = 11;
/// Least step between neighbours that counts as one, grey levels.
const LEAST_LEVELS: u32 = 2;
/// The same in 1/8.
const LEAST_STEP: i16 = 2 * ONE;

/// How envelopes are matched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EnvelopeSettings {
    /// Pixels of a template: odd, 3 to 9.
    pub template_width: u8,
    /// How much two envelopes may differ in the mean after their mean difference is removed, grey levels.
    pub dispersion: u8,
    /// Percent by which the second least difference must exceed the least.
    pub uniqueness_ratio: u8,
    /// Whether segments along the columns give points, too.
    pub columns: bool,
    /// Whether points are left out that those around them do not support.
    pub linked_only: bool,
}

impl EnvelopeSettings {
    /// The paper's template of 3 px and dispersion of 30, rows or columns; supported points only.
    pub const DEFAULT: Self =
        Self { template_width: 3, dispersion: 30, uniqueness_ratio: 20, columns: true, linked_only: true };
}

impl Default for EnvelopeSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Sparse stereo by the shapes of the grey levels along a line: what the paper puts in the place of blocks.
///
/// A line falls into monotone segments. Their ends, the peaks, troughs and plateaus of the line, and the
/// steepest point of each rise and fall are its extrema, and a few pixels around one are its envelope. It
/// matches the envelope of the same shape in the same row of the right view that differs least after the
/// mean difference is removed, if that is within the dispersion and stands out; the distance of the two
/// extrema is the disparity. Points come from segments along rows or along columns, for two rows at a time (the paper's
/// section 3, Fig. 1).
///
/// `BLOCKS` is the capacity: [`blocks_for`](crate::blocks_for) the widest row.
pub type EnvelopeStereo<const BLOCKS: usize, C = Untimed> = Sparse<EnvelopePoints<BLOCKS>, ROWS, BLOCKS, C>;

impl<const BLOCKS: usize> EnvelopeStereo<BLOCKS> {
    /// Builds the method for rows of `config.width` px.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        Self::with_settings(config, EnvelopeSettings::DEFAULT)
    }

    /// Builds the method with other settings.
    ///
    /// # Errors
    /// If the configuration is invalid, the width over the capacity or a template even, narrower than 3
    /// or wider than 9 px.
    pub fn with_settings(config: Config, settings: EnvelopeSettings) -> Result<Self, ConfigError> {
        let width = usize::from(settings.template_width);
        if !(3..=MAX_WIDTH).contains(&width) || width.is_multiple_of(2) {
            return Err(ConfigError::TemplateWidth);
        }
        Self::build(config, EnvelopePoints { settings }, Untimed)
    }
}

impl<const BLOCKS: usize, C: StageClock> EnvelopeStereo<BLOCKS, C> {
    /// Builds the method for rows of `config.width` px, with a clock that is told of its stages.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn timed(config: Config, clock: C) -> Result<Self, ConfigError> {
        Self::build(config, EnvelopePoints { settings: EnvelopeSettings::DEFAULT }, clock)
    }
}

/// What a line does at an extremum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Shape {
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
struct Extremum<const N: usize> {
    column: u16,
    shape: Shape,
    /// By how much it lies right of its pixel, 1/16 px.
    fraction: i8,
    /// The values less their mean, times `N`: 1/8 grey level.
    template: [i16; N],
}

impl<const N: usize> Extremum<N> {
    const NONE: Self = Self { column: 0, shape: Shape::None, fraction: 0, template: [0; N] };

    /// Sum of the distances of the differences from their mean, times `N`: in 1/8 grey level, at most 9 * 2 * 9 * 2040.
    #[inline(always)]
    fn difference(&self, other: &Self) -> i32 {
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
const WIDTHS: [i16; MAX_WIDTH + 1] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9];

/// The extrema of one line, left to right.
#[derive(Debug, Clone)]
struct Extrema<const N: usize, const BLOCKS: usize> {
    list: [[Extremum<N>; 4]; BLOCKS],
    len: usize,
}

impl<const N: usize, const BLOCKS: usize> Extrema<N, BLOCKS> {
    const fn new() -> Self {
        Self { list: [[Extremum::NONE; 4]; BLOCKS], len: 0 }
    }

    fn as_slice(&self) -> &[Extremum<N>] {
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
    fn find_along(&mut self, values: &[i16]) {
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
    fn find_down(&mut self, rows: [&Row<BLOCKS>; MAX_WIDTH], width: usize) {
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

/// The points of [`EnvelopeStereo`].
#[derive(Debug, Clone)]
pub struct EnvelopePoints<const BLOCKS: usize> {
    settings: EnvelopeSettings,
}

impl<const BLOCKS: usize> Points<ROWS, BLOCKS> for EnvelopePoints<BLOCKS> {
    fn reach(&self) -> u32 {
        LEAST_REACH.max(u32::from(self.settings.template_width / 2))
    }

    fn links(&self) -> Option<Links> {
        self.settings.linked_only.then_some(LINKS)
    }

    fn measure(
        &mut self,
        rows: &SparseRows<'_, ROWS, BLOCKS>,
        points: &mut PointRows<BLOCKS>,
        clock: &impl StageClock,
    ) {
        match self.settings.template_width {
            3 => self.measure_by::<3>(rows, points, clock),
            5 => self.measure_by::<5>(rows, points, clock),
            7 => self.measure_by::<7>(rows, points, clock),
            _ => self.measure_by::<9>(rows, points, clock),
        }
    }
}

impl<const BLOCKS: usize> EnvelopePoints<BLOCKS> {
    /// Measures by templates of `N` pixels.
    fn measure_by<const N: usize>(
        &self,
        rows: &SparseRows<'_, ROWS, BLOCKS>,
        points: &mut PointRows<BLOCKS>,
        clock: &impl StageClock,
    ) {
        let width = usize::from(rows.config.width);
        let mut extrema = [const { Extrema::<N, BLOCKS>::new() }; 2];
        clock.enter(Stage::Contours);
        for (view, extrema) in extrema.iter_mut().enumerate() {
            let mut values = [[0; 4]; BLOCKS];
            along([rows.row(view, 0), rows.row(view, 1)], width, &mut values);
            extrema.find_along(&values.as_flattened()[..width]);
        }
        clock.enter(Stage::Blocks);
        self.answer(rows.config, &extrema, true, points);
        if self.settings.columns {
            clock.enter(Stage::Contours);
            for (view, extrema) in extrema.iter_mut().enumerate() {
                extrema.find_down([-4, -3, -2, -1, 0, 1, 2, 3, 4].map(|y| rows.row(view, y)), width);
            }
            clock.enter(Stage::Blocks);
            self.answer(rows.config, &extrema, false, points);
        }
    }

    /// Matches every extremum of the left line.
    ///
    /// - `has_fractions`: whether the extrema tell their fractions; else those are of the differences.
    #[inline(never)]
    fn answer<const N: usize>(
        &self,
        config: &Config,
        extrema: &[Extrema<N, BLOCKS>; 2],
        has_fractions: bool,
        points: &mut PointRows<BLOCKS>,
    ) {
        let least = i32::from(config.min_disparity);
        let most = least + i32::from(config.num_disparities);
        let ratio = 100 + i32::from(self.settings.uniqueness_ratio);
        let square = i32::from(WIDTHS[N]) * i32::from(WIDTHS[N]);
        let dispersion = i32::from(ONE) * square * i32::from(self.settings.dispersion);
        // Difference and column of those within the dispersion.
        let mut candidates = [0u32; Config::MAX_DISPARITIES as usize];
        let [envelopes, others] = extrema.each_ref().map(Extrema::as_slice);
        let mut start = 0;
        for envelope in envelopes {
            let x = i32::from(envelope.column);
            // Both lines are in order, so nobody looks further left than this again.
            while others.get(start).is_some_and(|other| x - i32::from(other.column) >= most) {
                start += 1;
            }
            let (mut len, mut least_key, mut best) = (0, u32::MAX, None);
            for other in &others[start..] {
                if x - i32::from(other.column) < least {
                    break;
                }
                if other.shape != envelope.shape {
                    continue;
                }
                let difference = envelope.difference(other);
                if difference <= dispersion
                    && let Some(candidate) = candidates.get_mut(len)
                {
                    let key = difference.cast_unsigned() << COLUMN_BITS | u32::from(other.column);
                    *candidate = key;
                    len += 1;
                    if key < least_key {
                        (least_key, best) = (key, Some(other));
                    }
                }
            }
            let Some(best) = best else { continue };
            let candidates = &candidates[..len];
            let column_of = |key: u32| key & ((1 << COLUMN_BITS) - 1);
            let difference_of = |key: u32| (key >> COLUMN_BITS).cast_signed();
            let cost = difference_of(least_key);
            let mut second = i32::MAX;
            for &key in candidates {
                // A neighbour of the best is no rival: a lying envelope goes on.
                if column_of(key).abs_diff(best.column.into()) > 1 {
                    second = second.min(difference_of(key));
                }
            }
            if second != i32::MAX && 100 * second <= ratio * cost {
                continue;
            }
            let at = x - i32::from(best.column);
            let fraction = if has_fractions {
                i32::from(envelope.fraction) - i32::from(best.fraction)
            } else {
                let near = |at: i32| {
                    let column = (x - at).cast_unsigned();
                    candidates.iter().find(|&&key| column_of(key) == column).map(|&key| difference_of(key))
                };
                Minimum { at, cost, before: near(at - 1), after: near(at + 1) }.refine_subpixel()
            };
            points.add(config, x, 1, 16 * at + fraction, || {
                // As costs of 48 pixels.
                let cost_of = |difference: i32| 6 * difference / square;
                Merit::new(cost_of(cost), (second != i32::MAX).then(|| cost_of(second - cost)))
            });
        }
    }
}

/// The byte of a word that begins at a bit.
#[inline(always)]
const fn pixel(word: u32, bit: u32) -> i16 {
    (word >> bit & 0xff) as i16
}

/// The values of a line along two rows: their mean, smoothed by `[1 2 1]`.
#[inline(never)]
fn along<const BLOCKS: usize>(rows: [&Row<BLOCKS>; 2], width: usize, values: &mut [[i16; 4]; BLOCKS]) {
    let words = width.div_ceil(4) + 1;
    let sums = |i: usize| {
        let [a, b] = rows.map(|row| row[i] ^ FLIP);
        [0, 8, 16, 24].map(|bit| pixel(a, bit) + pixel(b, bit))
    };
    let (mut last, mut here) = (sums(0)[3], sums(1));
    for (i, out) in (2..=words).zip(values) {
        let next = sums(i);
        let [a, b, c, d] = here;
        let pairs = [last + a, a + b, b + c, c + d, d + next[0]];
        *out = [pairs[0] + pairs[1], pairs[1] + pairs[2], pairs[2] + pairs[3], pairs[3] + pairs[4]];
        (last, here) = (d, next);
    }
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

    fn refusal(template_width: u8) -> Option<ConfigError> {
        let settings = EnvelopeSettings { template_width, ..EnvelopeSettings::DEFAULT };
        EnvelopeStereo::<18>::with_settings(Config::for_width(64), settings).err()
    }

    #[test]
    fn a_template_is_odd_and_3_to_9_px_wide() {
        for width in 0..=u8::MAX {
            let is_valid = [3, 5, 7, 9].contains(&width);
            assert_eq!(refusal(width), (!is_valid).then_some(ConfigError::TemplateWidth), "{width}");
        }
    }

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
