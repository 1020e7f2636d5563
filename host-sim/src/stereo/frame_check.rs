//! Whether a frame can be what it should be: two views of one scene, row by row.
//!
//! Where a map is right, what the left view shows at a pixel the right view shows at the pixel that the map names. The
//! *mismatch* is the sum of absolute differences of the gradients of the two, as a share of what these gradients would
//! make if nothing matched: 100 x sum |left - right| / (2 x sum |left|), over cells of 8 x 4 px of which the left view
//! shows more than noise. Noise raises both sums, so that one limit does for all light.

use haarline::Rectification;
use haarline::confidence::SURE;
use haarline::frame_figures::FrameFigures;
pub use haarline::frame_figures::{Input, Trust};
use serde::Serialize;

use super::pipeline;
use crate::input::noise;
use crate::{DisparityMap, Frame, StereoPair};

/// A greater mismatch, percent, is no stereo pair. Of the 36 recorded scenes right ones have 9 to 26 (one, lit otherwise in
/// one view, 30), clean, in noise 10 and in low light; swapped, two and six rows off and unrelated ones 30 to 75.
pub const MOST_MISMATCH_PERCENT: f64 = 27.0;
/// With a smaller share of cells that show something, percent, nothing was seen: in pure noise it is 0.3 at most.
pub const LEAST_SEEN_PERCENT: f64 = 1.0;

/// The figures of a frame as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrameCheck {
    /// Whether the frame is what it should be.
    pub input_ok: bool,
    /// What it is.
    pub input: Input,
    /// Share of what the left view shows that the right view contradicts; none where nothing is seen and answered.
    pub mismatch_percent: Option<f64>,
    /// Share of the pixels with a sure answer, percent.
    pub share_sure: f64,
    /// How far the right view lies lower, px: of this frame and those before, where enough was sure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub row_error_px: Option<f64>,
}

impl From<FrameFigures> for FrameCheck {
    fn from(FrameFigures { input, mismatch, sure, row_error_q8 }: FrameFigures) -> Self {
        let percent = |per_mille: u16| f64::from(per_mille) / 10.0;
        let (mismatch_percent, share_sure) = (mismatch.map(percent), percent(sure));
        let row_error_px = row_error_q8.map(row_error_px);
        Self { input_ok: input == Input::Ok, input, mismatch_percent, share_sure, row_error_px }
    }
}

/// A row error of 1/256 px in px.
#[must_use]
pub fn row_error_px(q8: i16) -> f64 {
    f64::from(q8) / 256.0
}

impl FrameCheck {
    /// What the method itself tells of the frame that it made `map` of, as a chip would; of a method that tells nothing the
    /// same from map and views ([`FrameCheck::of`]).
    ///
    /// # Panics
    /// If map and views differ in size.
    #[must_use]
    pub fn told(figures: Option<FrameFigures>, pair: &StereoPair, rig: &Rectification, map: &DisparityMap) -> Self {
        figures.map_or_else(|| Self::of(pair, rig, map), Self::from)
    }

    /// Checks a frame of cameras that are put right by `rig`, of which a method made `map`.
    ///
    /// # Panics
    /// If map and views differ in size.
    #[must_use]
    pub fn of(pair: &StereoPair, rig: &Rectification, map: &DisparityMap) -> Self {
        assert_eq!(map.disparity.len(), pair.left.luma.len(), "map and views differ in size");
        let sums = Sums::of(pair, rig, map);
        let mismatch_percent = sums.mismatch_percent();
        let input = if sums.cells < LEAST_CELLS {
            Input::Ok
        } else if sums.seen_percent() < LEAST_SEEN_PERCENT {
            Input::NothingSeen
        } else if pair.left.luma == pair.right.luma {
            Input::SameView
        } else if mismatch_percent.is_some_and(|percent| percent > MOST_MISMATCH_PERCENT) {
            Input::Mismatch
        } else {
            Input::Ok
        };
        let sure = map.confidence.iter().filter(|&&confidence| confidence >= SURE).count();
        let share_sure = 100.0 * sure as f64 / map.confidence.len().max(1) as f64;
        Self { input_ok: input == Input::Ok, input, mismatch_percent, share_sure, row_error_px: None }
    }

    /// In a few words, for a summary.
    #[must_use]
    pub fn words(&self) -> String {
        let mismatch = self.mismatch_percent.map_or_else(|| "-".to_owned(), |percent| format!("{percent:.0} %"));
        format!("{:.1} % sure, mismatch {mismatch}", self.share_sure)
    }
}

