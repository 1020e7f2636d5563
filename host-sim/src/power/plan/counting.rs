//! Counts made: every method on scenes scaled to several sizes, on the emulated chip.

use anyhow::{Context, Result};
use haarline::Config;
use image::{GrayImage, imageops};
use rayon::prelude::*;

use super::counts::{Count, Input};
use crate::score::degrade::Degradation;
use crate::score::scene::Scene;
use crate::stereo::method::MethodKind;
use crate::study::Chip;
use crate::{Frame, StereoPair};

/// The methods that the chip has.
pub const METHODS: [MethodKind; 7] = [
    MethodKind::Full,
    MethodKind::Lite,
    MethodKind::WaveletBlock,
    MethodKind::Contour,
    MethodKind::Envelope,
    MethodKind::Block,
    MethodKind::Sgm,
];

/// Widths and disparities that are counted and stored: many widths, for the detail that is left of a scaled scene, and with it
/// what the searches among extrema cost, varies from one to the next.
pub const STORED: [(u16, u16); 28] = [
    (64, 16),
    (64, 32),
    (80, 16),
    (80, 32),
    (96, 16),
    (96, 32),
    (96, 48),
    (128, 32),
    (128, 48),
    (128, 64),
    (160, 32),
    (160, 48),
    (160, 80),
    (192, 32),
    (192, 64),
    (192, 96),
    (224, 48),
    (224, 80),
    (224, 112),
    (256, 48),
    (256, 80),
    (256, 128),
    (288, 48),
    (288, 96),
    (288, 128),
    (320, 48),
    (320, 80),
    (320, 128),
];

/// Others, which what is computed from the stored ones is held against.
pub const CHECKED: [(u16, u16); 11] = [
    (72, 32),
    (88, 32),
    (112, 32),
    (144, 64),
    (176, 48),
    (208, 64),
    (240, 48),
    (240, 112),
    (272, 80),
    (304, 48),
    (304, 128),
];

/// Width of the scenes that are scaled, px.
pub const WIDTH: u16 = 320;
/// Rows of random views for a column.
const RANDOM_ASPECT: f64 = 0.75;
/// Seed of random views and of the noise.
const SEED: u64 = 1;

/// Counts every method on every scene, clean and noisy, and on random views, at these widths and disparities. `done` is
/// told after each count.
///
/// # Errors
/// If the emulated chip fails.
pub fn count(chip: &Chip, scenes: &[Scene], sizes: &[(u16, u16)], done: impl Fn() + Sync) -> Result<Vec<Count>> {
    let mut jobs = Vec::new();
    for method in METHODS {
        for scene in scenes {
            jobs.extend([Input::Clean, Input::Noisy].map(|input| (method, Some(scene), input)));
        }
        jobs.push((method, None, Input::Random));
    }
    let jobs: Vec<_> = jobs
        .into_iter()
        .flat_map(|(method, scene, input)| sizes.iter().map(move |&size| (method, scene, input, size)))
        .collect();
    jobs.into_par_iter()
        .map(|(method, scene, input, (width, disparities))| {
            let name = scene.map_or("random", |scene| &scene.name);
            let pair = seen(scene, input, width.into());
            let config = Config { width, min_disparity: 0, num_disparities: disparities };
            let counted = chip.count_pair(method, &pair, config);
            let counted = counted.with_context(|| format!("{method} on {name}, {width} px wide"))?;
            done();
            Ok(Count {
                method: method.name().to_owned(),
                scene: name.to_owned(),
                input,
                width,
                height: u32::try_from(pair.height())?,
                disparities,
                instructions: hundredths(counted.total),
                packets: hundredths(counted.packets),
            })
        })
        .collect()
}

/// How many counts [`count`] makes.
#[must_use]
pub fn jobs(scenes: usize, sizes: usize) -> usize {
    METHODS.len() * (2 * scenes + 1) * sizes
}

fn hundredths(value: f64) -> f64 {
    (100.0 * value).round() / 100.0
}

/// What the cameras see of the scene at that width; without a scene random views.
fn seen(scene: Option<&Scene>, input: Input, width: usize) -> StereoPair {
    let (name, mut pair) = match scene {
        Some(scene) => (scene.name.as_str(), scaled(&scene.pair, width)),
        None => {
            let height = (RANDOM_ASPECT * width as f64) as usize;
            let blank = Frame::from_luma(width, height, vec![0; width * height]);
            ("random", StereoPair { left: blank.clone(), right: blank })
        }
    };
    let noise = if input == Input::Noisy { Input::NOISE } else { 0.0 };
    Degradation { noise, random: input == Input::Random, seed: SEED, ..Degradation::default() }.apply(name, &mut pair);
    pair
}

/// The pair made narrower, its shape kept: each pixel is the mean of those that it covers.
fn scaled(pair: &StereoPair, width: usize) -> StereoPair {
    let height = (pair.height() * width + pair.width() / 2) / pair.width();
    let view = |frame: &Frame| {
        let grey = GrayImage::from_raw(frame.width as u32, frame.height as u32, frame.luma.clone());
        let grey = grey.expect("a frame has as many pixels as its size says");
        let small = imageops::thumbnail(&grey, width as u32, height as u32);
        Frame::from_luma(width, height, small.into_raw())
    };
    if width == pair.width() { pair.clone() } else { StereoPair { left: view(&pair.left), right: view(&pair.right) } }
}
