//! Frames made worse on purpose: cameras that stand or see otherwise than they should, exposure differences
//! between the views, sensor noise, few bits, views that do not belong together.

mod misalignment;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use serde::Serialize;

pub use self::misalignment::Misalignment;
use crate::{Frame, StereoPair};

/// What is done to a pair, in this order. Where the views are `random`, each pixel becomes a random byte; where they
/// are to `swap`, they do. The right view is resampled as a camera out of place would see it. It becomes
/// `value x gain + offset`, then both views are multiplied by `both_gain`, then both get all three kinds of noise; at
/// the end each pixel is rounded once (halves to even), clipped to 0..=255 and reduced to its highest `bits`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Degradation {
    /// Standard deviation of Gaussian noise, independent in every pixel of both views, grey levels.
    pub noise: f64,
    /// Shot noise: standard deviation at one grey level; it grows with the square root of the grey level.
    pub shot_noise: f64,
    /// Fixed pattern: standard deviation of what each column of a view is too bright, grey levels.
    pub pattern_noise: f64,
    /// Factor on the right view.
    pub gain: f64,
    /// Grey levels added to the right view, after the factor.
    pub offset: f64,
    /// Factor on both views: less light.
    pub both_gain: f64,
    /// How the right camera is out of place.
    #[serde(flatten)]
    pub misalignment: Misalignment,
    /// How many bits of a grey level are left, 1 to 8.
    pub bits: u8,
    /// Whether the views change places.
    pub swap: bool,
    /// Whether both views are random bytes.
    pub random: bool,
    /// Seed of the noise and of random views.
    pub seed: u64,
}

impl Default for Degradation {
    fn default() -> Self {
        Self::NONE
    }
}

impl Degradation {
    /// Leaves the frames as they are.
    pub const NONE: Self = Self {
        noise: 0.0,
        shot_noise: 0.0,
        pattern_noise: 0.0,
        gain: 1.0,
        offset: 0.0,
        both_gain: 1.0,
        misalignment: Misalignment::NONE,
        bits: 8,
        swap: false,
        random: false,
        seed: 0,
    };

    /// Whether Gaussian noise is all it does, if anything.
    #[must_use]
    pub fn is_noise_only(&self) -> bool {
        *self == Self { noise: self.noise, seed: self.seed, ..Self::NONE }
    }

    /// Degrades both views of the scene called `name`. What is drawn depends on the seed, the name and
    /// the view only, so neither on the order of the scenes nor on which of them are computed.
    ///
    /// # Panics
    /// If the noise is negative or not finite.
    pub fn apply(&self, name: &str, pair: &mut StereoPair) {
        if self.random {
            for (view, frame) in [&mut pair.left, &mut pair.right].into_iter().enumerate() {
                generator(self.seed, name, RANDOM_VIEWS + view as u8).fill_bytes(&mut frame.luma);
                frame.colour = None;
            }
        }
        if self.swap {
            std::mem::swap(&mut pair.left, &mut pair.right);
        }
        let left: Vec<f64> = pair.left.luma.iter().map(|&pixel| f64::from(pixel)).collect();
        let right = self.misalignment.resample(&pair.right);
        let left_gain = self.both_gain;
        self.degrade(&mut pair.left, &left, [left_gain, 0.0], generator(self.seed, name, 0));
        let (gain, offset) = (self.gain * self.both_gain, self.offset * self.both_gain);
        self.degrade(&mut pair.right, &right, [gain, offset], generator(self.seed, name, 1));
    }

    /// Makes `frame` what a camera sees of `light`.
    fn degrade(&self, frame: &mut Frame, light: &[f64], [gain, offset]: [f64; 2], mut rng: ChaCha8Rng) {
        let normal = |sigma: f64| Normal::new(0.0, sigma).expect("the noise is finite and not negative");
        let (noise, unit, pattern) = (normal(self.noise), normal(1.0), normal(self.pattern_noise));
        let mut draw = |law: &Normal<f64>, is_on: bool| if is_on { law.sample(&mut rng) } else { 0.0 };
        let columns: Vec<f64> = (0..frame.width).map(|_| draw(&pattern, self.pattern_noise > 0.0)).collect();
        for (row, light) in frame.luma.chunks_mut(frame.width).zip(light.chunks(frame.width)) {
            for ((pixel, light), column) in row.iter_mut().zip(light).zip(&columns) {
                let light = light * gain + offset;
                let shot = draw(&unit, self.shot_noise > 0.0) * self.shot_noise * light.max(0.0).sqrt();
                let value = light + shot + column + draw(&noise, self.noise > 0.0);
                *pixel = self.reduce(value.round_ties_even().clamp(0.0, 255.0) as u8);
            }
        }
    }

    /// The highest bits alone, spread over the whole range again: black stays 0, white 255.
    fn reduce(&self, pixel: u8) -> u8 {
        let most = (1_u32 << self.bits) - 1;
        ((u32::from(pixel) >> (8 - self.bits)) * 255 / most) as u8
    }
}

/// Puts the right view of another scene in the place of a pair's own. Where it is smaller it is repeated, where it is
/// larger cut off, from the top left.
pub fn replace_right(pair: &mut StereoPair, other: &Frame) {
    let right = &mut pair.right;
    right.colour = None;
    for (y, row) in right.luma.chunks_mut(right.width).enumerate() {
        let from = other.row(y % other.height);
        row.iter_mut().zip(from.iter().cycle()).for_each(|(pixel, &from)| *pixel = from);
    }
}

/// Numbers of the generators of random views, beside those of the noise in both views.
const RANDOM_VIEWS: u8 = 2;