/// Fewer cells than this say nothing of a frame.
const LEAST_CELLS: usize = 12;
/// Columns and rows of a cell.
const CELL: [usize; 2] = [8, 4];
/// Gradients count up to here, grey levels, or up to three times what noise makes: what stands out more says no more.
const MOST_GRADIENT: f32 = 15.0;
/// Least mean gradient that noise is taken to make, grey levels: rounding hides a fainter one.
const LEAST_FLOOR: f32 = 26.0 / 16.0;

/// Sums over the cells of a frame.
#[derive(Debug, Default)]
struct Sums {
    cells: usize,
    seen: usize,
    difference: f64,
    strength: f64,
}

impl Sums {
    fn of(pair: &StereoPair, rig: &Rectification, map: &DisparityMap) -> Self {
        let sigma = noise::estimate(pair).unwrap_or(0.0) as f32;
        let smoothing = Smoothing::for_noise(sigma);
        let floor = smoothing.floor(sigma).max(LEAST_FLOOR);
        let (least, most) = (2.0 * floor, MOST_GRADIENT.max(3.0 * floor));
        let [left, right] = [&pair.left, &pair.right].map(|frame| gradients(frame, smoothing, most));
        let mut sums = Self::default();
        for top in (0..map.height.saturating_sub(CELL[1] - 1)).step_by(CELL[1]) {
            for first in (0..map.width.saturating_sub(CELL[0] - 1)).step_by(CELL[0]) {
                sums.add(CellSums::of([first, top], rig, map, &left, &right), least);
            }
        }
        sums
    }

    fn add(&mut self, cell: CellSums, least: f32) {
        let pixels = CELL[0] * CELL[1];
        self.cells += 1;
        if cell.strength < least * (2 * pixels) as f32 {
            return;
        }
        self.seen += 1;
        // What is answered in part says little.
        if cell.answered >= pixels / 2 {
            self.difference += f64::from(cell.difference);
            self.strength += f64::from(cell.strength_answered);
        }
    }

    fn seen_percent(&self) -> f64 {
        100.0 * self.seen as f64 / self.cells.max(1) as f64
    }

    fn mismatch_percent(&self) -> Option<f64> {
        (self.strength > 0.0).then(|| 50.0 * self.difference / self.strength)
    }
}

/// Sums over both gradients of the pixels of a cell.
#[derive(Debug, Default)]
struct CellSums {
    answered: usize,
    strength: f32,
    strength_answered: f32,
    difference: f32,
}

impl CellSums {
    fn of(
        [first, top]: [usize; 2],
        rig: &Rectification,
        map: &DisparityMap,
        left: &Gradients,
        right: &Gradients,
    ) -> Self {
        let mut sums = Self::default();
        for y in top..top + CELL[1] {
            for x in first..first + CELL[0] {
                let here = y * map.width + x;
                let strength: f32 = left.iter().map(|gradient| gradient[here].abs()).sum();
                sums.strength += strength;
                if let Some(there) = corresponding([x, y], rig, map) {
                    sums.answered += 1;
                    sums.strength_answered += strength;
                    let pairs = left.iter().zip(right);
                    sums.difference += pairs.map(|(left, right)| (left[here] - right[there]).abs()).sum::<f32>();
                }
            }
        }
        sums
    }
}

/// The pixel of the right view that the map names for one of the left view.
fn corresponding([x, y]: [usize; 2], rig: &Rectification, map: &DisparityMap) -> Option<usize> {
    let bits = i64::from(map.disparity[y * map.width + x].known()?);
    let px = (bits + 8).div_euclid(16);
    let column = usize::try_from(x as i64 - px + i64::from(rig.columns)).ok().filter(|&x| x < map.width)?;
    let row = pipeline::right_row(rig, [column, y], [map.width, map.height])?;
    Some(row * map.width + column)
}

/// Along rows and along columns, grey levels over two pixels.
type Gradients = [Vec<f32>; 2];

