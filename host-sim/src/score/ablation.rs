//! What each part of the method `full` brings: the same scenes without one part each.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result};
use comfy_table::Table;
use haarline::{Config, ConfigError, Full, Parts, Seeds, StereoMethod, blocks_for};
use serde::Serialize;

use crate::score::baselines::Baselines;
use crate::score::degrade::Degradation;
use crate::score::evaluation::{Evaluator, Mean, Source};
use crate::score::evaluations::evaluations;
use crate::score::report::{self, format_figure};
use crate::score::scene::Scene;
use crate::score::{MapScore, Score};
use crate::stereo::method::{MethodKind, on_large_stack};

/// Blocks for the widest rows.
const BLOCKS: usize = blocks_for(Config::MAX_WIDTH);

/// A method, or what is left of one.
#[derive(Debug, Clone, Copy)]
pub struct Variant {
    /// Its name in tables and files.
    pub name: &'static str,
    kind: Kind,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Full(Parts),
    Other(MethodKind),
}

impl Variant {
    /// All of them, the whole method first.
    pub const ALL: [Self; 8] = [
        Self { name: "full", kind: Kind::Full(Parts::ALL) },
        Self { name: "without seeds", kind: Kind::Full(Parts { seeds: Seeds::None, ..Parts::ALL }) },
        Self { name: "without extremum step", kind: Kind::Full(Parts { extremum: false, ..Parts::ALL }) },
        Self { name: "without agreement", kind: Kind::Full(Parts { agreement: false, ..Parts::ALL }) },
        Self { name: "without smoothing", kind: Kind::Full(Parts { smoothing: false, ..Parts::ALL }) },
        Self { name: "without texture test", kind: Kind::Full(Parts { texture: false, ..Parts::ALL }) },
        Self { name: "lite", kind: Kind::Other(MethodKind::Lite) },
        Self { name: "block", kind: Kind::Other(MethodKind::Block) },
    ];

    /// Where hypotheses may come from that no neighbour has, as many a tile each, and none: `full` with each.
    pub const SOURCES: [Self; 4] = [
        Self { name: "contours", kind: Kind::Full(Parts::ALL) },
        Self { name: "random disparities", kind: Kind::Full(Parts { seeds: Seeds::Random(0), ..Parts::ALL }) },
        Self { name: "regular grid", kind: Kind::Full(Parts { seeds: Seeds::Grid, ..Parts::ALL }) },
        Self { name: "neighbours only", kind: Kind::Full(Parts { seeds: Seeds::None, ..Parts::ALL }) },
    ];

    /// The same with another seed, where it draws random disparities; `None` where it draws none.
    fn with_seed(self, seed: u64) -> Option<Self> {
        match self.kind {
            Kind::Full(parts @ Parts { seeds: Seeds::Random(_), .. }) => {
                // Any 32 bits do.
                let seeds = Seeds::Random(seed as u32);
                Some(Self { kind: Kind::Full(Parts { seeds, ..parts }), ..self })
            }
            _ => None,
        }
    }

    /// An instance for rows of up to [`Config::MAX_WIDTH`] px.
    ///
    /// # Errors
    /// If the configuration is refused.
    pub fn build(self, config: Config) -> Result<Box<dyn StereoMethod + Send>, ConfigError> {
        type Built = Result<Box<dyn StereoMethod + Send>, ConfigError>;
        match self.kind {
            Kind::Full(parts) => {
                on_large_stack(|| -> Built { Ok(Box::new(Full::<BLOCKS>::with_parts(config, parts)?)) })
            }
            Kind::Other(method) => method.build(config),
        }
    }
}

/// A variant at one level of noise.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    /// The variant's name.
    pub variant: &'static str,
    /// Standard deviation of the noise, grey levels.
    pub noise: f64,
    /// The mean over the scenes, of all answers.
    pub mean: Score,
    /// The same of the default answers.
    pub default_answers: Score,
    /// Costs worked out for a pixel; `None` where they are not counted.
    pub evaluations: Option<f64>,
    /// Each scene's score.
    pub scenes: BTreeMap<String, Score>,
}

