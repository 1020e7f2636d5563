//! A recording through one instance of a method, frame after frame, into a folder.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use haarline::obstacle::MAX_SECTORS;
use haarline::{Config, Offset, StereoMethod};
use haarline_rig::Description;
use rayon::prelude::*;
use serde::{Serialize, Serializer};

use crate::input::recording::RecordedFrame;
use crate::output::obstacle_strip::ObstacleStrip;
use crate::output::picture::{self, ColourRange};
use crate::stereo::method::Method;
use crate::stereo::obstacles::{FrameObstacles, ObstacleFinder};
use crate::stereo::pipeline::{self, Run};
use crate::{DisparityMap, Geometry, StereoPair, input::noise, input::rig_file, output};

/// So many frames are read at once, and so many results written; in between they are matched one after
/// the other.
const BATCH: usize = 16;

/// What came of a frame: a row of `frames.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrameReport {
    /// Its place in the recording, from 0.
    pub frame: usize,
    /// Its file, that of the left view if there are two.
    pub file: String,
    /// Whether it could be played.
    pub status: Status,
    /// Share of the pixels with a disparity, percent.
    #[serde(serialize_with = "rounded")]
    pub density: Option<f64>,
    /// The lower median of the disparities, px.
    #[serde(serialize_with = "rounded")]
    pub median_disparity_px: Option<f64>,
    /// Noise of the views ([`noise::estimate`]), grey levels.
    #[serde(serialize_with = "rounded")]
    pub noise: Option<f64>,
    /// Pixels of the left view.
    pub pixels: Option<usize>,
    /// Those with a disparity.
    pub answered: Option<usize>,
    /// Rows that the method delivered.
    pub rows: Option<usize>,
    /// Those without a disparity.
    pub rows_unknown: Option<usize>,
    /// Time in the method.
    #[serde(serialize_with = "rounded")]
    pub milliseconds: Option<f64>,
    /// Why it could not be played.
    pub error: Option<String>,
}

/// Whether a frame could be played.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// It was.
    Ok,
    /// It cannot be read, or has another size than the first one that can.
    Damaged,
}

/// To three digits: what is beyond says nothing.
fn rounded<S: Serializer>(value: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    value.map(|value| (value * 1000.0).round() / 1000.0).serialize(serializer)
}

impl FrameReport {
    fn damaged(frame: &RecordedFrame, error: &anyhow::Error) -> Self {
        let words = format!("{error:#}");
        Self {
            frame: frame.index,
            file: frame.file.clone(),
            status: Status::Damaged,
            density: None,
            median_disparity_px: None,
            noise: None,
            pixels: None,
            answered: None,
            rows: None,
            rows_unknown: None,
            milliseconds: None,
            error: Some(words.split_whitespace().collect::<Vec<_>>().join(" ")),
        }
    }

    fn played(frame: &RecordedFrame, Run { map, elapsed }: &Run, noise: Option<f64>) -> Self {
        let is_unknown = |row: &&[haarline::Disparity]| !row.iter().any(|disparity| disparity.is_known());
        Self {
            frame: frame.index,
            file: frame.file.clone(),
            status: Status::Ok,
            density: Some(map.density()),
            median_disparity_px: map.spread().map(|spread| spread.median_px),
            noise,
            pixels: Some(map.disparity.len()),
            answered: Some(map.known().count()),
            rows: Some(map.height),
            rows_unknown: Some(map.disparity.chunks(map.width).filter(is_unknown).count()),
            milliseconds: Some(elapsed.as_secs_f64() * 1000.0),
            error: None,
        }
    }

    /// Whether it could be played.
    #[must_use]
    pub fn is_ok(&self) -> bool {
        self.status == Status::Ok
    }
}

/// The rig that a recording was taken with.
#[derive(Debug)]
struct RigView {
    offset: Offset,
    geometry: Geometry,
    finder: ObstacleFinder,
    obstacles: Vec<FrameObstacles>,
}

/// Plays frames of one size.
pub struct Player<'a> {
    method: Box<dyn StereoMethod + Send>,
    height: usize,
    range: ColourRange,
    min_confidence: u8,
    folder: &'a Path,
    rig: Option<RigView>,
}

