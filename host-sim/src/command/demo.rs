//! `haarline demo`: the core on a rendered scene with known truth.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::ValueEnum;
use haarline::confidence::SURE;
use serde::Serialize;

use super::shared::quoted;
use super::{natural_number, number, print};
use crate::output::colour_range::ColourRange;
use crate::output::{self, encode_grey_png, picture};
use crate::score::report::table;
use crate::score::scene::{Meta, RIG_FILE};
use crate::score::{LEAST_DEFAULT_CONFIDENCE, Score};
use crate::stereo::method::MethodKind;
use crate::stereo::pipeline::{self, Run};
use crate::synthetic::folder::{self, NamedFile};
use crate::synthetic::regions::RegionScore;
use crate::synthetic::{BlankScore, Rendering, Scene, YARD};
use crate::{DisparityMap, Geometry};

/// Distance of the cameras that the scenes are as if seen by.
const BASELINE_MM: f64 = 60.0;

/// What is rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SceneKind {
    /// A room with a blank wall
    Room,
    /// What confuses: a fence, a blank wall, a dark corner, strips that the right view does not see; told apart
    Yard,
    /// What a rover sees: flat ground and a post at 1.5 m, with the rig of haarline rig new
    Rover,
}

impl SceneKind {
    /// Focal length of the cameras that it is as if seen by.
    const fn focal_px(self) -> f64 {
        match self {
            Self::Room | Self::Yard => 280.0,
            Self::Rover => 200.0,
        }
    }
}

/// Arguments of `haarline demo`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Where the pictures go; the folder becomes a scene for haarline eval, too
    #[arg(short, long = "output", value_name = "DIR", default_value = "out/demo")]
    output: PathBuf,
    /// What to render
    #[arg(long, value_enum, value_name = "SCENE", default_value_t = SceneKind::Room)]
    scene: SceneKind,
    /// How to match
    #[arg(long, value_enum, default_value_t = MethodKind::BEST)]
    method: MethodKind,
    /// Sensor noise, standard deviation in grey levels
    #[arg(long, value_name = "SIGMA", default_value_t = 1.5, allow_hyphen_values = true, value_parser = number)]
    noise: f64,
    /// Seed of textures and noise
    #[arg(long, value_name = "S", default_value_t = 0, allow_hyphen_values = true, value_parser = natural_number)]
    seed: u64,
    /// Prints the figures as JSON
    #[arg(long)]
    json: bool,
}

/// What the core made of the scene.
#[derive(Debug, Serialize)]
struct Figures {
    method: &'static str,
    width: usize,
    height: usize,
    num_disparities: u16,
    milliseconds: f64,
    #[serde(flatten)]
    score: Score,
    wall_pixels: u64,
    /// Of the default answers, those of confidence 16 and more.
    wall_answered_percent: f64,
    wall_wrong_percent: f64,
    /// Of those that are sure enough to be an obstacle.
    wall_sure_wrong_percent: f64,
    /// The parts of the yard.
    regions: Vec<RegionScore>,
    folder: PathBuf,
    files: Vec<&'static str>,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let noise = self.noise;
        ensure!((0.0..=255.0).contains(&noise), "--noise {noise}: must be 0 to 255");
        output::prepare_folder("-o", &self.output)?;
        let scene = match self.scene {
            SceneKind::Room => Scene::room(self.seed),
            SceneKind::Yard => Scene::yard(self.seed),
            SceneKind::Rover => Scene::rover(self.seed),
        };
        let (scene, focal_px) = (Scene { noise, ..scene }, self.scene.focal_px());
        let rendering = scene.render();
        let Run { map, elapsed, .. } = pipeline::run(&mut *self.method.build(scene.config())?, &rendering.pair)?;
        let files = scene_files(&scene, &rendering, focal_px)?;
        let mut shown = map.clone();
        if self.method.has_guesses() {
            shown.drop_below(LEAST_DEFAULT_CONFIDENCE);
        }
        let files = files.into_iter().chain(map_files(&rendering, &shown, focal_px)?);
        let rig = (RIG_FILE, "the rig that it is as if seen by", haarline_rig::template().into_bytes());
        let files: Vec<NamedFile> = files.chain((self.scene == SceneKind::Rover).then_some(rig)).collect();
        for (name, _, bytes) in &files {
            output::write(&self.output.join(name), bytes)?;
        }
        let figures = self.figures(&scene, &rendering, &map, elapsed.as_secs_f64() * 1000.0, &files)?;
        print(&if self.json {
            serde_json::to_string(&figures)? + "\n"
        } else {
            figures.text(&files, noise) + &self.next_steps(&figures)
        })
    }

    /// What to try on the files, one command a line with what it does above.
    fn next_steps(&self, figures: &Figures) -> String {
        let file = |name: &str| quoted(&self.output.join(name).display().to_string());
        let (left, right, folder) = (file("left.png"), file("right.png"), quoted(&self.output.display().to_string()));
        let (scene, search) = match self.scene {
            SceneKind::Room => (String::new(), format!("--num-disparities {}", figures.num_disparities)),
            SceneKind::Yard => (" --scene yard".to_owned(), format!("--num-disparities {}", figures.num_disparities)),
            SceneKind::Rover => (" --scene rover".to_owned(), format!("--rig {}", file(RIG_FILE))),
        };
        let seed = if self.seed == 0 { String::new() } else { format!(" --seed {}", self.seed) };
        format!(
            "\nLook at {} beside {}.\n\n\
             The same scene from its files, as any folder of scenes with known truth:\n  haarline eval {folder}\n\
             The same scene in worse light:\n  haarline demo{scene}{seed} --noise 10 -o {}\n\
             Any rectified pair, here this one:\n  haarline depth {left} {right} {search} --picture depth.png\n",
            file("disparity_picture.png"),
            file("truth_picture.png"),
            quoted(&format!("{}-noisy", self.output.display())),
        )
    }

    fn figures(
        &self,
        scene: &Scene,
        rendering: &Rendering,
        map: &DisparityMap,
        milliseconds: f64,
        files: &[NamedFile],
    ) -> Result<Figures> {
        let BlankScore { pixels, answered, wrong } = rendering.blank_score(map, LEAST_DEFAULT_CONFIDENCE);
        let sure = rendering.blank_score(map, SURE);
        let percent = |count: u64| 100.0 * count as f64 / pixels.max(1) as f64;
        Ok(Figures {
            method: self.method.name(),
            width: map.width,
            height: map.height,
            num_disparities: scene.num_disparities,
            milliseconds,
            score: Score::of(map, &rendering.textured_truth(), None).context("the scene has nothing to score")?,
            wall_pixels: pixels,
            wall_answered_percent: percent(answered),
            wall_wrong_percent: percent(wrong),
            wall_sure_wrong_percent: percent(sure.wrong),
            regions: match self.scene {
                SceneKind::Yard => RegionScore::all(&YARD, rendering, map),
                SceneKind::Room | SceneKind::Rover => Vec::new(),
            },
            folder: self.output.clone(),
            files: files.iter().map(|(name, ..)| *name).collect(),
        })
    }
}

