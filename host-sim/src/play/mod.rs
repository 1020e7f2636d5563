//! A recording through one instance of a method, frame after frame, into a folder.
//!
//! Three threads: one reads the next frames, this one matches, one writes what came of the last ones; what waits
//! between them is bounded, whatever the recording's length.

mod report;
pub mod source;
mod writer;

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use anyhow::{Result, ensure};
use haarline::frame_figures::Bend;
use haarline::{Config, Rectification, Rectified, StereoMethod};
use haarline_rig::Description;

pub use report::{FrameReport, Status, Totals};
pub use writer::{Files, FrameWriter, ObstacleTotals, Played, Seen};

use crate::input::recording::RecordedFrame;
use crate::input::{noise, rig_file};
use crate::stereo::frame_check::FrameCheck;
use crate::stereo::method::{Method, OwnMethod};
use crate::stereo::obstacles::{FrameObstacles, ObstacleFinder};
use crate::stereo::pipeline;
use crate::{DisparityMap, StereoPair};

/// Frames that may wait before and after the matching.
const WAITING: usize = 2;

/// A frame as it comes from a recording or a stream.
#[derive(Debug)]
pub struct Taken {
    /// Its place in the recording, from 0.
    pub index: usize,
    /// What its files' names begin with; no other frame has the same.
    pub name: String,
    /// Its file, that of the left view if there are two.
    pub file: String,
    /// Both views, or why there are none.
    pub views: Result<StereoPair>,
}

impl Taken {
    /// Reads a frame of a recording.
    #[must_use]
    pub fn of(frame: &RecordedFrame) -> Self {
        let RecordedFrame { index, name, file, .. } = frame;
        Self { index: *index, name: name.clone(), file: file.clone(), views: frame.read() }
    }

    /// Both views, if they have the size, with their noise.
    fn check(&mut self, size: [usize; 2]) -> Result<(StereoPair, Option<f64>)> {
        let pair = std::mem::replace(&mut self.views, Err(anyhow::anyhow!("taken")))?;
        ensure!(
            [pair.width(), pair.height()] == size,
            "{}: the views are {}x{} px, but those of the first frame are {}x{} px",
            self.file,
            pair.width(),
            pair.height(),
            size[0],
            size[1]
        );
        let noise = noise::estimate(&pair);
        Ok((pair, noise))
    }

    /// What is told of it where it cannot be played.
    #[must_use]
    pub fn damaged(self, error: &anyhow::Error) -> Played {
        Played { report: FrameReport::damaged(&self, error), name: self.name, seen: None }
    }
}

/// A frame that was read.
type Read = (Taken, Result<(StereoPair, Option<f64>)>);

/// A method that looks through a rig's rectification, and watches whether the rig bends.
type Behind = Rectified<OwnMethod, { pipeline::RECTIFY_ROWS }, { Config::MAX_WIDTH as usize }>;

/// Plays frames of one size.
pub struct Player {
    method: Box<Behind>,
    height: usize,
    min_confidence: u8,
    fills: bool,
    bend: Bend,
    rig: Option<(Rectification, ObstacleFinder)>,
}

/// Puts a method behind a rectification.
fn behind(method: OwnMethod, height: usize, rectification: Rectification) -> Result<Box<Behind>> {
    Ok(Box::new(Behind::new(method, u16::try_from(height).unwrap_or(u16::MAX), rectification)?))
}

impl Player {
    /// A player for frames of `height` rows; pixels of less than `min_confidence` become unknown.
    ///
    /// # Errors
    /// If the method refuses the configuration.
    pub fn new(method: impl Into<Method>, config: Config, height: usize, min_confidence: u8) -> Result<Self> {
        let method = behind(OwnMethod(method.into().build(config)?), height, Rectification::default())?;
        Ok(Self { method, height, min_confidence, fills: false, bend: Bend::default(), rig: None })
    }

    /// The same, whose maps have their holes filled after the obstacles were looked for, or not.
    #[must_use]
    pub fn filling(self, fills: bool) -> Self {
        Self { fills, ..self }
    }

    /// The same for frames of that rig: takes its offsets away, and looks for obstacles, and for sectors that are free
    /// up to a distance if one is told, mm.
    ///
    /// # Errors
    /// If the frames have another size than the rig's, or its fields do not go together.
    pub fn with_rig(mut self, rig: &Description, free_beyond_mm: Option<u32>) -> Result<Self> {
        rig_file::check_size(rig, [self.method.config().width.into(), self.height])?;
        let finder = match free_beyond_mm {
            Some(mm) => ObstacleFinder::with_free_beyond(rig, mm)?,
            None => ObstacleFinder::new(rig)?,
        };
        let rectification = rig.rectification()?;
        let Self { method, height, .. } = self;
        self.method = behind(method.into_method(), height, rectification)?;
        self.rig = Some((rectification, finder));
        Ok(self)
    }

    /// Who finds the obstacles; none without a rig.
    #[must_use]
    pub fn obstacles(&self) -> Option<&ObstacleFinder> {
        self.rig.as_ref().map(|(_, finder)| finder)
    }

