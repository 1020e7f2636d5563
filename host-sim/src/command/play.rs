//! `haarline play`: a whole recording in, its disparities out, frame by frame.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use haarline::Config;
use haarline_rig::Description;
use serde::Serialize;

use super::shared::{
    LayoutKind, MethodOptions, MinConfidence, RigArg, SearchRange, WiringArgs, layout, progress, warn_skipped,
};
use super::{Finding, print, whole_number};
use crate::input::raw_dump::{RawFormat, ViewSize};
use crate::input::recording::{FrameRange, RecordedFrame, find_frames, find_raw_frames};
use crate::input::rig_file;
use crate::output;
use crate::play::{FrameReport, Player, encode_csv, report_damaged};

/// Arguments of `haarline play`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Folder with the folders left and right, whose images belong together by name, or in their order
    /// where no name is in both; or folder of images with both views (--layout side-by-side); or a file
    /// with the bytes a camera port stored (--raw)
    recording: PathBuf,
    /// Where everything goes: <frame>.pfm, <frame>_picture.png (the same colours in all of them: the
    /// searched range), frames.csv; with --rig obstacles.csv, the nearest obstacle in each direction, cm
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
    /// How the views are stored
    #[arg(long, value_enum, default_value_t = LayoutKind::Auto, conflicts_with = "raw")]
    layout: LayoutKind,
    /// The recording is a raw dump, frame after frame without any header; the size is that of one view,
    /// px, whatever the wiring (a frame has twice as many bytes as a view has pixels)
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    raw: Option<ViewSize>,
    #[command(flatten)]
    wiring: WiringArgs,
    #[command(flatten)]
    search: SearchRange,
    #[command(flatten)]
    method: MethodOptions,
    #[command(flatten)]
    rig: RigArg,
    /// Writes what a board would send to an autopilot: MAVLink 2, HEARTBEAT each second and OBSTACLE_DISTANCE of
    /// each frame, as if they came at the rig's frame rate; needs --rig
    #[arg(long, value_name = "FILE", requires = "rig")]
    mavlink: Option<PathBuf>,
    /// Only these frames, counted from 0 in the order of their names: A..B without B, A.. or ..B
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// Only every K-th of them
    #[arg(long, value_name = "K", default_value_t = 1, allow_hyphen_values = true, value_parser = whole_number)]
    every: i64,
    #[command(flatten)]
    min_confidence: MinConfidence,
    /// Prints the summary as JSON
    #[arg(long)]
    json: bool,
}

