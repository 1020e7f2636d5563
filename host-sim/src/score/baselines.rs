//! OpenCV's figures on the benchmark scenes, to compare with.
//!
//! The file holds them by method and noise (`bm9/noise10`) under `methods`, for the scenes of 320 px
//! width, and under `native` for scenes at their native size. The two share names, so the width
//! decides: a scene of more than 320 px is looked up under `native`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use serde::Deserialize;

use crate::input::whole_file;
use crate::score::Score;
use crate::score::degrade::Degradation;

/// The figures' methods: key in the file, and name.
pub const METHODS: [(&str, &str); 3] = [("bm9", "StereoBM 9"), ("bm15", "StereoBM 15"), ("sgbm", "StereoSGBM")];

/// Width of the scenes under `methods`, px.
const REDUCED_WIDTH: usize = 320;

/// A baselines file.
#[derive(Debug, Clone, Deserialize)]
pub struct Baselines {
    methods: BTreeMap<String, Run>,
    #[serde(default)]
    native: Option<BTreeMap<String, Run>>,
    /// Where it was read.
    #[serde(skip)]
    pub path: PathBuf,
}

#[derive(Debug, Clone, Deserialize)]
struct Run {
    scenes: BTreeMap<String, Row>,
}

/// One method's figures on one scene, as in [`Score`].
#[derive(Debug, Clone, Copy, Deserialize)]
struct Row {
    density: f64,
    bad1: f64,
    bad2: f64,
    #[serde(default)]
    tot05: Option<f64>,
    tot1: f64,
    tot2: f64,
    #[serde(default)]
    off10: Option<f64>,
    epe: f64,
}

/// Which of the noise levels in the file to compare with.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// The key's second half, such as `noise10`.
    pub key: String,
    /// Whether OpenCV saw frames degraded the same way. If not, these are its figures on clean ones.
    pub is_same: bool,
}

impl Level {
    /// What was seen, in words.
    #[must_use]
    pub fn describe(&self) -> String {
        match self.key.as_str() {
            "noise0" => "clean frames".to_owned(),
            key => key.replace("noise", "noise "),
        }
    }
}

impl Baselines {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// If it cannot be read or is not such a file.
    pub fn read(path: &Path) -> Result<Self> {
        let name = path.display();
        let text = whole_file::text(path)?;
        let mut baselines: Self =
            serde_json::from_str(&text).map_err(|error| anyhow!("{name}: is no baselines file: {error}"))?;
        baselines.path = path.to_owned();
        Ok(baselines)
    }

    /// The file `baselines.json` in the scenes' folder, or in one of the two folders above it.
    #[must_use]
    pub fn find(scenes: &Path) -> Option<PathBuf> {
        let folder = scenes.canonicalize().ok()?;
        folder.ancestors().take(3).map(|folder| folder.join("baselines.json")).find(|path| path.is_file())
    }

    /// The level for scenes of up to `width` px and what was done to them: the same noise if the
    /// file has it and noise is all, else clean.
    #[must_use]
    pub fn level(&self, width: usize, degradation: &Degradation) -> Level {
        let key = format!("noise{}", degradation.noise);
        let runs = self.runs(width);
        let has_key = METHODS.iter().any(|(method, _)| runs.contains_key(&format!("{method}/{key}")));
        if degradation.is_noise_only() && has_key {
            Level { key, is_same: true }
        } else {
            Level { key: "noise0".to_owned(), is_same: false }
        }
    }

    /// The figures of `method` on a scene; `None` where the file has none.
    #[must_use]
    pub fn score(&self, method: &str, level: &Level, scene: &str, width: usize) -> Option<Score> {
        let row = self.runs(width).get(&format!("{method}/{}", level.key))?.scenes.get(scene)?;
        Some(Score {
            density: row.density,
            bad1: Some(row.bad1),
            bad2: Some(row.bad2),
            tot05: row.tot05,
            tot1: row.tot1,
            tot2: row.tot2,
            off10: row.off10,
            epe: Some(row.epe),
            // The most confident answers as many as StereoBM 9 gives: of its own ones all.
            bad2_at_bm_density: (method == METHODS[0].0).then_some(row.bad2),
            auc: None,
        })
    }

    fn runs(&self, width: usize) -> &BTreeMap<String, Run> {
        match &self.native {
            Some(native) if width > REDUCED_WIDTH => native,
            _ => &self.methods,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn baselines() -> Baselines {
        let row = |density: f64| format!(r#"{{"density":{density},"bad1":4,"bad2":3,"tot1":2,"tot2":1,"epe":0.5}}"#);
        let runs = |key: &str, density| format!(r#""{key}":{{"scenes":{{"aloe":{}}},"summary":{{}}}}"#, row(density));
        let methods = format!("{},{}", runs("bm9/noise0", 80.0), runs("bm9/noise2.5", 60.0));
        let text = format!(r#"{{"methods":{{{methods}}},"native":{{{}}}}}"#, runs("bm9/noise0", 70.0));
        serde_json::from_str(&text).unwrap()
    }

    #[test]
    fn level_is_the_noise_or_clean() {
        let level = |width, noise, gain| {
            let level = baselines().level(width, &Degradation { noise, gain, ..Default::default() });
            (level.key, level.is_same)
        };
        assert_eq!(level(320, 0.0, 1.0), ("noise0".to_owned(), true));
        assert_eq!(level(320, 2.5, 1.0), ("noise2.5".to_owned(), true));
        assert_eq!(level(320, 2.5, 0.8), ("noise0".to_owned(), false));
        assert_eq!(level(320, 3.0, 1.0), ("noise0".to_owned(), false));
        assert_eq!(level(640, 2.5, 1.0), ("noise0".to_owned(), false));
    }

    #[test]
    fn width_tells_native_scenes() {
        let clean = Level { key: "noise0".to_owned(), is_same: true };
        let density = |scene, width| baselines().score("bm9", &clean, scene, width).map(|score| score.density);
        assert_eq!(density("aloe", 320), Some(80.0));
        assert_eq!(density("aloe", 450), Some(70.0));
        assert_eq!(density("art", 320), None);
    }
}
