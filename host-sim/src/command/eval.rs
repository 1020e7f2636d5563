//! `haarline eval`: a method on scenes with known truth.

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Result, bail, ensure};

use super::shared::{Benchmark, JsonOutput, MethodOptions, progress};
use super::{Finding, natural_number, number};
use crate::output;
use crate::score::baselines::{Baselines, Level};
use crate::score::degrade::Degradation;
use crate::score::evaluation::{self, Evaluator, Evidence, Mean, SceneScore};
use crate::score::report::Report;
use crate::score::scene::{Region, Scene};
use crate::score::sure::SURE;
use crate::score::{Figure, MapScore, Score};
use crate::stereo::method::Method;

/// Arguments of `haarline eval`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    benchmark: Benchmark,
    #[command(flatten)]
    method: MethodOptions,
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
    /// Seed of the noise
    #[arg(long, value_name = "S", default_value_t = 0, allow_hyphen_values = true, value_parser = natural_number)]
    seed: u64,
    /// Scores what is hidden from the right camera, too, apart
    #[arg(long)]
    occluded: bool,
    /// Scores the columns left of the number of disparities, too, apart
    #[arg(long)]
    left_band: bool,
    /// Shows what the sure answers are worth: their share, how many of them are wrong or too near, the worst scene
    #[arg(long)]
    sure: bool,
    /// From this confidence on an answer is sure, 1 to 255 [default: 64]
    #[arg(long, value_name = "C", value_parser = clap::value_parser!(u8).range(1..))]
    sure_from: Option<u8>,
    /// Looks for obstacles in the map and in the truth: how many are found, missed, told too far, and phantoms;
    /// with the scene's rig.toml if it has one, else everything is in the way
    #[arg(long)]
    obstacles: bool,
    #[command(flatten)]
    json: JsonOutput,
    /// Writes <scene>.pfm, <scene>_confidence.png and <scene>_picture.png of every scene
    #[arg(short, long = "output", value_name = "DIR")]
    output: Option<PathBuf>,
    /// Ends with exit status 1 if the mean of a figure is over a limit, as in tot2=9.5, or default_tot2=9.5 for
    /// the default answers; any number of times
    #[arg(long, value_name = "KEY=VALUE")]
    fail_over: Vec<Limit>,
}

/// What the keys of figures of the default answers begin with.
const OF_DEFAULT: &str = "default_";

/// A figure of the mean, and what it may be at most.
#[derive(Debug, Clone)]
struct Limit {
    key: String,
    figure: Figure,
    of_default: bool,
    most: f64,
}

