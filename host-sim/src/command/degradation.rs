//! How a command makes its views worse on purpose.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};

use super::{natural_number, number, whole_number};
use crate::Frame;
use crate::score::degrade::{Degradation, Misalignment};

/// What is done to both views before they are matched.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Views made worse on purpose")]
pub(super) struct DegradationOptions {
    /// Adds Gaussian noise to both views: standard deviation, grey levels
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0, allow_hyphen_values = true, value_parser = number)]
    noise: f64,
    /// Adds shot noise to both views: standard deviation at one grey level, grows with the root of the light
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0, allow_hyphen_values = true, value_parser = number)]
    shot_noise: f64,
    /// Adds a fixed pattern to both views: standard deviation from column to column, grey levels
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0, allow_hyphen_values = true, value_parser = number)]
    pattern_noise: f64,
    /// Multiplies the right view
    #[arg(long, value_name = "G", default_value_t = 1.0, allow_hyphen_values = true, value_parser = number)]
    gain: f64,
    /// Adds grey levels to the right view, after the gain
    #[arg(long, value_name = "O", default_value_t = 0.0, allow_hyphen_values = true, value_parser = number)]
    offset: f64,
    /// Multiplies both views, after gain and offset and before the noise: less light
    #[arg(long, value_name = "G", default_value_t = 1.0, allow_hyphen_values = true, value_parser = number)]
    both_gain: f64,
    /// Moves the right view so many rows down, -64 to 64, fractions too
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_hyphen_values = true, value_parser = number)]
    row_offset: f64,
    /// Turns the right view about its centre, degrees clockwise, -45 to 45
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_hyphen_values = true, value_parser = number)]
    roll: f64,
    /// Stretches the right view's rows about its centre, 0.5 to 2
    #[arg(long, value_name = "S", default_value_t = 1.0, allow_hyphen_values = true, value_parser = number)]
    row_scale: f64,
    /// Exchanges the views
    #[arg(long)]
    swap: bool,
    /// Takes the right view of another scene: its folder (in eval its name is enough) or an image
    #[arg(long, value_name = "SCENE")]
    right_from: Option<PathBuf>,
    /// Keeps so many bits of each grey level, 1 to 8
    #[arg(long, value_name = "N", default_value_t = 8, allow_hyphen_values = true, value_parser = whole_number)]
    bits: i64,
    /// Random bytes instead of both views
    #[arg(long)]
    random: bool,
    /// Seed of the noise and of random views
    #[arg(long, value_name = "S", default_value_t = 0, allow_hyphen_values = true, value_parser = natural_number)]
    seed: u64,
}

impl DegradationOptions {
    /// What is to be done, checked.
    pub(super) fn get(&self) -> Result<Degradation> {
        let limited = [
            ("--noise", self.noise),
            ("--shot-noise", self.shot_noise),
            ("--pattern-noise", self.pattern_noise),
            ("--gain", self.gain),
            ("--both-gain", self.both_gain),
        ];
        for (option, value) in limited {
            ensure!((0.0..=255.0).contains(&value), "{option} {value}: must be 0 to 255");
        }
        let Self { noise, shot_noise, pattern_noise, gain, offset, both_gain, swap, random, seed, .. } = *self;
        ensure!((-255.0..=255.0).contains(&offset), "--offset {offset}: must be -255 to 255 grey levels");
        let Self { row_offset, roll, row_scale, bits, .. } = *self;
        ensure!((-64.0..=64.0).contains(&row_offset), "--row-offset {row_offset}: must be -64 to 64 rows");
        ensure!((-45.0..=45.0).contains(&roll), "--roll {roll}: must be -45 to 45 degrees");
        ensure!((0.5..=2.0).contains(&row_scale), "--row-scale {row_scale}: must be 0.5 to 2");
        ensure!((1..=8).contains(&bits), "--bits {bits}: must be 1 to 8");
        ensure!(
            self.right_from.is_none() || !random,
            "--right-from and --random both tell what the right view is: give one of them"
        );
        let misalignment = Misalignment { row_offset, roll, row_scale };
        let bits = bits as u8;
        let photometric =
            Degradation { noise, shot_noise, pattern_noise, gain, offset, both_gain, ..Degradation::NONE };
        Ok(Degradation { misalignment, bits, swap, random, seed, ..photometric })
    }

    /// The view that takes the place of the right one, if one is asked for; a name is one of the scenes in `scenes`.
    pub(super) fn right_from(&self, scenes: Option<&Path>) -> Result<Option<Frame>> {
        let Some(path) = &self.right_from else { return Ok(None) };
        let named = scenes.map(|scenes| scenes.join(path)).filter(|folder| folder.is_dir());
        let path = named.as_ref().unwrap_or(path);
        ensure!(path.exists(), "--right-from {}: there is no such scene", path.display());
        let view = if path.is_dir() { path.join("right.png") } else { path.clone() };
        Frame::read_of_any_size(&view).map(Some)
    }

    /// What stands for the other scene in a report.
    pub(super) fn right_from_name(&self) -> Option<String> {
        self.right_from.as_ref().map(|path| path.display().to_string())
    }
}
