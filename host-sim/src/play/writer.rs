//! What a recording's maps are written as: frame by frame, so that a run that is killed leaves everything up to
//! its last frame.

use std::path::{Path, PathBuf};

use anyhow::Result;
use haarline::obstacle::MAX_SECTORS;
use rayon::prelude::*;
use serde::Serialize;

use super::FrameReport;
use crate::output::colour_range::{ColourRange, Spectrum};
use crate::output::growing::{GrowingFile, GrowingTable};
use crate::output::map_file::{MapKind, MapView};
use crate::output::obstacle_strip::ObstacleStrip;
use crate::stereo::obstacles::{FrameObstacles, MavlinkFeed, ObstacleFinder, ObstacleSummary};
use crate::{DisparityMap, Frame, Geometry, output};

/// A frame that was played, or could not be.
#[derive(Debug)]
pub struct Played {
    /// What its files' names begin with.
    pub name: String,
    /// What came of it.
    pub report: FrameReport,
    /// Its map, the left view and, with a rig, its nearest obstacles; none of a damaged frame.
    pub seen: Option<Seen>,
}

/// What there is to write of a frame.
#[derive(Debug)]
pub struct Seen {
    /// Its disparities.
    pub map: DisparityMap,
    /// The left view.
    pub left: Frame,
    /// With a rig, its obstacles.
    pub obstacles: Option<FrameObstacles>,
}

/// What is written of each frame.
#[derive(Debug, Clone)]
pub struct Files {
    /// Where it goes.
    pub folder: PathBuf,
    /// Which kinds of file.
    pub kinds: Vec<MapKind>,
    /// Focal length and baseline, for depths.
    pub geometry: Option<Geometry>,
    /// What is farther is in no file that tells depth, m.
    pub max_depth_m: Option<f64>,
    /// What the colours span, if it was told.
    pub range: Option<ColourRange>,
    /// Frames of the first second, which tell what the colours span if nothing else does.
    pub first_second: usize,
}

/// Writes the maps of a recording, `frames.csv` and, with a rig, `obstacles.csv`.
#[derive(Debug)]
pub struct FrameWriter {
    files: Files,
    colours: Colours,
    frames: GrowingTable,
    obstacles: Option<ObstacleWriter>,
}

/// What the colours span, as far as that is known.
#[derive(Debug)]
enum Colours {
    /// Fixed.
    Kept(ColourRange),
    /// Those of the frames so far, whose pictures are made once more when all of the first second came.
    Found { spectrum: Spectrum, frames: Vec<(String, Seen)> },
}

impl FrameWriter {
    /// A writer of nothing yet; the tables are begun anew.
    ///
    /// # Errors
    /// Names the file that cannot be written.
    pub fn begin(files: Files) -> Result<Self> {
        let frames = GrowingTable::create(&files.folder.join("frames.csv"))?;
        let found = || Colours::Found { spectrum: Spectrum::default(), frames: Vec::new() };
        let colours = files.range.map_or_else(found, Colours::Kept);
        Ok(Self { files, colours, frames, obstacles: None })
    }

    /// The same for frames with obstacles, which go into `obstacles.csv` and as MAVLink into `mavlink`.
    ///
    /// # Errors
    /// Names the file that cannot be written.
    pub fn with_obstacles(mut self, finder: &ObstacleFinder, mavlink: Option<&Path>) -> Result<Self> {
        let mut table = GrowingTable::create(&self.files.folder.join("obstacles.csv"))?;
        table.add_record(&finder.heads())?;
        let mavlink = mavlink.map(GrowingFile::create).transpose()?.map(|file| (file, finder.feed()));
        let (finder, totals) = (Box::new(finder.clone()), ObstacleTotals::default());
        self.obstacles = Some(ObstacleWriter { finder, table, mavlink, totals });
        Ok(self)
    }

    /// The obstacles so far; none without a rig.
    #[must_use]
    pub fn obstacles(&self) -> Option<ObstacleTotals> {
        self.obstacles.as_ref().map(|obstacles| obstacles.totals)
    }

    /// What it writes of each frame.
    #[must_use]
    pub const fn files(&self) -> &Files {
        &self.files
    }

    /// What the colours of the pictures span, once that is settled.
    #[must_use]
    pub fn range(&self) -> Option<ColourRange> {
        match &self.colours {
            Colours::Kept(range) => Some(*range),
            Colours::Found { .. } => None,
        }
    }

