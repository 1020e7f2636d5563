//! The method `envelope`: intensity envelopes of both views, matched (the paper's S1).

use crate::answer::confidence::Merit;
use crate::answer::linkage::{Answers, Links};
use crate::count;
use crate::front_end::haar::sum_121;
use crate::front_end::ring::MARGIN;
use crate::matching::extremum::{Minimum, parabola};
use crate::method::sparse::{Points, Sparse, SparseRow, SparseView};
use crate::stage::{Stage, StageClock, Untimed};
use crate::{Config, ConfigError};

/// Widest template, px.
const MAX_WIDTH: usize = 9;
/// Smoothed rows that are kept: the widest template down a column.
const ROWS: usize = MAX_WIDTH;
/// Rows of that template above its middle.
const MIDDLE: i64 = 4;
/// Links of an envelope, which few others support: single envelopes are wrong half of the time.
const LINKS: Links = Links { least: 7, share: 6 };
/// Least step between neighbours that counts as one, in 1/4 grey level.
const LEAST_STEP: i16 = 4;

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
/// extrema is the disparity. Points come from segments along rows or along columns.
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

/// The points of [`EnvelopeStereo`].
#[derive(Debug, Clone)]
pub struct EnvelopePoints<const BLOCKS: usize> {
    settings: EnvelopeSettings,
}

impl<const BLOCKS: usize> Points<ROWS, BLOCKS> for EnvelopePoints<BLOCKS> {
    fn reach(&self) -> u32 {
        // The window of a shape and half of the longest template.
        4
    }

    fn uses_features(&self) -> bool {
        false
    }

    fn links(&self) -> Option<Links> {
        self.settings.linked_only.then_some(LINKS)
    }

    fn measure(&mut self, row: &SparseRow<'_, ROWS, BLOCKS>, answers: &mut Answers<BLOCKS>, clock: &impl StageClock) {
        clock.enter(Stage::Contours);
        let (mut left, mut right) = (Line::<BLOCKS>::along(row.left, row), Line::<BLOCKS>::along(row.right, row));
        clock.enter(Stage::Blocks);
        self.answer(row, &left, &right, answers);
        if self.settings.columns {
            clock.enter(Stage::Contours);
            left.turn(row.left, row);
            right.turn(row.right, row);
            clock.enter(Stage::Blocks);
            self.answer(row, &left, &right, answers);
        }
    }
}

impl<const BLOCKS: usize> EnvelopePoints<BLOCKS> {
    /// Matches every extremum of the left line.
    fn answer(
        &self,
        row: &SparseRow<'_, ROWS, BLOCKS>,
        left: &Line<BLOCKS>,
        right: &Line<BLOCKS>,
        answers: &mut Answers<BLOCKS>,
    ) {
        let mut differences = [NO_DIFFERENCE; Config::MAX_DISPARITIES as usize];
        let shapes = left.shapes.as_flattened().iter().take(usize::from(row.config.width));
        for (x, &shape) in (0..).zip(shapes).filter(|&(_, &shape)| shape != Shape::None) {
            let candidates = self.compare(row.config, x, shape, [left, right], &mut differences);
            let Some((index, least)) = (0..).zip(candidates).min_by_key(|(_, least)| **least) else { continue };
            // A neighbour of the best is no rival: a lying envelope goes on.
            let rivals = (0..).zip(candidates).filter(|(other, _): &(usize, _)| other.abs_diff(index) > 1);
            let second = rivals.map(|(_, &rival)| rival).min().unwrap_or(NO_DIFFERENCE);
            count::comparisons(2 * candidates.len());
            let ratio = 100 + i32::from(self.settings.uniqueness_ratio);
            if *least == NO_DIFFERENCE || second != NO_DIFFERENCE && 100 * second <= ratio * *least {
                continue;
            }
            let at = i32::from(row.config.min_disparity) + i32::try_from(index).unwrap_or(0);
            let near = |index: Option<usize>| candidates.get(index?).copied().filter(|&d| d != NO_DIFFERENCE);
            let minimum =
                Minimum { at, cost: *least, before: near(index.checked_sub(1)), after: near(Some(index + 1)) };
            let fraction = match left.is_along_row {
                true => left.fraction(x, shape) - right.fraction(x - at, shape),
                false => minimum.refine_subpixel(),
            };
            let margin = (second != NO_DIFFERENCE).then(|| self.per_window(second - *least));
            answers.add(row.config, x, 16 * at + fraction, Merit::new(self.per_window(*least), margin));
        }
    }