/// A source of hypotheses at one level of noise, with several seeds of the noise and of what is random.
#[derive(Debug, Clone, Serialize)]
pub struct Repeated {
    /// The source.
    pub hypotheses: &'static str,
    /// Standard deviation of the noise, grey levels.
    pub noise: f64,
    /// How many seeds there were; one where none changes anything.
    pub seeds: u64,
    /// The mean over seeds of the mean over scenes.
    pub mean: Score,
    /// The standard deviation over seeds of each figure told with a spread.
    pub deviation: BTreeMap<&'static str, f64>,
}

/// The figures that are told with their spread over seeds.
const SPREAD: [&str; 4] = ["tot05", "tot1", "tot2", "off10"];

impl Repeated {
    fn of(hypotheses: &'static str, noise: f64, runs: &[Score]) -> Result<Self> {
        let mean = Score::mean(runs).context("no seed")?;
        let deviation = |key: &'static str| {
            let off = runs.iter().filter_map(|run| Some(run.figure(key)? - mean.figure(key)?));
            (key, (off.map(|off| off * off).sum::<f64>() / (runs.len().max(2) - 1) as f64).sqrt())
        };
        let deviation = SPREAD.map(deviation).into();
        Ok(Self { hypotheses, noise, seeds: runs.len() as u64, mean, deviation })
    }
}

/// What is to be tried.
pub struct Ablation<'a> {
    /// The scenes, sorted by name.
    pub scenes: &'a [Scene],
    /// OpenCV's figures, of which StereoBM's density is used.
    pub baselines: Option<&'a Baselines>,
    /// Seed of the noise.
    pub seed: u64,
}

impl Ablation<'_> {
    /// Tries a variant on all scenes; `done` is called after each.
    ///
    /// # Errors
    /// The first scene's in their order, if some fail.
    pub fn try_out(&self, variant: Variant, noise: f64, done: impl Fn() + Sync + Send) -> Result<Trial> {
        let degradation = Degradation { noise, seed: self.seed, ..Default::default() };
        let widest = self.scenes.iter().map(|scene| scene.pair.width()).max().unwrap_or(0);
        let level = self.baselines.map(|baselines| baselines.level(widest, &degradation));
        let baselines = self.baselines.zip(level.as_ref());
        let build = |config| variant.build(config);
        let evaluator = Evaluator { degradation, baselines, ..Evaluator::of(Source::Method(&build)) };
        let pixels = self.scenes.iter().map(|scene| scene.pair.left.luma.len()).sum();
        let (scores, evaluations) = evaluations(pixels, || evaluator.run(self.scenes, done))?;
        let scores = scores?;
        let MapScore { all: mean, default_answers, .. } = Mean::of(scores.iter()).context("no scene")?.score;
        let scenes = scores.into_iter().map(|scene| (scene.name, scene.score.all)).collect();
        Ok(Trial { variant: variant.name, noise, mean, default_answers, evaluations, scenes })
    }
}

impl Ablation<'_> {
    /// Tries a source of hypotheses with `seeds` seeds from this one's on; `done` is called after each scene.
    ///
    /// # Errors
    /// The first scene's in their order, if some fail.
    pub fn repeat(&self, source: Variant, noise: f64, seeds: u64, done: &(impl Fn() + Sync)) -> Result<Repeated> {
        let run = |seed| {
            let variant = source.with_seed(seed).unwrap_or(source);
            Ok(Self { seed, ..*self }.try_out(variant, noise, done)?.mean)
        };
        let seeds = if is_drawn(source, noise) { seeds } else { 1 };
        let runs: Vec<Score> = (self.seed..self.seed + seeds).map(run).collect::<Result<_>>()?;
        Repeated::of(source.name, noise, &runs)
    }
}

/// Whether anything is drawn at random, so that another seed gives other figures.
fn is_drawn(source: Variant, noise: f64) -> bool {
    noise > 0.0 || source.with_seed(0).is_some()
}

/// How often all scenes are tried for [`Ablation::repeat`] of all sources.
#[must_use]
pub fn repeats(noise: f64, seeds: u64) -> u64 {
    Variant::SOURCES.iter().map(|&source| if is_drawn(source, noise) { seeds } else { 1 }).sum()
}