    /// Plays `frames` in their order into `writer`; `done` is called after each was written. A damaged frame is
    /// told and skipped.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn play(
        &mut self,
        frames: impl Iterator<Item = Taken> + Send,
        writer: &mut FrameWriter,
        mut done: impl FnMut(&FrameReport) + Send,
    ) -> Result<()> {
        let size = [usize::from(self.method.config().width), self.height];
        let (to_match, taken) = sync_channel(WAITING);
        let (to_write, played) = sync_channel::<Played>(WAITING);
        thread::scope(|scope| {
            scope.spawn(move || read(frames, size, &to_match));
            let writing = scope.spawn(move || {
                for played in played {
                    let report = played.report.clone();
                    writer.write(played)?;
                    done(&report);
                }
                writer.finish()
            });
            let matched = self.match_all(taken, &to_write);
            drop(to_write);
            let written = writing.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            // Where the writer gave up, the matching only stopped.
            written.and(matched)
        })
    }

    /// Matches one frame after the other, until there is none or nobody to take them.
    fn match_all(&mut self, taken: Receiver<Read>, to_write: &SyncSender<Played>) -> Result<()> {
        for (taken, views) in taken {
            let played = match views {
                Ok((pair, noise)) => self.match_one(taken, pair, noise)?,
                Err(error) => taken.damaged(&error),
            };
            if to_write.send(played).is_err() {
                break;
            }
        }
        Ok(())
    }

    fn match_one(&mut self, taken: Taken, pair: StereoPair, noise: Option<f64>) -> Result<Played> {
        let rectification = self.rig.as_ref().map_or_else(Rectification::default, |(rectification, _)| *rectification);
        let mut run = pipeline::run(&mut *self.method, &pair)?;
        let is_bent = self.bend.take(run.figures);
        let (pair, rest) = pipeline::seen_views(&rectification, pair)?;
        let check = FrameCheck::told(run.figures, &pair, &rest, &run.map);
        run.map.drop_below(self.min_confidence);
        let obstacles = self
            .rig
            .as_mut()
            .map(|(_, finder)| finder.find_checked(taken.index, &run.map, &check))
            .map(|found| FrameObstacles { is_bent, ..found });
        if self.fills {
            run.map.fill_holes();
        }
        let report = FrameReport::played(&taken, &run, noise, &check, is_bent);
        let map: DisparityMap = run.map;
        Ok(Played { name: taken.name, report, seen: Some(Seen { map, left: pair.left, obstacles }) })
    }
}

/// Reads one frame after the other, until there is none or nobody to take them.
fn read(frames: impl Iterator<Item = Taken>, size: [usize; 2], to_match: &SyncSender<Read>) {
    for mut taken in frames {
        let views = taken.check(size);
        if to_match.send((taken, views)).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MethodKind;
    use crate::input::recording::{Layout, Side, find_frames};
    use crate::output::encode_grey_png;
    use crate::output::map_file::MapKind;
    use std::fs;
    use std::path::Path;

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

    fn play(frames: &[RecordedFrame], height: usize, out: &Path) -> Vec<FrameReport> {
        let config = Config { width: 64, min_disparity: 0, num_disparities: 16 };
        let mut player = Player::new(MethodKind::Lite, config, height, 0).unwrap();
        let kinds = vec![MapKind::Disparity, MapKind::Picture];
        let (folder, first_second) = (out.to_owned(), 10);
        let files = Files { folder, kinds, geometry: None, max_depth_m: None, range: None, first_second };
        let mut writer = FrameWriter::begin(files).unwrap();
        let mut reports = Vec::new();
        player.play(frames.iter().map(Taken::of), &mut writer, |report| reports.push(report.clone())).unwrap();
        reports
    }

    #[test]
    fn a_damaged_frame_is_reported_and_the_others_are_played_alike() {
        let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let frames = record(folder.path());
        let reports = play(&frames, 24, out.path());
        assert_eq!(reports.len(), 3);
        assert_eq!([0, 1, 2].map(|i| reports[i].is_ok()), [true, false, true]);
        assert_eq!((reports[0].pixels, reports[0].rows), (Some(64 * 24), Some(24)));
        let file = |name: &str| fs::read(out.path().join(name));
        assert_eq!(file("a.pfm").unwrap(), file("c.pfm").unwrap());
        assert_eq!(file("a_picture.png").unwrap(), file("c_picture.png").unwrap());
        assert!(file("b, cut.pfm").is_err());

        let csv = String::from_utf8(file("frames.csv").unwrap()).unwrap();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines.len(), 4);
        assert_eq!(
            lines[0],
            "frame,file,status,density,median_disparity_px,noise,pixels,answered,rows,rows_unknown,milliseconds,input,mismatch_percent,share_sure,row_error_px,error"
        );
        assert!(lines[1].starts_with("0,a.png,ok,") && lines[1].ends_with(','), "{}", lines[1]);
        assert!(lines[2].starts_with("1,\"b, cut.png\",damaged,,,,,,,,,,,,,"), "{}", lines[2]);
    }

    #[test]
    fn another_size_is_damage() {
        let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let reports = play(&record(folder.path()), 25, out.path());
        assert!(reports.iter().all(|report| !report.is_ok()));
        assert!(reports[2].error.as_ref().unwrap().contains("64x24 px"), "{:?}", reports[2].error);
        assert_eq!(fs::read_dir(out.path()).unwrap().count(), 1, "the table alone");
    }

    #[test]
    fn what_cannot_be_written_ends_the_playing() {
        let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let frames = record(folder.path());
        fs::create_dir_all(out.path().join("a.pfm")).unwrap();
        let config = Config { width: 64, min_disparity: 0, num_disparities: 16 };
        let mut player = Player::new(MethodKind::Lite, config, 24, 0).unwrap();
        let (folder, kinds) = (out.path().to_owned(), vec![MapKind::Disparity]);
        let files = Files { folder, kinds, geometry: None, max_depth_m: None, range: None, first_second: 1 };
        let mut writer = FrameWriter::begin(files).unwrap();
        let endless = frames.iter().cycle().map(Taken::of);
        let error = player.play(endless, &mut writer, |_| ()).unwrap_err().to_string();
        assert!(error.contains("a.pfm"), "{error}");
    }
}
