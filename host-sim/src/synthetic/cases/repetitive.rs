//! What repeats along the row: fences, slats, ribs.

use std::ops::{Range, RangeInclusive};

use rand::RngExt;

use super::{BLUR, Case, Family, WIDTH, generator};
use crate::synthetic::{Bars, Layer, Scene, Shape, Slope, Texture};

const HEIGHT: usize = 160;
/// Scenes of slats and strips.
const COUNT: usize = 12;

/// Equal bars at one distance, a scene for each period from 8 to 30 px, with a fraction from 9 on.
pub(super) fn fences(seed: u64) -> Vec<Case> {
    equal_bars(seed, Family::Fences, 8..=30, 48, 8.0..36.0)
}

/// The same of period 31 to 60 px, far enough for the next bar to be within the search.
pub(super) fn wide_fences(seed: u64) -> Vec<Case> {
    equal_bars(seed, Family::WideFences, 31..=60, 64, 3.0..14.0)
}

/// A fence for each of the periods, px, at a disparity within that range.
fn equal_bars(
    seed: u64,
    family: Family,
    periods: RangeInclusive<usize>,
    num_disparities: u16,
    disparities: Range<f64>,
) -> Vec<Case> {
    let fence = |(index, whole): (usize, usize)| {
        let mut rng = generator(seed, family, index);
        let period = whole as f64 + if index.is_multiple_of(2) { 0.0 } else { rng.random_range(-0.5..0.5) };
        let bars = Bars {
            period,
            share: rng.random_range(0.3..0.7),
            edge: rng.random_range(1.0..3.0),
            depth: rng.random_range(70.0..150.0),
        };
        let layer = Layer {
            shape: Shape::Everywhere,
            disparity: Slope::facing(rng.random_range(disparities.clone())),
            texture: Texture::blank(rng.random_range(180.0..225.0)).with_bars(bars),
        };
        Case::new(format!("fence_p{whole:02}"), scene(num_disparities, vec![layer], rng.random()))
    };
    periods.enumerate().map(fence).collect()
}

/// Slats of one grey, and the garden between them.
pub(super) fn slats(seed: u64) -> Vec<Case> {
    let slats = |index: usize| {
        let mut rng = generator(seed, Family::Slats, index);
        let period = rng.random_range(16.0..36.0);
        let garden = Layer {
            shape: Shape::Everywhere,
            disparity: Slope::facing(rng.random_range(4.0..8.0)),
            texture: Texture::new(0, 112.0, rng.random_range(60.0..100.0)).scaled(rng.random_range(0.8..1.6)),
        };
        let slats = Layer {
            shape: Shape::Slats {
                first: rng.random_range(0.0..period),
                period,
                width: period * rng.random_range(0.4..0.65),
            },
            disparity: Slope::facing(rng.random_range(12.0..20.0)),
            texture: Texture::blank(rng.random_range(60.0..200.0)),
        };
        Case::new(format!("slats_{index:02}"), scene(48, vec![garden, slats], rng.random()))
    };
    (0..COUNT).map(slats).collect()
}

/// Ribs from the left to the middle, a textured wall to the right of it, before them a dark stand, and right of the
/// stand a post so near that it hides from the right view what lies between the two.
pub(super) fn strips(seed: u64) -> Vec<Case> {
    let strip = |index: usize| {
        let mut rng = generator(seed, Family::Strips, index);
        let far = rng.random_range(22.0..36.0);
        let bars = Bars {
            period: rng.random_range(9.0..14.0),
            share: rng.random_range(0.35..0.6),
            edge: rng.random_range(1.5..4.0),
            depth: rng.random_range(60.0..110.0),
        };
        let upright = |from: f64, to: f64| Shape::Rectangle { columns: [from, to], rows: [-20.0, 400.0] };
        let stand = rng.random_range(110.0..135.0);
        let stand_end = stand + rng.random_range(16.0..24.0);
        let post = stand_end + rng.random_range(14.0..26.0);
        let post_end = post + rng.random_range(18.0..26.0);
        let layers = vec![
            Layer {
                shape: Shape::Everywhere,
                disparity: Slope::facing(far),
                texture: Texture::blank(205.0).with_bars(bars),
            },
            Layer {
                shape: upright(post_end + rng.random_range(14.0..24.0), 720.0),
                disparity: Slope::facing(far + 0.5),
                texture: Texture::new(1, 128.0, 60.0).scaled(1.5),
            },
            Layer {
                shape: upright(stand, stand_end),
                disparity: Slope::facing(far + rng.random_range(1.5..4.0)),
                texture: Texture::new(2, 26.0, 8.0),
            },
            Layer {
                shape: upright(post, post_end),
                disparity: Slope::facing(far + rng.random_range(13.0..20.0)),
                texture: Texture::new(3, 105.0, 30.0),
            },
        ];
        Case::new(format!("strip_{index:02}"), scene(64, layers, rng.random()))
    };
    (0..COUNT).map(strip).collect()
}

fn scene(num_disparities: u16, layers: Vec<Layer>, seed: u64) -> Scene {
    Scene { width: WIDTH, height: HEIGHT, num_disparities, layers, blur: BLUR, noise: 0.0, seed }
}
