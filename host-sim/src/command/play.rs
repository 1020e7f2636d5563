//! `haarline play`: a whole recording in, its disparities out, frame by frame.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use clap::ValueEnum;
use haarline::Config;
use haarline_rig::Description;
use haarline_telemetry::LEAST_FRAMES_IN_10_S;
use serde::Serialize;

use super::shared::{
    DepthOptions, FillArg, LayoutArgs, MethodOptions, MinConfidence, RangeArg, RigArg, SearchRange, WiringArgs,
    bent_words, progress, warn_input, warn_skipped,
};
use super::{Finding, number, print, whole_number};
use crate::input::raw_dump::{RawFormat, ViewSize};
use crate::input::raw_stream::RawStream;
use crate::input::recording::{FrameRange, find_frames, find_raw_frames};
use crate::input::rig_file;
use crate::output::claims::Claims;
use crate::output::map_file::MapKind;
use crate::play::source::Source;
use crate::play::{Files, FrameReport, FrameWriter, ObstacleTotals, Player, Taken, Totals};
use crate::stereo::frame_check::Input;

/// Frames that the colours are taken from where no rig tells how many come in a second.
const FIRST_SECOND: usize = 10;
/// The most frames that wait for their colours.
const MOST_HELD: usize = 30;

/// Arguments of `haarline play`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Folder with images of both cameras, in folders left and right or as datasets have them, which belong
    /// together by name, number or time; or of images with both views (--layout side-by-side, top-bottom); or
    /// an MCAP file with two topics of images (in a build with the feature mcap); or a file with the bytes a camera port stored (--raw), or - for a stream of these without end, as from ffmpeg
    recording: PathBuf,
    /// Where everything goes, frame by frame: <frame>.pfm, <frame>_picture.png, frames.csv; with --rig
    /// obstacles.csv, the nearest obstacle in each direction, cm
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
    /// What is written of each frame
    #[arg(long, value_enum, value_name = "KIND,...", value_delimiter = ',', default_value = "disparity,picture")]
    write: Vec<MapKind>,
    #[command(flatten)]
    layout: LayoutArgs,
    /// The recording is a raw dump, frame after frame without any header; the size is that of one view,
    /// px, whatever the wiring (a frame has twice as many bytes as a view has pixels)
    #[arg(long, value_name = "WIDTHxHEIGHT", conflicts_with_all = ["layout", "left_views"])]
    raw: Option<ViewSize>,
    #[command(flatten)]
    wiring: WiringArgs,
    #[command(flatten)]
    search: SearchRange,
    #[command(flatten)]
    method: MethodOptions,
    #[command(flatten)]
    rig: RigArg,
    #[command(flatten)]
    depth: DepthOptions,
    #[command(flatten)]
    range: RangeArg,
    /// Writes what a board would send to an autopilot: MAVLink 2, HEARTBEAT each second and OBSTACLE_DISTANCE of
    /// each frame, as if they came at the rig's frame rate; needs --rig
    #[arg(long, value_name = "FILE", requires = "rig")]
    mavlink: Option<PathBuf>,
    /// In these messages a sector may be told to be free: one in which nothing is found, and of whose pixels 80 % are
    /// sure and lie beyond so many m; farther obstacles are not told then. Without it no sector ever is
    #[arg(long, value_name = "M", requires = "mavlink", value_parser = number)]
    free_beyond: Option<f64>,
    /// Only these frames, counted from 0 in the order of their names: A..B without B, A.. or ..B
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// Only every K-th of them
    #[arg(long, value_name = "K", default_value_t = 1, allow_hyphen_values = true, value_parser = whole_number)]
    every: i64,
    #[command(flatten)]
    min_confidence: MinConfidence,
    #[command(flatten)]
    fill: FillArg,
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
    mean_share_sure: Option<f64>,
    mean_mismatch_percent: Option<f64>,
    /// Frames that are no two views of one scene, by what they are.
    wrong_input: &'a BTreeMap<Input, usize>,
    input_ok: bool,
    mean_milliseconds: Option<f64>,
    damaged_frames: &'a [FrameReport],
    /// What the colours of the pictures span, px.
    colours_px: Option<[f64; 2]>,
    #[serde(skip)]
    colours_from: String,
    #[serde(flatten)]
    obstacles: Option<ObstacleTotals>,
    #[serde(skip)]
    files: String,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let method = self.method.get()?;
        let min_confidence = self.fill.least(&self.min_confidence, method.kind)?;
        // Whatever the width will be.
        self.search.config(Config::MAX_WIDTH)?;
        let step = usize::try_from(self.every).ok().filter(|&step| step > 0);
        let step = step.with_context(|| format!("--every {}: must be 1 or more", self.every))?;
        let described = self.rig.description()?;
        let mut source = self.source(described.as_ref())?;
        let claims = self.claims(&source);
        let recorded = source.choose(self.frames.unwrap_or_default(), step)?;
        let size = source.size(self.depth.shrink);
        let sides = size.map(|(width, height)| [width.into(), height]);
        let rig = self.depth.rig(&self.rig, described.as_ref(), &self.search, sides)?;
        let free_beyond_mm = self.free_beyond_mm()?;
        if let (Some(rig), Some(_)) = (&rig, &self.mavlink) {
            warn_of_pace(rig.frame_rate_hz);
        }
        let files = self.files(rig.as_ref())?;
        let format = match size {
            Some((width, height)) => {
                if let Some((described, rig)) = described.as_ref().zip(rig.as_ref()) {
                    rig_file::check_shrunk_size(described, rig, self.depth.shrink, [width.into(), height])?;
                }
                let config = rig.as_ref().map_or_else(|| self.search.config(width), |rig| Ok(rig.config()))?;
                Some((config, height))
            }
            None => None,
        };
        self.check_output(claims, &files.kinds)?;
        let mut writer = FrameWriter::begin(files)?;
        let mut totals = Totals::default();
        match format {
            Some((config, height)) => {
                let mut player = Player::new(method, config, height, min_confidence)?.filling(self.fill.fill);
                if let Some(rig) = &rig {
                    player = player.with_rig(rig, free_beyond_mm)?;
                }
                if let Some(finder) = player.obstacles() {
                    writer = writer.with_obstacles(finder, self.mavlink.as_deref())?;
                }
                play(&mut player, source, &mut writer, &mut totals)?;
            }
            None => source.taken().try_for_each(|taken| write_damaged(taken, &mut writer, &mut totals))?,
        }
        ensure!(totals.frames > 0, "{}: ended before there was one frame", self.recording.display());
        let summary = self.summary(&totals, &writer, recorded.unwrap_or(totals.frames), format);
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.text() })?;
        warn_bent(&totals);
        warn_wrong_input(&totals);
        let damaged = totals.damaged;
        ensure!(damaged == 0, Finding(format!("{damaged} of {} were damaged and skipped", count(totals.frames))));
        Ok(())
    }

    fn free_beyond_mm(&self) -> Result<Option<u32>> {
        let Some(metres) = self.free_beyond else { return Ok(None) };
        ensure!((0.1..=600.0).contains(&metres), "--free-beyond {metres}: must be 0.1 to 600 m");
        Ok(Some((metres * 1000.0) as u32))
    }

    /// What is written of each frame.
    fn files(&self, rig: Option<&Description>) -> Result<Files> {
        let geometry = self.depth.geometry(rig)?;
        let max_depth_m = self.depth.max_depth_m(geometry.as_ref())?;
        let mut kinds: Vec<MapKind> = Vec::new();
        for &kind in &self.write {
            let name = kind.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default();
            ensure!(
                geometry.is_some() || !kind.needs_geometry(),
                "--write {name}: needs --focal-px and --baseline-mm, or --rig, to tell metres"
            );
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        // A second of what a board would see; without a rig no one tells how many frames that is.
        let first_second = rig.map_or(Ok(FIRST_SECOND), |rig| rig.plan().map(|plan| plan.frame_rate_hz.into()))?;
        let first_second = usize::clamp(first_second, 1, MOST_HELD);
        let range = self.range.range;
        Ok(Files { folder: self.output.clone(), kinds, geometry, max_depth_m, range, first_second })
    }

    fn source(&self, rig: Option<&Description>) -> Result<Source> {
        let shrink = self.depth.shrink;
        let Some(size) = self.raw else {
            ensure!(self.wiring.get()?.is_none(), "--wiring: is for raw dumps, add --raw WIDTHxHEIGHT");
            ensure!(
                !RawStream::is_one(&self.recording),
                "a stream has no sizes in it: add --raw WIDTHxHEIGHT and --wiring"
            );
            ensure!(
                self.layout.layout.has_both() || self.wiring.first.is_none(),
                "--first: is for frames with both views, add --layout side-by-side or top-bottom"
            );
            let frames = find_frames(&self.recording, self.layout.get(self.wiring.first_with(rig))?)?;
            return Ok(Source::recorded(frames, shrink));
        };
        let format = RawFormat { size, wiring: self.wiring.get_with(rig)? };
        if RawStream::is_one(&self.recording) {
            return Source::stream(&self.recording, format, shrink);
        }
        Ok(Source::recorded(find_raw_frames(&self.recording, format)?, shrink))
    }

    /// All that is read.
    fn claims(&self, source: &Source) -> Claims<'static> {
        let mut claims = Claims::new();
        claims.read(self.rig.path());
        claims.read_recording(&self.recording, source.files());
        claims
    }

    /// Refuses to replace what is read, and to write among the frames: pictures would be frames of the next
    /// run.
    fn check_output(&self, mut claims: Claims<'_>, kinds: &[MapKind]) -> Result<()> {
        self.mavlink.as_ref().map_or(Ok(()), |path| claims.write("--mavlink", path))?;
        let endings: Vec<String> = kinds.iter().map(|kind| kind.ending().to_owned()).collect();
        let is_ours = move |name: &str| {
            ["frames.csv", "obstacles.csv"].contains(&name) || endings.iter().any(|ending| name.ends_with(ending))
        };
        claims.write_in("-o", &self.output, is_ours)
    }

    fn summary<'a>(
        &'a self,
        totals: &'a Totals,
        writer: &FrameWriter,
        recorded: usize,
        format: Option<(Config, usize)>,
    ) -> Summary<'a> {
        let config = format.map(|(config, _)| config);
        let endings = writer.files().kinds.iter().map(|kind| format!("<frame>{}", kind.ending()));
        let tables = ["frames.csv", "obstacles.csv"].into_iter().take(1 + usize::from(writer.obstacles().is_some()));
        let has_colours = totals.damaged < totals.frames && writer.files().kinds.iter().any(|kind| kind.has_range());
        Summary {
            recording: &self.recording,
            folder: &self.output,
            method: self.method.name(),
            width: config.map(|config| config.width),
            height: format.map(|(_, height)| height),
            min_disparity: config.map(|config| config.min_disparity),
            num_disparities: config.map(|config| config.num_disparities),
            recorded,
            frames: totals.frames,
            damaged: totals.damaged,
            mean_density: totals.mean_density(),
            median_disparity_px: totals.median_disparity_px(),
            mean_noise: totals.mean_noise(),
            mean_share_sure: totals.mean_share_sure(),
            mean_mismatch_percent: totals.mean_mismatch_percent(),
            wrong_input: &totals.wrong_input,
            input_ok: totals.wrong_input.is_empty(),
            mean_milliseconds: totals.mean_milliseconds(),
            damaged_frames: &totals.damaged_frames,
            colours_px: writer.range().filter(|_| has_colours).map(|range| [range.min_px, range.max_px]),
            colours_from: match self.range.range {
                Some(_) => "--range".to_owned(),
                None => match writer.files().first_second.min(totals.frames - totals.damaged) {
                    1 => "the first frame".to_owned(),
                    frames => format!("the first {frames} frames"),
                },
            },
            obstacles: writer.obstacles(),
            files: endings.chain(tables.map(str::to_owned)).collect::<Vec<_>>().join(", "),
        }
    }
}

