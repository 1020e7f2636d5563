//! What the front end of `full` and `lite` does to the views before anything else looks at them, as a filter of its
//! own: so that any method can have it, whoever made it.
//!
//! Row by row the same rules as in the core (`front_end`), on whole images:
//! - both views are multiplied by 4, 2 or 1, the most that saturates no more than 2 percent of the pixels so far;
//! - the noise is judged by the second difference down and across of the rows so far, in the less noisy view;
//! - at about 2.5, 5 and 15 grey levels the smoothing grows, from none over `[1 2 1]` down and across and
//!   `[1 2 2 2 1]` down and across to `[1 2 2 2 1]` down and `[1 2 2 2 2 2 2 2 1]` across.
//!
//! Rows so far are those up to two below the row that is made. Pixels beyond the border replicate it.

use crate::{Frame, StereoPair};

/// Rows by which a smoothed row lags behind the newest one.
const LAG: usize = 2;
/// One pixel in so many is looked at.
const STRIDE: usize = 4;
/// Second differences from here on are one class.
const BINS: usize = 64;
/// The noise's counts are halved at so many.
const FULL: u32 = 1 << 15;
/// Noise is told in 1/16 grey level.
const ONE: u32 = 16;

/// Weights of a filter from its middle outwards, and the logarithm of their sum over both directions.
struct Filter {
    down: &'static [u32],
    across: &'static [u32],
    shift: u32,
}

/// The filters by the noise at the 30th percentile of the second differences, 1/16 grey level.
const FILTERS: [(u32, Filter); 4] = [
    (92, Filter { down: &[1], across: &[1], shift: 0 }),
    (185, Filter { down: &[2, 1], across: &[2, 1], shift: 4 }),
    (554, Filter { down: &[2, 2, 1], across: &[2, 2, 1], shift: 6 }),
    (u32::MAX, Filter { down: &[2, 2, 1], across: &[2, 2, 2, 2, 1], shift: 7 }),
];

/// Smooths both views of a frame.
pub fn smooth(pair: &mut StereoPair) {
    let (left, right) = (pair.left.clone(), pair.right.clone());
    let mut noise = [Noise::default(), Noise::default()];
    let mut exposure = Exposure::default();
    for newest in 0..left.height + LAG {
        if newest < left.height {
            for (view, noise) in [&left, &right].into_iter().zip(&mut noise) {
                noise.add(view, newest);
                exposure.add(view.row(newest));
            }
        }
        if let Some(y) = newest.checked_sub(LAG) {
            let gain = exposure.gain();
            let least = noise.iter().map(|noise| noise.percentile(30)).min().unwrap_or(0) * gain;
            let (_, filter) = FILTERS.iter().find(|(below, _)| least < *below).unwrap_or(&FILTERS[3]);
            for (from, to) in [(&left, &mut pair.left), (&right, &mut pair.right)] {
                let width = from.width;
                filter.apply(from, y, gain, &mut to.luma[y * width..][..width]);
            }
        }
    }
}

impl Filter {
    fn apply(&self, frame: &Frame, y: usize, gain: u32, out: &mut [u8]) {
        let weights = |half: &'static [u32]| {
            let reach = half.len() as isize - 1;
            (-reach..=reach).map(move |at| (at, half[at.unsigned_abs()]))
        };
        let clamped = |at: usize, by: isize, size: usize| at.saturating_add_signed(by).min(size - 1);
        let column = |x: usize| -> u32 {
            let rows = weights(self.down).map(|(by, weight)| (clamped(y, by, frame.height), weight));
            rows.map(|(y, weight)| weight * u32::from(frame.row(y)[x])).sum()
        };
        let columns: Vec<u32> = (0..frame.width).map(column).collect();
        let half = (1 << self.shift) >> 1;
        for (x, out) in out.iter_mut().enumerate() {
            let sum: u32 = weights(self.across).map(|(by, weight)| weight * columns[clamped(x, by, frame.width)]).sum();
            // One weight of 1 in either direction is no filter, the pixel itself.
            *out = ((sum * gain + half) >> self.shift).min(255) as u8;
        }
    }
}

/// Histogram of one view's second differences.
struct Noise {
    bins: [u32; BINS],
    total: u32,
}