    /// How much the envelope at `x` differs from that of each disparity: [`NO_DIFFERENCE`] where the
    /// shape is another or the dispersion is passed.
    fn compare<'a>(
        &self,
        config: &Config,
        x: i32,
        shape: Shape,
        [left, right]: [&Line<BLOCKS>; 2],
        differences: &'a mut [i32; Config::MAX_DISPARITIES as usize],
    ) -> &'a [i32] {
        let range = i32::from(config.min_disparity)..;
        let candidates = differences.get_mut(..usize::from(config.num_disparities)).unwrap_or(&mut []);
        count::comparisons(candidates.len());
        for (disparity, difference) in range.zip(candidates.iter_mut()) {
            *difference = match right.shape(x - disparity) {
                Some(other) if other == shape => self.difference(left, x, right, x - disparity),
                _ => None,
            }
            .unwrap_or(NO_DIFFERENCE);
        }
        candidates
    }

    /// Sum of the differences' distances from their mean, times the width of the template: in 1/4 grey
    /// level, at most 9 * 2 * 9 * 1020; `None` over the dispersion or out of the view.
    fn difference(&self, left: &Line<BLOCKS>, x: i32, right: &Line<BLOCKS>, other: i32) -> Option<i32> {
        let width = i32::from(self.settings.template_width);
        let half = width / 2;
        let difference = |k: i32| Some(left.value(x, k)? - right.value(other, k)?);
        let mut sum = 0;
        for k in -half..=half {
            sum += difference(k)?;
        }
        let mut distance = 0;
        for k in -half..=half {
            distance += (width * difference(k)? - sum).abs();
        }
        let pixels = usize::from(self.settings.template_width);
        count::evaluations(1);
        // The mean by additions: the difference `width` times.
        count::additions(pixels * (pixels + 1));
        count::subtractions(3 * pixels);
        count::comparisons(pixels + 1);
        (distance <= 4 * width * width * i32::from(self.settings.dispersion)).then_some(distance)
    }

    /// A difference as a cost of 48 pixels.
    fn per_window(&self, difference: i32) -> i32 {
        let width = i32::from(self.settings.template_width);
        12 * difference / (width * width).max(1)
    }
}

/// A difference that is none: shapes that disagree.
const NO_DIFFERENCE: i32 = i32::MAX;

/// One view's lines through the pixels of a row: along the row, or along the columns. Scratch of one row.
struct Line<const BLOCKS: usize> {
    is_along_row: bool,
    width: i32,
    /// Along the row: its pixels, smoothed by `[1 2 1]`. Along the columns: the rows from `MAX_WIDTH / 2`
    /// above on. 1/4 grey level.
    values: [[[i16; 4]; BLOCKS]; MAX_WIDTH],
    shapes: [[Shape; 4]; BLOCKS],
}

impl<const BLOCKS: usize> Line<BLOCKS> {
    /// The line along the row.
    fn along(view: &SparseView<ROWS, BLOCKS>, row: &SparseRow<'_, ROWS, BLOCKS>) -> Self {
        let width = row.config.width;
        let mut line = Self {
            is_along_row: true,
            width: i32::from(width),
            values: [[[0; 4]; BLOCKS]; MAX_WIDTH],
            shapes: [[Shape::None; 4]; BLOCKS],
        };
        let pixels = view.smooth.row(row.y).get(MARGIN - 1..).unwrap_or(&[]);
        let values = line.values[0].as_flattened_mut();
        for (value, around) in values.iter_mut().zip(pixels.windows(3)).take(usize::from(width)) {
            *value = i16::try_from(sum_121(around[0], around[1], around[2])).unwrap_or(i16::MAX);
        }
        let values = values.get(..usize::from(width)).unwrap_or(&[]);
        for (shape, around) in line.shapes.as_flattened_mut().iter_mut().skip(2).zip(values.windows(4)) {
            *shape = Shape::of([around[0], around[1], around[2], around[3]]);
        }
        mark_plateaus(values, line.shapes.as_flattened_mut());
        count::additions(3 * values.len());
        count::subtractions(values.len());
        count::comparisons(10 * values.len());
        line
    }

    /// Makes it the lines along the columns.
    fn turn(&mut self, view: &SparseView<ROWS, BLOCKS>, row: &SparseRow<'_, ROWS, BLOCKS>) {
        self.is_along_row = false;
        let first = row.y - MIDDLE;
        for (y, values) in (first..).zip(&mut self.values) {
            let pixels = view.smooth.row(y).iter().skip(MARGIN);
            for (value, &pixel) in values.as_flattened_mut().iter_mut().zip(pixels) {
                *value = i16::from(pixel) << 2;
            }
        }
        let [.., a, b, c, d, _, _, _] = &self.values;
        let rows = [a, b, c, d].map(|row| row.as_flattened().iter());
        let [a, b, c, d] = rows;
        let columns = a.zip(b).zip(c).zip(d);
        for (shape, (((&a, &b), &c), &d)) in self.shapes.as_flattened_mut().iter_mut().zip(columns) {
            *shape = Shape::of([a, b, c, d]);
        }
        let width = usize::try_from(self.width).unwrap_or(0);
        count::subtractions(3 * width);
        count::comparisons(8 * width);
    }