/// A generator of its own for one view of one scene.
fn generator(seed: u64, name: &str, view: u8) -> ChaCha8Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&fnv1a(name.as_bytes()).to_le_bytes());
    key[16] = view;
    ChaCha8Rng::from_seed(key)
}

/// The 64-bit FNV-1a hash: the same on every machine and in every release.
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(value: u8) -> StereoPair {
        let frame = Frame::from_luma(200, 100, vec![value; 20_000]);
        StereoPair { left: frame.clone(), right: frame }
    }

    fn degraded(value: u8, degradation: Degradation) -> StereoPair {
        let mut pair = flat(value);
        degradation.apply("flat", &mut pair);
        pair
    }

    #[test]
    fn nothing_asked_changes_nothing() {
        assert_eq!(degraded(77, Degradation::default()), flat(77));
    }

    #[test]
    fn gain_and_offset_change_the_right_view_only_and_clip() {
        let pair = degraded(200, Degradation { gain: 0.8, offset: 25.0, ..Default::default() });
        assert_eq!((pair.left.luma[0], pair.right.luma[0]), (200, 185));
        let pair = degraded(200, Degradation { gain: 1.2, offset: 25.0, ..Default::default() });
        assert_eq!(pair.right.luma[0], 255);
        let pair = degraded(100, Degradation { both_gain: 0.25, offset: 20.0, ..Default::default() });
        assert_eq!((pair.left.luma[0], pair.right.luma[0]), (25, 30));
    }

    #[test]
    fn few_bits_leave_few_grey_levels_from_black_to_white() {
        for bits in 1..=8 {
            let degradation = Degradation { bits, ..Default::default() };
            let mut levels: Vec<u8> = (0..=255).map(|pixel| degradation.reduce(pixel)).collect();
            assert!(levels.is_sorted() && (levels[0], levels[255]) == (0, 255), "{bits}");
            levels.dedup();
            assert_eq!(levels.len(), 1 << bits);
        }
        assert_eq!(degraded(0x9f, Degradation { bits: 4, ..Default::default() }).left.luma[0], 0x99);
    }

    #[test]
    fn swapped_views_are_the_other_s_before_anything_else() {
        let mut pair = flat(100);
        pair.right.luma.fill(40);
        Degradation { swap: true, gain: 2.0, ..Default::default() }.apply("flat", &mut pair);
        assert_eq!((pair.left.luma[0], pair.right.luma[0]), (40, 200));
    }

    #[test]
    fn random_views_depend_on_seed_and_scene_and_hold_nothing_of_the_frame() {
        let random = Degradation { random: true, ..Default::default() };
        let first = degraded(128, random);
        assert_eq!(first, degraded(3, random));
        assert_ne!(first.left, first.right);
        assert_ne!(first, degraded(128, Degradation { seed: 1, ..random }));
        let mean = first.left.luma.iter().map(|&v| f64::from(v)).sum::<f64>() / 20_000.0;
        assert!((mean - 127.5).abs() < 2.5, "{mean}");
    }

    #[test]
    fn another_right_view_is_repeated_and_cut_off() {
        let mut pair = flat(9);
        let other = Frame::from_luma(150, 40, (0..6000).map(|i| (i % 150 + i / 150) as u8).collect());
        replace_right(&mut pair, &other);
        let right = &pair.right;
        assert_eq!((right.row(0)[7], right.row(3)[149], right.row(45)[151]), (7, 152, 6));
        assert_eq!(pair.left, flat(9).left);
    }

    #[test]
    fn noise_has_the_mean_and_the_sigma_asked_for() {
        let pair = degraded(128, Degradation { noise: 10.0, ..Default::default() });
        for luma in [&pair.left.luma, &pair.right.luma] {
            let mean = luma.iter().map(|&v| f64::from(v)).sum::<f64>() / 20_000.0;
            let variance = luma.iter().map(|&v| (f64::from(v) - mean).powi(2)).sum::<f64>() / 20_000.0;
            // The mean of 20000 has a sigma of 0.07, their sigma one of 0.05; rounding adds 1/12.
            assert!((mean - 128.0).abs() < 0.35, "mean {mean}");
            assert!(((variance - 1.0 / 12.0).sqrt() - 10.0).abs() < 0.25, "variance {variance}");
        }
    }

    #[test]
    fn shot_noise_grows_with_the_root_of_the_light_and_a_pattern_stays_in_its_column() {
        let sigma = |value: u8| {
            let luma = degraded(value, Degradation { shot_noise: 0.8, ..Default::default() }).left.luma;
            let variance = luma.iter().map(|&v| (f64::from(v) - f64::from(value)).powi(2)).sum::<f64>() / 20_000.0;
            (variance - 1.0 / 12.0).sqrt()
        };
        assert!((sigma(100) - 8.0).abs() < 0.2 && (sigma(25) - 4.0).abs() < 0.1, "{} {}", sigma(100), sigma(25));
        let pattern = degraded(128, Degradation { pattern_noise: 5.0, ..Default::default() }).left.luma;
        assert!(pattern.chunks(200).all(|row| row == &pattern[..200]));
        assert!(pattern[..200].iter().any(|&v| v != 128));
    }

    #[test]
    fn noise_depends_on_seed_scene_and_view() {
        let noise = Degradation { noise: 5.0, ..Default::default() };
        let first = degraded(128, noise);
        assert_eq!(first, degraded(128, noise));
        assert_ne!(first.left, first.right);
        assert_ne!(first, degraded(128, Degradation { seed: 1, ..noise }));
        let mut other = flat(128);
        noise.apply("other", &mut other);
        assert_ne!(first, other);
    }
}
