//! Walls without texture.

use rand::RngExt;

use super::{BLUR, Case, Family, Scored, WIDTH, generator};
use crate::synthetic::{Layer, Scene, Shape, Slope, Texture};

/// Rooms, panels and discs each.
const COUNT: usize = 4;

/// The demo's room with other textures; a panel before a textured back, and a disc in which nothing is upright.
pub(super) fn cases(seed: u64) -> Vec<Case> {
    let room = |index: usize| {
        let scene = Scene { noise: 0.0, ..Scene::room(generator(seed, Family::Walls, index).random()) };
        (format!("room_{index:02}"), scene)
    };
    let panel = |index: usize, name: &str| {
        let mut rng = generator(seed, Family::Walls, COUNT + index);
        let back = Layer {
            shape: Shape::Everywhere,
            disparity: Slope { at_origin: rng.random_range(3.0..8.0), per_column: 0.0, per_row: 0.01 },
            texture: Texture::new(0, 100.0, 70.0).scaled(1.3),
        };
        let (left, top) = (rng.random_range(90.0..150.0), rng.random_range(20.0..80.0));
        let shape = match name {
            "disc" => Shape::Disc { centre: [left + 70.0, top + 70.0], radius: rng.random_range(45.0..75.0) },
            _ => Shape::Rectangle { columns: [left, left + rng.random_range(60.0..150.0)], rows: [top, top + 120.0] },
        };
        let panel = Layer {
            shape,
            disparity: Slope::facing(rng.random_range(12.0..30.0)),
            texture: Texture::blank(rng.random_range(60.0..220.0)),
        };
        let layers = vec![back, panel];
        let seed = rng.random();
        let scene = Scene { width: WIDTH, height: 240, num_disparities: 48, layers, blur: BLUR, noise: 0.0, seed };
        (format!("{name}_{:02}", index % COUNT), scene)
    };
    let rooms = (0..COUNT).map(room);
    let panels = (0..COUNT).map(|index| panel(index, "panel"));
    let discs = (COUNT..2 * COUNT).map(|index| panel(index, "disc"));
    let case = |(name, scene)| Case { scored: Scored::Blank, ..Case::new(name, scene) };
    rooms.chain(panels).chain(discs).map(case).collect()
}