    fn shape(&self, x: i32) -> Option<Shape> {
        let is_inside = (0..self.width).contains(&x);
        self.shapes.as_flattened().get(usize::try_from(x).ok()?).copied().filter(|_| is_inside)
    }

    /// Value of a template's pixel: `k` from its middle.
    fn value(&self, x: i32, k: i32) -> Option<i32> {
        let (row, x) = if self.is_along_row { (0, x + k) } else { (usize::try_from(k + 4).ok()?, x) };
        let is_inside = (0..self.width).contains(&x);
        let value = self.values.get(row)?.as_flattened().get(usize::try_from(x).ok()?)?;
        is_inside.then_some(i32::from(*value))
    }

    /// By how much the extremum lies right of its pixel, 1/16 px: vertex of the parabola through the
    /// values of a peak, through the steps of a rise.
    fn fraction(&self, x: i32, shape: Shape) -> i32 {
        let value = |k| self.value(x, k).unwrap_or(0);
        let step = |k| value(k) - value(k - 1);
        match shape {
            Shape::Peak => parabola(-value(-1), -value(0), -value(1)),
            Shape::Trough => parabola(value(-1), value(0), value(1)),
            Shape::Rise => parabola(-step(-1), -step(0), -step(1)),
            Shape::Fall => parabola(step(-1), step(0), step(1)),
            Shape::Plateau | Shape::None => 0,
        }
    }
}

/// Marks the middle of each run of equal values that both its neighbours lie below, or both above.
fn mark_plateaus(values: &[i16], shapes: &mut [Shape]) {
    let mut start = 0;
    while let Some((&here, rest)) = values.get(start..).and_then(<[i16]>::split_first) {
        let end = start + 1 + rest.iter().take_while(|&&value| value == here).count();
        let before = start.checked_sub(1).and_then(|x| values.get(x));
        if let (true, Some(&before), Some(&after)) = (end - start > 1, before, values.get(end)) {
            let [rise, fall] = [here - before, here - after];
            let is_extremum = rise.min(fall) >= LEAST_STEP || rise.max(fall) <= -LEAST_STEP;
            if let (true, Some(shape)) = (is_extremum, shapes.get_mut(usize::midpoint(start, end - 1))) {
                *shape = Shape::Plateau;
            }
        }
        start = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            ([0, 10, 20, 10], Shape::Peak),
            ([20, 10, 0, 10], Shape::Trough),
            ([0, 2, 20, 22], Shape::Rise),
            ([22, 20, 2, 0], Shape::Fall),
            ([0, 10, 20, 30], Shape::None),
            ([5, 5, 5, 5], Shape::None),
            ([0, 0, 3, 0], Shape::None),
        ];
        for (values, shape) in cases {
            assert_eq!(Shape::of(values), shape, "{values:?}");
        }
    }

    #[test]
    fn a_plateau_is_the_middle_of_equal_pixels_above_or_below_their_neighbours() {
        let mut shapes = [Shape::None; 12];
        mark_plateaus(&[0, 9, 9, 9, 0, 0, 0, 7, 7, 20, 20, 20], &mut shapes);
        let found = shapes.map(|shape| shape == Shape::Plateau);
        assert_eq!(found.iter().filter(|&&is| is).count(), 2);
        assert!(found[2] && found[5], "{found:?}");
    }

    #[test]
    fn envelopes_that_differ_by_an_offset_do_not_differ() {
        let points = EnvelopePoints::<4> { settings: EnvelopeSettings::DEFAULT };
        let line = |values: [i16; 16]| {
            let mut rows = [[[0; 4]; 4]; MAX_WIDTH];
            rows[0].as_flattened_mut().copy_from_slice(&values);
            Line::<4> { is_along_row: true, width: 16, values: rows, shapes: [[Shape::None; 4]; 4] }
        };
        let left = line([0, 0, 0, 0, 40, 90, 20, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        let right = line([9, 9, 140, 190, 120, 9, 9, 9, 9, 9, 9, 9, 40, 90, 23, 9]);
        assert_eq!(points.difference(&left, 5, &right, 3), Some(0));
        // Differences 0, 0, -3 lie 1, 1 and 2 from their mean, 3 times that.
        assert_eq!(points.difference(&left, 5, &right, 13), Some(12));
        assert_eq!(points.difference(&left, 0, &right, 3), None, "leaves the view");
        let strict = EnvelopePoints::<4> { settings: EnvelopeSettings { dispersion: 0, ..points.settings } };
        assert_eq!(strict.difference(&left, 5, &right, 13), None);
    }
}
