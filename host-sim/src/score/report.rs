//! Scores as tables to read and as JSON to compute with.

use std::collections::BTreeMap;
use std::path::Path;

use comfy_table::{CellAlignment, ContentArrangement, Row, Table};
use serde::Serialize;

use crate::score::baselines::{Baselines, Level, METHODS};
use crate::score::degrade::{Degradation, Misalignment};
use crate::score::evaluation::{Mean, SceneScore};
use crate::score::evidence::{self, SureJson};
use crate::score::obstacle_score::ObstacleScore;
use crate::score::scene::Region;
use crate::score::sure::SureScore;
use crate::score::{LEAST_DEFAULT_CONFIDENCE, MapScore, Score};
use crate::stereo::frame_check::FrameCheck;

/// Everything that an evaluation found.
#[derive(Debug)]
pub struct Report<'a> {
    /// The method's name.
    pub method: &'a str,
    /// Where the scenes are.
    pub folder: &'a Path,
    /// What was done to the frames and to the maps.
    pub treatment: Treatment,
    /// OpenCV's figures, and which of them.
    pub baselines: Option<(&'a Baselines, &'a Level)>,
    /// The scenes, sorted by name.
    pub scenes: &'a [SceneScore],
    /// Their mean.
    pub mean: &'a Mean,
    /// Whether the text tells what the sure answers are worth; the JSON always does.
    pub shows_sure: bool,
}

/// What was done to the frames before the method got them, and to its maps.
#[derive(Debug, Clone, Serialize)]
pub struct Treatment {
    /// How the frames were made worse.
    #[serde(flatten)]
    pub degradation: Degradation,
    /// Whose right view took the place of each scene's own.
    pub right_from: Option<String>,
    /// Whether the frames were smoothed as by our front end.
    pub smooth: bool,
    /// Whether holes were filled.
    pub fill: bool,
}

impl Treatment {
    /// In words.
    fn describe(&self) -> String {
        let mut words = vec![describe(&self.degradation)];
        words.extend(self.right_from.as_ref().map(|other| format!("right views of {other}")));
        words.extend(self.smooth.then(|| "smoothed".to_owned()));
        words.extend(self.fill.then(|| "holes filled".to_owned()));
        words.join(", ")
    }
}

/// Heads of [`Score::FIGURES`] in a table.
const HEADS: [&str; 10] = ["density", "bad1", "bad2", "tot05", "tot1", "tot2", "off10", "epe", "bad2@BM", "auc"];

/// What stands beside a scene's own figures, of its default answers: the head, and the figure's key.
const OF_DEFAULT: [(&str, &str); 3] =
    [("default density", "density"), ("default bad2", "bad2"), ("default tot2", "tot2")];

/// What stands beside these: OpenCV's method, the head, and the figure's key.
const BESIDE: [(usize, &str, &str); 6] = [
    (0, "BM density", "density"),
    (0, "BM bad2", "bad2"),
    (0, "BM tot2", "tot2"),
    (2, "SGBM density", "density"),
    (2, "SGBM bad2", "bad2"),
    (2, "SGBM tot2", "tot2"),
];

