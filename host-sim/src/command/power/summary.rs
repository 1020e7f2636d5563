//! What is told of a measurement.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::Serialize;

use crate::power::measurement::{Measurement, Tally};
use crate::power::page::Named;
use crate::power::phase::Phase;
use crate::power::segments::Segment;
use crate::power::stages::{Log, StageEnergy};
use crate::study::Table;

/// What the energy of the stages rests on.
const STAGES_REST_ON: &str =
    "cycles of the chip's counter times the measured running power; the meter sees no single stage";

/// What was told beside the recording.
pub(super) struct Given<'a> {
    /// Mean power of the idle board, W.
    pub(super) idle: Option<f64>,
    /// The same with its sensors running.
    pub(super) sensors: Option<f64>,
    pub(super) fps: Option<f64>,
    pub(super) size: Option<[u32; 2]>,
    pub(super) log: Option<&'a Log>,
}

#[derive(Debug, Serialize)]
pub(super) struct Summary {
    file: PathBuf,
    kind: &'static str,
    samples: u64,
    seconds: f64,
    shared_samples: f64,
    gaps: u64,
    lost_seconds: f64,
    is_cut: bool,
    mean_mw: f64,
    peak_mw: f64,
    mj: f64,
    phases: Option<Vec<PhaseLine>>,
    /// Time in which the pins told none.
    untold_seconds: Option<f64>,
    segments: Vec<SegmentLine>,
    /// Segments of one name together.
    methods: Vec<MethodLine>,
    idle_mw: Option<f64>,
    above_idle_mw: Option<f64>,
    sensors_mw: Option<f64>,
    above_sensors_mw: Option<f64>,
    frames_per_second: Option<f64>,
    mj_per_frame: Option<f64>,
    nj_per_pixel: Option<f64>,
    running_mw: Option<f64>,
    stages: Option<Vec<StageEnergy>>,
    stages_rest_on: Option<&'static str>,
}

#[derive(Debug, Serialize)]
struct PhaseLine {
    phase: Phase,
    seconds: f64,
    share_percent: f64,
    mean_mw: Option<f64>,
    peak_mw: f64,
    mj: f64,
}

#[derive(Debug, Serialize)]
struct SegmentLine {
    name: Option<String>,
    begin_s: f64,
    seconds: f64,
    mean_mw: f64,
    mj: f64,
}

#[derive(Debug, Serialize)]
struct MethodLine {
    name: String,
    segments: usize,
    mean_mw: f64,
    mj_per_segment: f64,
}

impl Summary {
    pub(super) fn new(file: &Path, measured: &Measurement, segments: &[Named], given: &Given<'_>) -> Result<Self> {
        let watts = measured.total.watts().context("nothing was measured")?;
        let fps = given.fps.or(given.log.map(Log::frames_per_second));
        let pixels = given.size.or(given.log.map(|log| [log.width, log.height]));
        let pixels = pixels.map(|[width, height]| f64::from(width) * f64::from(height));
        let running = given.log.map(|log| Ok::<_, anyhow::Error>((log, running(measured)?))).transpose()?;
        Ok(Self {
            file: file.to_owned(),
            kind: measured.kind.name(),
            samples: measured.samples,
            seconds: measured.total.seconds,
            shared_samples: measured.shared,
            gaps: measured.gaps,
            lost_seconds: measured.lost_seconds,
            is_cut: measured.is_cut,
            mean_mw: 1e3 * watts,
            peak_mw: 1e3 * measured.total.peak_watts,
            mj: 1e3 * measured.total.joules,
            phases: measured.has_phases.then(|| Phase::ALL.map(|phase| PhaseLine::new(phase, measured)).into()),
            untold_seconds: measured.has_phases.then_some(measured.untold.seconds),
            segments: segments.iter().map(SegmentLine::new).collect(),
            methods: methods(segments),
            idle_mw: given.idle.map(|idle| 1e3 * idle),
            above_idle_mw: given.idle.map(|idle| 1e3 * (watts - idle)),
            sensors_mw: given.sensors.map(|sensors| 1e3 * sensors),
            above_sensors_mw: given.sensors.map(|sensors| 1e3 * (watts - sensors)),
            frames_per_second: fps,
            mj_per_frame: fps.map(|fps| 1e3 * watts / fps),
            nj_per_pixel: fps.zip(pixels).map(|(fps, pixels)| 1e9 * watts / fps / pixels),
            running_mw: running.map(|(_, watts)| 1e3 * watts),
            stages: running.map(|(log, watts)| log.energies(watts)),
            stages_rest_on: running.map(|_| STAGES_REST_ON),
        })
    }

    pub(super) fn text(&self) -> String {
        let Self { kind, samples, seconds, mean_mw, peak_mw, mj, .. } = self;
        let mut text = format!(
            "{kind}, {samples} samples, {seconds:.3} s: mean {mean_mw:.3} mW, peak {peak_mw:.3} mW, {mj:.3} mJ\n"
        );
        if self.gaps > 0 || self.shared_samples > 0.0 {
            let _ = writeln!(
                text,
                "lost: {} single samples, which their neighbours share, and {} gaps of {:.3} s in all",
                self.shared_samples, self.gaps, self.lost_seconds
            );
        }
        for (what, off, above) in
            [("idle", self.idle_mw, self.above_idle_mw), ("with sensors", self.sensors_mw, self.above_sensors_mw)]
        {
            if let (Some(off), Some(above)) = (off, above) {
                let _ = writeln!(text, "{what} {off:.3} mW, above that {above:.3} mW");
            }
        }
        if let (Some(fps), Some(energy)) = (self.frames_per_second, self.mj_per_frame) {
            let pixel = self.nj_per_pixel.map(|energy| format!(", a pixel {energy:.2} nJ")).unwrap_or_default();
            let _ = writeln!(text, "a frame of {fps:.3} a second takes {energy:.4} mJ{pixel}");
        }
        for table in self.tables() {
            let _ = writeln!(text, "\n{}", table.caption);
            let widths: Vec<usize> = (0..table.columns.len())
                .map(|column| {
                    let cells = table.rows.iter().map(|row| &row[column]).chain([&table.columns[column]]);
                    cells.map(|cell| cell.chars().count()).max().unwrap_or_default()
                })
                .collect();
            for row in std::iter::once(&table.columns).chain(&table.rows) {
                let cell = |(at, (cell, width)): (usize, (&String, &usize))| {
                    if at == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
                };
                let cells: Vec<String> = row.iter().zip(&widths).enumerate().map(cell).collect();
                let _ = writeln!(text, "  {}", cells.join("  ").trim_end());
            }
        }
        text
    }