fn gradients(frame: &Frame, smoothing: Smoothing, most: f32) -> Gradients {
    let (width, height) = (frame.width, frame.height);
    let mut light: Vec<f32> = frame.luma.iter().map(|&luma| f32::from(luma)).collect();
    for _ in 0..smoothing.passes() {
        let around = |at: usize, by: usize, from: &[f32], place: usize, length: usize| {
            let before = if place > 0 { from[at - by] } else { from[at] };
            let after = if place + 1 < length { from[at + by] } else { from[at] };
            (before + 2.0 * from[at] + after) / 4.0
        };
        let along: Vec<f32> = (0..light.len()).map(|at| around(at, 1, &light, at % width, width)).collect();
        light = (0..along.len()).map(|at| around(at, width, &along, at / width, height)).collect();
    }
    let gradient = |by: usize, place: fn(usize, usize) -> usize, length: usize| {
        let at = |at: usize| {
            let place = place(at, width);
            let is_inside = place > 0 && place + 1 < length;
            if is_inside { (light[at + by] - light[at - by]).clamp(-most, most) } else { 0.0 }
        };
        (0..light.len()).map(at).collect()
    };
    [gradient(1, |at, width| at % width, width), gradient(width, |at, width| at / width, height)]
}

/// Binomial smoothing before the gradients: the more, the noisier the views.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Smoothing {
    None,
    Once,
    Twice,
}

impl Smoothing {
    fn for_noise(sigma: f32) -> Self {
        match sigma {
            sigma if sigma < 1.5 => Self::None,
            sigma if sigma < 6.0 => Self::Once,
            _ => Self::Twice,
        }
    }

    const fn passes(self) -> usize {
        match self {
            Self::None => 0,
            Self::Once => 1,
            Self::Twice => 2,
        }
    }

    /// Mean magnitude of the gradients of noise alone: 0.8 sigma times the root of the sum of the squared weights of
    /// smoothing and difference together.
    fn floor(self, sigma: f32) -> f32 {
        let root = match self {
            Self::None => 1.414,
            Self::Once => 0.484,
            Self::Twice => 0.300,
        };
        0.8 * root * sigma
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::degrade::Degradation;
    use crate::synthetic::{Layer, Scene, Shape, Slope, Texture};
    use haarline::Ramp;

    /// A textured plane at 7.5 px and what is true of it.
    fn plane(seed: u64) -> (StereoPair, DisparityMap) {
        let layer = Layer {
            shape: Shape::Everywhere,
            disparity: Slope::facing(7.5),
            texture: Texture::new(0, 120.0, 90.0).scaled(1.5),
        };
        let scene =
            Scene { width: 160, height: 60, num_disparities: 16, layers: vec![layer], blur: 0.5, noise: 0.0, seed };
        let rendering = scene.render();
        (rendering.pair, rendering.truth.to_map())
    }

    fn check(pair: &StereoPair, map: &DisparityMap) -> FrameCheck {
        FrameCheck::of(pair, &Rectification::default(), map)
    }

    #[test]
    fn a_right_map_matches_in_noise_too_and_a_wrong_one_does_not() {
        let (mut pair, map) = plane(0);
        assert_eq!(check(&pair, &map).input, Input::Ok, "{:?}", check(&pair, &map));
        let wrong = StereoPair { left: pair.left.clone(), right: plane(1).0.right };
        assert_eq!(check(&wrong, &map).input, Input::Mismatch);
        Degradation { noise: 10.0, ..Degradation::default() }.apply("plane", &mut pair);
        let noisy = check(&pair, &map);
        assert_eq!(noisy.input, Input::Ok, "{noisy:?}");
        assert_eq!((noisy.input_ok, noisy.share_sure), (true, 100.0));
    }

    #[test]
    fn rows_off_are_a_mismatch_until_the_offset_is_told() {
        let (StereoPair { left, right }, map) = plane(2);
        let lower = [vec![90; 3 * 160], right.luma[..57 * 160].to_vec()].concat();
        let pair = StereoPair { left, right: Frame::from_luma(160, 60, lower) };
        assert_eq!(check(&pair, &map).input, Input::Mismatch);
        assert_eq!(FrameCheck::of(&pair, &Rectification::from(Ramp::whole(3)), &map).input, Input::Ok);
    }

    #[test]
    fn noise_and_blank_views_show_nothing_and_equal_ones_are_told() {
        let (pair, map) = plane(3);
        let blank = Frame::from_luma(160, 60, vec![127; 160 * 60]);
        let mut views = StereoPair { left: blank.clone(), right: blank };
        assert_eq!(check(&views, &map).input, Input::NothingSeen);
        for noise in [0.5, 1.4, 3.0, 10.0, 25.0, 60.0] {
            let mut noisy = views.clone();
            Degradation { noise, ..Degradation::default() }.apply("blank", &mut noisy);
            assert_eq!(check(&noisy, &map).input, Input::NothingSeen, "noise {noise}");
        }
        views.left = pair.left.clone();
        views.right = pair.left;
        assert_eq!(check(&views, &map).input, Input::SameView);
    }
}