impl<'a> Player<'a> {
    /// A player for frames of `height` rows that writes into `folder`; pixels of less than
    /// `min_confidence` become unknown.
    ///
    /// # Errors
    /// If the method refuses the configuration.
    pub fn new(
        method: impl Into<Method>,
        config: Config,
        height: usize,
        min_confidence: u8,
        folder: &'a Path,
    ) -> Result<Self> {
        // The same colours for all frames, so that the pictures compare.
        let range = ColourRange::of_search(&config);
        Ok(Self { method: method.into().build(config)?, height, range, min_confidence, folder, rig: None })
    }

    /// The same for frames of that rig: takes its offsets away, and looks for obstacles.
    ///
    /// # Errors
    /// If the frames have another size than the rig's, or its fields do not go together.
    pub fn with_rig(mut self, rig: &Description) -> Result<Self> {
        rig_file::check_size(rig, [self.method.config().width.into(), self.height])?;
        let (geometry, finder) = (Geometry::new(rig.focal_px, rig.baseline_mm)?, ObstacleFinder::new(rig)?);
        self.rig = Some(RigView { offset: rig.offset, geometry, finder, obstacles: Vec::new() });
        Ok(self)
    }

    /// The obstacles of the frames played so far, and who found them; none without a rig.
    #[must_use]
    pub fn obstacles(&self) -> Option<(&ObstacleFinder, &[FrameObstacles])> {
        self.rig.as_ref().map(|rig| (&rig.finder, &rig.obstacles[..]))
    }

    /// Plays `frames` in their order and writes `<name>.pfm` and `<name>_picture.png` of each; `done`
    /// is called after each. A damaged frame is skipped.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn play(&mut self, frames: &[RecordedFrame], mut done: impl FnMut(&FrameReport)) -> Result<Vec<FrameReport>> {
        let mut reports = Vec::with_capacity(frames.len());
        for batch in frames.chunks(BATCH) {
            let size = [usize::from(self.method.config().width), self.height];
            let views: Vec<Result<(StereoPair, Option<f64>)>> =
                batch.par_iter().map(|frame| read(frame, size)).collect();
            let mut maps = Vec::with_capacity(batch.len());
            for (frame, views) in batch.iter().zip(views) {
                let report = match views {
                    Ok((pair, noise)) => {
                        let offset = self.rig.as_ref().map_or_else(Offset::default, |rig| rig.offset);
                        let mut run = pipeline::run_paired(&mut *self.method, offset, &pair)?;
                        run.map.drop_below(self.min_confidence);
                        let report = FrameReport::played(frame, &run, noise);
                        let nearest_mm = self.rig.as_mut().map(|rig| rig.look(frame, &run.map));
                        maps.push((frame, run.map, nearest_mm));
                        report
                    }
                    Err(error) => {
                        if let Some(rig) = &mut self.rig {
                            rig.obstacles.push(FrameObstacles { frame: frame.index, nearest_mm: Vec::new() });
                        }
                        FrameReport::damaged(frame, &error)
                    }
                };
                done(&report);
                reports.push(report);
            }
            let (folder, range, rig) = (self.folder, &self.range, self.rig.as_ref());
            maps.par_iter().try_for_each(|(frame, map, nearest_mm)| {
                let strip = rig.zip(nearest_mm.as_deref()).map(|(rig, nearest_mm)| rig.strip(nearest_mm));
                write_map(folder, range, frame, map, strip.as_ref())
            })?;
        }
        Ok(reports)
    }
}

impl RigView {
    /// Looks for obstacles in a map, and notes them.
    fn look(&mut self, frame: &RecordedFrame, map: &DisparityMap) -> Vec<Option<u32>> {
        let nearest_mm = self.finder.find(map);
        self.obstacles.push(FrameObstacles { frame: frame.index, nearest_mm: nearest_mm.clone() });
        nearest_mm
    }

    fn strip<'a>(&'a self, nearest_mm: &'a [Option<u32>]) -> ObstacleStrip<'a, MAX_SECTORS> {
        ObstacleStrip { setup: self.finder.setup(), geometry: &self.geometry, nearest_mm }
    }
}

/// Both views of a frame, if they have the size, and their noise.
fn read(frame: &RecordedFrame, size: [usize; 2]) -> Result<(StereoPair, Option<f64>)> {
    let pair = frame.read()?;
    ensure!(
        [pair.width(), pair.height()] == size,
        "{}: the views are {}x{} px, but those of the first frame are {}x{} px",
        frame.file,
        pair.width(),
        pair.height(),
        size[0],
        size[1]
    );
    let noise = noise::estimate(&pair);
    Ok((pair, noise))
}