/// Heads of the figures of [`Score`] in the table, by their keys.
const FIGURES: [(&str, &str); 9] = [
    ("density", "density"),
    ("bad2", "bad2"),
    ("tot05", "tot05"),
    ("tot1", "tot1"),
    ("tot2", "tot2"),
    ("off10", "off10"),
    ("epe", "epe"),
    ("bad2_at_bm_density", "bad2@BM"),
    ("auc", "auc"),
];

/// The trials as text, a table for each level of noise.
#[must_use]
pub fn text(trials: &[Trial], scenes: usize, folder: &Path, seed: u64) -> String {
    let mut text = report::scenes_of(scenes, folder) + "\n";
    for group in trials.chunk_by(|one, other| one.noise == other.noise) {
        let what = report::describe(&Degradation { noise: group[0].noise, seed, ..Default::default() });
        text += &format!("\n{what}\n{}\n", table(group).trim_fmt());
    }
    text += LEGEND;
    if trials.iter().all(|trial| trial.evaluations.is_none()) {
        text += HOW_TO_COUNT;
    }
    text
}

/// The sources of hypotheses as text, a table for each level of noise.
#[must_use]
pub fn sources_text(repeated: &[Repeated]) -> String {
    let mut text = "\nwhere hypotheses come from that no neighbour has, as many a tile each\n".to_owned();
    for group in repeated.chunk_by(|one, other| one.noise == other.noise) {
        let what = if group[0].noise > 0.0 { format!("noise {}", group[0].noise) } else { "clean frames".to_owned() };
        let heads = ["hypotheses", "seeds"].into_iter().chain(SPREAD);
        let mut table = report::table(heads.collect::<Vec<_>>(), 1);
        for run in group {
            let mut cells = vec![run.hypotheses.to_owned(), run.seeds.to_string()];
            cells.extend(SPREAD.map(|key| {
                let deviation = run.deviation.get(key).copied().unwrap_or(0.0);
                format!("{} +- {deviation:.2}", format_figure(run.mean.figure(key)))
            }));
            table.add_row(cells);
        }
        text += &format!("\n{what}\n{}\n", table.trim_fmt());
    }
    text + "\nmean and standard deviation over the seeds, of the noise and of what is random.\n"
}

fn table(trials: &[Trial]) -> Table {
    let heads = ["variant"].into_iter().chain(FIGURES.map(|(_, head)| head));
    let heads = heads.chain(["tot2 - full's", "evaluations"]);
    let mut table = report::table(heads.collect::<Vec<_>>(), 1);
    for trial in trials {
        let mut cells = vec![trial.variant.to_owned()];
        cells.extend(FIGURES.map(|(key, _)| format_figure(trial.mean.figure(key))));
        let difference = trial.mean.tot2 - trials[0].mean.tot2;
        cells.push(if trial.variant == trials[0].variant { String::new() } else { format!("{difference:+.2}") });
        cells.push(format_figure(trial.evaluations));
        table.add_row(cells);
    }
    table
}

const LEGEND: &str = "
density: answered, % of the scored pixels. bad2: off by more than 2 px, % of the answered. tot05, tot1, tot2: off
by more than 0.5, 1, 2 px or unanswered, % of the scored. off10: off by more than a tenth of the depth or unanswered.
epe: mean error of the answered, px. bad2@BM: bad2 of the most confident answers, as many as StereoBM 9 gives. auc: area under the curve of bad2 over the share of answers kept.
evaluations: costs worked out per pixel, of a disparity of a tile of 8 x 4 px; of block and sgm of a pixel.
without seeds: hypotheses from neighbours only. The texture test makes walls without texture guesses; wherever the
truth is known, that counts as bad in tot1 and tot2.
";

const HOW_TO_COUNT: &str = "
Evaluations are counted by a build with the feature count, which makes every method slower:
  cargo run --release -p haarline-sim --features count -- ablate ...
";

