//! `haarline depth`: a frame in, its disparities out.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use haarline::obstacle::MAX_SECTORS;
use haarline::{Config, Disparity, Offset};
use haarline_rig::Description;
use serde::Serialize;

use super::shared::{MethodOptions, MinConfidence, RigArg, SearchRange};
use super::{number, print};
use crate::output::obstacle_strip::ObstacleStrip;
use crate::output::picture::{self, ColourRange};
use crate::output::{self, MapKind};
use crate::stereo::disparity_map::{DisparityMap, Spread};
use crate::stereo::method::MethodKind;
use crate::stereo::obstacles::{FrameObstacles, ObstacleFinder};
use crate::stereo::pipeline::{self, Run};
use crate::{Frame, Geometry, StereoPair, input::rig_file};

/// Arguments of `haarline depth`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Left view: PNG, PGM, PPM, BMP, JPEG or TIFF, 8 or 16 bits (of which the high byte counts), grey
    /// or colour (which becomes luma by Rec. 601, as in OpenCV)
    left: PathBuf,
    /// Right view, of the same size; matching points lie in the same row, further left
    right: PathBuf,
    #[command(flatten)]
    search: SearchRange,
    #[command(flatten)]
    method: MethodOptions,
    /// Focal length, px; with --baseline-mm depth is told, too
    #[arg(long, value_name = "F", allow_hyphen_values = true, value_parser = number)]
    focal_px: Option<f64>,
    /// Distance of the two cameras, mm
    #[arg(long, value_name = "B", allow_hyphen_values = true, value_parser = number)]
    baseline_mm: Option<f64>,
    #[command(flatten)]
    rig: RigArg,
    /// Distance to the nearest obstacle in each direction, cm; needs --rig
    #[arg(long, value_name = "FILE.csv", requires = "rig")]
    obstacles: Option<PathBuf>,
    /// Disparity file, any number of times: .pfm (px, float, unknown = +inf), .png (16 bits, disparity x
    /// 256, 0 = unknown) or .ply (point cloud in m; needs --focal-px and --baseline-mm)
    #[arg(short, long = "output", value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Picture in colours with a legend; unknown is a grey checkerboard
    #[arg(long, value_name = "FILE.png")]
    picture: Option<PathBuf>,
    /// Picture in grey, nearer = brighter: the searched range as 1 to 255, unknown as 0
    #[arg(long, value_name = "FILE.png")]
    grey: Option<PathBuf>,
    /// Confidence of each pixel, 0 to 255
    #[arg(long, value_name = "FILE.png")]
    confidence: Option<PathBuf>,
    #[command(flatten)]
    min_confidence: MinConfidence,
    /// Fills unknown pixels with the farther of the next known ones beside them: a guess, confidence 1
    #[arg(long)]
    fill: bool,
    /// Prints the summary as JSON
    #[arg(long)]
    json: bool,
}

/// What is told about a map.
#[derive(Debug, Serialize)]
struct Summary {
    width: usize,
    height: usize,
    method: &'static str,
    min_disparity: i16,
    num_disparities: u16,
    density: f64,
    min_disparity_px: Option<f64>,
    median_disparity_px: Option<f64>,
    max_disparity_px: Option<f64>,
    milliseconds: f64,
    #[serde(flatten)]
    depth: Option<DepthSummary>,
}

