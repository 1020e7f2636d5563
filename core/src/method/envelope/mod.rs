//! The method `envelope`: intensity envelopes of both views, matched (the paper's S1).
#![allow(clippy::needless_range_loop, reason = "words of several rows at one number")]

use crate::answer::linkage::{Links, PointRows};
use crate::answer::merit::Merit;
use crate::front_end::camera_view::Row;
use crate::lanes::rows::FLIP;
use crate::matching::extremum::Minimum;
use crate::method::sparse::{LEAST_REACH, Points, Sparse, SparseRows};
use crate::stage::{Stage, StageClock, Untimed};
use crate::{Config, ConfigError};

mod extrema;

use extrema::{Extrema, MAX_WIDTH, ONE, WIDTHS, pixel};

/// Smoothed rows that are kept: the widest template down a column, and one more.
const ROWS: usize = MAX_WIDTH + 1;
/// Links of an envelope, which few others support: single envelopes are wrong half of the time.
const LINKS: Links = Links { least: 8, share: 6 };
/// Bits of a column; differences have 19.
const COLUMN_BITS: u32 = 11;

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
}
