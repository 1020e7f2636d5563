//! `haarline depth`: a frame in, its disparities out.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use haarline::obstacle::MAX_SECTORS;
use haarline::{Config, Disparity};
use haarline_rig::Description;
use serde::Serialize;

use super::degradation::DegradationOptions;
use super::print;
use super::shared::{DepthOptions, FillArg, MethodOptions, MinConfidence, RangeArg, RigArg, SearchRange, warn_input};
use crate::output;
use crate::output::claims::Claims;
use crate::output::colour_range::ColourRange;
use crate::output::map_file::{MapKind, MapView};
use crate::output::obstacle_strip::ObstacleStrip;
use crate::score::degrade::replace_right;
use crate::stereo::disparity_map::{DisparityMap, Spread};
use crate::stereo::frame_check::FrameCheck;
use crate::stereo::method::MethodKind;
use crate::stereo::obstacles::{FrameObstacles, ObstacleFinder, ObstacleSummary};
use crate::stereo::pipeline::{self, Run};
use crate::{Geometry, StereoPair, input::rig_file};

/// Arguments of `haarline depth`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Left view: PNG, PGM, PPM, BMP, JPEG or TIFF, 8 or 16 bits, grey
    /// or colour (which becomes luma by Rec. 601, as in OpenCV)
    left: PathBuf,
    /// Right view, of the same size; matching points lie in the same row, further left
    right: PathBuf,
    #[command(flatten)]
    search: SearchRange,
    #[command(flatten)]
    method: MethodOptions,
    #[command(flatten)]
    depth: DepthOptions,
    #[command(flatten)]
    rig: RigArg,
    /// Distance to the nearest obstacle in each direction, cm; needs --rig
    #[arg(long, value_name = "FILE.csv", requires = "rig")]
    obstacles: Option<PathBuf>,
    /// Disparity file, any number of times: .pfm (px, float, unknown = +inf), .png (16 bits, disparity x
    /// 256, 0 = unknown), .npy (px, float32, unknown = NaN) or .ply (coloured points in m)
    #[arg(short, long = "output", value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Depth in mm, 16 bits, 0 = unknown or farther than 65.535 m; needs --focal-px and --baseline-mm, or --rig
    #[arg(long, value_name = "FILE.png")]
    depth_png: Option<PathBuf>,
    /// Picture in colours with a legend; unknown is a grey checkerboard
    #[arg(long, value_name = "FILE.png")]
    picture: Option<PathBuf>,
    /// Picture in grey, nearer = brighter: 1 to 255, unknown is 0
    #[arg(long, value_name = "FILE.png")]
    grey: Option<PathBuf>,
    #[command(flatten)]
    range: RangeArg,
    /// Confidence of each pixel, 0 to 255
    #[arg(long, value_name = "FILE.png")]
    confidence: Option<PathBuf>,
    #[command(flatten)]
    min_confidence: MinConfidence,
    #[command(flatten)]
    fill: FillArg,
    #[command(flatten)]
    degradation: DegradationOptions,
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
    #[serde(flatten)]
    check: FrameCheck,
    #[serde(flatten)]
    obstacles: Option<ObstacleSummary>,
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
        let pair = self.read_pair()?;
        let size = [pair.width(), pair.height()];
        let described = self.rig.description()?;
        let rig = self.depth.rig(&self.rig, described.as_ref(), &self.search, Some(size))?;
        let geometry = self.depth.geometry(rig.as_ref())?;
        let max_depth_m = self.depth.max_depth_m(geometry.as_ref())?;
        let method = self.method.get()?;
        let min_confidence = self.fill.least(&self.min_confidence, method.kind)?;
        let files = self.files()?;
        self.check_outputs(&files, geometry.is_some())?;
        let config = match described.as_ref().zip(rig.as_ref()) {
            Some((described, rig)) => {
                rig_file::check_shrunk_size(described, rig, self.depth.shrink, size)?;
                rig.config()
            }
            None => self.search.config(pair.width() as u16)?,
        };
        let rectification = rig.as_ref().map(Description::rectification).transpose()?.unwrap_or_default();
        let Run { mut map, elapsed, figures } =
            pipeline::run_rectified(&mut *method.build(config)?, &rectification, &pair)?;
        let (pair, rest) = pipeline::seen_views(&rectification, pair)?;
        let check = FrameCheck::told(figures, &pair, &rest, &map);
        map.drop_below(min_confidence);
        let obstacles = rig.as_ref().map(|rig| Found::new(rig, &map, &check)).transpose()?;
        if self.fill.fill {
            map.fill_holes();
        }
        let range = self.range.range.unwrap_or_else(|| ColourRange::of(&map));
        let strip = geometry.as_ref().zip(obstacles.as_ref()).map(|(geometry, found)| found.strip(geometry));
        let view = MapView {
            map: &map,
            left: &pair.left,
            geometry: geometry.as_ref(),
            max_depth_m,
            range: &range,
            obstacles: strip.as_ref(),
        };
        self.write(&files, &view, obstacles.as_ref())?;
        if let Some(advice) = check.input.advice() {
            warn_input(&format!("{}: {advice}", self.left.display()));
        }
        let milliseconds = elapsed.as_secs_f64() * 1000.0;
        let mut summary = Summary::new(&map, &config, method.kind, milliseconds, geometry.as_ref(), check);
        summary.obstacles = obstacles.map(|found| found.finder.summary(&found.frame));
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.line() })
    }

    /// The files that tell the map, with the options that ask for them.
    fn files(&self) -> Result<Vec<(&'static str, MapKind, &Path)>> {
        let maps = self.output.iter().map(|path| Ok(("-o", MapKind::of(path)?, path.as_path())));
        let mut files = maps.collect::<Result<Vec<_>>>()?;
        let pictures = [
            ("--depth-png", MapKind::Depth, &self.depth_png),
            ("--picture", MapKind::Picture, &self.picture),
            ("--grey", MapKind::Grey, &self.grey),
            ("--confidence", MapKind::Confidence, &self.confidence),
        ];
        for (option, kind, path) in pictures {
            if let Some(path) = path {
                output::check_png_name(option, path)?;
                files.push((option, kind, path));
            }
        }
        Ok(files)
    }

    /// The views as the method gets them. What is drawn is what eval draws of a scene: by the name of the folder.
    fn read_pair(&self) -> Result<StereoPair> {
        let degradation = self.degradation.get()?;
        let other = self.degradation.right_from(None)?;
        let mut pair = StereoPair::read_shrunk(&self.left, &self.right, self.depth.shrink)?;
        if let Some(other) = &other {
            replace_right(&mut pair, other);
        }
        let folder = self.left.canonicalize().ok().and_then(|path| Some(path.parent()?.file_name()?.to_owned()));
        degradation.apply(&folder.unwrap_or_default().to_string_lossy(), &mut pair);
        Ok(pair)
    }

    /// Checks every name that is to be written before anything is computed.
    fn check_outputs(&self, files: &[(&'static str, MapKind, &Path)], has_geometry: bool) -> Result<()> {
        for (option, kind, path) in files {
            ensure!(
                has_geometry || !kind.needs_geometry(),
                "{option} {}: needs --focal-px and --baseline-mm, or --rig, to tell metres",
                path.display()
            );
        }
        let mut claims = Claims::new();
        claims.read([&self.left, &self.right].into_iter().chain(self.rig.path()));
        claims.read(self.degradation.right_from_file());
        let table = self.obstacles.iter().map(|path| ("--obstacles", path.as_path()));
        let mut files = files.iter().map(|(option, _, path)| (*option, *path)).chain(table);
        files.try_for_each(|(option, path)| claims.write(option, path))
    }

    /// Writes every file, after the content of all is known.
    fn write(
        &self,
        files: &[(&'static str, MapKind, &Path)],
        view: &MapView<'_>,
        obstacles: Option<&Found>,
    ) -> Result<()> {
        let mut contents = Vec::new();
        for (option, kind, path) in files {
            let bytes = kind.encode(view).with_context(|| format!("{option} {}", path.display()))?;
            contents.push((*path, bytes));
        }
        if let (Some(path), Some(found)) = (&self.obstacles, obstacles) {
            contents.push((path, found.finder.encode_csv(std::slice::from_ref(&found.frame))?));
        }
        contents.iter().try_for_each(|(path, bytes)| output::write(path, bytes))
    }
}

/// The obstacles of the frame.
struct Found {
    finder: ObstacleFinder,
    frame: FrameObstacles,
}

impl Found {
    fn new(rig: &Description, map: &DisparityMap, check: &FrameCheck) -> Result<Self> {
        let mut finder = ObstacleFinder::new(rig)?;
        let frame = finder.find_checked(0, map, check);
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
        check: FrameCheck,
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
            check,
            obstacles: None,
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
        let obstacles = self.obstacles.as_ref().map(|summary| format!(", {}", summary.words())).unwrap_or_default();
        let check = self.check.words();
        format!(
            "{width}x{height}, {method}, searched {min_disparity} to {last} px: {density:.2} % known, {check}, {range}{depth}{obstacles}, \
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
