//! What turns disparities into depth.

use anyhow::{Result, ensure};
use haarline_rig::Description;

use super::{RigArg, SearchRange};
use crate::Geometry;
use crate::command::number;
use crate::input::frame::Shrink;

/// What turns disparities into depth.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct DepthOptions {
    /// Focal length, px; with --baseline-mm depth is told, too
    #[arg(long, value_name = "F", allow_hyphen_values = true, value_parser = number)]
    focal_px: Option<f64>,
    /// Distance of the two cameras, mm
    #[arg(long, value_name = "B", allow_hyphen_values = true, value_parser = number)]
    baseline_mm: Option<f64>,
    /// Leaves what is farther out of depth images and point clouds, m
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    max_depth: Option<f64>,
    /// Makes one pixel, their mean, of K x K of both views, 1 to 8; focal length and rig are those of the views as
    /// they are and follow (a rig of the small views' size is theirs), the options of the search mean the small ones
    #[arg(long, value_name = "K", default_value = "1", hide_default_value = true)]
    pub(in crate::command) shrink: Shrink,
}

impl DepthOptions {
    /// The rig that was described, with the values of these options where they tell some; of shrunken views of `size`, if that is
    /// known.
    pub(in crate::command) fn rig(
        &self,
        rig: &RigArg,
        described: Option<&Description>,
        search: &SearchRange,
        size: Option<[usize; 2]>,
    ) -> Result<Option<Description>> {
        let fitted = |described| rig.fitted(described, search, [self.focal_px, self.baseline_mm], self.shrink, size);
        described.map(fitted).transpose()
    }

    /// Focal length and baseline, if they are known; `rig` has what the options told already.
    pub(in crate::command) fn geometry(&self, rig: Option<&Description>) -> Result<Option<Geometry>> {
        match rig {
            Some(rig) => Geometry::of_rig(rig).map(Some),
            None => {
                let focal_px = self.focal_px.map(|focal_px| focal_px / f64::from(self.shrink.factor()));
                Geometry::from_options(focal_px, self.baseline_mm)
            }
        }
    }

    /// What is farther is left out, m; only where depth is known can it be told.
    pub(in crate::command) fn max_depth_m(&self, geometry: Option<&Geometry>) -> Result<Option<f64>> {
        let Some(most) = self.max_depth else { return Ok(None) };
        ensure!(most.is_finite() && most > 0.0, "--max-depth {most}: must be a positive number of m");
        ensure!(geometry.is_some(), "--max-depth {most}: needs --focal-px and --baseline-mm, or --rig");
        Ok(Some(most))
    }
}
