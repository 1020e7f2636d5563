//! How noisy the frame is, judged from the rows that came so far.

use crate::count;
use crate::front_end::exposure::Gain;
use crate::front_end::haar::difference_121;
use crate::front_end::reading::Reading;
use crate::front_end::ring::MARGIN;
use crate::lanes::rows::{Mean, second_difference};

const BINS: usize = 64;
/// One pixel in so many is looked at.
const STRIDE: usize = 4;
/// Counts are halved here, so that they fit their 16 bits and old rows count less.
const FULL: u16 = 1 << 15;
/// Percentiles are in 1/16 grey level.
const ONE: u32 = 16;

/// Histogram of the second difference down and across, `|[1 -2 1] x [1 -2 1]|`, of one view.
///
/// Planes cancel in it; texture does not, but half of an ordinary picture has little of it, so the
/// low percentiles speak of the sensor. Gaussian noise of standard deviation sigma shows as
/// 0.75 sigma at the 10th and 2.31 sigma at the 30th percentile.
#[derive(Debug, Clone)]
pub(crate) struct NoiseHistogram {
    bins: [u16; BINS],
    total: u16,
}

impl NoiseHistogram {
    pub(crate) const fn new() -> Self {
        Self { bins: [0; BINS], total: 0 }
    }

    pub(crate) fn clear(&mut self) {
        *self = Self::new();
    }

    /// Takes the row between `above` and `below` into account; all with margins.
    pub(crate) fn add(&mut self, above: &[u8], row: &[u8], below: &[u8], width: usize) {
        let inside = MARGIN..MARGIN + width;
        let (Some(a), Some(b), Some(c)) = (above.get(inside.clone()), row.get(inside.clone()), below.get(inside))
        else {
            return;
        };
        let pixels = width.saturating_sub(2).div_ceil(STRIDE);
        count::subtractions(12 * pixels);
        count::comparisons(2 * pixels);
        count::additions(2 * pixels);
        for ((a, b), c) in a.windows(3).zip(b.windows(3)).zip(c.windows(3)).step_by(STRIDE) {
            let across = |r: &[u8]| difference_121(i32::from(r[0]), i32::from(r[1]), i32::from(r[2]));
            let second = difference_121(across(a), across(b), across(c)).unsigned_abs() as usize;
            self.bins[second.min(BINS - 1)] += 1;
            self.total += 1;
        }
        // A row adds at most 1280 / 4 counts, so the total cannot pass the u16 in between.
        if self.total >= FULL {
            self.total = 0;
            for bin in &mut self.bins {
                *bin /= 2;
                self.total += *bin;
            }
        }
    }

    /// Takes every `stride`-th pixel of the row between `above` and `below`, from `first` on, into account; signed rows in
    /// words, with a word of margin.
    #[inline(never)]
    pub(crate) fn sample<const WORDS: usize>(
        &mut self,
        rows: [&[u32; WORDS]; 3],
        first: usize,
        stride: usize,
        weight: u16,
        width: usize,
    ) {
        let mut total = self.total;
        for x in (first.max(1)..width.saturating_sub(1)).step_by(stride) {
            let second = second_difference(rows, x + 3) as usize;
            self.bins[second.min(BINS - 1)] += weight;
            total += weight;
        }
        self.total = total;
        if self.total >= FULL {
            self.total = 0;
            for bin in &mut self.bins {
                *bin /= 2;
                self.total += *bin;
            }
        }
    }

    /// The value that `percent` of the pixels do not reach, interpolated, in 1/16 grey level.
    fn percentile(&self, percent: u32) -> u32 {
        // In units of 1/100 count.
        let target = u32::from(self.total) * percent;
        let mut below = 0;
        count::additions(BINS);
        count::comparisons(BINS);
        count::multiplications(BINS);
        for (value, &count) in (0..).zip(&self.bins) {
            let count = u32::from(count) * 100;
            if count > 0 && below + count >= target {
                // The bin covers value - 1/2 .. value + 1/2.
                return (value * ONE + (target - below) * ONE / count).saturating_sub(ONE / 2);
            }
            below += count;
        }
        0
    }
}

/// What the front end and the texture test want to know of the noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Noise {
    /// 10th percentile of the less noisy view after the gain, 1/16 grey level.
    floor: u16,
    /// How strongly to smooth, 0 to 3.
    pub(crate) level: SmoothingLevel,
}

