//! Views of rigs that are not aligned, made of rectified ones.

use anyhow::Result;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Normal};

use crate::{Frame, StereoPair};

/// What is wrong with a rig's right camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disturbance {
    /// Its view is displaced downwards, px.
    pub rows: f64,
    /// Its view is displaced to the right, px.
    pub columns: f64,
    /// Its view is turned clockwise about its middle, degrees.
    pub roll_deg: f64,
    /// Its view is so much larger, percent.
    pub scale_percent: f64,
    /// Its grey levels are so much greater.
    pub gain: f64,
    /// Standard deviation of the noise on both views, grey levels.
    pub noise: f64,
}

impl Disturbance {
    /// One at random: ±10 rows, ±8 columns, ±2 degrees, ±2 %, gain 0.8 to 1.25, noise 5.
    pub fn random(rng: &mut impl Rng) -> Self {
        Self {
            rows: rng.random_range(-10.0..=10.0),
            columns: rng.random_range(-8.0..=8.0),
            roll_deg: rng.random_range(-2.0..=2.0),
            scale_percent: rng.random_range(-2.0..=2.0),
            gain: rng.random_range(0.8..=1.25),
            noise: 5.0,
        }
    }

    /// None but the noise.
    #[must_use]
    pub const fn none(noise: f64) -> Self {
        Self { rows: 0.0, columns: 0.0, roll_deg: 0.0, scale_percent: 0.0, gain: 1.0, noise }
    }

    /// The pair as such a rig would have taken it.
    ///
    /// # Errors
    /// If the noise is no number.
    pub fn apply(&self, pair: &StereoPair, rng: &mut impl Rng) -> Result<StereoPair> {
        let plain = |frame: &Frame| frame.luma.iter().map(|&v| f64::from(v)).collect::<Vec<f64>>();
        let right: Vec<f64> = self.turned(&pair.right).into_iter().map(|value| value * self.gain).collect();
        let mut noisy = |frame: &Frame, values: Vec<f64>| -> Result<Frame> {
            let noise = Normal::new(0.0, self.noise)?;
            let luma = values.into_iter().map(|v| (v + noise.sample(rng)).round().clamp(0.0, 255.0) as u8).collect();
            Ok(Frame::from_luma(frame.width, frame.height, luma))
        };
        Ok(StereoPair { left: noisy(&pair.left, plain(&pair.left))?, right: noisy(&pair.right, right)? })
    }

    /// The right view, cubic between pixels.
    fn turned(&self, frame: &Frame) -> Vec<f64> {
        let (sin, cos) = self.roll_deg.to_radians().sin_cos();
        let scale = 1.0 + self.scale_percent / 100.0;
        let middle = [(frame.width as f64 - 1.0) / 2.0, (frame.height as f64 - 1.0) / 2.0];
        let pixel = |index: usize| {
            let x = (index % frame.width) as f64 - middle[0] - self.columns;
            let y = (index / frame.width) as f64 - middle[1] - self.rows;
            cubic(frame, middle[0] + (cos * x + sin * y) / scale, middle[1] + (cos * y - sin * x) / scale)
        };
        (0..frame.luma.len()).map(pixel).collect()
    }
}

/// The view between its pixels by Catmull-Rom, its border repeated.
fn cubic(frame: &Frame, x: f64, y: f64) -> f64 {
    let weights = |t: f64| {
        [
            ((-0.5 * t + 1.0) * t - 0.5) * t,
            (1.5 * t - 2.5) * t * t + 1.0,
            ((-1.5 * t + 2.0) * t + 0.5) * t,
            (0.5 * t - 0.5) * t * t,
        ]
    };
    let (left, top) = (x.floor(), y.floor());
    let (across, down) = (weights(x - left), weights(y - top));
    let at = |x: i64, y: i64| {
        let (x, y) = (x.clamp(0, frame.width as i64 - 1), y.clamp(0, frame.height as i64 - 1));
        f64::from(frame.luma[y as usize * frame.width + x as usize])
    };
    let row = |y: i64| (0..4).map(|i| across[i] * at(left as i64 - 1 + i as i64, y)).sum::<f64>();
    (0..4).map(|j| down[j] * row(top as i64 - 1 + j as i64)).sum()
}
