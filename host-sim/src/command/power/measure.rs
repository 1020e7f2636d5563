//! `haarline power measure`: a recorded current in, power and energy by phase and by segment out.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};

use super::super::shared::{quoted, warn_input};
use super::super::{number, print};
use super::summary::{Given, Summary};
use crate::input::raw_dump::ViewSize;
use crate::output;
use crate::output::claims::Claims;
use crate::power::current_file::Setup;
use crate::power::measurement::Measurement;
use crate::power::page::{Named, page};
use crate::power::segments;
use crate::power::stages::Log;

/// So much lost time is told, of all.
const MOST_LOST: f64 = 0.01;

/// Arguments of `haarline power measure`.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct Args {
    /// The recording: a PPK2's export (Timestamp(ms),Current(uA),D0-D7,...), or a Joulescope's statistics
    /// (#time,current,voltage,...) or waveform (# time,<device>.current,...) as CSV; - is the standard input
    #[arg(value_name = "CURRENT.csv")]
    current: PathBuf,
    /// Supply, V, where the recording has no voltage, as a PPK2's
    #[arg(long, value_name = "V", allow_hyphen_values = true, value_parser = number)]
    volts: Option<f64>,
    /// Rows a second, where the recording has no times
    #[arg(long, value_name = "HZ", allow_hyphen_values = true, value_parser = number)]
    rate: Option<f64>,
    /// Digital inputs that the low and the high phase pin are wired to (00 idle, 01 capture, 11 compute, 10 send)
    #[arg(long, value_name = "LOW,HIGH", value_parser = pins, default_value = "0,1")]
    pins: Pins,
    /// Names of the segments, in the order of the program profile: the first whole segment of the recording has the first
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    segments: Vec<String>,
    /// Frames a second, for the energy of a frame
    #[arg(long, value_name = "F", allow_hyphen_values = true, value_parser = number, conflicts_with = "log")]
    fps: Option<f64>,
    /// Size of a frame, px, for the energy of a pixel
    #[arg(long, value_name = "WIDTHxHEIGHT", requires = "fps")]
    size: Option<ViewSize>,
    /// What the chip counted meanwhile, JSON: clock_hz, seconds, frames, width, height and stage_cycles; tells the energy of
    /// each stage: its cycles times the measured running power. Or the words that probe-rs read b32 prints from
    /// HAARLINE_MEASURED on
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// A recording of the idle board, whose power is taken off
    #[arg(long, value_name = "CURRENT.csv")]
    idle: Option<PathBuf>,
    /// A recording of the board with its sensors running and nothing computed, whose power is taken off
    #[arg(long, value_name = "CURRENT.csv")]
    sensors: Option<PathBuf>,
    /// A page with tables and plots
    #[arg(short, long = "output", value_name = "FILE.html")]
    output: Option<PathBuf>,
    /// Prints the summary as JSON
    #[arg(long)]
    json: bool,
}

/// Two digital inputs.
#[derive(Debug, Clone, Copy)]
struct Pins([usize; 2]);

