//! `haarline scene`: families of rendered scenes with exact truth.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use rayon::prelude::*;

use super::{natural_number, number, print};
use crate::output;
use crate::score::scene::{Meta, RIG_FILE};
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
    /// Only these scenes of the family
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    only: Vec<String>,
    /// Sensor noise, standard deviation in grey levels
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0, allow_hyphen_values = true, value_parser = number)]
    noise: f64,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let Self { family, output, seed, only, noise } = self;
        ensure!((0.0..=255.0).contains(&noise), "--noise {noise}: must be 0 to 255");
        let cases = choose(family.cases(seed), &only)?;
        output::prepare_folder("-o", &output)?;
        cases.par_iter().try_for_each(|case| write(case, family, noise, &output.join(&case.name)))?;
        let (count, folder) = (cases.len(), output.display());
        print(&format!("in {folder}: {count} scenes; haarline eval {folder} scores a method on them\n"))
    }
}

/// The cases named, or all.
fn choose(cases: Vec<Case>, only: &[String]) -> Result<Vec<Case>> {
    let names: Vec<&str> = cases.iter().map(|case| case.name.as_str()).collect();
    for wanted in only {
        ensure!(names.contains(&wanted.as_str()), "--only: there is no scene {wanted:?}, but {}", names.join(", "));
    }
    Ok(cases.into_iter().filter(|case| only.is_empty() || only.contains(&case.name)).collect())
}

fn write(case: &Case, family: Family, noise: f64, folder: &Path) -> Result<()> {
    let scene = Scene { noise, ..case.scene.clone() };
    let rendering = scene.render();
    let (num_disparities, family) = (scene.num_disparities, family.name().to_owned());
    let meta = Meta { num_disparities, family, focal_px: None, baseline_mm: None };
    output::prepare_folder("-o", folder)?;
    for (name, _, bytes) in folder::files(&scene, &rendering.pair, &case.truth(&rendering), &meta)? {
        output::write(&folder.join(name), &bytes)?;
    }
    if case.has_rig {
        output::write(&folder.join(RIG_FILE), haarline_rig::template().as_bytes())?;
    }
    Ok(())
}