/// What is told about a recording.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    recording: &'a Path,
    folder: &'a Path,
    method: &'static str,
    width: Option<u16>,
    height: Option<usize>,
    min_disparity: Option<i16>,
    num_disparities: Option<u16>,
    recorded: usize,
    frames: usize,
    damaged: usize,
    mean_density: Option<f64>,
    median_disparity_px: Option<f64>,
    mean_noise: Option<f64>,
    mean_milliseconds: Option<f64>,
    damaged_frames: Vec<&'a FrameReport>,
    #[serde(skip)]
    has_rig: bool,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let (method, min_confidence) = (self.method.get()?, self.min_confidence.get()?);
        // Whatever the width will be.
        self.search.config(Config::MAX_WIDTH)?;
        let step = usize::try_from(self.every).ok().filter(|&step| step > 0);
        let step = step.with_context(|| format!("--every {}: must be 1 or more", self.every))?;
        let rig = self.rig.read(&self.search, [None; 2])?;
        let frames = self.find_frames(rig.as_ref())?;
        let recorded = frames.len();
        let range = self.frames.unwrap_or_default();
        let frames = range.choose(frames, step);
        ensure!(
            !frames.is_empty(),
            "--frames {range}: the recording has {recorded} frames only, counted from 0: the last one is {}",
            recorded - 1
        );
        // The first frame that can be read tells the size of all.
        let size = frames.iter().find_map(|frame| frame.read().ok()).map(|pair| (pair.width() as u16, pair.height()));
        let format = match size {
            Some((width, height)) => {
                if let Some(rig) = &rig {
                    rig_file::check_size(rig, [width.into(), height])?;
                }
                let config = rig.as_ref().map_or_else(|| self.search.config(width), |rig| Ok(rig.config()))?;
                Some((config, height))
            }
            None => None,
        };
        self.check_output()?;
        let reports = match format {
            Some((config, height)) => {
                let mut player = Player::new(method, config, height, min_confidence, &self.output)?;
                if let Some(rig) = &rig {
                    player = player.with_rig(rig)?;
                }
                let reports = play(&mut player, &frames)?;
                self.write_obstacles(&player)?;
                reports
            }
            None => report_damaged(&frames).into_iter().inspect(warn).collect(),
        };
        output::write(&self.output.join("frames.csv"), &encode_csv(&reports)?)?;
        let summary = self.summary(&reports, recorded, format);
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.text() })?;
        let damaged = summary.damaged;
        ensure!(damaged == 0, Finding(format!("{damaged} of {} were damaged and skipped", count(reports.len()))));
        Ok(())
    }

    fn write_obstacles(&self, player: &Player<'_>) -> Result<()> {
        let Some((finder, frames)) = player.obstacles() else { return Ok(()) };
        output::write(&self.output.join("obstacles.csv"), &finder.encode_csv(frames)?)?;
        if let Some(path) = &self.mavlink {
            output::write(path, &finder.encode_mavlink(frames))?;
        }
        Ok(())
    }

    fn find_frames(&self, rig: Option<&Description>) -> Result<Vec<RecordedFrame>> {
        if let Some(size) = self.raw {
            if let Some(rig) = rig {
                rig_file::check_size(rig, [size.width.into(), size.height.into()])?;
            }
            let wiring = self.wiring.get_with(rig)?;
            return find_raw_frames(&self.recording, RawFormat { size, wiring });
        }
        ensure!(self.wiring.get()?.is_none(), "--wiring: is for raw dumps, add --raw WIDTHxHEIGHT");
        find_frames(&self.recording, layout(self.layout, self.wiring.first, "--first")?)
    }

    /// Refuses to write among the frames: pictures would be frames of the next run, and a list of the
    /// recording might have the name of ours.
    fn check_output(&self) -> Result<()> {
        let folders = ["", "left", "right"].map(|name| self.recording.join(name));
        for folder in folders {
            ensure!(
                !output::is_same_file(&folder, &self.output),
                "-o {}: is a folder of the recording, give another one",
                self.output.display()
            );
        }
        if let Some(path) = &self.mavlink {
            output::check_writable("--mavlink", path)?;
            ensure!(
                !output::is_same_file(path, &self.recording),
                "--mavlink {}: is the recording, give another name",
                path.display()
            );
        }
        output::prepare_folder("-o", &self.output)
    }

    fn summary<'a>(
        &'a self,
        reports: &'a [FrameReport],
        recorded: usize,
        format: Option<(Config, usize)>,
    ) -> Summary<'a> {
        let of = |figure: fn(&FrameReport) -> Option<f64>| reports.iter().filter_map(figure).collect::<Vec<f64>>();
        let damaged_frames: Vec<&FrameReport> = reports.iter().filter(|report| !report.is_ok()).collect();
        let config = format.map(|(config, _)| config);
        Summary {
            recording: &self.recording,
            folder: &self.output,
            method: self.method.name(),
            width: config.map(|config| config.width),
            height: format.map(|(_, height)| height),
            min_disparity: config.map(|config| config.min_disparity),
            num_disparities: config.map(|config| config.num_disparities),
            recorded,
            frames: reports.len(),
            damaged: damaged_frames.len(),
            mean_density: mean(&of(|report| report.density)),
            median_disparity_px: median(of(|report| report.median_disparity_px)),
            mean_noise: mean(&of(|report| report.noise)),
            mean_milliseconds: mean(&of(|report| report.milliseconds)),
            damaged_frames,
            has_rig: self.rig.is_given() && config.is_some(),
        }
    }
}

/// Plays with a progress bar; each damaged frame is told as it comes.
fn play(player: &mut Player<'_>, frames: &[RecordedFrame]) -> Result<Vec<FrameReport>> {
    let bar = progress(frames.len(), "frames")?;
    let reports = player.play(frames, |report| {
        if !report.is_ok() {
            bar.suspend(|| warn(report));
        }
        bar.inc(1);
    });
    bar.finish_and_clear();
    reports
}

fn warn(report: &FrameReport) {
    warn_skipped(report.frame, report.error.as_deref().unwrap_or("damaged"));
}

impl Summary<'_> {
    fn text(&self) -> String {
        let mut text = format!("{}, {}", self.method, count(self.frames));
        if let (Some(width), Some(height)) = (self.width, self.height) {
            let _ = write!(text, " of {width}x{height} px");
        }
        if let (Some(min), Some(num)) = (self.min_disparity, self.num_disparities) {
            let _ = write!(text, ", searched {min} to {} px", i32::from(min) + i32::from(num) - 1);
        }
        if let (Some(density), Some(milliseconds)) = (self.mean_density, self.mean_milliseconds) {
            let _ = write!(text, ": {density:.2} % known, {milliseconds:.1} ms a frame");
        }
        if let Some(median) = self.median_disparity_px {
            let _ = write!(text, ", median disparity {median:.2} px");
        }
        if let Some(noise) = self.mean_noise {
            let _ = write!(text, ", noise {noise:.1} grey levels");
        }
        let folder = self.folder.display();
        let obstacles = if self.has_rig { ", obstacles.csv" } else { "" };
        text + &format!("\nin {folder}: <frame>.pfm, <frame>_picture.png, frames.csv{obstacles}\n")
    }
}

fn count(frames: usize) -> String {
    if frames == 1 { "1 frame".to_owned() } else { format!("{frames} frames") }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The lower median.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len().checked_sub(1)? / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_medians_of_nothing_are_none() {
        assert_eq!((mean(&[]), median(vec![])), (None, None));
        assert_eq!((mean(&[1.0, 2.0]), median(vec![3.0, 1.0, 2.0, 9.0])), (Some(1.5), Some(2.0)));
    }
}
