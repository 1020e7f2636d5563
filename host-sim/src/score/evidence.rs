//! What the sure answers and the obstacles of many scenes are worth: tables and JSON.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::score::evaluation::SceneScore;
use crate::score::obstacle_score::{Counts, ObstacleScore};
use crate::score::report::{format_figure, table};
use crate::score::sure::SureScore;

/// Means and worst scenes of [`SureScore`].
#[derive(Debug, Clone, Serialize)]
pub(crate) struct SureJson {
    mean: SureScore,
    worst: SureScore,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    families: BTreeMap<String, SureJson>,
}

impl SureJson {
    pub(crate) fn of(scenes: &[SceneScore]) -> Self {
        let named = |name: &String| {
            let scenes = scenes.iter().filter(|scene| scene.family == *name).map(|scene| &scene.sure);
            (name.clone(), Self::of_scores(scenes))
        };
        let names: BTreeMap<&String, ()> = scenes.iter().map(|scene| (&scene.family, ())).collect();
        let families = names.into_keys().map(named).collect();
        Self { families, ..Self::of_scores(scenes.iter().map(|scene| &scene.sure)) }
    }

    fn of_scores<'a>(scores: impl Iterator<Item = &'a SureScore> + Clone) -> Self {
        let (mean, worst) = (SureScore::mean(scores.clone()), SureScore::worst(scores));
        Self { mean, worst, families: BTreeMap::new() }
    }
}

/// A line a scene, then the means of the families and of all, then the worst of each figure.
pub(crate) fn sure_text(scenes: &[SceneScore]) -> String {
    let heads = ["density", "bad2", "s&w", "near", "hidden s&w", "hidden near"];
    let mut table = table(["sure answers"].into_iter().chain(heads).collect::<Vec<_>>(), 1);
    let mut add = |name: String, sure: &SureScore| {
        let figures = SureScore::FIGURES.map(|(_, figure)| format_figure(figure(sure)));
        table.add_row([name].into_iter().chain(figures).collect::<Vec<_>>());
    };
    for scene in scenes {
        add(scene.name.clone(), &scene.sure);
    }
    let json = SureJson::of(scenes);
    for (name, family) in &json.families {
        add(format!("mean of {name}"), &family.mean);
        add(format!("worst of {name}"), &family.worst);
    }
    if json.families.len() > 1 {
        add("mean".to_owned(), &json.mean);
        add("worst".to_owned(), &json.worst);
    }
    let input: Vec<String> = count_input(scenes).iter().map(|(what, count)| format!("{count} {what}")).collect();
    table.trim_fmt() + SURE_LEGEND + &format!("frames as a whole: {}\n", input.join(", "))
}

/// How many frames are what as a whole.
pub(crate) fn count_input(scenes: &[SceneScore]) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for check in scenes.iter().filter_map(|scene| scene.check) {
        *counts.entry(check.input.name()).or_default() += 1;
    }
    counts
}

const SURE_LEGEND: &str = "

density: sure, % of the scored pixels. bad2: off by more than 2 px, % of the sure. s&w: sure and off by more
than 2 px, % of the scored. near: sure and more than 2 px too near. hidden: the same of the pixels that only the
left view sees. worst: each figure by itself.
";

/// The sum over all scenes; `None` if obstacles were not looked for.
pub(crate) fn sum_of_obstacles(scenes: &[SceneScore]) -> Option<ObstacleScore> {
    let mut scores = scenes.iter().filter_map(|scene| scene.obstacles.as_ref()).peekable();
    scores.peek()?;
    let mut sum = ObstacleScore::default();
    scores.for_each(|score| sum.add(score));
    Some(sum)
}

/// The obstacles of all frames, in all and by range; nothing if they were not looked for.
pub(crate) fn obstacle_text(scenes: &[SceneScore]) -> String {
    let Some(sum) = sum_of_obstacles(scenes) else { return String::new() };
    let heads = ["obstacles", "count", "found %", "missed %", "too far %", "too near %"];
    let mut table = table(heads.to_vec(), 1);
    let mut add = |name: String, counts: &Counts| {
        let shares = [counts.found, counts.missed, counts.too_far, counts.too_near];
        let percent = |count: u64| format!("{:.1}", 100.0 * count as f64 / counts.obstacles.max(1) as f64);
        table.add_row([name, counts.obstacles.to_string()].into_iter().chain(shares.map(percent)).collect::<Vec<_>>());
    };
    add("nearest of a frame".to_owned(), &sum.nearest);
    for (range, counts) in &sum.by_range {
        add(format!("  {}", range.name()), counts);
    }
    add("nearest of each sector".to_owned(), &sum.sectors);
    let ObstacleScore { frames, silent, sparse, phantom_frames, phantom_sectors, .. } = sum;
    let mut text = format!("\n{}\n", table.trim_fmt());
    text += &format!("phantoms, nearer than all that is there less 15 %: in {phantom_frames} of {frames} frames");
    text += &format!(", {phantom_sectors} sectors\n");
    if silent > 0 {
        text += &format!("frames that do not match as a whole, of which nothing is told: {silent}\n");
    }
    if sparse > 0 {
        text += &format!("not judged, since the truth is known in less than half of the pixels: {sparse}\n");
    }
    text + OBSTACLE_LEGEND
}

const OBSTACLE_LEGEND: &str = "\
found: told within 15 % of where the finder sees it in the truth. missed: nothing is told there. too far: by more
than 25 %. too near: by more than 15 %.
";
