//! `haarline twin`: the firmware application on an emulated Cortex-M, every instruction counted.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use haarline::frame_figures::{FrameFigures, Input, Trust};
use haarline::wiring::{First, Kind};
use haarline::{Stage, Wiring};
use haarline_rig::Description;
use serde::Serialize;

use super::shared::{LayoutArgs, MinConfidence, RigArg, SearchRange, WiringArgs};
use super::{Finding, natural_number, number, print};
use crate::input::frame::Shrink;
use crate::input::raw_dump::{RawFormat, ViewSize};
use crate::input::recording::{Side, find_frames};
use crate::output;
use crate::output::claims::Claims;
use crate::power::plan::currents::Currents;
use crate::power::plan::full_load::FullLoad;
use crate::score::degrade::Degradation;
use crate::stereo::method::MethodKind;
use crate::stereo::obstacles::{FrameObstacles, ObstacleFinder};
use crate::twin::elf::{self, Memory};
use crate::twin::footage::Footage;
use crate::twin::machine::Machine;
use crate::twin::rows::decode;
use crate::twin::{Report, Request, obstacles};
use crate::{DisparityMap, Frame, StereoPair, input::rig_file, output::pfm, stereo::pipeline};

/// Bytes of results that are kept whole; of a longer run only the recording's first and last round are.
const MOST_KEPT: u64 = 256 << 20;

/// Width and height of random views, px.
const RANDOM_SIZE: [usize; 2] = [320, 240];

/// Arguments of `haarline twin`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Left view
    #[arg(required_unless_present_any = ["recording", "random"], requires = "right", conflicts_with_all = ["recording", "random"])]
    left: Option<PathBuf>,
    /// Right view
    right: Option<PathBuf>,
    /// Instead of a pair: folder with the folders left and right, or with images of both views
    /// (--layout side-by-side), or file with the bytes that a camera port stored (--raw)
    #[arg(long, value_name = "DIR")]
    recording: Option<PathBuf>,
    #[command(flatten)]
    layout: LayoutArgs,
    /// The recording is a raw dump, frame after frame without any header, which is played as it is; the
    /// size is that of one view, px
    #[arg(long, value_name = "WIDTHxHEIGHT", requires = "recording", conflicts_with_all = ["layout", "left_views"])]
    raw: Option<ViewSize>,
    /// Instead of a pair: two views of random bytes, 320 x 240 px, that have nothing in common
    #[arg(long, conflicts_with_all = ["recording", "noise", "rig"])]
    random: bool,
    /// Adds Gaussian noise to both views as eval does, if the views lie in the scene's folder: standard
    /// deviation, grey levels
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0, allow_hyphen_values = true, value_parser = number, conflicts_with = "raw")]
    noise: f64,
    /// Seed of the noise and of random views
    #[arg(long, value_name = "S", default_value_t = 0, allow_hyphen_values = true, value_parser = natural_number)]
    seed: u64,
    /// Frames to play; the recording begins again where it ends [default: each once]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    count: Option<u32>,
    /// Distance to the nearest obstacle in each direction of each frame, cm, as the chip found it; needs --rig
    #[arg(long, value_name = "FILE.csv", requires = "rig")]
    obstacles: Option<PathBuf>,
    #[command(flatten)]
    rig: RigArg,
    #[command(flatten)]
    search: SearchRange,
    /// How to match
    #[arg(long, value_enum, default_value_t = MethodKind::BEST)]
    method: MethodKind,
    /// The emulated machine [default: an386, or an505 where --elf is built for it]
    #[arg(long, value_enum)]
    machine: Option<Machine>,
    #[command(flatten)]
    wiring: WiringArgs,
    /// Lets something go wrong at the camera in a frame, counted from 0: lost-line, short, long, overrun,
    /// garbage, stall or burst
    #[arg(long, value_name = "KIND@FRAME", value_parser = fault)]
    fault: Option<String>,
    /// Disparity map in px (PFM); of several frames FILE_0000.pfm and so on
    #[arg(short, long = "output", value_name = "FILE.pfm")]
    output: Option<PathBuf>,
    #[command(flatten)]
    min_confidence: MinConfidence,
    /// The program, as `cargo twin` builds it in target/thumbv7em-none-eabihf/firmware/twin, for an505 `cargo twin-m33` in
    /// target/thumbv8m.main-none-eabihf/firmware/twin [default: that of the
    /// environment variable HAARLINE_TWIN, or built by cargo if this folder is in Haarline's sources]
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Seconds until the run is given up
    #[arg(long, value_name = "SECONDS", default_value_t = 600)]
    timeout: u64,
    /// Prints everything as JSON
    #[arg(long)]
    json: bool,
}