    /// Writes everything of a frame.
    ///
    /// # Errors
    /// Names the file that cannot be written.
    pub fn write(&mut self, played: Played) -> Result<()> {
        let Played { name, report, seen } = played;
        let found = seen.as_ref().and_then(|seen| seen.obstacles.clone());
        if let Some(seen) = seen {
            self.write_seen(name, seen)?;
        }
        if let Some(obstacles) = &mut self.obstacles {
            let none = || FrameObstacles::without_map(report.frame);
            obstacles.write(&found.unwrap_or_else(none))?;
        }
        self.frames.add(&report)
    }

    fn write_seen(&mut self, name: String, seen: Seen) -> Result<()> {
        let range = match &mut self.colours {
            Colours::Kept(range) => *range,
            Colours::Found { spectrum, .. } => {
                spectrum.add(&seen.map);
                spectrum.range()
            }
        };
        self.write_kinds(&name, &seen, &range, |_| true)?;
        if let Colours::Found { frames, .. } = &mut self.colours {
            // Of the view nothing is needed any more.
            frames.push((name, Seen { left: Frame::from_luma(0, 0, Vec::new()), ..seen }));
            if frames.len() >= self.files.first_second {
                self.finish()?;
            }
        }
        Ok(())
    }

    /// The recording ends: if that was before the first second was over, its pictures get their colours now.
    ///
    /// # Errors
    /// Names the file that cannot be written.
    pub fn finish(&mut self) -> Result<()> {
        let Colours::Found { spectrum, frames } = &mut self.colours else { return Ok(()) };
        let (range, frames) = (spectrum.range(), std::mem::take(frames));
        self.colours = Colours::Kept(range);
        frames.iter().try_for_each(|(name, seen)| self.write_kinds(name, seen, &range, MapKind::has_range))
    }

    fn write_kinds(&self, name: &str, seen: &Seen, range: &ColourRange, is_wanted: fn(MapKind) -> bool) -> Result<()> {
        let Files { folder, kinds, geometry, max_depth_m, .. } = &self.files;
        let setup = self.obstacles.as_ref().map(|obstacles| obstacles.finder.setup());
        let strip = setup.zip(geometry.as_ref()).map(|(setup, geometry)| ObstacleStrip::<MAX_SECTORS> {
            setup,
            geometry,
            nearest_mm: seen.obstacles.as_ref().map_or(&[], |found| &found.nearest_mm),
        });
        let view = MapView {
            map: &seen.map,
            left: &seen.left,
            geometry: geometry.as_ref(),
            max_depth_m: *max_depth_m,
            range,
            obstacles: strip.as_ref(),
        };
        kinds
            .par_iter()
            .filter(|kind| is_wanted(**kind))
            .try_for_each(|kind| output::write(&folder.join(format!("{name}{}", kind.ending())), &kind.encode(&view)?))
    }
}

#[derive(Debug)]
struct ObstacleWriter {
    finder: Box<ObstacleFinder>,
    table: GrowingTable,
    mavlink: Option<(GrowingFile, MavlinkFeed)>,
    totals: ObstacleTotals,
}

/// The obstacles of a recording in a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct ObstacleTotals {
    /// Frames in which an obstacle was measured. Of the others nothing is known.
    pub frames_with_obstacles: usize,
    /// The nearest of all.
    #[serde(flatten)]
    pub nearest: Option<ObstacleSummary>,
    /// The frame that has it.
    pub nearest_obstacle_frame: Option<usize>,
}

impl ObstacleWriter {
    fn write(&mut self, frame: &FrameObstacles) -> Result<()> {
        self.totals.add(frame.frame, self.finder.summary(frame));
        self.table.add_record(&frame.record(self.finder.setup().sectors.count))?;
        match &mut self.mavlink {
            Some((file, feed)) => file.add(&feed.next(frame)),
            None => Ok(()),
        }
    }
}

impl ObstacleTotals {
    fn add(&mut self, frame: usize, summary: ObstacleSummary) {
        let Some(mm) = summary.nearest_obstacle_mm else { return };
        self.frames_with_obstacles += 1;
        if self.nearest.and_then(|nearest| nearest.nearest_obstacle_mm).is_none_or(|nearest| mm < nearest) {
            (self.nearest, self.nearest_obstacle_frame) = (Some(summary), Some(frame));
        }
    }
}