/// The trials as CSV, one a row.
///
/// # Errors
/// Never for finite figures.
pub fn encode_csv(trials: &[Trial]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let heads = ["variant", "noise", "scenes"].into_iter().chain(Score::FIGURES.map(|(key, _)| key));
    writer.write_record(heads.chain(["evaluations_per_pixel"]))?;
    for trial in trials {
        let cell = |value: Option<f64>| value.map(|value| format!("{value:.4}")).unwrap_or_default();
        let mut cells = vec![trial.variant.to_owned(), trial.noise.to_string(), trial.scenes.len().to_string()];
        cells.extend(Score::FIGURES.map(|(_, figure)| cell(figure(&trial.mean))));
        cells.push(cell(trial.evaluations));
        writer.write_record(cells)?;
    }
    writer.into_inner().context("the CSV")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(variant: &'static str, noise: f64, tot2: f64) -> Trial {
        let mean = Score { density: 90.0, bad2: Some(1.5), tot1: 20.0, tot2, ..Score::default() };
        let evaluations = (variant == "full").then_some(2.25);
        Trial {
            variant,
            noise,
            mean,
            default_answers: mean,
            evaluations,
            scenes: BTreeMap::from([("aloe".to_owned(), mean)]),
        }
    }

    fn trials() -> Vec<Trial> {
        vec![trial("full", 0.0, 8.0), trial("block", 0.0, 18.5), trial("full", 10.0, 16.0), trial("block", 10.0, 12.0)]
    }

    #[test]
    fn every_variant_takes_the_largest_configuration() {
        let config = Config { width: Config::MAX_WIDTH, min_disparity: 0, num_disparities: Config::MAX_DISPARITIES };
        for variant in Variant::ALL {
            assert!(variant.build(config).is_ok(), "{}", variant.name);
        }
    }

    #[test]
    fn each_level_of_noise_is_compared_with_its_own_first_row() {
        let text = text(&trials(), 1, Path::new("scenes"), 0);
        assert!(text.contains("clean frames") && text.contains("noise 10 (seed 0)"), "{text}");
        assert!(text.contains("+10.50") && text.contains("-4.00") && text.contains("2.25"), "{text}");
        assert!(!text.contains("--features"), "{text}");
        let uncounted: Vec<Trial> = trials().into_iter().map(|trial| Trial { evaluations: None, ..trial }).collect();
        assert!(super::text(&uncounted, 1, Path::new("scenes"), 0).contains("--features count"));
    }

    #[test]
    fn seeds_give_a_mean_and_a_spread() {
        let run = |tot2: f64| Score { tot1: 20.0, tot2, tot05: Some(2.0 * tot2), off10: Some(9.0), ..Score::default() };
        let repeated = Repeated::of("grid", 0.0, &[run(5.0), run(6.0), run(7.0)]).unwrap();
        assert_eq!((repeated.seeds, repeated.mean.tot2), (3, 6.0));
        assert_eq!(repeated.deviation, [("tot05", 2.0), ("tot1", 0.0), ("tot2", 1.0), ("off10", 0.0)].into());
        assert_eq!(Repeated::of("grid", 0.0, &[run(5.0)]).unwrap().deviation["tot2"], 0.0);
        let text = sources_text(&[repeated]);
        assert!(text.contains("6.00 +- 1.00") && text.contains("clean frames"), "{text}");
    }

    #[test]
    fn only_what_is_drawn_is_repeated() {
        assert_eq!((repeats(0.0, 5), repeats(10.0, 5)), (8, 20));
    }

    #[test]
    fn csv_has_a_row_for_each_trial() {
        let csv = String::from_utf8(encode_csv(&trials()).unwrap()).unwrap();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines.len(), 5);
        assert_eq!(
            lines[0],
            "variant,noise,scenes,density,bad1,bad2,tot05,tot1,tot2,off10,epe,bad2_at_bm_density,auc,\
             evaluations_per_pixel"
        );
        assert_eq!(lines[3], "full,10,1,90.0000,,1.5000,,20.0000,16.0000,,,,,2.2500");
        assert_eq!(lines[4], "block,10,1,90.0000,,1.5000,,20.0000,12.0000,,,,,");
    }
}
