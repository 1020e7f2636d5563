//! Benchmark scenes: a stereo pair with true disparities, in a folder of its own.
//!
//! A scene's folder holds `left.png` and `right.png`; `truth.png`, 16 bits, the disparity of the left
//! view x 256, 0 = unknown; `nonocc.png`, 255 where both cameras see the point; and `meta.json` with
//! `num_disparities`, the search range to use, and `family`, the kind of scene. `rig.toml` may be there, too.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use haarline::{Config, Disparity};
use haarline_rig::Description;
use image::DynamicImage;
use serde::{Deserialize, Serialize};

use crate::input::{image_file, rig_file, whole_file};
use crate::stereo::method::check_config;
use crate::{DisparityMap, StereoPair};

/// The files that a scene consists of.
pub const FILES: [&str; 5] = ["left.png", "right.png", "truth.png", "nonocc.png", "meta.json"];
/// The rig that it was seen by: may be missing.
pub const RIG_FILE: &str = "rig.toml";

/// What `meta.json` tells; more keys may be there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Meta {
    /// How many disparities to search, from 0.
    pub num_disparities: u16,
    /// Which kind of scene it is; scores are also averaged by kind.
    #[serde(default = "Meta::no_family")]
    pub family: String,
    /// Focal length, px, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub focal_px: Option<f64>,
    /// Distance of the cameras, mm, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub baseline_mm: Option<f64>,
}

impl Meta {
    fn no_family() -> String {
        "other".to_owned()
    }
}

/// Which of the pixels with known truth. Each is in one region.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Region {
    /// Seen by both cameras, in column [`Truth::first_column`] or right of it: what is scored as a rule.
    Scored,
    /// Hidden from the right camera, or outside of its view.
    Occluded,
    /// Seen by both cameras, left of column [`Truth::first_column`].
    LeftBand,
}

/// The true disparities of a left view, and where they count.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Truth {
    /// Pixels in a row.
    pub width: usize,
    /// True disparity of each pixel, 1/256 px; 0 = unknown.
    pub disparity_q8: Vec<u16>,
    /// Whether both cameras see the point.
    pub seen_by_both: Vec<bool>,
    /// Pixels left of this column do not count: the search cannot reach all their candidates.
    pub first_column: usize,
}

impl Truth {
    /// The region of the pixel of that index; `None` where the truth is unknown.
    #[must_use]
    pub fn region(&self, index: usize) -> Option<Region> {
        let is_reached = index % self.width >= self.first_column;
        (self.disparity_q8[index] != 0).then_some(match (self.seen_by_both[index], is_reached) {
            (true, true) => Region::Scored,
            (true, false) => Region::LeftBand,
            (false, _) => Region::Occluded,
        })
    }

    /// Whether the pixel of that index is scored.
    #[must_use]
    pub fn is_scored(&self, index: usize) -> bool {
        self.region(index) == Some(Region::Scored)
    }

    /// Indices of the pixels of a region with their true disparities, 1/256 px.
    pub fn pixels(&self, region: Region) -> impl Iterator<Item = (usize, u16)> {
        (0..self.disparity_q8.len())
            .filter(move |&index| self.region(index) == Some(region))
            .map(|index| (index, self.disparity_q8[index]))
    }

    /// Indices of the scored pixels with their true disparities, 1/256 px.
    pub fn scored(&self) -> impl Iterator<Item = (usize, u16)> {
        self.pixels(Region::Scored)
    }

    /// The truth as a map, in the fixed point of an answer, to look at.
    #[must_use]
    pub fn to_map(&self) -> DisparityMap {
        let disparity = |&q8: &u16| match q8 {
            0 => Disparity::UNKNOWN,
            q8 => Disparity::from_bits(((u32::from(q8) + 8) >> 4) as i16),
        };
        let disparity: Vec<Disparity> = self.disparity_q8.iter().map(disparity).collect();
        let confidence = disparity.iter().map(|disparity| if disparity.is_known() { 255 } else { 0 }).collect();
        DisparityMap { width: self.width, height: disparity.len() / self.width, disparity, confidence }
    }

    /// Whether `map` has this truth's size.
    #[must_use]
    pub fn fits(&self, map: &DisparityMap) -> bool {
        (self.width, self.disparity_q8.len()) == (map.width, map.disparity.len())
    }
}

/// A scene, loaded and checked.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The folder's name.
    pub name: String,
    /// Both views.
    pub pair: StereoPair,
    /// What would be right.
    pub truth: Truth,
    /// What else is known.
    pub meta: Meta,
    /// The rig it was seen by, if that is known.
    pub rig: Option<Description>,
}