/// How strongly the views are smoothed before anything else looks at them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, PartialOrd, Ord)]
pub(crate) enum SmoothingLevel {
    /// As the camera sent it.
    #[default]
    Off,
    /// `[1 2 1]` down and across.
    Light,
    /// `[1 2 2 2 1]` down and across.
    Medium,
    /// `[1 2 2 2 1]` down, `[1 2 2 2 2 2 2 2 1]` across.
    Strong,
}

impl SmoothingLevel {
    /// Additions for each pixel: of the filter, and to round.
    pub(crate) const fn additions(self) -> usize {
        match self {
            Self::Off => 0,
            Self::Light => 13,
            Self::Medium => 11,
            Self::Strong => 12,
        }
    }
}

impl SmoothingLevel {
    /// The means down and along the row; none where rows stay as they came.
    pub(crate) const fn means(self) -> Option<(Mean, Mean)> {
        match self {
            Self::Off => None,
            Self::Light => Some((Mean::Three, Mean::Three)),
            Self::Medium => Some((Mean::Five, Mean::Five)),
            Self::Strong => Some((Mean::Five, Mean::Nine)),
        }
    }
}

impl Noise {
    pub(crate) fn of(left: &NoiseHistogram, right: &NoiseHistogram, gain: Gain) -> Self {
        // The lower view decides: texture only ever adds to the estimate.
        let least = |percent| gain.apply(left.percentile(percent).min(right.percentile(percent)));
        // sigma 2.2, 4 and 15 grey levels at the 30th percentile
        let level = match least(30) {
            0..90 => SmoothingLevel::Off,
            90..130 => SmoothingLevel::Light,
            130..554 => SmoothingLevel::Medium,
            _ => SmoothingLevel::Strong,
        };
        Self { floor: u16::try_from(least(10)).unwrap_or(u16::MAX), level }
    }

    /// [`Self::feature_floor`] of Haar features without a least value.
    pub(crate) fn haar_floor(self) -> u32 {
        let gain = match self.level {
            SmoothingLevel::Off => 76,
            SmoothingLevel::Light => 36,
            SmoothingLevel::Medium => 17,
            SmoothingLevel::Strong => 10,
        };
        u32::from(self.floor) * gain / 16
    }

    /// The mean magnitude of a feature that noise alone explains, with a margin of 1.3, in 1/16.
    ///
    /// White noise of 1 grey level gives gradients of 2.76 in the mean; smoothed 1.32, 0.60, 0.38. Of
    /// intensities less their mean it is 1.57; smoothed 0.58, 0.33, 0.22.
    pub(crate) fn feature_floor(self, reading: Reading) -> u32 {
        const LEAST: u32 = 10; // 0.6: a wall that the camera quantises to one grey level
        let gain = match (reading, self.level) {
            (Reading::Haar, SmoothingLevel::Off) => 76, // 16 x 1.3 x 2.76 / 0.754
            (Reading::Haar, SmoothingLevel::Light) => 36,
            (Reading::Haar, SmoothingLevel::Medium) => 17,
            (Reading::Haar, SmoothingLevel::Strong) => 10,
            (Reading::Intensity, SmoothingLevel::Off) => 43,
            (Reading::Intensity, SmoothingLevel::Light) => 16,
            (Reading::Intensity, SmoothingLevel::Medium) => 9,
            (Reading::Intensity, SmoothingLevel::Strong) => 6,
        };
        (u32::from(self.floor) * gain / 16).max(LEAST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_view_has_no_noise() {
        let mut histogram = NoiseHistogram::new();
        histogram.add(&[90; 72], &[90; 72], &[90; 72], 64);
        let noise = Noise::of(&histogram, &histogram, Gain::default());
        assert_eq!(noise, Noise { floor: 0, level: SmoothingLevel::Off });
    }

    #[test]
    fn percentiles_interpolate_within_a_grey_level() {
        let mut histogram = NoiseHistogram::new();
        histogram.bins[4] = 10;
        histogram.bins[5] = 10;
        histogram.total = 20;
        // half of bin 4: its centre
        assert_eq!(histogram.percentile(25), 4 * ONE);
        assert_eq!(histogram.percentile(100), 5 * ONE + ONE / 2);
    }

    #[test]
    fn a_long_frame_does_not_overflow() {
        let mut histogram = NoiseHistogram::new();
        let rows = [[0u8; 1288], [255; 1288], [0; 1288]];
        for _ in 0..1000 {
            histogram.add(&rows[0], &rows[1], &rows[2], 1280);
        }
        assert!(histogram.total < FULL + 320);
    }
}
