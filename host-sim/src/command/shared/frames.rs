//! Which frames of a recording, and how it stores them.

use std::path::Path;

use anyhow::{Context, Error, Result, bail, ensure};
use haarline_rig::Description;

use super::{LayoutArgs, WiringArgs, warn_skipped};
use crate::StereoPair;
use crate::command::whole_number;
use crate::input::raw_dump::{RawFormat, ViewSize};
use crate::input::recording::{FrameRange, RecordedFrame, Side, find_frames, find_raw_frames};

/// Which frames of a recording, and how it stores them.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct FrameArgs {
    #[command(flatten)]
    layout: LayoutArgs,
    /// The recording is a raw dump; the size is that of one view, px
    #[arg(long, value_name = "WIDTHxHEIGHT", conflicts_with_all = ["layout", "left_views"])]
    raw: Option<ViewSize>,
    #[command(flatten)]
    wiring: WiringArgs,
    /// Only these frames, counted from 0 in the order of their names: A..B without B, A.. or ..B
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// Only every K-th of them [default: so that not too many are left, where --frames does not choose]
    #[arg(long, value_name = "K", allow_hyphen_values = true, value_parser = whole_number)]
    every: Option<i64>,
}

impl FrameArgs {
    /// Which camera is first in frames with both views, where an option tells it.
    pub(in crate::command) const fn first(&self) -> Option<Side> {
        self.wiring.first
    }

    /// The frames of `recording` that are asked for; without --frames and --every at most `usual`, spread over it. What
    /// the options do not tell the rig does.
    pub(in crate::command) fn choose(
        &self,
        recording: &Path,
        rig: Option<&Description>,
        usual: usize,
    ) -> Result<Vec<RecordedFrame>> {
        let frames = self.find(recording, rig)?;
        self.choose_from(frames, usual)
    }

    /// Those of all `frames` of a recording that are asked for.
    pub(in crate::command) fn choose_from(
        &self,
        frames: Vec<RecordedFrame>,
        usual: usize,
    ) -> Result<Vec<RecordedFrame>> {
        let step = self.every.map(|every| {
            let step = usize::try_from(every).ok().filter(|&step| step > 0);
            step.with_context(|| format!("--every {every}: must be 1 or more"))
        });
        let step = step.transpose()?;
        let recorded = frames.len();
        let range = self.frames.unwrap_or_default();
        let chosen = range.choose(frames, 1);
        ensure!(
            !chosen.is_empty(),
            "--frames {range}: the recording has {recorded} frames only, counted from 0: the last one is {}",
            recorded - 1
        );
        let step = step.unwrap_or_else(|| if self.frames.is_some() { 1 } else { chosen.len().div_ceil(usual) });
        Ok(chosen.into_iter().step_by(step).collect())
    }

    /// All frames of `recording`.
    pub(in crate::command) fn find(&self, recording: &Path, rig: Option<&Description>) -> Result<Vec<RecordedFrame>> {
        if let Some(size) = self.raw {
            return find_raw_frames(recording, RawFormat { size, wiring: self.wiring.get_with(rig)? });
        }
        ensure!(self.wiring.get()?.is_none(), "--wiring: is for raw dumps, add --raw WIDTHxHEIGHT");
        ensure!(
            self.layout.layout.has_both() || self.wiring.first.is_none(),
            "--first: is for frames with both views, add --layout side-by-side or top-bottom"
        );
        find_frames(recording, self.layout.get(self.wiring.first_with(rig))?)
    }
}

/// The frames that can be read, how many others there are, and the middle one of them; a damaged one is told.
pub(in crate::command) fn readable(frames: Vec<RecordedFrame>) -> Result<(Vec<RecordedFrame>, usize, StereoPair)> {
    let recorded = frames.len();
    let mut last_error = None;
    let warn = |(frame, error): (usize, Error)| warn_skipped(frame, &format!("{error:#}"));
    let is_readable = |frame: &RecordedFrame| match frame.read() {
        Ok(_) => true,
        Err(error) => {
            if let Some(before) = last_error.replace((frame.index, error)) {
                warn(before);
            }
            false
        }
    };
    let frames: Vec<RecordedFrame> = frames.into_iter().filter(is_readable).collect();
    // What the refusal tells where there is no frame is not told before.
    if !frames.is_empty() {
        last_error.take().map(warn);
    }
    match (frames.get(frames.len() / 2), last_error) {
        (Some(frame), _) => {
            let middle = frame.read()?;
            let damaged = recorded - frames.len();
            Ok((frames, damaged, middle))
        }
        (None, Some((_, error))) => Err(error.context("no frame can be read")),
        (None, None) => bail!("there is no frame"),
    }
}
