//! Slanted planes with a texture that is known at every point.

use rand::RngExt;

use super::{BLUR, Case, Family, WIDTH, generator};
use crate::synthetic::{Layer, Scene, Shape, Slope, Texture};

const HEIGHT: usize = 240;
const NUM_DISPARITIES: u16 = 64;

/// Slopes along rows and columns, px of disparity a pixel: walls seen from the side, floors and both.
const SLOPES: [[f64; 2]; 12] = [
    [0.02, 0.0],
    [-0.02, 0.0],
    [0.05, 0.0],
    [-0.05, 0.0],
    [0.1, 0.0],
    [-0.1, 0.0],
    [0.0, 0.02],
    [0.0, 0.05],
    [0.0, 0.1],
    [0.0, -0.04],
    [0.04, 0.04],
    [-0.05, 0.06],
];

pub(super) fn cases(seed: u64) -> Vec<Case> {
    SLOPES.iter().enumerate().map(|(index, &slope)| plane(seed, index, slope)).collect()
}

/// A plane that fills the view; its disparity in the middle is drawn, with fractions, within what the slope leaves.
fn plane(seed: u64, index: usize, [per_column, per_row]: [f64; 2]) -> Case {
    let mut rng = generator(seed, Family::Planes, index);
    let middle = [WIDTH, HEIGHT].map(|length| length as f64 / 2.0);
    let spread = per_column.abs() * middle[0] + per_row.abs() * middle[1];
    let most = f64::from(NUM_DISPARITIES) - 3.0;
    let at_middle = rng.random_range(spread + 2.0..(most - spread).min(spread + 26.0));
    let disparity = Slope { at_origin: at_middle - per_column * middle[0] - per_row * middle[1], per_column, per_row };
    let texture = Texture::new(0, 118.0, rng.random_range(70.0..110.0)).scaled(rng.random_range(0.9..1.6));
    let layers = vec![Layer { shape: Shape::Everywhere, disparity, texture }];
    let scene = Scene {
        width: WIDTH,
        height: HEIGHT,
        num_disparities: NUM_DISPARITIES,
        layers,
        blur: BLUR,
        noise: 0.0,
        seed: rng.random(),
    };
    Case::new(format!("plane_{index:02}"), scene)
}