fn fault(text: &str) -> Result<String, &'static str> {
    const KINDS: [&str; 7] = ["lost-line", "short", "long", "overrun", "garbage", "stall", "burst"];
    let parts = text.split_once('@').filter(|(kind, frame)| KINDS.contains(kind) && frame.parse::<u32>().is_ok());
    let wanted = "must be KIND@FRAME with lost-line, short, long, overrun, garbage, stall or burst, as overrun@1";
    parts.map(|_| text.to_owned()).ok_or(wanted)
}

/// What the run tells.
#[derive(Debug, Serialize)]
struct Summary {
    method: &'static str,
    machine: &'static str,
    core: &'static str,
    width: usize,
    height: usize,
    min_disparity: i16,
    num_disparities: u16,
    noise: f64,
    seed: u64,
    /// Whether the views are random.
    random: bool,
    wiring: &'static str,
    first: &'static str,
    skew: &'static str,
    frames: u32,
    fault: Option<String>,
    /// `total` and one entry a stage.
    instructions_per_pixel: BTreeMap<&'static str, f64>,
    /// Instructions of a row that comes in: the mean, the most, and how many times the mean the most is.
    mean_row: f64,
    worst_row: u64,
    worst_row_ratio: f64,
    /// Instructions after a frame's last row, mean; and of how many rows that is the work.
    frame_end: f64,
    frame_end_rows: f64,
    /// Instructions of a change of stage, subtracted everywhere.
    clock_instructions: u64,
    estimates: Vec<FullLoad>,
    memory: Memory,
    stack_high_water: u64,
    startup_stack_high_water: u64,
    counters: BTreeMap<String, u64>,
    /// Frames compared with the host's, and those that differ, by number.
    compared: usize,
    different_frames: Vec<u32>,
    /// Frames whose obstacles were compared with the host's, and those that differ; none without a rig.
    obstacles_compared: Option<usize>,
    different_obstacles: Vec<u32>,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let min_confidence = self.min_confidence.get(Some(self.method))?;
        let described = self.rig.description()?;
        let fitted = |described| self.rig.fitted(described, &self.search, [None; 2], Shrink::NONE, None);
        let rig = described.as_ref().map(fitted).transpose()?;
        let footage = self.read(rig.as_ref())?;
        let ViewSize { width, height } = footage.format.size;
        let (width, height) = (usize::from(width), usize::from(height));
        let config = match &rig {
            Some(rig) => {
                rig_file::check_size(rig, [width, height])?;
                rig.config()
            }
            None => self.search.config(footage.format.size.width)?,
        };
        let plan = rig.as_ref().map(Description::plan).transpose()?;
        let recorded = u32::try_from(footage.pairs.len()).context("the recording")?;
        let frames = self.count.unwrap_or(recorded);
        let fits = u64::from(frames) * (width * height * 3) as u64 <= MOST_KEPT;
        let (method, wiring) = (self.method, footage.format.wiring);
        let keep = if fits { frames } else { recorded };
        let fault = self.fault.clone();
        let request = Request { config, height, recorded, frames, keep, method, wiring, fault, plan };
        request.check()?;
        self.claim(recorded.max(frames), rig.as_ref())?;

        let wanted = self.machine;
        let elf = self.elf.clone().map_or_else(|| elf::find(wanted.unwrap_or(Machine::An386)), Ok)?;
        let program = elf::read(&elf)?;
        let built = elf::machine(&program).with_context(|| elf.display().to_string())?;
        let machine = wanted.unwrap_or(built);
        ensure!(
            machine.target() == built.target(),
            "{} is built for {}, and the machine {} needs one for {}",
            elf.display(),
            built.target(),
            machine.name(),
            machine.target()
        );
        let memory = elf::memory(&program, method.name()).with_context(|| elf.display().to_string())?;
        let folder = tempfile::tempdir().context("a folder for the run")?;
        let file = |name: &str| folder.path().join(name);
        fs::write(file("twin.elf"), &program).context("a folder for the run")?;
        fs::write(file("raw.bin"), &footage.raw).context("a folder for the run")?;
        fs::write(file("tables.bin"), request.tables()).context("a folder for the run")?;
        machine.run(folder.path(), "twin.elf", &request.arguments(), Duration::from_secs(self.timeout))?;

