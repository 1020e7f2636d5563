//! How noisy the frame is, judged from the rows that came so far.

use crate::front_end::exposure::Gain;
use crate::lanes::rows::{Clips, Mean, second_difference, second_difference_in};
use crate::lanes::unseen;

const BINS: usize = 64;
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
        self.make_room();
    }

    /// Halves the counts once they are many.
    #[inline(always)]
    fn make_room(&mut self) {
        if self.total >= FULL {
            self.halve();
        }
    }

    #[cold]
    #[inline(never)]
    fn halve(&mut self) {
        let mut total = 0;
        for bin in &mut self.bins {
            let bin = unseen(bin);
            *bin /= 2;
            total += *bin;
        }
        self.total = total;
    }

    /// The value that `percent` of the pixels do not reach, interpolated, in 1/16 grey level.
    #[inline(never)]
    fn percentile(&self, percent: u32) -> u32 {
        // In units of 1/100 count.
        let target = u32::from(self.total) * percent;
        let mut below = 0;
        for (value, &count) in (0..).zip(unseen(&self.bins[..])) {
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

/// The noise of both views as the cameras sent them: of rows that are interpolated before a method gets them, which takes much
/// of it away that one row after the other shows, and less of what is matched.
#[derive(Debug, Clone)]
pub struct RawNoise {
    histograms: [NoiseHistogram; 2],
}

impl RawNoise {
    pub(crate) const fn new() -> Self {
        Self { histograms: [const { NoiseHistogram::new() }; 2] }
    }

    pub(crate) fn clear(&mut self) {
        self.histograms.iter_mut().for_each(NoiseHistogram::clear);
    }

    /// Takes every `stride`-th pixel of the middle one of three rows of either view into account.
    pub(crate) fn sample(&mut self, views: [[&[u8]; 3]; 2], first: usize, stride: usize, weight: u16) {
        for (histogram, rows) in self.histograms.iter_mut().zip(views) {
            let width = rows.map(<[u8]>::len).into_iter().min().unwrap_or(0);
            let rows = rows.map(|row| row.get(..width).unwrap_or(&[]));
            let mut total = histogram.total;
            for x in (first.max(1)..width.saturating_sub(2)).step_by(stride) {
                let second = second_difference_in(rows, x - 1) as usize;
                histogram.bins[second.min(BINS - 1)] += weight;
                total += weight;
            }
            histogram.total = total;
            histogram.make_room();
        }
    }

    /// Standard deviations of the views, 1/16 grey level.
    pub(crate) fn deviations_q4(&self) -> [u32; 2] {
        self.histograms.each_ref().map(|histogram| histogram.percentile(30) * 100 / 231)
    }

    /// What a method wants to know of it, whose views get that gain.
    pub(crate) fn noise(&self, gain: Gain) -> Noise {
        let [left, right] = &self.histograms;
        Noise::of(left, right, gain)
    }
}

/// What the front end and the texture test want to know of the noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Noise {
    /// 10th percentile of the less noisy view after the gain, 1/16 grey level.
    floor: u16,
    /// How strongly to smooth, 0 to 3.
    pub(crate) level: SmoothingLevel,
}

/// How strongly the views are smoothed before anything else looks at them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum SmoothingLevel {
    /// As the camera sent it.
    Off,
    /// `[1 2 1]` down and across.
    Light,
    /// `[1 2 2 2 1]` down and across.
    Medium,
    /// `[1 2 2 2 1]` down, `[1 2 2 2 2 2 2 2 1]` across.
    Strong,
}

impl SmoothingLevel {
    /// How gradients are limited.
    pub(crate) const fn clips(self) -> Clips {
        match self {
            Self::Off | Self::Light => Clips::new(15, 4),
            Self::Medium | Self::Strong => Clips::new(31, 0),
        }
    }

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
    /// None seen so far.
    pub(crate) const NONE: Self = Self { floor: 0, level: SmoothingLevel::Off };

    pub(crate) fn of(left: &NoiseHistogram, right: &NoiseHistogram, gain: Gain) -> Self {
        // The lower view decides: texture only ever adds to the estimate.
        let least = |percent| gain.apply(left.percentile(percent).min(right.percentile(percent)));
        // sigma 2.1, 3.5 and 15 grey levels at the 30th percentile
        let level = match least(30) {
            0..78 => SmoothingLevel::Off,
            78..130 => SmoothingLevel::Light,
            130..554 => SmoothingLevel::Medium,
            _ => SmoothingLevel::Strong,
        };
        Self { floor: u16::try_from(least(10)).unwrap_or(u16::MAX), level }
    }

    /// The mean magnitude of a Haar feature that noise alone explains, with a margin of 1.3, in 1/16.
    ///
    /// White noise of 1 grey level gives gradients of 2.76 in the mean; smoothed 1.32, 0.60, 0.38.
    pub(crate) fn haar_floor(self) -> u32 {
        let gain = match self.level {
            SmoothingLevel::Off => 76,
            SmoothingLevel::Light => 36,
            SmoothingLevel::Medium => 17,
            SmoothingLevel::Strong => 10,
        };
        u32::from(self.floor) * gain / 16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_view_has_no_noise() {
        let mut histogram = NoiseHistogram::new();
        histogram.sample([&[0x5a5a_5a5a; 18]; 3], 0, 1, 1, 64);
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
        let rows = [[0x8080_8080; 322], [0x7f7f_7f7f; 322], [0x8080_8080; 322]];
        for _ in 0..1000 {
            histogram.sample(rows.each_ref(), 0, 4, 1, 1280);
        }
        assert!(histogram.total < FULL + 320);
    }
}
