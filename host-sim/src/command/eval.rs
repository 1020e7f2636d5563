//! `haarline eval`: a method on scenes with known truth.

use haarline::confidence::SURE;
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Result, bail, ensure};

use super::Finding;
use super::degradation::DegradationOptions;
use super::shared::{Benchmark, JsonOutput, MethodOptions, progress};
use crate::score::evaluation::{self, Evaluator, Evidence, Mean, Source};
use crate::score::report::{Report, Treatment};
use crate::score::scene::Region;
use crate::score::{Figure, MapScore, Score};

/// Arguments of `haarline eval`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    benchmark: Benchmark,
    #[command(flatten)]
    method: MethodOptions,
    #[command(flatten)]
    degradation: DegradationOptions,
    /// Smooths the views as our front end does, by their noise, before the method gets them
    #[arg(long)]
    smooth: bool,
    /// Fills unknown pixels with the farther of the next known ones beside them: guesses, confidence 1
    #[arg(long)]
    fill: bool,
    /// Scores finished maps instead of a method's: <scene>.pfm (px) or <scene>.png (16 bits, disparity x 256), and
    /// <scene>_confidence.png where there is one. What was done to the views is only told
    #[arg(long, value_name = "DIR", conflicts_with_all = ["method", "smooth", "write_views", "right_from"])]
    maps: Option<PathBuf>,
    /// Writes <scene>/left.png and <scene>/right.png of every scene as the method gets them
    #[arg(long, value_name = "DIR")]
    write_views: Option<PathBuf>,
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
        let degradation = self.degradation.get()?;
        let method = self.method.get()?;
        let right = self.degradation.right_from(Some(&self.benchmark.scenes))?;
        let folders = self.benchmark.folders()?;
        let scenes = evaluation::load(&folders)?;
        let baselines = self.benchmark.read_baselines()?;
        self.check_outputs(&folders)?;
        let widest = scenes.iter().map(|scene| scene.pair.width()).max().unwrap_or(0);
        let level = baselines.as_ref().map(|baselines| baselines.level(widest, &degradation));
        let baselines = baselines.as_ref().zip(level.as_ref());
        let regions = [(self.occluded, Region::Occluded), (self.left_band, Region::LeftBand)];
        let apart: Vec<Region> =
            regions.into_iter().filter_map(|(is_asked, region)| is_asked.then_some(region)).collect();
        let build = |config| method.build(config);
        let evaluator = Evaluator {
            source: self.maps.as_deref().map_or(Source::Method(&build), Source::Maps),
            right_from: right.as_ref(),
            degradation,
            smooth: self.smooth,
            fill: self.fill,
            baselines,
            apart: &apart,
            maps: self.output.as_deref(),
            views: self.write_views.as_deref(),
            evidence: Evidence { sure_from: self.sure_from.unwrap_or(SURE), obstacles: self.obstacles },
        };
        let progress = progress(scenes.len(), "scenes")?;
        let scores = evaluator.run(&scenes, || progress.inc(1));
        progress.finish_and_clear();
        let scores = scores?;
        let Some(mean) = Mean::of(scores.iter()) else { bail!("{}: no scene in it", self.benchmark.scenes.display()) };
        let maps = self.maps.as_ref().map(|folder| format!("maps in {}", folder.display()));
        let report = Report {
            method: maps.as_deref().unwrap_or(method.name()),
            folder: &self.benchmark.scenes,
            treatment: Treatment {
                degradation,
                right_from: self.degradation.right_from_name(),
                smooth: self.smooth,
                fill: self.fill,
            },
            baselines,
            scenes: &scores,
            mean: &mean,
            shows_sure: self.sure,
        };
        self.json.deliver(|| Ok(report.json()?), || report.text())?;
        check_limits(&self.fail_over, &mean.score)
    }

    fn check_outputs(&self, folders: &[PathBuf]) -> Result<()> {
        let mut claims = self.benchmark.claims(folders);
        claims.read(self.degradation.right_from_file());
        let maps = self.maps.iter().filter_map(|folder| folder.read_dir().ok()).flatten().filter_map(Result::ok);
        claims.read(maps.map(|map| map.path()));
        self.json.file().map_or(Ok(()), |path| claims.write("--json", path))?;
        let is_map = |name: &str| [".pfm", "_confidence.png", "_picture.png"].iter().any(|end| name.ends_with(end));
        self.output.as_ref().map_or(Ok(()), |folder| claims.write_in("-o", folder, is_map))?;
        for (views, scene) in self.write_views.iter().flat_map(|views| folders.iter().map(move |scene| (views, scene)))
        {
            let folder = views.join(scene.canonicalize()?.file_name().unwrap_or_default());
            claims.write_in("--write-views", &folder, |name| name == "left.png" || name == "right.png")?;
        }
        Ok(())
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