    /// All figures that come in rows.
    pub(super) fn tables(&self) -> Vec<Table> {
        let table = |name: &str, caption: &str, columns: &[&str], rows: Vec<Vec<String>>| Table {
            name: name.to_owned(),
            caption: caption.to_owned(),
            columns: columns.iter().map(|&column| column.to_owned()).collect(),
            rows,
        };
        let mut tables = Vec::new();
        if let Some(phases) = &self.phases {
            let row = |line: &PhaseLine| {
                let mean = line.mean_mw.map_or_else(|| "-".to_owned(), |mean| format!("{mean:.3}"));
                let numbers = [line.seconds, line.share_percent].map(|number| format!("{number:.3}"));
                let energy = [line.peak_mw, line.mj].map(|number| format!("{number:.3}"));
                [vec![line.phase.name().to_owned()], numbers.to_vec(), vec![mean], energy.to_vec()].concat()
            };
            let caption = format!(
                "By phase, as the pins tell; {:.3} s are told by none (a pin was not read, or changed within a sample).",
                self.untold_seconds.unwrap_or_default()
            );
            let columns = ["phase", "time, s", "of all, %", "mean, mW", "peak, mW", "energy, mJ"];
            tables.push(table("phases", &caption, &columns, phases.iter().map(row).collect()));
        }
        if !self.methods.is_empty() {
            let row = |line: &MethodLine| {
                let numbers = [line.mean_mw, line.mj_per_segment].map(|number| format!("{number:.3}"));
                vec![line.name.clone(), line.segments.to_string(), numbers[0].clone(), numbers[1].clone()]
            };
            let columns = ["name", "segments", "mean, mW", "energy of one, mJ"];
            tables.push(table("methods", "Segments of one name.", &columns, self.methods.iter().map(row).collect()));
        } else if !self.segments.is_empty() {
            let row = |(index, line): (usize, &SegmentLine)| {
                let numbers = [line.begin_s, line.seconds, line.mean_mw, line.mj].map(|number| format!("{number:.3}"));
                [vec![(index + 1).to_string()], numbers.to_vec()].concat()
            };
            let columns = ["segment", "begins, s", "time, s", "mean, mW", "energy, mJ"];
            let rows = self.segments.iter().enumerate().map(row).collect();
            tables.push(table("segments", "Segments between two sleeps.", &columns, rows));
        }
        if let (Some(stages), Some(running)) = (&self.stages, self.running_mw) {
            let row = |line: &StageEnergy| {
                let numbers = [
                    format!("{:.2}", line.cycles_per_pixel),
                    format!("{:.4}", line.mj_per_frame),
                    format!("{:.3}", line.nj_per_pixel),
                ];
                [vec![line.stage.clone()], numbers.to_vec()].concat()
            };
            let caption = format!("By stage: {STAGES_REST_ON} ({running:.3} mW).");
            let columns = ["stage", "cycles a pixel", "a frame, mJ", "a pixel, nJ"];
            tables.push(table("stages", &caption, &columns, stages.iter().map(row).collect()));
        }
        tables
    }
}

/// Power of the running program, W: in the phase of computing.
fn running(measured: &Measurement) -> Result<f64> {
    let watts = measured.phase(Phase::Compute).watts();
    watts.context("--log: the recording tells no phase of computing, whose power the cycles are multiplied with")
}

impl PhaseLine {
    fn new(phase: Phase, measured: &Measurement) -> Self {
        let tally: &Tally = measured.phase(phase);
        Self {
            phase,
            seconds: tally.seconds,
            share_percent: 100.0 * tally.seconds / measured.total.seconds,
            mean_mw: tally.watts().map(|watts| 1e3 * watts),
            peak_mw: 1e3 * tally.peak_watts,
            mj: 1e3 * tally.joules,
        }
    }
}

impl SegmentLine {
    fn new((name, segment): &Named) -> Self {
        let Segment { begin, seconds, joules, .. } = *segment;
        Self { name: name.clone(), begin_s: begin, seconds, mean_mw: 1e3 * segment.watts(), mj: 1e3 * joules }
    }
}

fn methods(segments: &[Named]) -> Vec<MethodLine> {
    let mut found = BTreeMap::<&str, Vec<&Segment>>::new();
    for (name, segment) in segments {
        if let Some(name) = name {
            found.entry(name).or_default().push(segment);
        }
    }
    let line = |(name, segments): (&str, Vec<&Segment>)| {
        let sum = |of: fn(&Segment) -> f64| segments.iter().map(|segment| of(segment)).sum::<f64>();
        let joules = sum(|segment| segment.joules);
        MethodLine {
            name: name.to_owned(),
            segments: segments.len(),
            mean_mw: 1e3 * joules / sum(|segment| segment.measured),
            mj_per_segment: 1e3 * joules / segments.len() as f64,
        }
    };
    found.into_iter().map(line).collect()
}
