//! Obstacles on flat ground, seen by the rig of [`haarline_rig::template`]: 200 px, 60 mm, 300 mm over the ground, level.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{BLUR, Case, Family, WIDTH, generator};
use crate::synthetic::{Layer, Scene, Shape, Slope, Texture};

const HEIGHT: usize = 240;
const FOCAL_PX: f64 = 200.0;
const BASELINE_MM: f64 = 60.0;
const CAMERA_MM: f64 = 300.0;
/// Distances of the obstacle, mm.
const DISTANCES_MM: [f64; 8] = [500.0, 750.0, 1000.0, 1250.0, 1500.0, 2000.0, 2500.0, 3000.0];

/// What stands there.
#[derive(Debug, Clone, Copy)]
enum Thing {
    Post,
    Box,
    Wall,
}

/// Posts, boxes and walls with texture.
pub(super) fn textured(seed: u64) -> Vec<Case> {
    let things = [("post", Thing::Post), ("box", Thing::Box), ("wall", Thing::Wall)];
    let look = |rng: &mut ChaCha8Rng| {
        let mean = rng.random_range(80.0..170.0);
        Texture::new(9, mean, rng.random_range(40.0..90.0)).scaled(rng.random_range(0.8..1.6))
    };
    cases(seed, Family::Obstacles, things.map(|(name, thing)| (name, thing, look as fn(&mut _) -> _)))
}

/// Boxes that are nearly black, saturated, and of one grey.
pub(super) fn dim(seed: u64) -> Vec<Case> {
    let looks: [Kind; 3] = [
        ("dark", Thing::Box, |rng| Texture::new(9, rng.random_range(3.0..9.0), 3.0)),
        ("saturated", Thing::Box, |_| Texture::blank(300.0)),
        ("blank", Thing::Box, |rng| Texture::blank(rng.random_range(70.0..200.0))),
    ];
    cases(seed, Family::DimObstacles, looks)
}

type Kind = (&'static str, Thing, fn(&mut ChaCha8Rng) -> Texture);

fn cases(seed: u64, family: Family, kinds: [Kind; 3]) -> Vec<Case> {
    let mut cases = Vec::new();
    for (number, (name, thing, look)) in kinds.into_iter().enumerate() {
        for (step, &at) in DISTANCES_MM.iter().enumerate() {
            let mut rng = generator(seed, family, number * DISTANCES_MM.len() + step);
            let distance = at * rng.random_range(0.95..1.05);
            let texture = look(&mut rng);
            let mut layers = surroundings(&mut rng);
            layers.push(obstacle(&mut rng, thing, distance, texture));
            let seed = rng.random();
            let scene =
                Scene { width: WIDTH, height: HEIGHT, num_disparities: 48, layers, blur: BLUR, noise: 0.0, seed };
            let name = format!("{name}_{at:04}mm");
            cases.push(Case { has_rig: true, ..Case::new(name, scene) });
        }
    }
    cases
}

/// The ground and a wall at 5 to 7 m.
fn surroundings(rng: &mut ChaCha8Rng) -> Vec<Layer> {
    let per_row = BASELINE_MM / CAMERA_MM;
    let wall = Slope::facing(FOCAL_PX * BASELINE_MM / rng.random_range(5000.0..7000.0));
    let below = Shape::Rectangle { columns: [-400.0, 720.0], rows: [HEIGHT as f64 / 2.0 + 1.0, 400.0] };
    let ground = Slope { at_origin: -per_row * middle(HEIGHT), per_column: 0.0, per_row };
    vec![
        Layer { shape: Shape::Everywhere, disparity: wall, texture: Texture::new(0, 150.0, 70.0) },
        Layer { shape: below, disparity: ground, texture: Texture::new(1, 96.0, 70.0).scaled(1.3) },
    ]
}

/// A thing that faces the cameras and stands on the ground.
fn obstacle(rng: &mut ChaCha8Rng, thing: Thing, distance_mm: f64, texture: Texture) -> Layer {
    let px = |mm: f64| FOCAL_PX * mm / distance_mm;
    let (width_mm, height_mm) = match thing {
        Thing::Post => (rng.random_range(60.0..120.0), rng.random_range(400.0..900.0)),
        Thing::Box => (rng.random_range(200.0..400.0), rng.random_range(250.0..500.0)),
        Thing::Wall => (6000.0, 1000.0),
    };
    let bearing = rng.random_range(-20.0..25.0_f64);
    let centre = match thing {
        Thing::Wall => middle(WIDTH),
        Thing::Post | Thing::Box => middle(WIDTH) + FOCAL_PX * bearing.to_radians().tan(),
    };
    let (half, foot) = (px(width_mm) / 2.0, middle(HEIGHT) + px(CAMERA_MM));
    let shape = Shape::Rectangle { columns: [centre - half, centre + half], rows: [foot - px(height_mm), foot] };
    Layer { shape, disparity: Slope::facing(FOCAL_PX * BASELINE_MM / distance_mm), texture }
}

/// The column or row on the axis.
fn middle(length: usize) -> f64 {
    (length as f64 - 1.0) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline_rig::Description;

    #[test]
    fn the_rig_is_the_templates() {
        let rig = Description::parse(&haarline_rig::template()).unwrap();
        assert_eq!((usize::from(rig.width), usize::from(rig.height), rig.pitch_deg), (WIDTH, HEIGHT, 0.0));
        assert_eq!((rig.focal_px, rig.baseline_mm), (FOCAL_PX, BASELINE_MM));
        assert_eq!((f64::from(rig.camera_height_mm), rig.num_disparities), (CAMERA_MM, 48));
    }
}
