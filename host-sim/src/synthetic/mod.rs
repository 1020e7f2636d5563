//! Synthetic scenes: flat layers at known disparities, seen by both cameras of a rectified pair.
//!
//! A layer is a shape in the left view with a disparity that is linear in the left view's pixels (so
//! it is a plane in space) and a texture of its own. Both views are rendered by asking for every
//! sample which layers lie there, and taking the nearest. In the right view a layer's pixel is found by
//! inverting its disparity, so sub-pixel disparities and occlusions are exact in both views, and
//! nothing is ever resampled.

mod blur;
pub mod cases;
pub mod folder;
mod presets;
pub mod regions;
mod texture;

use haarline::Config;

use crate::score::degrade::Degradation;
use crate::score::error_q8;
use crate::score::scene::Truth;
use crate::{DisparityMap, Frame, StereoPair};
pub use presets::YARD;
pub use texture::{Bars, Texture};

/// Samples of a pixel, across and down: edges mix as on a sensor.
const SAMPLES: [u32; 2] = [4, 2];

/// Where a layer is, in px of the left view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// In the whole view and beyond.
    Everywhere,
    /// Between two columns and two rows.
    Rectangle {
        /// First and last column.
        columns: [f64; 2],
        /// First and last row.
        rows: [f64; 2],
    },
    /// Upright slats in all rows, all alike.
    Slats {
        /// First column of one of them.
        first: f64,
        /// From one to the next.
        period: f64,
        /// Width of each.
        width: f64,
    },
    /// Around a point.
    Disc {
        /// Column and row of the centre.
        centre: [f64; 2],
        /// Radius.
        radius: f64,
    },
}

impl Shape {
    fn contains(&self, x: f64, y: f64) -> bool {
        match *self {
            Self::Everywhere => true,
            Self::Rectangle { columns, rows } => {
                (columns[0]..=columns[1]).contains(&x) && (rows[0]..=rows[1]).contains(&y)
            }
            Self::Slats { first, period, width } => (x - first).rem_euclid(period) <= width,
            Self::Disc { centre, radius } => (x - centre[0]).hypot(y - centre[1]) <= radius,
        }
    }
}

/// Disparity as a linear function of the left view's pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// Disparity in the top left corner, px.
    pub at_origin: f64,
    /// Px more with each column; less than 1.
    pub per_column: f64,
    /// Px more with each row.
    pub per_row: f64,
}

impl Slope {
    /// A plane that faces the cameras.
    #[must_use]
    pub const fn facing(disparity: f64) -> Self {
        Self { at_origin: disparity, per_column: 0.0, per_row: 0.0 }
    }

    fn at(&self, x: f64, y: f64) -> f64 {
        self.at_origin + self.per_column * x + self.per_row * y
    }

    /// The left view's column of what the right view sees in column `right`: solves
    /// `x - at(x, y) = right`.
    fn left_column(&self, right: f64, y: f64) -> f64 {
        (right + self.at_origin + self.per_row * y) / (1.0 - self.per_column)
    }
}

/// A flat piece of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Where it is.
    pub shape: Shape,
    /// How near it is.
    pub disparity: Slope,
    /// How it looks.
    pub texture: Texture,
}

/// A scene to render.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// How many disparities are to be searched; all layers' lie within.
    pub num_disparities: u16,
    /// Its layers, in any order, one of them everywhere.
    pub layers: Vec<Layer>,
    /// Standard deviation of the lens's Gaussian blur, px; 0 is none.
    pub blur: f64,
    /// Sensor noise in both views, grey levels.
    pub noise: f64,
    /// Seed of the textures and the noise.
    pub seed: u64,
}

/// Both views of a scene, and what is true of them.
#[derive(Debug, Clone)]
pub struct Rendering {
    /// The views.
    pub pair: StereoPair,
    /// True disparities, and which pixels both cameras see.
    pub truth: Truth,
    /// Which pixels show a layer without texture.
    pub is_blank: Vec<bool>,
    /// The layer that each pixel shows, by its place in the scene's list.
    pub layer: Vec<usize>,
}

/// What became of the scored pixels without texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlankScore {
    /// How many there are.
    pub pixels: u64,
    /// How many are answered.
    pub answered: u64,
    /// How many are answered wrong, by more than 2 px.
    pub wrong: u64,
}

