//! What came of each frame of a recording.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use super::Taken;
use crate::stereo::disparity_map::px;
use crate::stereo::frame_check::{FrameCheck, Input};
use crate::stereo::pipeline::Run;

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
    /// Noise of the views ([`crate::input::noise::estimate`]), grey levels.
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
    /// What it is as a whole.
    pub input: Option<Input>,
    /// Share of what the left view shows that the right view contradicts, percent.
    #[serde(serialize_with = "rounded")]
    pub mismatch_percent: Option<f64>,
    /// Share of the pixels with a sure answer, percent.
    #[serde(serialize_with = "rounded")]
    pub share_sure: Option<f64>,
    /// How far the right view lies lower, px: of this frame and those before, where enough was sure.
    #[serde(serialize_with = "rounded")]
    pub row_error_px: Option<f64>,
    /// Whether it is so much that the rig must have bent.
    #[serde(skip)]
    pub is_bent: bool,
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
    pub(super) fn damaged(taken: &Taken, error: &anyhow::Error) -> Self {
        let words = format!("{error:#}");
        Self {
            frame: taken.index,
            file: taken.file.clone(),
            status: Status::Damaged,
            density: None,
            median_disparity_px: None,
            noise: None,
            pixels: None,
            answered: None,
            rows: None,
            rows_unknown: None,
            milliseconds: None,
            input: None,
            mismatch_percent: None,
            share_sure: None,
            row_error_px: None,
            is_bent: false,
            error: Some(words.split_whitespace().collect::<Vec<_>>().join(" ")),
        }
    }

    pub(super) fn played(
        taken: &Taken,
        Run { map, elapsed, .. }: &Run,
        noise: Option<f64>,
        check: &FrameCheck,
        is_bent: bool,
    ) -> Self {
        let is_unknown = |row: &&[haarline::Disparity]| !row.iter().any(|disparity| disparity.is_known());
        Self {
            frame: taken.index,
            file: taken.file.clone(),
            status: Status::Ok,
            density: Some(map.density()),
            median_disparity_px: map.spread().map(|spread| spread.median_px),
            noise,
            pixels: Some(map.disparity.len()),
            answered: Some(map.known().count()),
            rows: Some(map.height),
            rows_unknown: Some(map.disparity.chunks(map.width).filter(is_unknown).count()),
            milliseconds: Some(elapsed.as_secs_f64() * 1000.0),
            input: Some(check.input),
            mismatch_percent: check.mismatch_percent,
            share_sure: Some(check.share_sure),
            row_error_px: check.row_error_px,
            is_bent,
            error: None,
        }
    }

    /// Whether it could be played.
    #[must_use]
    pub fn is_ok(&self) -> bool {
        self.status == Status::Ok
    }
}

/// The reports of a recording so far; as small for a long one as for a short one.
#[derive(Debug, Clone, Default)]
pub struct Totals {
    /// Frames, damaged ones included.
    pub frames: usize,
    /// Damaged ones.
    pub damaged: usize,
    /// The first of them, at most [`Totals::MOST_TOLD`].
    pub damaged_frames: Vec<FrameReport>,
    /// How many frames are what as a whole; those that are as they should be are left out.
    pub wrong_input: BTreeMap<Input, usize>,
    /// Frames of a rig that has bent.
    pub bent: usize,
    /// The row error of the last frame of which one is known, px.
    pub row_error_px: Option<f64>,
    density: Mean,
    noise: Mean,
    share_sure: Mean,
    mismatch: Mean,
    milliseconds: Mean,
    /// How many frames have which median, in raw 1/16 px.
    medians: BTreeMap<i32, usize>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, value: Option<f64>) {
        self.sum += value.unwrap_or_default();
        self.count += usize::from(value.is_some());
    }

    fn get(self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}

impl Totals {
    /// So many damaged frames are kept; frames.csv has all.
    pub const MOST_TOLD: usize = 100;

    /// Adds a frame.
    pub fn add(&mut self, report: &FrameReport) {
        self.frames += 1;
        if !report.is_ok() {
            self.damaged += 1;
            if self.damaged_frames.len() < Self::MOST_TOLD {
                self.damaged_frames.push(report.clone());
            }
        }
        self.bent += usize::from(report.is_bent);
        self.row_error_px = report.row_error_px.or(self.row_error_px);
        self.density.add(report.density);
        self.noise.add(report.noise);
        self.share_sure.add(report.share_sure);
        self.mismatch.add(report.mismatch_percent);
        if let Some(input) = report.input.filter(|&input| input != Input::Ok) {
            *self.wrong_input.entry(input).or_default() += 1;
        }
        self.milliseconds.add(report.milliseconds);
        if let Some(median) = report.median_disparity_px {
            *self.medians.entry((median * 16.0).round() as i32).or_default() += 1;
        }
    }

    /// Mean share of the pixels with a disparity, percent.
    #[must_use]
    pub fn mean_density(&self) -> Option<f64> {
        self.density.get()
    }

    /// Mean noise, grey levels.
    #[must_use]
    pub fn mean_noise(&self) -> Option<f64> {
        self.noise.get()
    }

    /// Mean share of the pixels with a sure answer, percent.
    #[must_use]
    pub fn mean_share_sure(&self) -> Option<f64> {
        self.share_sure.get()
    }

    /// Mean mismatch of the views, percent.
    #[must_use]
    pub fn mean_mismatch_percent(&self) -> Option<f64> {
        self.mismatch.get()
    }

    /// Mean time in the method.
    #[must_use]
    pub fn mean_milliseconds(&self) -> Option<f64> {
        self.milliseconds.get()
    }

    /// The lower median of the frames' medians, px.
    #[must_use]
    pub fn median_disparity_px(&self) -> Option<f64> {
        let count: usize = self.medians.values().sum();
        let mut seen = 0;
        self.medians.iter().find_map(|(&bits, frames)| {
            seen += frames;
            (2 * seen >= count).then(|| px(bits as i16))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::anyhow;

    fn report(median_disparity_px: Option<f64>, density: Option<f64>) -> FrameReport {
        let taken = Taken { index: 0, name: String::new(), file: String::new(), views: Err(anyhow!("none")) };
        let damaged = FrameReport::damaged(&taken, &anyhow!("none"));
        let status = if density.is_some() { Status::Ok } else { Status::Damaged };
        FrameReport { median_disparity_px, density, status, ..damaged }
    }

    #[test]
    fn totals_are_means_and_the_lower_median_of_what_is_known() {
        let mut totals = Totals::default();
        assert_eq!((totals.mean_density(), totals.median_disparity_px()), (None, None));
        for (median, density) in [(3.0, 10.0), (1.0, 20.0), (2.5, 30.0), (9.0, 40.0)] {
            totals.add(&report(Some(median), Some(density)));
        }
        totals.add(&report(None, None));
        assert_eq!((totals.mean_density(), totals.median_disparity_px()), (Some(25.0), Some(2.5)));
        assert_eq!((totals.frames, totals.damaged, totals.damaged_frames.len()), (5, 1, 1));
        (0..200).for_each(|_| totals.add(&report(None, None)));
        assert_eq!((totals.damaged, totals.damaged_frames.len()), (201, Totals::MOST_TOLD));
    }
}
