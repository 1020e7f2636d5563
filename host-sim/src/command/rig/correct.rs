//! `haarline rig correct`: what lenses leave of disparities, taken away by what the rig sees of a plane.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use haarline::Rectification;
use haarline_rig::Description;
use serde::Serialize;

use super::super::shared::{FrameArgs, MethodOptions, progress, readable, warn_skipped};
use super::super::{Finding, number, print, whole_number};
use crate::input::rig_file;
use crate::output::claims::Claims;
use crate::rig::correction::{Plane, Residuals};
use crate::rig::description_file::DescriptionFile;
use crate::rig::planes::{self, PlaneLine};
use crate::stereo::pipeline;
use crate::{Geometry, StereoPair};

/// Frames of each recording that are looked at without --frames and --every.
const USUAL_FRAMES: usize = 400;
/// Least confidence of a sure answer.
const SURE: u8 = 64;

/// Arguments of `haarline rig correct`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Recordings in which a textured plane (a wall with posters, a screen) stands square before the cameras at a known
    /// distance, best in all columns, or passing over them
    #[arg(value_name = "RECORDING", required = true)]
    recordings: Vec<PathBuf>,
    /// Description of the rig, aligned or imported
    #[arg(long, value_name = "FILE")]
    rig: PathBuf,
    /// Distance of the plane from the left camera along its axis, m; it fills the view then
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number, conflicts_with = "planes", required_unless_present = "planes")]
    depth_m: Option<f64>,
    /// Instead, of each recording, where the plane stood frame by frame: a table with the columns depth_m and, where they
    /// are known, frame, first_column, last_column, first_row, last_row
    #[arg(long, value_name = "FILE.csv")]
    planes: Vec<PathBuf>,
    /// Writes the correction into the description; the previous one is kept as RIG.toml.bak. Else it is told only
    #[arg(long)]
    update: bool,
    #[command(flatten)]
    frames: FrameArgs,
    #[command(flatten)]
    method: MethodOptions,
    /// Least confidence of the answers that count, 0 to 255
    #[arg(long, value_name = "C", default_value_t = SURE.into(), allow_hyphen_values = true, value_parser = whole_number)]
    min_confidence: i64,
    /// Prints everything as JSON
    #[arg(long)]
    json: bool,
}

/// What is told.
#[derive(Debug, Serialize)]
struct Summary {
    frames: usize,
    damaged: usize,
    answers: usize,
    columns: [usize; 2],
    rows: [usize; 2],
    /// Median error of a part of the view without the correction and with it, px.
    error_px: [f64; 2],
    disparity_correction: Vec<Vec<f64>>,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let min_confidence = u8::try_from(self.min_confidence)
            .ok()
            .with_context(|| format!("--min-confidence {}: must be 0 to 255", self.min_confidence))?;
        let tables = self.tables()?;
        ensure!(self.rig.exists(), "--rig {}: no such file, where a rig description is expected", self.rig.display());
        rig_file::read(&self.rig)?;
        let file = DescriptionFile::open("--rig", &self.rig, true)?;
        if self.update {
            let mut claims = Claims::new();
            claims.read(self.planes.iter().chain(&self.recordings));
            file.claim_backup("--update", &mut claims)?;
        }
        let rig = rig_file::read(&self.rig)?;
        let size = [rig.width, rig.height].map(usize::from);
        let (mut residuals, mut frames, mut damaged, mut answers) = (Residuals::new(size), 0, 0, 0);
        let rectification = Rectification { correction: None, ..rig.rectification()? };
        let mut method = self.method.get()?.build(rig.config())?;
        for (recording, table) in self.recordings.iter().zip(&tables) {
            let chosen = self.frames.choose(recording, Some(&rig), USUAL_FRAMES)?;
            let chosen: Vec<_> = chosen.into_iter().filter(|frame| table.of(frame.index).is_some()).collect();
            ensure!(!chosen.is_empty(), "{}: of none of its frames a plane is told", recording.display());
            let (chosen, unreadable, first) = readable(chosen)?;
            rig_file::check_size(&rig, [first.width(), first.height()])?;
            damaged += unreadable;
            let bar = progress(chosen.len(), "frames")?;
            for frame in &chosen {
                bar.inc(1);
                let pair: StereoPair = frame.read()?;
                if [pair.width(), pair.height()] != size {
                    warn_skipped(frame.index, "its views have another size");
                    damaged += 1;
                    continue;
                }
                let Some(plane) = table.of(frame.index).and_then(|line| plane(&rig, &line)) else { continue };
                let run = pipeline::run_rectified(&mut *method, &rectification, &pair)?;
                answers += residuals.add(&run.map, min_confidence, &plane);
                frames += 1;
            }
            bar.finish_and_clear();
        }
        let fit = residuals.fit().map_err(|error| Finding(error.to_string()))?;
        let rounded = |row: &Vec<f64>| row.iter().map(|node| (node * 1000.0).round() / 1000.0).collect();
        let nodes: Vec<Vec<f64>> = fit.nodes.iter().map(rounded).collect();
        let summary = Summary {
            frames,
            damaged,
            answers,
            columns: fit.columns,
            rows: fit.rows,
            error_px: fit.error_px,
            disparity_correction: nodes,
        };
        let mut text = summary.text(size);
        if self.update {
            let changes = file.write(&[("disparity_correction", toml(&summary.disparity_correction))])?;
            let changed = if changes.is_empty() { "nothing changed".to_owned() } else { changes.join("; ") };
            let name = self.rig.display();
            text += &format!("in {name} (before: {name}.bak): {changed}\n");
        } else {
            text += &format!(
                "disparity_correction = {}\nnothing was written: --update puts it into {}\n",
                toml(&summary.disparity_correction),
                self.rig.display()
            );
        }
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { text })
    }

    /// Of each recording, where the plane stood.
    fn tables(&self) -> Result<Vec<Table>> {
        if let Some(depth_m) = self.depth_m {
            ensure!((0.05..=1000.0).contains(&depth_m), "--depth-m {depth_m}: must be 0.05 to 1000 m");
            return Ok(vec![Table::Still(PlaneLine { depth_m, columns: None, rows: None }); self.recordings.len()]);
        }
        let (planes, recordings) = (self.planes.len(), self.recordings.len());
        ensure!(planes == recordings, "--planes: {planes} tables of {recordings} recordings, one of each is needed");
        self.planes.iter().map(|path| planes::read(path).map(Table::Moving)).collect()
    }
}

