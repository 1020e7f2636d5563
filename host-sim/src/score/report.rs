//! Scores as tables to read and as JSON to compute with.

use std::collections::BTreeMap;
use std::path::Path;

use comfy_table::{CellAlignment, ContentArrangement, Row, Table};
use serde::Serialize;

use crate::score::Score;
use crate::score::baselines::{Baselines, Level, METHODS};
use crate::score::degrade::Degradation;
use crate::score::evaluation::{Mean, SceneScore};

/// Everything that an evaluation found.
#[derive(Debug)]
pub struct Report<'a> {
    /// The method's name.
    pub method: &'a str,
    /// Where the scenes are.
    pub folder: &'a Path,
    /// What was done to the frames.
    pub degradation: Degradation,
    /// OpenCV's figures, and which of them.
    pub baselines: Option<(&'a Baselines, &'a Level)>,
    /// The scenes, sorted by name.
    pub scenes: &'a [SceneScore],
    /// Their mean.
    pub mean: &'a Mean,
}

/// Heads of [`Score::FIGURES`] in a table.
const HEADS: [&str; 8] = ["density", "bad1", "bad2", "tot1", "tot2", "epe", "bad2@BM", "auc"];

/// What stands beside a scene's own figures: OpenCV's method, the head, and the figure.
const BESIDE: [(usize, &str, usize); 6] = [
    (0, "BM density", 0),
    (0, "BM bad2", 2),
    (0, "BM tot2", 4),
    (2, "SGBM density", 0),
    (2, "SGBM bad2", 2),
    (2, "SGBM tot2", 4),
];

impl Report<'_> {
    /// As text: a line on what was done, the scenes, the families, the mean.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "{} on {}, {}\n{}\n\n{}\n",
            self.method,
            scenes_of(self.scenes.len(), self.folder),
            describe(&self.degradation),
            self.describe_baselines(),
            self.scene_table()
        );
        for (family, mean) in Mean::by_family(self.scenes) {
            text += &format!("\nfamily {family}, {}\n{}\n", count(mean.scenes), mean_table(self.method, &mean));
        }
        text += &format!("\nmean over {}\n{}\n", count(self.mean.scenes), mean_table(self.method, self.mean));
        text + LEGEND
    }

    fn describe_baselines(&self) -> String {
        let Some((baselines, level)) = self.baselines else {
            return "OpenCV's figures: none found beside or above the scenes (--baselines FILE names them)".to_owned();
        };
        let (what, file) = (level.describe(), baselines.path.display());
        if level.is_same {
            format!("OpenCV's figures: on {what}, from {file}")
        } else {
            format!(
                "OpenCV's figures: on {what}, NOT as degraded here (the file has none for that), from {file}\n\
                 (bad2@BM is taken at StereoBM's density on {what}, too)"
            )
        }
    }

    fn scene_table(&self) -> String {
        let has_references = self.scenes.iter().any(|scene| scene.references.iter().any(Option::is_some));
        let beside = if has_references { &BESIDE[..] } else { &[] };
        let heads = ["scene", "family"].into_iter().chain(HEADS).chain(beside.iter().map(|(_, head, _)| *head));
        let mut table = table(heads.collect::<Vec<_>>(), 2);
        for scene in self.scenes {
            let mut cells = vec![scene.name.clone(), scene.family.clone()];
            cells.extend(figures(&scene.score));
            cells.extend(beside.iter().map(|&(method, _, figure)| {
                let value = scene.references[method].as_ref().and_then(Score::FIGURES[figure].1);
                format_figure(value)
            }));
            table.add_row(cells);
        }
        table.trim_fmt()
    }

    /// As JSON, indented.
    ///
    /// # Errors
    /// Never for finite figures.
    pub fn json(&self) -> serde_json::Result<String> {
        let scene =
            |scene: &SceneScore| (scene.name.clone(), SceneJson { score: scene.score, family: scene.family.clone() });
        let json = ReportJson {
            method: self.method,
            noise: self.degradation.noise,
            shot_noise: self.degradation.shot_noise,
            pattern_noise: self.degradation.pattern_noise,
            gain: self.degradation.gain,
            offset: self.degradation.offset,
            both_gain: self.degradation.both_gain,
            seed: self.degradation.seed,
            mean: self.mean.score,
            families: Mean::by_family(self.scenes).into_iter().map(|(family, mean)| (family, mean.score)).collect(),
            scenes: self.scenes.iter().map(scene).collect(),
            baselines: self.baselines.map(|baselines| self.baselines_json(baselines)),
        };
        serde_json::to_string_pretty(&json).map(|text| text + "\n")
    }

    fn baselines_json(&self, (baselines, level): (&Baselines, &Level)) -> BaselinesJson {
        let families = Mean::by_family(self.scenes);
        let method = |(index, (key, _)): (usize, &(&'static str, &str))| {
            let (mean, scenes_compared) = self.mean.references[index]?;
            let family = |(name, mean): (&&str, &Mean)| Some(((*name).to_owned(), mean.references[index]?.0));
            let scene = |scene: &SceneScore| Some((scene.name.clone(), scene.references[index]?));
            let (families, scenes) = (families.iter().filter_map(family), self.scenes.iter().filter_map(scene));
            let method = MethodJson { scenes_compared, mean, families: families.collect(), scenes: scenes.collect() };
            Some((*key, method))
        };
        BaselinesJson {
            file: baselines.path.display().to_string(),
            level: level.key.clone(),
            same_degradation: level.is_same,
            methods: METHODS.iter().enumerate().filter_map(method).collect(),
        }
    }
}