/// The same in mm, where the rig is known. Far beyond all is null.
#[derive(Debug, Serialize)]
struct DepthSummary {
    focal_px: f64,
    baseline_mm: f64,
    nearest_depth_mm: Option<u32>,
    median_depth_mm: Option<u32>,
    farthest_depth_mm: Option<u32>,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let rig = self.rig.read(&self.search, [self.focal_px, self.baseline_mm])?;
        let geometry = match &rig {
            Some(rig) => Some(Geometry::new(rig.focal_px, rig.baseline_mm)?),
            None => Geometry::from_options(self.focal_px, self.baseline_mm)?,
        };
        let (method, min_confidence) = (self.method.get()?, self.min_confidence.get()?);
        let kinds = self.check_outputs(geometry.as_ref())?;
        let pair = StereoPair::read(&self.left, &self.right)?;
        let config = match &rig {
            Some(rig) => {
                rig_file::check_size(rig, [pair.width(), pair.height()])?;
                rig.config()
            }
            None => self.search.config(pair.width() as u16)?,
        };
        let offset = rig.as_ref().map_or_else(Offset::default, |rig| rig.offset);
        let Run { mut map, elapsed } = pipeline::run_paired(&mut *method.build(config)?, offset, &pair)?;
        map.drop_below(min_confidence);
        let obstacles = rig.as_ref().map(|rig| Found::new(rig, &map)).transpose()?;
        if self.fill {
            map.fill_holes();
        }
        for (path, bytes) in self.files(&kinds, &map, &pair.left, &config, geometry.as_ref(), obstacles.as_ref())? {
            output::write(path, &bytes)?;
        }
        let summary = Summary::new(&map, &config, method.kind, elapsed.as_secs_f64() * 1000.0, geometry.as_ref());
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.line() })
    }

    /// Checks every name that is to be written before anything is computed.
    fn check_outputs(&self, geometry: Option<&Geometry>) -> Result<Vec<MapKind>> {
        let kinds: Vec<MapKind> = self.output.iter().map(|path| MapKind::of(path)).collect::<Result<_>>()?;
        let cloud = kinds.iter().position(|&kind| kind == MapKind::Ply);
        if let (Some(index), None) = (cloud, geometry) {
            let name = self.output[index].display();
            anyhow::bail!("-o {name}: a point cloud in m needs --focal-px and --baseline-mm");
        }
        for (option, path) in self.pictures() {
            output::check_png_name(option, path)?;
        }
        let maps = self.output.iter().map(|path| ("-o", path.as_path()));
        let mut taken: Vec<PathBuf> = Vec::new();
        let table = self.obstacles.iter().map(|path| ("--obstacles", path.as_path()));
        for (option, path) in maps.chain(self.pictures()).chain(table) {
            output::check_writable(option, path)?;
            let same_as = |other: &Path| output::is_same_file(path, other);
            ensure!(
                !same_as(&self.left) && !same_as(&self.right),
                "{option} {}: is one of the views, give another name",
                path.display()
            );
            ensure!(!taken.iter().any(|other| same_as(other)), "{option} {}: the name is given twice", path.display());
            taken.push(path.to_owned());
        }
        Ok(kinds)
    }

    fn pictures(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let named = [("--picture", &self.picture), ("--grey", &self.grey), ("--confidence", &self.confidence)];
        named.into_iter().filter_map(|(option, path)| Some((option, path.as_deref()?)))
    }

    /// Every file's content, before the first one is written.
    fn files(
        &self,
        kinds: &[MapKind],
        map: &DisparityMap,
        left: &Frame,
        config: &Config,
        geometry: Option<&Geometry>,
        obstacles: Option<&Found>,
    ) -> Result<Vec<(&Path, Vec<u8>)>> {
        let mut files = Vec::new();
        for (path, kind) in self.output.iter().zip(kinds) {
            let bytes = kind.encode(map, left, geometry).with_context(|| format!("-o {}", path.display()))?;
            files.push((path.as_path(), bytes));
        }
        if let Some(path) = &self.picture {
            let range = ColourRange::of(map);
            let picture = match geometry.zip(obstacles) {
                Some((geometry, found)) => picture::encode_with_obstacles(map, &range, &found.strip(geometry))?,
                None => picture::encode(map, &range, geometry)?,
            };
            files.push((path, picture));
        }
        if let (Some(path), Some(found)) = (&self.obstacles, obstacles) {
            files.push((path, found.finder.encode_csv(std::slice::from_ref(&found.frame))?));
        }
        if let Some(path) = &self.grey {
            files.push((path, picture::encode_grey(map, config)?));
        }
        if let Some(path) = &self.confidence {
            files.push((path, output::encode_grey_png(&map.confidence, [map.width, map.height])?));
        }
        Ok(files)
    }
}

/// The obstacles of the frame.
struct Found {
    finder: ObstacleFinder,
    frame: FrameObstacles,
}

impl Found {
    fn new(rig: &Description, map: &DisparityMap) -> Result<Self> {
        let mut finder = ObstacleFinder::new(rig)?;
        let frame = FrameObstacles { frame: 0, nearest_mm: finder.find(map) };
        Ok(Self { finder, frame })
    }

    fn strip<'a>(&'a self, geometry: &'a Geometry) -> ObstacleStrip<'a, MAX_SECTORS> {
        ObstacleStrip { setup: self.finder.setup(), geometry, nearest_mm: &self.frame.nearest_mm }
    }
}

impl Summary {
    fn new(
        map: &DisparityMap,
        config: &Config,
        method: MethodKind,
        milliseconds: f64,
        geometry: Option<&Geometry>,
    ) -> Self {
        let spread = map.spread();
        let depth = geometry.map(|geometry| DepthSummary::new(geometry, spread.as_ref()));
        Self {
            width: map.width,
            height: map.height,
            method: method.name(),
            min_disparity: config.min_disparity,
            num_disparities: config.num_disparities,
            density: map.density(),
            min_disparity_px: spread.map(|spread| spread.min_px),
            median_disparity_px: spread.map(|spread| spread.median_px),
            max_disparity_px: spread.map(|spread| spread.max_px),
            milliseconds,
            depth,
        }
    }

    fn line(&self) -> String {
        let Self { width, height, method, min_disparity, num_disparities, density, milliseconds, .. } = self;
        let last = i32::from(*min_disparity) + i32::from(*num_disparities) - 1;
        let range = match (self.min_disparity_px, self.median_disparity_px, self.max_disparity_px) {
            (Some(min), Some(median), Some(max)) => format!("disparity {min:.2} to {max:.2} px, median {median:.2}"),
            _ => "no disparity known".to_owned(),
        };
        let depth = self.depth.as_ref().map(DepthSummary::words).unwrap_or_default();
        format!(
            "{width}x{height}, {method}, searched {min_disparity} to {last} px: {density:.2} % known, {range}{depth}, \
             {milliseconds:.1} ms\n"
        )
    }
}

impl DepthSummary {
    fn new(geometry: &Geometry, spread: Option<&Spread>) -> Self {
        let depth = |pick: fn(&Spread) -> f64| {
            let bits = (pick(spread?) * f64::from(1 << Disparity::FRAC_BITS)) as i16;
            geometry.depth_mm(Disparity::from_bits(bits))
        };
        Self {
            focal_px: geometry.focal_px,
            baseline_mm: geometry.baseline_mm,
            nearest_depth_mm: depth(|spread| spread.max_px),
            median_depth_mm: depth(|spread| spread.median_px),
            farthest_depth_mm: depth(|spread| spread.min_px),
        }
    }

    fn words(&self) -> String {
        let metres = |depth: Option<u32>| match depth {
            Some(mm) => format!("{:.3} m", f64::from(mm) / 1000.0),
            None => "infinity".to_owned(),
        };
        match self.nearest_depth_mm {
            Some(_) => format!(", depth {} to {}", metres(self.nearest_depth_mm), metres(self.farthest_depth_mm)),
            None => String::new(),
        }
    }
}