impl Scene {
    /// How a method is to be configured for this scene.
    #[must_use]
    pub fn config(&self) -> Config {
        Config { width: self.width as u16, min_disparity: 0, num_disparities: self.num_disparities }
    }

    /// Renders both views, with truth and masks.
    #[must_use]
    pub fn render(&self) -> Rendering {
        let left = self.view(|layer, x, y| (x, layer.disparity.at(x, y)));
        let right = self.view(|layer, right, y| {
            let x = layer.disparity.left_column(right, y);
            (x, layer.disparity.at(x, y))
        });
        let mut pair = StereoPair { left, right };
        Degradation { noise: self.noise, seed: self.seed, ..Degradation::default() }.apply("synthetic", &mut pair);
        let (truth, layer) = self.truth();
        let is_blank = layer.iter().map(|&layer| self.layers[layer].texture.is_blank()).collect();
        Rendering { pair, truth, is_blank, layer }
    }

    /// A view; `locate` tells where a layer's point in this view is in the left one, and how near. The blur
    /// sees beyond the view's borders.
    fn view(&self, locate: impl Fn(&Layer, f64, f64) -> (f64, f64)) -> Frame {
        let count = f64::from(SAMPLES[0] * SAMPLES[1]);
        let kernel = blur::Kernel::new(self.blur);
        let margin = kernel.reach();
        let [width, height] = [self.width, self.height].map(|length| length + 2 * margin);
        let pixel = |index: usize| {
            let place = |at: usize| at as f64 - margin as f64;
            let (x, y) = (place(index % width), place(index / width));
            let sample = |[dx, dy]: [f64; 2]| match self.nearest(x + dx, y + dy, &locate) {
                Some((layer, at)) => self.layers[layer].texture.grey(at, y + dy, self.seed),
                None => 0.0,
            };
            sample_offsets().map(sample).sum::<f64>() / count
        };
        let sharp: Vec<f64> = (0..width * height).map(pixel).collect();
        let light = kernel.apply(&sharp, width);
        let luma = light.into_iter().map(|mean| mean.round().clamp(0.0, 255.0) as u8).collect();
        Frame::from_luma(self.width, self.height, luma)
    }

    /// The nearest layer at a point of a view, and its column in the left view.
    fn nearest(&self, x: f64, y: f64, locate: impl Fn(&Layer, f64, f64) -> (f64, f64)) -> Option<(usize, f64)> {
        let mut nearest = None;
        let mut most = f64::NEG_INFINITY;
        for (index, layer) in self.layers.iter().enumerate() {
            let (at, disparity) = locate(layer, x, y);
            if disparity > most && layer.shape.contains(at, y) {
                (nearest, most) = (Some((index, at)), disparity);
            }
        }
        nearest
    }

    /// The truth, and the layer that each pixel shows.
    fn truth(&self) -> (Truth, Vec<usize>) {
        let pixels = self.width * self.height;
        let (mut disparity_q8, mut seen_by_both, mut layers) = (vec![0; pixels], vec![false; pixels], vec![0; pixels]);
        for index in 0..pixels {
            let (x, y) = ((index % self.width) as f64, (index / self.width) as f64);
            let Some((layer, _)) = self.nearest(x, y, |layer, x, y| (x, layer.disparity.at(x, y))) else { continue };
            let disparity = self.layers[layer].disparity.at(x, y);
            disparity_q8[index] = (disparity * 256.0).round().clamp(1.0, 65535.0) as u16;
            seen_by_both[index] = self.is_seen_right(layer, x - disparity, y);
            layers[index] = layer;
        }
        let first_column = usize::from(self.num_disparities);
        (Truth { width: self.width, disparity_q8, seen_by_both, first_column }, layers)
    }

    /// Whether the right view shows `layer` in its column `right`.
    fn is_seen_right(&self, layer: usize, right: f64, y: f64) -> bool {
        let locate = |layer: &Layer, right: f64, y: f64| {
            let x = layer.disparity.left_column(right, y);
            (x, layer.disparity.at(x, y))
        };
        let is_inside = (0.0..=self.width as f64 - 1.0).contains(&right);
        is_inside && self.nearest(right, y, locate).is_some_and(|(nearest, _)| nearest == layer)
    }
}