/// Plays with a progress bar; each damaged frame is told as it comes.
fn play(player: &mut Player, source: Source, writer: &mut FrameWriter, totals: &mut Totals) -> Result<()> {
    let bar = progress(source.known_length().unwrap_or(0), "frames")?;
    let done = |report: &FrameReport| {
        if !report.is_ok() {
            bar.suspend(|| warn(report));
        }
        totals.add(report);
        bar.inc(1);
    };
    let played = player.play(source.taken(), writer, done);
    bar.finish_and_clear();
    played
}

/// Of a recording of which no frame can be read.
fn write_damaged(mut taken: Taken, writer: &mut FrameWriter, totals: &mut Totals) -> Result<()> {
    let views = std::mem::replace(&mut taken.views, Err(anyhow!("it was read")));
    let error = views.err().unwrap_or_else(|| anyhow!("{}: could not be read at first", taken.file));
    let played = taken.damaged(&error);
    warn(&played.report);
    totals.add(&played.report);
    writer.write(played)
}

/// Autopilots forget what they are not told again in time.
fn warn_of_pace(frame_rate_hz: u16) {
    if 10 * frame_rate_hz < LEAST_FRAMES_IN_10_S {
        warn_input(&format!(
            "frame_rate_hz = {frame_rate_hz}: autopilots forget a distance after 0.5 s, let the rig take 3 frames a \
             second or more"
        ));
    }
}