        let report = Report::read(&file("report.txt"))?;
        let maps = decode(fs::read(file("rows.bin")).context("the program left no results")?, [width, height])?;
        self.write(&maps, min_confidence)?;
        let (expected, figures): (Vec<_>, Vec<_>) = self.expected(&footage.pairs, &request)?.into_iter().unzip();
        let different = different(&maps, &expected, &request);
        let mut summary = self.summary(machine, &request, &report, memory, maps.len(), different)?;
        if let Some(rig) = &rig {
            let text = fs::read_to_string(file("obstacles.txt")).context("the program left no obstacles")?;
            let found = obstacles::decode(&text)?;
            let mut finder = ObstacleFinder::new(rig)?;
            let frame = |frame: u32| (frame % recorded) as usize;
            // As on the chip: no sector is known while the views do not match.
            let mut trust = Trust::default();
            let mut find = |number: u32| {
                let found = finder.find(&expected[frame(number)]);
                let input = figures[frame(number)].map_or(Input::Ok, |figures| figures.input);
                if trust.take(input) { found } else { vec![None; found.len()] }
            };
            let expected: Vec<_> = (0..frames).map(&mut find).collect();
            summary.obstacles_compared = Some(found.len());
            let frames = (0..frames).filter(|&frame| found.get(&frame) != Some(&expected[frame as usize]));
            summary.different_obstacles = frames.collect();
            if let Some(path) = &self.obstacles {
                let frames = found.into_iter().map(|(frame, nearest_mm)| FrameObstacles {
                    frame: frame as usize,
                    nearest_mm,
                    free: Vec::new(),
                    is_trusted: true,
                    is_bent: false,
                });
                output::write(path, &finder.encode_csv(&frames.collect::<Vec<_>>())?)?;
            }
        }
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.text() })?;
        let damaged = request.damaged();
        let wrong: Vec<u32> = summary.different_frames.iter().copied().filter(|&f| Some(f) != damaged).collect();
        ensure!(wrong.is_empty(), Finding(format!("the map of frame {} is not the host's, byte for byte", wrong[0])));
        let wrong = summary.different_obstacles.iter().find(|&&frame| Some(frame) != damaged);
        ensure!(
            wrong.is_none(),
            Finding(format!("the obstacles of frame {} are not the host's", wrong.copied().unwrap_or_default()))
        );
        Ok(())
    }

    /// All frames, in order, as the port stores them.
    fn read(&self, rig: Option<&Description>) -> Result<Footage> {
        if let (Some(size), Some(file)) = (self.raw, &self.recording) {
            return Footage::read(file, RawFormat { size, wiring: self.wiring.get_with(rig)? });
        }
        let first = if self.wiring.first == Some(Side::Right) { First::Right } else { First::Left };
        let wiring = match rig {
            Some(_) => self.wiring.get_with(rig)?,
            None => self.wiring.get()?.unwrap_or(Wiring::new(Kind::SideBySide, first)),
        };
        let mut pairs = self.read_pairs(rig)?;
        let noise = self.noise;
        ensure!((0.0..=255.0).contains(&noise), "--noise {noise}: must be 0 to 255");
        let degradation = Degradation { noise, seed: self.seed, ..Degradation::default() };
        for (name, pair) in &mut pairs {
            degradation.apply(name, pair);
        }
        Footage::record(&pairs.into_iter().map(|(_, pair)| pair).collect::<Vec<_>>(), wiring)
    }

    /// All frames, with the names that tell their noise apart: that of the scene's folder or of the frame.
    fn read_pairs(&self, rig: Option<&Description>) -> Result<Vec<(String, StereoPair)>> {
        if self.random {
            return Ok(vec![(String::from("random"), random_views(self.seed))]);
        }
        if let (Some(left), Some(right)) = (&self.left, &self.right) {
            let pair = StereoPair::read(left, right)?;
            let path = left.canonicalize().with_context(|| left.display().to_string())?;
            let scene = path.parent().and_then(Path::file_name).unwrap_or_default();
            return Ok(vec![(scene.to_string_lossy().into_owned(), pair)]);
        }
        let Some(folder) = &self.recording else { bail!("two views are needed, or --recording") };
        find_frames(folder, self.layout.get(self.wiring.first_with(rig))?)?
            .into_iter()
            .map(|frame| Ok((frame.name.clone(), frame.read()?)))
            .collect()
    }

    /// No map of one of the first `frames` frames, nor the table, may be one of the files that are read.
    fn claim(&self, frames: u32, rig: Option<&Description>) -> Result<()> {
        let mut claims = Claims::new();
        claims.read(self.left.iter().chain(&self.right).chain(&self.elf).chain(self.rig.path()));
        match &self.recording {
            Some(file) if self.raw.is_some() => claims.read([file]),
            Some(folder) => {
                let frames = find_frames(folder, self.layout.get(self.wiring.first_with(rig))?)?;
                frames.iter().for_each(|frame| claims.read(frame.files()));
            }
            None => {}
        }
        if let Some(path) = &self.output {
            claims.write("-o", path)?;
            (0..frames)
                .skip(usize::from(frames == 1))
                .try_for_each(|frame| claims.write("-o", &numbered(path, frame)))?;
        }
        self.obstacles.as_ref().map_or(Ok(()), |path| claims.write("--obstacles", path))
    }

    fn write(&self, maps: &BTreeMap<u32, DisparityMap>, min_confidence: u8) -> Result<()> {
        let Some(path) = &self.output else { return Ok(()) };
        for (frame, map) in maps {
            let path = if maps.len() == 1 { path.clone() } else { numbered(path, *frame) };
            let mut map = map.clone();
            map.drop_below(min_confidence);
            output::write(&path, &pfm::encode(&map))?;
        }
        Ok(())
    }

    /// What the host makes of the recording: maps, and what the frames are worth.
    fn expected(&self, pairs: &[StereoPair], request: &Request) -> Result<Vec<(DisparityMap, Option<FrameFigures>)>> {
        let mut method = self.method.build(request.config)?;
        let rectification = request.plan.as_ref().map(|plan| plan.rectification).unwrap_or_default();
        let mut run = |pair| {
            let run = pipeline::run_rectified(&mut *method, &rectification, pair)?;
            Ok((run.map, run.figures))
        };
        pairs.iter().map(&mut run).collect()
    }

    fn summary(
        &self,
        machine: Machine,
        request: &Request,
        report: &Report,
        memory: Memory,
        compared: usize,
        different_frames: Vec<u32>,
    ) -> Result<Summary> {
        let width = usize::from(request.config.width);
        let rows = report.get("worked_rows")? as f64;
        let pixels = (rows * width as f64).max(1.0);
        let total = report.get("total")? as f64 / pixels;
        let mean_row = report.get("row_sum")? as f64 / rows.max(1.0);
        let frame_end = report.get("frame_ends")? as f64 / f64::from(request.frames);
        let mut instructions_per_pixel = BTreeMap::from([("total", total)]);
        for (stage, count) in report.stages()? {
            instructions_per_pixel.insert(stage.name(), count as f64 / pixels);
        }
        let frame_pixels = (width * request.height) as f64;
        Ok(Summary {
            method: request.method.name(),
            machine: machine.name(),
            core: machine.core(),
            width,
            height: request.height,
            min_disparity: request.config.min_disparity,
            num_disparities: request.config.num_disparities,
            noise: self.noise,
            seed: self.seed,
            random: self.random,
            wiring: request.wiring.kind.name(),
            first: request.wiring.first.name(),
            skew: request.wiring.skew.name(),
            frames: request.frames,
            fault: self.fault.clone(),
            instructions_per_pixel,
            mean_row,
            worst_row: report.get("worst_row")?,
            worst_row_ratio: report.get("worst_row")? as f64 / mean_row.max(1.0),
            frame_end,
            frame_end_rows: frame_end / mean_row.max(1.0),
            clock_instructions: report.get("clock")?,
            estimates: FullLoad::of_program(&Currents::own()?, machine.processor(), total, frame_pixels)?,
            memory,
            stack_high_water: report.get("stack")?,
            startup_stack_high_water: report.get("startup_stack")?,
            counters: report.counters().map(|(name, count)| (name.to_owned(), count)).collect(),
            compared,
            different_frames,
            obstacles_compared: None,
            different_obstacles: Vec::new(),
        })
    }
}