impl Default for Noise {
    fn default() -> Self {
        Self { bins: [0; BINS], total: 0 }
    }
}

impl Noise {
    /// Takes the row above the newest into account.
    fn add(&mut self, frame: &Frame, newest: usize) {
        let Some(first) = newest.checked_sub(2) else { return };
        let across = |row: &[u8], x: usize| {
            let [a, b, c] = [row[x], row[x + 1], row[x + 2]].map(i32::from);
            a - 2 * b + c
        };
        for x in (0..frame.width.saturating_sub(2)).step_by(STRIDE) {
            let [a, b, c] = [first, first + 1, newest].map(|y| across(frame.row(y), x));
            let second = (a - 2 * b + c).unsigned_abs() as usize;
            self.bins[second.min(BINS - 1)] += 1;
            self.total += 1;
        }
        if self.total >= FULL {
            self.bins.iter_mut().for_each(|bin| *bin /= 2);
            self.total = self.bins.iter().sum();
        }
    }

    /// The value that `percent` of the pixels do not reach, interpolated, in 1/16 grey level.
    fn percentile(&self, percent: u32) -> u32 {
        let target = self.total * percent;
        let mut below = 0;
        for (value, &count) in (0..).zip(&self.bins) {
            let count = count * 100;
            if count > 0 && below + count >= target {
                return (value * ONE + (target - below) * ONE / count).saturating_sub(ONE / 2);
            }
            below += count;
        }
        0
    }
}

/// How bright the rows so far are, of both views.
#[derive(Default)]
struct Exposure {
    total: u32,
    over_quarter: u32,
    over_half: u32,
}

impl Exposure {
    fn add(&mut self, row: &[u8]) {
        for &pixel in row.iter().step_by(STRIDE) {
            self.total += 1;
            self.over_quarter += u32::from(pixel >= 64);
            self.over_half += u32::from(pixel >= 128);
        }
    }

    fn gain(&self) -> u32 {
        let is_rare = |count: u32| count * 50 < self.total;
        if is_rare(self.over_quarter) {
            4
        } else if is_rare(self.over_half) {
            2
        } else {
            1
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::degrade::Degradation;

    fn pair(pixel: impl Fn(usize, usize) -> u8) -> StereoPair {
        let luma = (0..120 * 60).map(|index| pixel(index % 120, index / 120)).collect();
        let frame = Frame::from_luma(120, 60, luma);
        StereoPair { left: frame.clone(), right: frame }
    }

    fn smoothed(mut pair: StereoPair) -> StereoPair {
        smooth(&mut pair);
        pair
    }

    /// A ramp with bright pixels enough for no gain.
    fn ramp() -> StereoPair {
        pair(|x, y| (60 + x + y) as u8)
    }

    #[test]
    fn clean_views_stay_as_they_are() {
        assert_eq!(smoothed(ramp()), ramp());
        let squares = |x: usize, y: usize| if x / 20 % 2 == y / 20 % 2 { 30 } else { 180 };
        assert_eq!(smoothed(pair(squares)), pair(squares));
    }

    #[test]
    fn dark_views_get_what_they_have_room_for() {
        let right = |grey| smoothed(pair(|_, _| grey)).right.luma[3000];
        assert_eq!([63, 64, 127, 128].map(right), [252, 128, 254, 128]);
    }

    #[test]
    fn the_noisier_the_more_is_smoothed() {
        // Left of white noise by the squares of the weights: 0.14, 0.045 and 0.026 of the variance.
        for (noise, left) in [(3.5, 0.375), (9.0, 0.219), (18.0, 0.169)] {
            let mut noisy = ramp();
            Degradation { noise, ..Default::default() }.apply("ramp", &mut noisy);
            let smooth = smoothed(noisy);
            let errors = (10..50).flat_map(|y| (10..110).map(move |x| (x, y)));
            let errors = errors.map(|(x, y)| f64::from(smooth.left.row(y)[x]) - (60 + x + y) as f64);
            let (sum, count) = errors.fold((0.0, 0.0), |(sum, count), error| (sum + error * error, count + 1.0));
            let sigma = ((sum / count) - 1.0 / 12.0).sqrt();
            assert!((sigma / noise / left - 1.0).abs() < 0.15, "{sigma} of {noise}");
        }
    }
}