/// One warning for the whole recording: that its rig has bent.
fn warn_bent(totals: &Totals) {
    if let Some(error) = totals.row_error_px.filter(|_| totals.bent > 0) {
        let all = count(totals.frames - totals.damaged);
        warn_input(&format!("{} of {all}: {}; frames.csv tells which", totals.bent, bent_words(error)));
    }
}

/// One warning for the whole recording: what most of the wrong frames are.
fn warn_wrong_input(totals: &Totals) {
    let most = totals.wrong_input.iter().max_by_key(|(_, count)| **count);
    let Some((frames, advice)) = most.and_then(|(input, frames)| Some((frames, input.advice()?))) else { return };
    let all = count(totals.frames - totals.damaged);
    warn_input(&format!("{frames} of {all}: {advice}; frames.csv tells which, and while it lasts no obstacle is told"));
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
        if let (Some(sure), Some(mismatch)) = (self.mean_share_sure, self.mean_mismatch_percent) {
            let _ = write!(text, ", {sure:.1} % sure, mismatch {mismatch:.0} %");
        }
        if let Some(obstacles) = &self.obstacles {
            let _ = match (&obstacles.nearest, obstacles.nearest_obstacle_frame) {
                (Some(nearest), Some(frame)) => write!(
                    text,
                    "\nobstacles in {}, {} in frame {frame}",
                    count(obstacles.frames_with_obstacles),
                    nearest.words()
                ),
                _ => write!(text, "\nno obstacle measured"),
            };
        }
        if let Some([min, max]) = self.colours_px {
            let _ = write!(text, "\ncolours span {min} to {max} px in all pictures, from {}", self.colours_from);
        }
        text + &format!("\nin {}: {}\n", self.folder.display(), self.files)
    }
}

fn count(frames: usize) -> String {
    if frames == 1 { "1 frame".to_owned() } else { format!("{frames} frames") }
}