#[derive(Serialize)]
struct ReportJson<'a> {
    method: &'a str,
    noise: f64,
    shot_noise: f64,
    pattern_noise: f64,
    gain: f64,
    offset: f64,
    both_gain: f64,
    seed: u64,
    mean: Score,
    families: BTreeMap<&'a str, Score>,
    scenes: BTreeMap<String, SceneJson>,
    baselines: Option<BaselinesJson>,
}

#[derive(Serialize)]
struct SceneJson {
    #[serde(flatten)]
    score: Score,
    family: String,
}

#[derive(Serialize)]
struct BaselinesJson {
    file: String,
    level: String,
    same_degradation: bool,
    methods: BTreeMap<&'static str, MethodJson>,
}

#[derive(Serialize)]
struct MethodJson {
    scenes_compared: usize,
    mean: Score,
    families: BTreeMap<String, Score>,
    scenes: BTreeMap<String, Score>,
}

const LEGEND: &str = "
density: answered, % of the scored pixels. bad1, bad2: off by more than 1, 2 px, % of the answered.
tot1, tot2: the same with unanswered as bad, % of the scored. epe: mean error of the answered, px.
bad2@BM: bad2 of the most confident answers, as many as StereoBM 9 gives. auc: area under the curve of
bad2 over the share of answers kept, most confident first. But for density, less is better.
";

/// A method's means, with OpenCV's below.
#[must_use]
pub fn mean_table(method: &str, mean: &Mean) -> String {
    let mut table = table(["method"].into_iter().chain(HEADS).collect::<Vec<_>>(), 1);
    let mut add = |name: String, score: &Score| {
        let mut cells = vec![name];
        cells.extend(figures(score));
        table.add_row(cells);
    };
    add(method.to_owned(), &mean.score);
    for ((_, name), reference) in METHODS.iter().zip(&mean.references) {
        if let Some((score, scenes)) = reference {
            let part = if *scenes < mean.scenes { format!(" ({})", count(*scenes)) } else { String::new() };
            add(format!("{name}{part}"), score);
        }
    }
    table.trim_fmt()
}

/// What was done to the frames, in words.
#[must_use]
pub fn describe(degradation: &Degradation) -> String {
    let Degradation { noise, shot_noise, pattern_noise, gain, offset, both_gain, seed } = *degradation;
    let mut words = Vec::new();
    if (gain, offset) != (1.0, 0.0) {
        let shift = match offset {
            0.0 => String::new(),
            offset if offset < 0.0 => format!(" - {}", -offset),
            offset => format!(" + {offset}"),
        };
        words.push(format!("right view x {gain}{shift}"));
    }
    if both_gain != 1.0 {
        words.push(format!("both views x {both_gain}"));
    }
    for (kind, sigma) in [("noise", noise), ("shot noise", shot_noise), ("pattern noise", pattern_noise)] {
        if sigma > 0.0 {
            words.push(format!("{kind} {sigma} (seed {seed})"));
        }
    }
    if words.is_empty() { "clean frames".to_owned() } else { words.join(", ") }
}

fn figures(score: &Score) -> impl Iterator<Item = String> {
    Score::FIGURES.map(|(_, figure)| format_figure(figure(score))).into_iter()
}

pub(crate) fn format_figure(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"))
}

fn count(scenes: usize) -> String {
    if scenes == 1 { "1 scene".to_owned() } else { format!("{scenes} scenes") }
}

pub(crate) fn scenes_of(scenes: usize, folder: &Path) -> String {
    format!("{} of {}", count(scenes), folder.display())
}

/// A table without lines: `left` columns of words, the others of numbers.
pub(crate) fn table(heads: impl Into<Row>, left: usize) -> Table {
    let mut table = Table::new();
    table.load_style(comfy_table::presets::NOTHING).set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(heads);
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        column.set_cell_alignment(if index < left { CellAlignment::Left } else { CellAlignment::Right });
    }
    table
}