fn write_map(
    folder: &Path,
    range: &ColourRange,
    frame: &RecordedFrame,
    map: &DisparityMap,
    strip: Option<&ObstacleStrip<'_, MAX_SECTORS>>,
) -> Result<()> {
    let file = |suffix: &str| folder.join(format!("{}{suffix}", frame.name));
    output::write(&file(".pfm"), &output::pfm::encode(map))?;
    let picture = match strip {
        Some(strip) => picture::encode_with_obstacles(map, range, strip)?,
        None => picture::encode(map, range, None)?,
    };
    output::write(&file("_picture.png"), &picture)
}

/// The reports of frames that cannot be read, where no frame of the recording can.
#[must_use]
pub fn report_damaged(frames: &[RecordedFrame]) -> Vec<FrameReport> {
    let report = |frame: &RecordedFrame| match frame.read() {
        Ok(_) => FrameReport::damaged(frame, &anyhow::anyhow!("{}: could not be read at first", frame.file)),
        Err(error) => FrameReport::damaged(frame, &error),
    };
    frames.par_iter().map(report).collect()
}

/// The content of `frames.csv`.
///
/// # Errors
/// Never for reports of frames.
pub fn encode_csv(reports: &[FrameReport]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for report in reports {
        writer.serialize(report)?;
    }
    writer.into_inner().context("frames.csv")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MethodKind;
    use crate::input::recording::{Layout, Side, find_frames};
    use crate::output::encode_grey_png;
    use std::fs;

    /// A recording of three frames of noise shifted by 3 px, the middle one cut off.
    fn record(folder: &Path) -> Vec<RecordedFrame> {
        let value = |x: usize, y: usize| (x * x * 31 + y * y * 17 + x * y * 7) as u8;
        let pixel = |i: usize| if i % 128 < 64 { value(i % 128, i / 128) } else { value(i % 128 - 61, i / 128) };
        let png = encode_grey_png(&(0..128 * 24).map(pixel).collect::<Vec<_>>(), [128, 24]).unwrap();
        for name in ["a.png", "c.png"] {
            fs::write(folder.join(name), &png).unwrap();
        }
        fs::write(folder.join("b, cut.png"), &png[..png.len() / 2]).unwrap();
        find_frames(folder, Layout::SideBySide { first: Side::Left }).unwrap()
    }

    #[test]
    fn a_damaged_frame_is_reported_and_the_others_are_played_alike() {
        let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let frames = record(folder.path());
        let config = Config { width: 64, min_disparity: 0, num_disparities: 16 };
        let mut player = Player::new(MethodKind::Lite, config, 24, 0, out.path()).unwrap();
        let mut seen = 0;
        let reports = player.play(&frames, |_| seen += 1).unwrap();
        assert_eq!((seen, reports.len()), (3, 3));
        assert_eq!([0, 1, 2].map(|i| reports[i].is_ok()), [true, false, true]);
        assert_eq!((reports[0].pixels, reports[0].rows), (Some(64 * 24), Some(24)));
        let file = |name: &str| fs::read(out.path().join(name));
        assert_eq!(file("a.pfm").unwrap(), file("c.pfm").unwrap());
        assert!(file("c_picture.png").is_ok() && file("b, cut.pfm").is_err());

        let csv = String::from_utf8(encode_csv(&reports).unwrap()).unwrap();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines.len(), 4);
        assert_eq!(
            lines[0],
            "frame,file,status,density,median_disparity_px,noise,pixels,answered,rows,rows_unknown,milliseconds,error"
        );
        assert!(lines[1].starts_with("0,a.png,ok,") && lines[1].ends_with(','), "{}", lines[1]);
        assert!(lines[2].starts_with("1,\"b, cut.png\",damaged,,,,,,,,,"), "{}", lines[2]);
    }

    #[test]
    fn another_size_is_damage() {
        let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let frames = record(folder.path());
        let config = Config { width: 64, min_disparity: 0, num_disparities: 16 };
        let mut player = Player::new(MethodKind::Lite, config, 25, 0, out.path()).unwrap();
        let reports = player.play(&frames, |_| ()).unwrap();
        assert!(reports.iter().all(|report| !report.is_ok()));
        assert!(reports[2].error.as_ref().unwrap().contains("64x24 px"), "{:?}", reports[2].error);
        assert_eq!(fs::read_dir(out.path()).unwrap().count(), 0);
    }
}