impl Scene {
    /// Reads the scene in `folder`.
    ///
    /// # Errors
    /// If a file is missing or damaged, sizes differ or nothing could be scored.
    pub fn read(folder: &Path) -> Result<Self> {
        for file in FILES {
            let path = folder.join(file);
            ensure!(path.is_file(), "{}: missing; a scene consists of {}", path.display(), FILES.join(", "));
        }
        let name = folder.canonicalize()?.file_name().map(|name| name.to_string_lossy().into_owned());
        let meta = read_meta(&folder.join("meta.json"))?;
        let pair = StereoPair::read(&folder.join("left.png"), &folder.join("right.png"))?;
        let rig_path = folder.join(RIG_FILE);
        let rig = rig_path.is_file().then(|| rig_file::read(&rig_path)).transpose()?;
        if let Some(rig) = &rig {
            rig_file::check_size(rig, [pair.width(), pair.height()]).with_context(|| rig_path.display().to_string())?;
        }
        let scene = Self { name: name.unwrap_or_default(), truth: read_truth(folder, &pair, &meta)?, pair, meta, rig };
        check_config(&scene.config(), "num_disparities")
            .with_context(|| folder.join("meta.json").display().to_string())?;
        ensure!(
            scene.truth.scored().next().is_some(),
            "{}: no pixel has a true disparity, is seen by both cameras and lies right of column {}",
            folder.join("truth.png").display(),
            scene.truth.first_column
        );
        Ok(scene)
    }

    /// How a method is to be configured for this scene.
    #[must_use]
    pub fn config(&self) -> Config {
        let width = self.pair.width() as u16;
        Config { width, min_disparity: 0, num_disparities: self.meta.num_disparities }
    }
}

/// The scene folders in `folder`, sorted by name; `folder` itself if it is one.
///
/// # Errors
/// If the folder cannot be read or holds no scene.
pub fn find_scenes(folder: &Path) -> Result<Vec<PathBuf>> {
    let name = folder.display();
    ensure!(folder.exists(), "{name}: no such folder, where one with scene folders is expected");
    ensure!(folder.is_dir(), "{name}: is a file, where a folder with scene folders is expected");
    if is_scene(folder) {
        return Ok(vec![folder.to_owned()]);
    }
    let entries = fs::read_dir(folder).map_err(|error| anyhow!("{name}: cannot be read: {error}"))?;
    let mut scenes = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| anyhow!("{name}: cannot be read: {error}"))?.path();
        if path.is_dir() && is_scene(&path) {
            scenes.push(path);
        }
    }
    ensure!(!scenes.is_empty(), "{name}: no scene in it; a scene is a folder with {}", FILES.join(", "));
    scenes.sort();
    Ok(scenes)
}

/// Whether a folder is meant as a scene: it has one of its images. What else is missing, reading tells.
fn is_scene(folder: &Path) -> bool {
    FILES[..3].iter().any(|file| folder.join(file).is_file())
}

/// Reads a scene's `meta.json`.
pub(crate) fn read_meta(path: &Path) -> Result<Meta> {
    let text = whole_file::text(path)?;
    serde_json::from_str(&text)
        .map_err(|error| anyhow!("{}: needs \"num_disparities\", a whole number: {error}", path.display()))
}

fn read_truth(folder: &Path, pair: &StereoPair, meta: &Meta) -> Result<Truth> {
    let (truth_path, mask_path) = (folder.join("truth.png"), folder.join("nonocc.png"));
    let DynamicImage::ImageLuma16(truth) = image_file::read(&truth_path)? else {
        return Err(anyhow!("{}: must be a grey image of 16 bits: disparity x 256, 0 = unknown", truth_path.display()));
    };
    let DynamicImage::ImageLuma8(mask) = image_file::read(&mask_path)? else {
        return Err(anyhow!("{}: must be a grey image of 8 bits: 255 = seen by both cameras", mask_path.display()));
    };
    let size = (pair.width() as u32, pair.height() as u32);
    for (path, found) in [(&truth_path, truth.dimensions()), (&mask_path, mask.dimensions())] {
        ensure!(
            found == size,
            "{}: is {}x{} px, but the views are {}x{} px: all must have the same size",
            path.display(),
            found.0,
            found.1,
            size.0,
            size.1
        );
    }
    Ok(Truth {
        width: pair.width(),
        disparity_q8: truth.into_raw(),
        seen_by_both: mask.into_raw().into_iter().map(|value| value == 255).collect(),
        first_column: usize::from(meta.num_disparities),
    })
}