/// Where the plane stood.
#[derive(Debug, Clone)]
enum Table {
    /// In every frame in the same place.
    Still(PlaneLine),
    /// In frames by their number.
    Moving(BTreeMap<usize, PlaneLine>),
}

impl Table {
    fn of(&self, frame: usize) -> Option<PlaneLine> {
        match self {
            Self::Still(line) => Some(*line),
            Self::Moving(lines) => lines.get(&frame).copied(),
        }
    }
}

/// The plane as the rig would see it; `None` where it stood beside the view.
fn plane(rig: &Description, line: &PlaneLine) -> Option<Plane> {
    let geometry = Geometry::of_rig(rig).ok()?;
    let disparity_px = geometry.focal_px * geometry.baseline_mm / (1000.0 * line.depth_m) - geometry.doffs;
    let within = |range: Option<[f64; 2]>, side: u16| {
        let last = f64::from(side) - 1.0;
        let [from, to] = range.unwrap_or([0.0, last]);
        let [from, to] = [from.ceil().max(0.0), to.floor().min(last)];
        (from <= to).then_some([from as usize, to as usize])
    };
    Some(Plane { disparity_px, columns: within(line.columns, rig.width)?, rows: within(line.rows, rig.height)? })
}

/// Rows of nodes as a description has them.
fn toml(nodes: &[Vec<f64>]) -> String {
    let row = |row: &Vec<f64>| format!("[{}]", row.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(", "));
    format!("[{}]", nodes.iter().map(row).collect::<Vec<_>>().join(", "))
}

impl Summary {
    fn text(&self, size: [usize; 2]) -> String {
        let Self { frames, answers, columns, rows, error_px, disparity_correction, .. } = self;
        let frames = if *frames == 1 { "1 frame".to_owned() } else { format!("{frames} frames") };
        let by = if disparity_correction.len() > 1 { "column and row" } else { "column" };
        let beyond =
            if columns[0] > 0 || columns[1] + 1 < size[0] { "; beyond, it goes on as at their borders" } else { "" };
        format!(
            "{frames}, {answers} answers on the plane, in columns {} to {} and rows {} to {}{beyond}\n\
             disparities were {:.2} px wrong in the median, and are {:.2} px from a correction by {by}\n",
            columns[0], columns[1], rows[0], rows[1], error_px[0], error_px[1]
        )
    }
}