/// The scene in the layout that `haarline eval` reads; blank surfaces are not scored.
fn scene_files(scene: &Scene, rendering: &Rendering, focal_px: f64) -> Result<[NamedFile; 5]> {
    let meta = Meta {
        num_disparities: scene.num_disparities,
        family: "synthetic".to_owned(),
        focal_px: Some(focal_px),
        baseline_mm: Some(BASELINE_MM),
    };
    folder::files(scene, &rendering.pair, &rendering.textured_truth(), &meta)
}

/// The core's answer, and the truth in the same colours.
fn map_files(rendering: &Rendering, map: &DisparityMap, focal_px: f64) -> Result<[NamedFile; 6]> {
    let geometry = Geometry::new(focal_px, BASELINE_MM)?;
    let true_map = rendering.truth.to_map();
    let range = ColourRange::of(&true_map);
    let picture = |map: &DisparityMap| picture::encode(map, &range, Some(&geometry), None);
    Ok([
        ("truth_picture.png", "true disparity in colours", picture(&true_map)?),
        ("disparity_picture.png", "the disparity found, in the same colours", picture(map)?),
        ("disparity_grey.png", "the same in grey", picture::encode_grey(map, &range)?),
        ("confidence.png", "its confidence", encode_grey_png(&map.confidence, [map.width, map.height])?),
        ("disparity.pfm", "its disparity in px", output::pfm::encode(map)),
        ("cloud.ply", "its points in m", output::ply::encode(map, &rendering.pair.left, &geometry, None)),
    ])
}

impl Figures {
    fn text(&self, files: &[NamedFile], noise: f64) -> String {
        let Self { method, width, height, num_disparities, milliseconds, score, .. } = self;
        let figure = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"));
        let mut text = format!(
            "{method} on a rendered scene, {width}x{height} px, {num_disparities} disparities, noise {noise}: \
             {milliseconds:.1} ms\n\
             answered {:.2} % of the pixels with texture that both cameras see; of the answers {} % are off by more \
             than 2 px and {} % by more than 1 px, mean error {} px\n",
            score.density,
            figure(score.bad2),
            figure(score.bad1),
            figure(score.epe),
        );
        if !self.regions.is_empty() {
            text += &region_table(&self.regions);
        } else if self.wall_pixels > 0 {
            text += &format!(
                "blank wall, {} pixels without texture: {:.2} % answered by more than a guess, {:.2} % wrong by more than 2 px\n",
                self.wall_pixels, self.wall_answered_percent, self.wall_wrong_percent,
            );
        }
        text.push('\n');
        for (name, what, _) in files {
            text += &format!("  {:<40} {what}\n", self.folder.join(name).display().to_string());
        }
        text
    }
}

/// What became of each part of the scene.
fn region_table(regions: &[RegionScore]) -> String {
    let heads = ["part", "pixels", "answered %", "wrong %", "sure %", "sure and wrong %"];
    let mut table = table(heads.to_vec(), 1);
    for region in regions {
        let shares = [region.answered_percent, region.wrong_percent, region.sure_percent, region.sure_wrong_percent];
        let shares = shares.map(|share| format!("{share:.2}"));
        table
            .add_row([region.name.to_owned(), region.pixels.to_string()].into_iter().chain(shares).collect::<Vec<_>>());
    }
    table.trim_fmt() + "\n"
}