impl Report<'_> {
    /// As text: a line on what was done, the scenes, the families, the mean.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "{} on {}, {}\n{}\n\n{}\n",
            self.method,
            scenes_of(self.scenes.len(), self.folder),
            self.treatment.describe(),
            self.describe_baselines(),
            self.scene_table()
        );
        for (family, mean) in Mean::by_family(self.scenes) {
            text += &format!("\nfamily {family}, {}\n{}\n", count(mean.scenes), mean_table(self.method, &mean));
        }
        text += &format!("\nmean over {}\n{}\n", count(self.mean.scenes), mean_table(self.method, self.mean));
        for (region, score, scenes) in &self.mean.apart {
            let mut table = table(["method"].into_iter().chain(HEADS).collect::<Vec<_>>(), 1);
            add_both(&mut table, self.method, score);
            text += &format!("\n{}, mean over {}\n{}\n", describe_region(*region), count(*scenes), table.trim_fmt());
        }
        text += LEGEND;
        if self.shows_sure {
            text += &("\n".to_owned() + &evidence::sure_text(self.scenes));
        }
        text + &evidence::obstacle_text(self.scenes)
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
        let heads = ["scene", "family"].into_iter().chain(HEADS).chain(OF_DEFAULT.map(|(head, _)| head));
        let heads = heads.chain(beside.iter().map(|(_, head, _)| *head));
        let mut table = table(heads.collect::<Vec<_>>(), 2);
        for scene in self.scenes {
            let mut cells = vec![scene.name.clone(), scene.family.clone()];
            cells.extend(figures(&scene.score.all));
            cells.extend(OF_DEFAULT.map(|(_, key)| format_figure(scene.score.default_answers.figure(key))));
            cells.extend(beside.iter().map(|&(method, _, key)| {
                let value = scene.references[method].as_ref().and_then(|score| score.figure(key));
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
        let scene = |scene: &SceneScore| {
            let apart = scene.apart.iter().map(|(region, score)| (key_of_region(*region), score.clone()));
            let score = ScoreJson { score: scene.score.clone(), apart: apart.collect() };
            let SceneScore { sure, check, obstacles, family, .. } = scene.clone();
            (scene.name.clone(), SceneJson { score, sure, check, obstacles, family })
        };
        let mean = |mean: &Mean| {
            let apart = mean.apart.iter().map(|(region, score, _)| (key_of_region(*region), Some(score.clone())));
            ScoreJson { score: mean.score.clone(), apart: apart.collect() }
        };
        let json = ReportJson {
            method: self.method,
            treatment: &self.treatment,
            mean: mean(self.mean),
            sure: SureJson::of(self.scenes),
            input: evidence::count_input(self.scenes),
            obstacles: evidence::sum_of_obstacles(self.scenes),
            families: Mean::by_family(self.scenes).into_iter().map(|(family, of)| (family, mean(&of))).collect(),
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
    #[serde(flatten)]
    treatment: &'a Treatment,
    mean: ScoreJson,
    sure: SureJson,
    input: BTreeMap<&'static str, usize>,
    obstacles: Option<ObstacleScore>,
    families: BTreeMap<&'a str, ScoreJson>,
    scenes: BTreeMap<String, SceneJson>,
    baselines: Option<BaselinesJson>,
}

/// A score with those of the regions apart.
#[derive(Serialize)]
struct ScoreJson {
    #[serde(flatten)]
    score: MapScore,
    #[serde(flatten)]
    apart: BTreeMap<&'static str, Option<MapScore>>,
}

#[derive(Serialize)]
struct SceneJson {
    #[serde(flatten)]
    score: ScoreJson,
    #[serde(flatten)]
    sure: SureScore,
    #[serde(flatten)]
    check: Option<FrameCheck>,
    obstacles: Option<ObstacleScore>,
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
tot05, tot1, tot2: off by more than 0.5, 1, 2 px or unanswered, % of the scored. off10: off by more than a tenth of
the depth or unanswered, % of the scored. epe: mean error of the answered, px. bad2@BM: bad2 of the most confident
answers, as many as StereoBM 9 gives. auc: area under the curve of bad2 over the share of answers kept, most
confident first. But for density, less is better. Default answers have a confidence of 16 or more, the others are
guesses.
";

/// A method's means, with OpenCV's below.
#[must_use]
pub fn mean_table(method: &str, mean: &Mean) -> String {
    let mut table = table(["method"].into_iter().chain(HEADS).collect::<Vec<_>>(), 1);
    add_both(&mut table, method, &mean.score);
    for ((_, name), reference) in METHODS.iter().zip(&mean.references) {
        if let Some((score, scenes)) = reference {
            let part = if *scenes < mean.scenes { format!(" ({})", count(*scenes)) } else { String::new() };
            add(&mut table, format!("{name}{part}"), score);
        }
    }
    table.trim_fmt()
}

/// A row for all answers of a method, and one for those given by default.
fn add_both(table: &mut Table, method: &str, score: &MapScore) {
    add(table, method.to_owned(), &score.all);
    add(table, format!("{method}, default (>= {LEAST_DEFAULT_CONFIDENCE})"), &score.default_answers);
}

fn add(table: &mut Table, name: String, score: &Score) {
    let mut cells = vec![name];
    cells.extend(figures(score));
    table.add_row(cells);
}

/// What a region that is scored apart holds, in words.
fn describe_region(region: Region) -> &'static str {
    match region {
        Region::Scored => "seen by both cameras",
        Region::Occluded => "occluded (hidden from the right camera or out of its view)",
        Region::LeftBand => "left band (columns left of num_disparities, seen by both cameras)",
    }
}

/// The key of a region that is scored apart.
fn key_of_region(region: Region) -> &'static str {
    match region {
        Region::Scored => "scored",
        Region::Occluded => "occluded",
        Region::LeftBand => "left_band",
    }
}

/// What was done to the frames, in words.
#[must_use]
pub fn describe(degradation: &Degradation) -> String {
    let Degradation { noise, shot_noise, pattern_noise, gain, offset, both_gain, misalignment, .. } = *degradation;
    let Degradation { bits, swap, random, seed, .. } = *degradation;
    let mut words = Vec::new();
    words.extend(random.then(|| format!("random views (seed {seed})")));
    words.extend(swap.then(|| "views swapped".to_owned()));
    let Misalignment { row_offset, roll, row_scale } = misalignment;
    for (what, value, usual) in
        [("rows lower by", row_offset, 0.0), ("turned by degrees", roll, 0.0), ("stretched down by", row_scale, 1.0)]
    {
        words.extend((value != usual).then(|| format!("right view {what} {value}")));
    }
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
    words.extend((bits < 8).then(|| format!("{bits} bits")));
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
