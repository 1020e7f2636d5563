//! Rendered scenes with known truth, for studies that are given no others.

use crate::score::scene::{self, Meta};
use crate::synthetic::{Layer, Rendering, Scene, Shape, Slope, Texture};

/// What the page calls them.
pub const NAME: &str = "three rendered scenes (room, boards, fence; 320x240 px, sensor noise 1.5)";

/// A room, slanted boards, and thin posts before a textured back; blank surfaces are not scored.
#[must_use]
pub fn scenes(seed: u64) -> Vec<scene::Scene> {
    let named = [("room", Scene::room(seed)), ("boards", boards(seed)), ("fence", fence(seed))];
    named.into_iter().map(|(name, scene)| benchmark_scene(name, &scene)).collect()
}

/// The rendering as a scene read from files would be.
fn benchmark_scene(name: &str, scene: &Scene) -> scene::Scene {
    let rendering = scene.render();
    let truth = rendering.textured_truth();
    let Rendering { pair, .. } = rendering;
    let num_disparities = scene.num_disparities;
    let meta = Meta { num_disparities, family: "rendered".to_owned(), focal_px: None, baseline_mm: None };
    scene::Scene { name: name.to_owned(), pair, truth, meta, rig: None }
}

/// Slanted boards of growing nearness and contrast before a faint back.
fn boards(seed: u64) -> Scene {
    let back = Layer {
        shape: Shape::Everywhere,
        disparity: Slope { at_origin: 4.2, per_column: 0.0, per_row: 0.02 },
        texture: Texture::new(0, 96.0, 36.0).scaled(1.4),
    };
    let board = |index: u32| {
        let number = f64::from(index);
        let left = 62.0 * number - 20.0;
        Layer {
            shape: Shape::Rectangle { columns: [left, left + 44.0], rows: [24.0 * number, 400.0] },
            disparity: Slope { at_origin: 6.0 + 6.4 * number - 0.05 * left, per_column: 0.05, per_row: 0.0 },
            texture: Texture::new(index, 70.0 + 28.0 * number, 30.0 + 12.0 * number).scaled(0.8 + 0.3 * number),
        }
    };
    let layers = std::iter::once(back).chain((1..=4).map(board)).collect();
    Scene { width: 320, height: 240, num_disparities: 48, layers, blur: 0.0, noise: 1.5, seed }
}

/// Posts of 2 and 3 px and a box of 40 px before a soft back.
fn fence(seed: u64) -> Scene {
    let rectangle = |columns| Shape::Rectangle { columns, rows: [-1.0, 400.0] };
    let post = |index: u32| {
        let left = 62.5 + 38.0 * f64::from(index);
        let width = 1.98 + f64::from(index % 2);
        Layer {
            shape: rectangle([left, left + width]),
            disparity: Slope::facing(17.3 + f64::from(index)),
            texture: Texture::new(10 + index, 205.0, 18.0),
        }
    };
    let back = Layer {
        shape: Shape::Everywhere,
        disparity: Slope::facing(6.6),
        texture: Texture::new(0, 92.0, 40.0).scaled(3.0),
    };
    let thing = Layer {
        shape: rectangle([230.5, 270.4]),
        disparity: Slope::facing(25.7),
        texture: Texture::new(1, 205.0, 18.0),
    };
    let layers = [back, thing].into_iter().chain((0..4).map(post)).collect();
    Scene { width: 320, height: 240, num_disparities: 48, layers, blur: 0.0, noise: 1.5, seed }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_lies_within_its_search_and_is_scored() {
        for scene in scenes(0) {
            let range = scene.meta.num_disparities;
            let most = scene.truth.scored().map(|(_, q8)| q8).max().unwrap();
            assert!(most <= (range - 1) * 256, "{}: {most}", scene.name);
            assert!(scene.truth.scored().count() > 20_000, "{}", scene.name);
            assert_eq!((scene.pair.width(), scene.pair.height()), (320, 240));
        }
    }

    #[test]
    fn the_seed_decides() {
        let pair = |seed| benchmark_scene("fence", &fence(seed)).pair;
        let first = pair(1);
        assert_eq!(first, pair(1));
        assert_ne!(first, pair(2));
    }
}
