//! A method on many scenes: scored in parallel, with the same result whatever the number of threads.

use haarline::confidence::SURE;
use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result};
use haarline::{Config, ConfigError, Rectification, StereoMethod};
use rayon::prelude::*;

use crate::output::colour_range::ColourRange;
use crate::output::picture;
use crate::score::baselines::{self, Baselines, Level};
use crate::score::degrade::{Degradation, replace_right};
use crate::score::map_file;
use crate::score::obstacle_score::ObstacleScore;
use crate::score::scene::{Region, Scene};
use crate::score::sure::SureScore;
use crate::score::{MapScore, Score};
use crate::stereo::disparity_map::DisparityMap;
use crate::stereo::frame_check::FrameCheck;
use crate::stereo::pipeline;
use crate::stereo::smoothing;
use crate::{Frame, Geometry, StereoPair, output};

/// Builds an instance of a method.
pub type Build<'a> = dyn Fn(Config) -> Result<Box<dyn StereoMethod + Send>, ConfigError> + Sync + 'a;

/// Where the maps come from that are scored.
pub enum Source<'a> {
    /// A method makes them.
    Method(&'a Build<'a>),
    /// They are read from a folder ([`map_file`]).
    Maps(&'a Path),
}

/// What is to be done with every scene.
pub struct Evaluator<'a> {
    /// Where the maps come from.
    pub source: Source<'a>,
    /// Another scene's right view, which takes the place of every scene's own.
    pub right_from: Option<&'a Frame>,
    /// What happens to the frames before.
    pub degradation: Degradation,
    /// Whether the frames are smoothed then, as our front end does ([`smoothing`]).
    pub smooth: bool,
    /// Whether the holes of the maps are filled.
    pub fill: bool,
    /// OpenCV's figures, and which of them.
    pub baselines: Option<(&'a Baselines, &'a Level)>,
    /// Regions that are scored apart, besides [`Region::Scored`].
    pub apart: &'a [Region],
    /// Where the maps go, if anywhere.
    pub maps: Option<&'a Path>,
    /// Where the frames go as the method gets them, if anywhere.
    pub views: Option<&'a Path>,
    /// What is asked of the evidence.
    pub evidence: Evidence,
}

/// What is asked of the confidence and the obstacles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Evidence {
    /// From which confidence on an answer is sure.
    pub sure_from: u8,
    /// Whether obstacles are looked for.
    pub obstacles: bool,
}

impl Evidence {
    /// The usual confidence, no obstacles.
    pub const USUAL: Self = Self { sure_from: SURE, obstacles: false };
}

/// A scene's score, and those of OpenCV on it.
#[derive(Debug, Clone)]
pub struct SceneScore {
    /// The scene's name.
    pub name: String,
    /// The scene's kind.
    pub family: String,
    /// The method's score.
    pub score: MapScore,
    /// The same in the regions that are scored apart; `None` where the scene has no such pixel.
    pub apart: Vec<(Region, Option<MapScore>)>,
    /// What its sure answers are worth.
    pub sure: SureScore,
    /// What the frame is as a whole.
    pub check: Option<FrameCheck>,
    /// Obstacles in its map and in the truth's, if they were looked for.
    pub obstacles: Option<ObstacleScore>,
    /// OpenCV's, in the order of [`baselines::METHODS`]; `None` where the file has none.
    pub references: [Option<Score>; baselines::METHODS.len()],
}

/// Mean scores over a group of scenes.
#[derive(Debug, Clone)]
pub struct Mean {
    /// How many scenes there are.
    pub scenes: usize,
    /// The method's mean.
    pub score: MapScore,
    /// The same in the regions that are scored apart, each over those of the scenes that have such pixels, and
    /// how many these are.
    pub apart: Vec<(Region, MapScore, usize)>,
    /// OpenCV's means, each over those of the scenes that the file has, and how many these are.
    pub references: [Option<(Score, usize)>; baselines::METHODS.len()],
}

