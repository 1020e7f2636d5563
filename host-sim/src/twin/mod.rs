//! The application on an emulated Cortex-M: its program, a run of it, and what the run tells.

pub mod cycles;
pub mod elf;
pub mod footage;
pub mod machine;
pub mod obstacles;
pub mod rows;

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use haarline::{Config, Rectification, Stage, Wiring};
use haarline_rig::Plan;

use crate::stereo::method::MethodKind;

/// What the program reported: counts by name.
#[derive(Debug, Clone, Default)]
pub struct Report(BTreeMap<String, u64>);

impl Report {
    /// Reads lines of a name and a number.
    ///
    /// # Errors
    /// If the file cannot be read or is none.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).context("the program left no report")?;
        let line = |line: &str| {
            let (name, value) = line.split_once(' ')?;
            Some((name.to_owned(), value.parse().ok()?))
        };
        let entries = text.lines().map(line).collect::<Option<_>>();
        entries.map(Self).with_context(|| format!("the program's report is not understood: {text:?}"))
    }

    /// A count.
    ///
    /// # Errors
    /// If the program did not report it: then it is an older or a newer one.
    pub fn get(&self, name: &str) -> Result<u64> {
        self.0.get(name).copied().with_context(|| format!("the program did not report {name}: build it again"))
    }

    /// Executed instructions of each stage, without what the counting cost.
    ///
    /// # Errors
    /// If one is missing.
    pub fn stages(&self) -> Result<[(Stage, u64); Stage::COUNT]> {
        let mut stages = Stage::ALL.map(|stage| (stage, 0));
        for (stage, count) in &mut stages {
            *count = self.get(stage.name())?;
        }
        Ok(stages)
    }

    /// What happened to the camera's frames, by name.
    pub fn counters(&self) -> impl Iterator<Item = (&str, u64)> {
        self.0.iter().filter_map(|(name, value)| Some((name.strip_prefix("counter_")?, *value)))
    }
}

/// What the program is asked to do.
#[derive(Debug, Clone)]
pub struct Request {
    /// The search.
    pub config: Config,
    /// Rows of a frame.
    pub height: usize,
    /// Frames of the recording, and to play: it begins again where it ends.
    pub recorded: u32,
    /// Frames to play.
    pub frames: u32,
    /// Frames at the beginning and at the end whose disparities are kept.
    pub keep: u32,
    /// The method.
    pub method: MethodKind,
    /// How the cameras are wired to the port.
    pub wiring: Wiring,
    /// `KIND@FRAME`.
    pub fault: Option<String>,
    /// The rig, whose offset holds and whose obstacles are looked for.
    pub plan: Option<Plan>,
}

impl Request {
    /// The program's arguments.
    #[must_use]
    pub fn arguments(&self) -> Vec<String> {
        let Config { width, min_disparity, num_disparities } = self.config;
        let Self { height, recorded, frames, keep, method, wiring, .. } = self;
        let mut arguments = vec![
            format!("width={width}"),
            format!("height={height}"),
            format!("min={min_disparity}"),
            format!("num={num_disparities}"),
            format!("recorded={recorded}"),
            format!("frames={frames}"),
            format!("keep={keep}"),
            format!("method={method}"),
            format!("wiring={}", wiring.kind.name()),
            format!("first={}", wiring.first.name()),
            format!("skew={}", wiring.skew.name()),
        ];
        arguments.extend(self.fault.iter().map(|fault| format!("fault={fault}")));
        if let Some(plan) = &self.plan {
            let axis_q8 = plan.rig.axis_q8([plan.config.width, plan.height]);
            let Rectification { lenses, correction, .. } = plan.rectification;
            arguments.extend([
                format!("lens_nodes={}", lenses.map_or(0, |[left, _]| left.nodes().len())),
                format!("correction_nodes={}", correction.map_or(0, |correction| correction.nodes().len())),
                format!("correction_columns={}", correction.map_or(0, |correction| correction.columns())),
                format!("rows_q16={}", plan.rectification.ramp.rows_q16),
                format!("roll_q16={}", plan.rectification.ramp.roll_q16),
                format!("scale_q16={}", plan.rectification.ramp.scale_q16),
                format!("columns={}", plan.rectification.columns),
                format!("axis_x_q8={}", axis_q8[0]),
                format!("axis_y_q8={}", axis_q8[1]),
                format!("doffs_q8={}", plan.rig.doffs_q8()),
                format!("focal_px_q8={}", plan.rig.focal_px_q8()),
                format!("baseline_um={}", plan.rig.baseline_um()),
                format!("camera_height_mm={}", plan.camera_height_mm),
                // Its bits, so that it is the same to the last one.
                format!("pitch_bits={}", plan.pitch_deg.to_bits().cast_signed()),
                format!("lowest_mm={}", plan.lowest_mm),
                format!("highest_mm={}", plan.highest_mm),
                format!("sectors={}", plan.sectors),
                format!("sector_deg={}", plan.reach.sector_deg),
                format!("first_deg={}", plan.reach.first_deg),
            ]);
        }
        arguments
    }

    /// The rig's tables, as the program reads them from a file; none where it has none.
    #[must_use]
    pub fn tables(&self) -> Vec<u8> {
        let Some(Rectification { lenses, correction, .. }) = self.plan.as_ref().map(|plan| plan.rectification) else {
            return Vec::new();
        };
        let lenses = lenses.iter().flatten().flat_map(|table| table.nodes().iter().flatten());
        let correction = correction.iter().flat_map(|correction| correction.nodes());
        lenses.chain(correction).flat_map(|node| node.to_le_bytes()).collect()
    }

    /// The frame that the fault is in.
    #[must_use]
    pub fn damaged(&self) -> Option<u32> {
        self.fault.as_deref()?.split_once('@')?.1.parse().ok()
    }

    /// Checks what only the program's memory limits.
    ///
    /// # Errors
    /// If the views are too wide, the fault is in no frame, or the method is a reference that no chip has.
    pub fn check(&self) -> Result<()> {
        let width = self.config.width;
        ensure!(width <= 320, "the views are {width} px wide, the emulated application takes up to 320: scale them");
        ensure!(
            !matches!(self.method, MethodKind::Ssd | MethodKind::Ncc),
            "--method {}: runs on the host only, the reference on the chip is block",
            self.method
        );
        let frame = self.damaged();
        ensure!(
            frame.is_none_or(|frame| frame < self.frames),
            "--fault {}: frames are counted from 0, and {} frame(s) are played: ask for more by --count",
            self.fault.as_deref().unwrap_or_default(),
            self.frames
        );
        Ok(())
    }
}