impl Rendering {
    /// The truth with the pixels without texture left out of the score.
    #[must_use]
    pub fn textured_truth(&self) -> Truth {
        let mut truth = self.truth.clone();
        for (seen, blank) in truth.seen_by_both.iter_mut().zip(&self.is_blank) {
            *seen &= !blank;
        }
        truth
    }

    /// The truth of the pixels without texture alone.
    #[must_use]
    pub fn blank_truth(&self) -> Truth {
        let mut truth = self.truth.clone();
        for (seen, blank) in truth.seen_by_both.iter_mut().zip(&self.is_blank) {
            *seen &= blank;
        }
        truth
    }

    /// Counts the answers of at least some confidence on scored pixels without texture.
    ///
    /// # Panics
    /// If `map` has another size.
    #[must_use]
    pub fn blank_score(&self, map: &DisparityMap, least_confidence: u8) -> BlankScore {
        assert!(self.truth.fits(map), "map and truth differ in size");
        let mut score = BlankScore { pixels: 0, answered: 0, wrong: 0 };
        for (index, true_q8) in self.truth.scored().filter(|&(index, _)| self.is_blank[index]) {
            let is_meant = map.confidence[index] >= least_confidence;
            let error = error_q8(map.disparity[index], true_q8).filter(|_| is_meant);
            score.pixels += 1;
            score.answered += u64::from(error.is_some());
            score.wrong += u64::from(error.is_some_and(|error| error > 512));
        }
        score
    }
}

/// Where a pixel's samples lie, from its middle.
fn sample_offsets() -> impl Iterator<Item = [f64; 2]> {
    let offset = |index: u32, count: u32| (f64::from(index) + 0.5) / f64::from(count) - 0.5;
    let [across, down] = SAMPLES;
    (0..across * down).map(move |index| [offset(index % across, across), offset(index / across, down)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A textured back at `back` px with a box before it.
    fn two_planes(back: f64, front: f64) -> Scene {
        let box_shape = Shape::Rectangle { columns: [80.0, 110.0], rows: [-1.0, 100.0] };
        let layers = vec![
            Layer { shape: Shape::Everywhere, disparity: Slope::facing(back), texture: Texture::new(0, 128.0, 60.0) },
            Layer { shape: box_shape, disparity: Slope::facing(front), texture: Texture::blank(200.0) },
        ];
        Scene { width: 160, height: 12, num_disparities: 16, layers, blur: 0.0, noise: 0.0, seed: 3 }
    }

    #[test]
    fn the_right_view_is_the_left_one_shifted() {
        let Rendering { pair, truth, .. } = two_planes(4.0, 9.0).render();
        for (index, true_q8) in truth.scored() {
            let disparity = usize::from(true_q8 / 256);
            let (left, right) = (pair.left.luma[index], pair.right.luma[index - disparity]);
            // Pixels on an edge mix with what lies behind, which differs between the views.
            let x = index % 160;
            if !(79..=81).contains(&x) && !(109..=111).contains(&x) {
                assert_eq!(left, right, "column {x}");
            }
        }
    }

    #[test]
    fn what_the_box_hides_from_the_right_camera_lies_left_of_it() {
        let Rendering { truth, is_blank, .. } = two_planes(4.0, 9.0).render();
        let hidden: Vec<usize> = (16..160).filter(|&x| !truth.seen_by_both[x]).collect();
        assert_eq!(hidden, [75, 76, 77, 78, 79]);
        assert_eq!((0..160).filter(|&x| is_blank[x]).collect::<Vec<_>>(), (80..=110).collect::<Vec<_>>());
        assert_eq!((truth.disparity_q8[90], truth.disparity_q8[20]), (9 * 256, 4 * 256));
    }

    #[test]
    fn the_room_stays_within_its_search_and_repeats() {
        let scene = Scene::room(0);
        let rendering = scene.render();
        let most = u32::from(scene.num_disparities - 1) * 256;
        assert!(rendering.truth.disparity_q8.iter().all(|&q8| 0 < q8 && u32::from(q8) <= most));
        assert_eq!(rendering.pair, scene.render().pair);
        assert_ne!(rendering.pair, Scene::room(1).render().pair);
        let blank = rendering.blank_score(&rendering.truth.to_map(), 16);
        assert!(blank.pixels > 10_000, "{blank:?}");
        assert_eq!((blank.answered, blank.wrong), (blank.pixels, 0));
    }
}