impl Mean {
    /// The mean over `scenes`; `None` if there are none.
    #[must_use]
    pub fn of<'a>(scenes: impl Iterator<Item = &'a SceneScore> + Clone) -> Option<Self> {
        let score = MapScore::mean(scenes.clone().map(|scene| &scene.score))?;
        let regions = scenes.clone().next().map_or(0, |scene| scene.apart.len());
        let apart = (0..regions).filter_map(|index| {
            let known = scenes.clone().filter_map(move |scene| scene.apart[index].1.as_ref());
            let region = scenes.clone().next()?.apart[index].0;
            Some((region, MapScore::mean(known.clone())?, known.count()))
        });
        let apart = apart.collect();
        let references = std::array::from_fn(|method| {
            let known = scenes.clone().filter_map(move |scene| scene.references[method].as_ref());
            Some((Score::mean(known.clone())?, known.count()))
        });
        Some(Self { scenes: scenes.count(), score, apart, references })
    }

    /// The mean of each family of scenes, by name.
    #[must_use]
    pub fn by_family(scenes: &[SceneScore]) -> BTreeMap<&str, Self> {
        let families: BTreeMap<&str, ()> = scenes.iter().map(|scene| (scene.family.as_str(), ())).collect();
        let mean = |family: &str| Self::of(scenes.iter().filter(|scene| scene.family == family));
        families.into_keys().filter_map(|family| Some((family, mean(family)?))).collect()
    }
}

/// Loads the scenes in `folders`, in their order.
///
/// # Errors
/// The first folder's in that order, if some cannot be loaded.
pub fn load(folders: &[impl AsRef<Path> + Sync]) -> Result<Vec<Scene>> {
    let scenes: Vec<Result<Scene>> = folders.par_iter().map(|folder| Scene::read(folder.as_ref())).collect();
    scenes.into_iter().collect()
}

impl<'a> Evaluator<'a> {
    /// Scores the maps of `source` as they are, of frames as they are.
    #[must_use]
    pub const fn of(source: Source<'a>) -> Self {
        Self {
            source,
            right_from: None,
            degradation: Degradation::NONE,
            smooth: false,
            fill: false,
            baselines: None,
            apart: &[],
            maps: None,
            views: None,
            evidence: Evidence::USUAL,
        }
    }

    /// Scores every scene, in their order; `done` is called after each.
    ///
    /// # Errors
    /// The first scene's in that order, if some fail.
    pub fn run(&self, scenes: &[Scene], done: impl Fn() + Sync) -> Result<Vec<SceneScore>> {
        let score = |scene: &Scene| {
            let score = self.score(scene).with_context(|| format!("scene {}", scene.name));
            done();
            score
        };
        let scores: Vec<Result<SceneScore>> = scenes.par_iter().map(score).collect();
        scores.into_iter().collect()
    }

    /// Degrades, matches and scores one scene, and writes its map.
    fn score(&self, scene: &Scene) -> Result<SceneScore> {
        let pair = self.views_of(scene)?;
        let (mut map, figures) = match self.source {
            Source::Maps(folder) => (map_file::read(folder, scene)?, None),
            Source::Method(build) => {
                let run = pipeline::run(&mut *build(scene.config())?, &pair)?;
                (run.map, run.figures)
            }
        };
        let check = FrameCheck::told(figures, &pair, &Rectification::default(), &map);
        if self.fill {
            map.fill_holes();
        }
        if let Some(folder) = self.maps {
            write_maps(folder, scene, &map)?;
        }
        let references = self.references(scene);
        let reference_density = references[0].map(|score| score.density);
        let score_in = |region, density| MapScore::of(&map, &scene.truth, region, density);
        let score = score_in(Region::Scored, reference_density).context("nothing to score")?;
        let apart = self.apart.iter().map(|&region| (region, score_in(region, None))).collect();
        let Evidence { sure_from, obstacles } = self.evidence;
        let sure = SureScore::of(&map, &scene.truth, sure_from);
        let obstacles = obstacles.then(|| ObstacleScore::of(scene, &map, sure_from, check.input_ok)).transpose()?;
        let (name, family) = (scene.name.clone(), scene.meta.family.clone());
        Ok(SceneScore { name, family, score, apart, sure, check: Some(check), obstacles, references })
    }