/// The frames whose maps are not the host's.
fn different(maps: &BTreeMap<u32, DisparityMap>, expected: &[DisparityMap], request: &Request) -> Vec<u32> {
    let Request { frames, keep, recorded, .. } = *request;
    let kept = (0..frames).filter(|&frame| frame < keep || frame >= frames.saturating_sub(keep));
    kept.filter(|frame| maps.get(frame) != Some(&expected[(frame % recorded) as usize])).collect()
}

/// Two views of random bytes.
fn random_views(seed: u64) -> StereoPair {
    let [width, height] = RANDOM_SIZE;
    let blank = Frame::from_luma(width, height, vec![0; width * height]);
    let mut pair = StereoPair { left: blank.clone(), right: blank };
    Degradation { random: true, seed, ..Degradation::default() }.apply("random", &mut pair);
    pair
}

/// The name for one of several maps.
fn numbered(path: &Path, frame: u32) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}_{frame:04}.pfm"))
}

impl Summary {
    fn text(&self) -> String {
        let Self { method, machine, core, width, height, num_disparities, min_disparity, frames, .. } = self;
        let last = i32::from(*min_disparity) + i32::from(*num_disparities) - 1;
        let mut text = format!(
            "{method}, {frames} x {width}x{height} px, searched {min_disparity} to {last} px, on {machine} ({core})\n"
        );
        let _ = writeln!(
            text,
            "executed instructions per pixel, counted (the clock's own {} a change of stage subtracted):",
            self.clock_instructions
        );
        for name in Stage::ALL.map(Stage::name).into_iter().chain(["total"]) {
            let count = self.instructions_per_pixel.get(name).copied().unwrap_or_default();
            let _ = writeln!(text, "  {name:12}{count:9.2}");
        }
        let _ = writeln!(
            text,
            "row: mean {:.0}, worst {} instructions, {:.2} x the mean; frame end {:.0}, {:.1} rows",
            self.mean_row, self.worst_row, self.worst_row_ratio, self.frame_end, self.frame_end_rows
        );
        let _ = writeln!(text, "estimated by a model of instruction classes (no cycle was measured):");
        for FullLoad { chip, cycles_per_pixel, fps, core_mw, nj_per_pixel, current_source } in &self.estimates {
            let _ = writeln!(
                text,
                "  {chip}: {cycles_per_pixel:.0} cycles/px, {fps:.1} fps, core {core_mw:.0} mW, {nj_per_pixel:.2} nJ/px ({current_source})"
            );
        }
        let Memory { static_ram, method_ram, ring_ram, flash, core_flash } = self.memory;
        let _ = writeln!(
            text,
            "memory: {method} {method_ram} B, rings {ring_ram} B, all static {static_ram} B (with the other methods); \
             stack at most {} B, at start-up {} B; flash {flash} B, of which the core {core_flash} B",
            self.stack_high_water, self.startup_stack_high_water
        );
        let counters: Vec<String> = self.counters.iter().map(|(name, count)| format!("{name} {count}")).collect();
        let _ = writeln!(text, "counters: {}", counters.join(", "));
        let verdict = |different: &[u32], same: &str| match different {
            [] => same.to_owned(),
            frames => format!("different from the host's: {frames:?}"),
        };
        let told = verdict(&self.different_frames, "all the same bytes as on the host");
        let _ = writeln!(text, "{} maps compared: {told}", self.compared);
        if let Some(compared) = self.obstacles_compared {
            let told = verdict(&self.different_obstacles, "all as on the host");
            let _ = writeln!(text, "obstacles of {compared} frames compared: {told}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_is_a_kind_and_a_frame() {
        assert_eq!(fault("overrun@12").as_deref(), Ok("overrun@12"));
        for text in ["overrun", "overrun@", "overrun@-1", "flood@1", "@1"] {
            assert!(fault(text).is_err(), "{text}");
        }
    }

    #[test]
    fn several_maps_have_numbers() {
        assert_eq!(numbered(Path::new("a/b.pfm"), 7), Path::new("a/b_0007.pfm"));
    }
}
