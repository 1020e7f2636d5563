//! How noisy a frame is, for the record: the core has an estimate of its own, from the rows so far.
//!
//! The second difference `[1 -2 1]` down and across is 0 on planes, and its standard deviation is 6
//! sigma for white noise of standard deviation sigma (the square of 1 + 4 + 1 under the root). Of its
//! magnitudes a low percentile is taken instead of the mean: most of a picture's texture lies above.
//! The mask is that of J. Immerkær, Fast noise variance estimation, Computer Vision and Image
//! Understanding 64 (1996), who takes the mean.

use crate::{Frame, StereoPair};

/// Share of the windows that lie below the percentile.
const SHARE: f64 = 0.3;
/// What that percentile is for white Gaussian noise of 1 grey level: 6 x 0.38532, the 65 % point of the
/// normal distribution.
const PERCENTILE_OF_ONE: f64 = 2.312;
/// The greatest magnitude: 255 times the mask's positive weights.
const MOST: usize = 8 * 255;
/// With fewer windows than this there is no estimate.
const LEAST_WINDOWS: u32 = 100;

/// Standard deviation of the noise, grey levels: that of the less noisy view, since texture only adds
/// to it. `None` where too little of the views is unclipped.
#[must_use]
pub fn estimate(pair: &StereoPair) -> Option<f64> {
    let views = [&pair.left, &pair.right].map(of_view);
    views.into_iter().flatten().reduce(f64::min)
}

fn of_view(frame: &Frame) -> Option<f64> {
    let mut counts = [0_u32; MOST + 1];
    let mut total = 0;
    for y in 1..frame.height.saturating_sub(1) {
        let rows = [frame.row(y - 1), frame.row(y), frame.row(y + 1)];
        for x in 1..frame.width.saturating_sub(1) {
            let window = rows.map(|row| [row[x - 1], row[x], row[x + 1]]);
            // Clipped pixels have lost their noise.
            if window.as_flattened().iter().any(|value| matches!(value, 0 | 255)) {
                continue;
            }
            counts[second_difference(window)] += 1;
            total += 1;
        }
    }
    (total >= LEAST_WINDOWS).then(|| percentile(&counts, SHARE * f64::from(total)) / PERCENTILE_OF_ONE)
}

fn second_difference(window: [[u8; 3]; 3]) -> usize {
    let of = |[a, b, c]: [i32; 3]| a - 2 * b + c;
    let across = window.map(|row| of(row.map(i32::from)));
    of(across).unsigned_abs() as usize
}

/// The value that `target` of the counted ones do not reach. A whole value stands for half a step to
/// either side, but the first for itself alone.
fn percentile(counts: &[u32], target: f64) -> f64 {
    let mut below = 0.0;
    for (value, &count) in counts.iter().enumerate() {
        let count = f64::from(count);
        if below + count >= target && count > 0.0 {
            return (value as f64 - 0.5 + (target - below) / count).max(0.0);
        }
        below += count;
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::degrade::Degradation;

    fn ramp() -> StereoPair {
        let luma = (0..100 * 200).map(|i| (60 + i % 200 / 4 + i / 200) as u8).collect();
        let frame = Frame::from_luma(200, 100, luma);
        StereoPair { left: frame.clone(), right: frame }
    }

    #[test]
    fn noise_added_is_noise_found() {
        for noise in [2.0, 5.0, 10.0] {
            let mut pair = ramp();
            Degradation { noise, ..Default::default() }.apply("ramp", &mut pair);
            let found = estimate(&pair).unwrap();
            assert!((found / noise - 1.0).abs() < 0.05, "{found} of {noise}");
        }
    }

    #[test]
    fn a_flat_view_has_none_and_a_clipped_one_tells_nothing() {
        let pair = |value| {
            let frame = Frame::from_luma(64, 20, vec![value; 64 * 20]);
            StereoPair { left: frame.clone(), right: frame }
        };
        assert_eq!(estimate(&pair(90)), Some(0.0));
        assert_eq!(estimate(&pair(255)), None);
        let mut half = pair(255);
        half.left = pair(90).left;
        assert_eq!(estimate(&half), Some(0.0));
    }
}
