//! `haarline scene`: families of rendered scenes with exact truth.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use rayon::prelude::*;

use super::{natural_number, number, print};
use crate::output;
use crate::score::scene::Meta;
use crate::synthetic::cases::{Case, Family};
use crate::synthetic::{Scene, folder};

/// Arguments of `haarline scene`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Which family of scenes
    #[arg(value_enum, value_name = "FAMILY")]
    family: Family,
    /// Where they go: a folder each, with left.png, right.png, truth.png, nonocc.png and meta.json, as haarline
    /// eval reads them
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
    /// Seed of everything that is drawn: another one gives other scenes of the same kind
    #[arg(long, value_name = "S", default_value_t = 0, allow_hyphen_values = true, value_parser = natural_number)]
    seed: u64,
    /// Sensor noise, standard deviation in grey levels
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0, allow_hyphen_values = true, value_parser = number)]
    noise: f64,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let Self { family, output, seed, noise } = self;
        ensure!((0.0..=255.0).contains(&noise), "--noise {noise}: must be 0 to 255");
        output::prepare_folder("-o", &output)?;
        let cases = family.cases(seed);
        cases.par_iter().try_for_each(|Case { name, scene }| {
            let scene = Scene { noise, ..scene.clone() };
            let rendering = scene.render();
            let (num_disparities, family) = (scene.num_disparities, family.name().to_owned());
            let meta = Meta { num_disparities, family, focal_px: None, baseline_mm: None };
            let folder = output.join(name);
            output::prepare_folder("-o", &folder)?;
            let files = folder::files(&scene, &rendering.pair, &rendering.truth, &meta)?;
            files.iter().try_for_each(|(name, _, bytes)| output::write(&folder.join(name), bytes))
        })?;
        let (count, folder) = (cases.len(), output.display());
        print(&format!("in {folder}: {count} scenes; haarline eval {folder} scores a method on them\n"))
    }
}