impl FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (key, value) = text.split_once('=').ok_or("must be KEY=VALUE, as in tot2=9.5")?;
        let keys = || Score::FIGURES.map(|(key, _)| key).join(", ");
        let (name, of_default) = key.strip_prefix(OF_DEFAULT).map_or((key, false), |name| (name, true));
        let figure = Score::FIGURES.into_iter().find(|figure| figure.0 == name);
        let figure = figure.ok_or_else(|| format!("there is no figure {key:?}, but {}", keys()))?;
        match value.parse() {
            Ok(most) if f64::is_finite(most) => Ok(Self { key: key.to_owned(), figure, of_default, most }),
            _ => Err(format!("the limit {value:?} is no number")),
        }
    }
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let (method, degradation) = (self.method.get()?, self.degradation()?);
        let folders = self.benchmark.folders()?;
        let scenes = evaluation::load(&folders)?;
        let baselines = self.benchmark.read_baselines()?;
        self.check_outputs()?;
        let widest = scenes.iter().map(|scene| scene.pair.width()).max().unwrap_or(0);
        let level = baselines.as_ref().map(|baselines| baselines.level(widest, &degradation));
        let baselines = baselines.as_ref().zip(level.as_ref());
        let scores = self.evaluate(method, &scenes, degradation, baselines)?;
        let Some(mean) = Mean::of(scores.iter()) else { bail!("{}: no scene in it", self.benchmark.scenes.display()) };
        let report = Report {
            method: method.name(),
            folder: &self.benchmark.scenes,
            degradation,
            baselines,
            scenes: &scores,
            mean: &mean,
            shows_sure: self.sure,
        };
        self.json.deliver(|| Ok(report.json()?), || report.text())?;
        check_limits(&self.fail_over, &mean.score)
    }

    fn degradation(&self) -> Result<Degradation> {
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
        let offset = self.offset;
        ensure!((-255.0..=255.0).contains(&offset), "--offset {offset}: must be -255 to 255 grey levels");
        let Self { noise, shot_noise, pattern_noise, gain, offset, both_gain, seed, .. } = *self;
        Ok(Degradation { noise, shot_noise, pattern_noise, gain, offset, both_gain, seed })
    }

    fn check_outputs(&self) -> Result<()> {
        if let Some(path) = self.json.file() {
            output::check_writable("--json", path)?;
        }
        match &self.output {
            Some(folder) => output::prepare_folder("-o", folder),
            None => Ok(()),
        }
    }

    fn evaluate(
        &self,
        method: Method,
        scenes: &[Scene],
        degradation: Degradation,
        baselines: Option<(&Baselines, &Level)>,
    ) -> Result<Vec<SceneScore>> {
        let build = |config| method.build(config);
        let regions = [(self.occluded, Region::Occluded), (self.left_band, Region::LeftBand)];
        let apart: Vec<Region> =
            regions.into_iter().filter_map(|(is_asked, region)| is_asked.then_some(region)).collect();
        let evidence = Evidence { sure_from: self.sure_from.unwrap_or(SURE), obstacles: self.obstacles };
        let maps = self.output.as_deref();
        let evaluator = Evaluator { build: &build, degradation, baselines, apart: &apart, maps, evidence };
        let progress = progress(scenes.len(), "scenes")?;
        let scores = evaluator.run(scenes, || progress.inc(1));
        progress.finish_and_clear();
        scores
    }
}

/// Refuses a mean with a figure over its limit, or without a figure that is limited.
fn check_limits(limits: &[Limit], mean: &MapScore) -> Result<()> {
    let mut over = Vec::new();
    for Limit { key, figure: (_, figure), of_default, most } in limits {
        match figure(if *of_default { &mean.default_answers } else { &mean.all }) {
            Some(value) if value <= *most => {}
            Some(value) => over.push(format!("{key} is {value:.3}, over the limit of {most}")),
            None => over.push(format!("{key} is undefined, where at most {most} is asked for")),
        }
    }
    ensure!(over.is_empty(), Finding(format!("--fail-over: in the mean {}", over.join(", "))));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::confidence_classes::ConfidenceClasses;

    fn score(tot2: f64) -> MapScore {
        let all = Score { tot1: 100.0, tot2, ..Score::default() };
        let default_answers = Score { tot2: tot2 + 1.0, ..all };
        MapScore { all, default_answers, confidence_classes: ConfidenceClasses::mean(&[]) }
    }

    #[test]
    fn a_limit_is_kept_up_to_the_limit_itself() {
        let limits = |text: &str| vec![text.parse::<Limit>().unwrap()];
        for text in ["tot2=9.5", "default_tot2=10.5"] {
            assert!(check_limits(&limits(text), &score(9.5)).is_ok());
            let error = check_limits(&limits(text), &score(9.501)).unwrap_err();
            assert!(error.is::<Finding>() && error.to_string().contains(text.split('=').next().unwrap()), "{error}");
        }
        assert!(check_limits(&limits("bad2=9.5"), &score(1.0)).is_err(), "undefined is no pass");
    }

    #[test]
    fn a_limit_needs_a_known_key_and_a_number() {
        for text in ["tot2", "tot3=1", "tot2=", "tot2=x", "tot2=NaN", "=1", "default_=1", "default_tot3=1"] {
            assert!(text.parse::<Limit>().is_err(), "{text}");
        }
    }
}