fn pins(text: &str) -> Result<Pins, &'static str> {
    let pin = |text: &str| text.trim().parse::<usize>().ok().filter(|&pin| pin < 8);
    let both = text.split_once(',').and_then(|(low, high)| Some([pin(low)?, pin(high)?]));
    both.filter(|[low, high]| low != high).map(Pins).ok_or("must be two different inputs of 0 to 7, as 0,1")
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        self.check()?;
        let mut claims = Claims::new();
        claims.read([&self.current].into_iter().chain(&self.log).chain(&self.idle).chain(&self.sensors));
        self.output.as_ref().map_or(Ok(()), |path| claims.write("-o", path))?;
        let log = self.log.as_deref().map(Log::read).transpose()?;
        let measured = self.read(&self.current)?;
        let idle = self.idle.as_deref().map(|path| self.mean(path)).transpose()?;
        let sensors = self.sensors.as_deref().map(|path| self.mean(path)).transpose()?;
        let segments = self.named(segments::find(&measured.blocks));
        ensure!(
            self.segments.is_empty() || !segments.is_empty(),
            "--segments: none was found: the program must work for a second or more between sleeps of {} s or more",
            0.4
        );
        let size = self.size.map(|size| [size.width.into(), size.height.into()]);
        let given = Given { idle, sensors, fps: self.fps, size, log: log.as_ref() };
        let summary = Summary::new(&self.current, &measured, &segments, &given)?;
        if let Some(path) = &self.output {
            let title = format!("Power: {}", self.current.display());
            let made = page(&title, &self.command_line(), &measured, &segments, summary.tables())?;
            output::write(path, made.as_bytes())?;
        }
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.text() })?;
        self.warn(&measured);
        Ok(())
    }

    fn check(&self) -> Result<()> {
        let positive = [("--volts", self.volts, 60.0), ("--rate", self.rate, 1e7), ("--fps", self.fps, 1e4)];
        for (option, value, most) in positive {
            let is_right = value.is_none_or(|value| value > 0.0 && value <= most);
            ensure!(is_right, "{option} {}: must be more than 0, and {most} at most", value.unwrap_or_default());
        }
        let is_page = self.output.as_ref().is_none_or(|path| path.extension().is_some_and(|suffix| suffix == "html"));
        let name = self.output.as_deref().unwrap_or(Path::new("")).display();
        ensure!(is_page, "-o {name}: the name must end in .html");
        Ok(())
    }

    fn read(&self, path: &Path) -> Result<Measurement> {
        let name = path.display();
        ensure!(!path.is_dir(), "{name}: is a folder, where a recording of a current is expected");
        let from: Box<dyn Read> = if path == Path::new("-") {
            Box::new(io::stdin().lock())
        } else {
            Box::new(File::open(path).map_err(|error| anyhow!("{name}: cannot be read: {error}"))?)
        };
        let setup = Setup { volts: self.volts, rate: self.rate, pins: self.pins.0 };
        Measurement::read(from, &setup).with_context(|| name.to_string())
    }

    /// Mean power of another recording, W.
    fn mean(&self, path: &Path) -> Result<f64> {
        self.read(path)?.total.watts().with_context(|| path.display().to_string())
    }

    fn named(&self, segments: Vec<segments::Segment>) -> Vec<Named> {
        let name = |index: usize| self.segments.get(index % self.segments.len().max(1)).cloned();
        segments.into_iter().enumerate().map(|(index, segment)| (name(index), segment)).collect()
    }

    fn warn(&self, measured: &Measurement) {
        let name = self.current.display();
        if measured.is_cut {
            warn_input(&format!("{name}: its last row is cut off; what is whole was added up"));
        }
        let lost = measured.lost_seconds / (measured.lost_seconds + measured.total.seconds);
        if lost > MOST_LOST {
            warn_input(&format!("{name}: {:.1} % of its time was lost, of which no energy is told", 100.0 * lost));
        }
        if !measured.has_phases {
            let [low, high] = self.pins.0;
            warn_input(&format!(
                "{name}: has no columns of the digital inputs {low} and {high}, so energy by phase is not told: export them, \
                 or name others by --pins"
            ));
        }
    }

    fn command_line(&self) -> String {
        let word = |path: &Path| quoted(&path.to_string_lossy());
        let mut line = format!("haarline power measure {}", word(&self.current));
        let numbers = [("--volts", self.volts), ("--rate", self.rate), ("--fps", self.fps)];
        for (option, value) in numbers.into_iter().filter_map(|(option, value)| Some((option, value?))) {
            line += &format!(" {option} {value}");
        }
        if self.pins.0 != [0, 1] {
            line += &format!(" --pins {},{}", self.pins.0[0], self.pins.0[1]);
        }
        if !self.segments.is_empty() {
            line += &format!(" --segments {}", quoted(&self.segments.join(",")));
        }
        if let Some(size) = self.size {
            line += &format!(" --size {}x{}", size.width, size.height);
        }
        let files = [("--log", &self.log), ("--idle", &self.idle), ("--sensors", &self.sensors), ("-o", &self.output)];
        for (option, path) in files.into_iter().filter_map(|(option, path)| Some((option, path.as_deref()?))) {
            line += &format!(" {option} {}", word(path));
        }
        line
    }
}