    /// The frames of a scene as the method gets them.
    fn views_of(&self, scene: &Scene) -> Result<StereoPair> {
        let mut pair = scene.pair.clone();
        if let Some(other) = self.right_from {
            replace_right(&mut pair, other);
        }
        self.degradation.apply(&scene.name, &mut pair);
        if self.smooth {
            smoothing::smooth(&mut pair);
        }
        if let Some(folder) = self.views {
            let folder = folder.join(&scene.name);
            output::prepare_folder("--write-views", &folder)?;
            for (name, view) in [("left.png", &pair.left), ("right.png", &pair.right)] {
                output::write(&folder.join(name), &output::encode_grey_png(&view.luma, [view.width, view.height])?)?;
            }
        }
        Ok(pair)
    }

    fn references(&self, scene: &Scene) -> [Option<Score>; baselines::METHODS.len()] {
        baselines::METHODS.map(|(method, _)| {
            let (baselines, level) = self.baselines?;
            baselines.score(method, level, &scene.name, scene.pair.width())
        })
    }
}

/// `<scene>.pfm`, `<scene>_confidence.png` and `<scene>_picture.png`, the colours spanning the truth.
fn write_maps(folder: &Path, scene: &Scene, map: &DisparityMap) -> Result<()> {
    let file = |suffix: &str| folder.join(format!("{}{suffix}", scene.name));
    let geometry = match (scene.meta.focal_px, scene.meta.baseline_mm) {
        (Some(focal_px), Some(baseline_mm)) => Geometry::new(focal_px, baseline_mm).ok(),
        _ => None,
    };
    let range = ColourRange::of(&scene.truth.to_map());
    output::write(&file(".pfm"), &output::pfm::encode(map))?;
    let confidence = output::encode_grey_png(&map.confidence, [map.width, map.height])?;
    output::write(&file("_confidence.png"), &confidence)?;
    output::write(&file("_picture.png"), &picture::encode(map, &range, geometry.as_ref(), None)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::confidence_classes::ConfidenceClasses;

    fn scene(family: &str, tot2: f64, reference: Option<f64>) -> SceneScore {
        let all = |tot2| Score { density: 50.0, tot1: 100.0, tot2, ..Score::default() };
        let score = |tot2| MapScore {
            all: all(tot2),
            default_answers: all(tot2 + 1.0),
            confidence_classes: ConfidenceClasses::mean(&[]),
        };
        let apart = vec![(Region::Occluded, reference.map(score)), (Region::LeftBand, None)];
        let references = [reference.map(all), None, None];
        let (name, family, sure) = (String::new(), family.to_owned(), SureScore::default());
        SceneScore { name, family, score: score(tot2), apart, sure, check: None, obstacles: None, references }
    }

    #[test]
    fn means_are_plain_over_scenes_and_within_families() {
        let scenes = [scene("b", 10.0, Some(20.0)), scene("b", 20.0, None), scene("a", 60.0, Some(40.0))];
        let mean = Mean::of(scenes.iter()).unwrap();
        assert_eq!((mean.scenes, mean.score.all.tot2, mean.score.all.epe), (3, 30.0, None));
        let (reference, count) = mean.references[0].unwrap();
        assert_eq!((reference.tot2, count), (30.0, 2));
        assert!(mean.references[1].is_none());
        assert_eq!(mean.score.default_answers.tot2, 31.0);
        let [(Region::Occluded, occluded, 2)] = &mean.apart[..] else { panic!("{:?}", mean.apart) };
        assert_eq!(occluded.all.tot2, 30.0);
        let families = Mean::by_family(&scenes);
        let tot2: Vec<(&str, f64)> = families.iter().map(|(family, mean)| (*family, mean.score.all.tot2)).collect();
        assert_eq!(tot2, [("a", 60.0), ("b", 15.0)]);
    }
}
