//! The rig's description, with what options tell otherwise.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use haarline_rig::Description;

use super::SearchRange;
use crate::input::frame::Shrink;
use crate::{Geometry, input::rig_file};

/// The rig.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct RigArg {
    /// Rig description (see haarline rig new): its search range, focal length, baseline, offsets and, for raw
    /// dumps, wiring hold where no option tells otherwise; obstacles are looked for
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
}

impl RigArg {
    /// Its file, if there is one.
    pub(in crate::command) fn path(&self) -> Option<&PathBuf> {
        self.rig.as_ref()
    }

    /// The description as the file has it, if there is one.
    pub(in crate::command) fn description(&self) -> Result<Option<Description>> {
        self.rig.as_deref().map(rig_file::read).transpose()
    }

    /// What was described, with the search range, focal length in px and baseline in mm of the options where these tell
    /// some: of views of `size` once they are shrunk, if that is known.
    pub(in crate::command) fn fitted(
        &self,
        described: &Description,
        search: &SearchRange,
        [focal_px, baseline_mm]: [Option<f64>; 2],
        shrink: Shrink,
        size: Option<[usize; 2]>,
    ) -> Result<Description> {
        let mut rig = described.clone();
        // One that was imported for the small views is theirs already.
        let is_small = size == Some([rig.width, rig.height].map(usize::from)) && shrink != Shrink::NONE;
        if let Some(focal_px) = focal_px {
            rig.focal_px = if is_small { focal_px / f64::from(shrink.factor()) } else { focal_px };
        }
        if !is_small {
            rig = rig_file::shrunk(&rig, shrink);
        }
        let config = search.or(&rig).config(rig.width)?;
        (rig.min_disparity, rig.num_disparities) = (config.min_disparity, config.num_disparities);
        rig.baseline_mm = baseline_mm.unwrap_or(rig.baseline_mm);
        // Refuses what is not positive, in the options' words.
        Geometry::new(rig.focal_px, rig.baseline_mm)?;
        rig.check().with_context(|| self.rig.as_deref().unwrap_or_else(|| Path::new("--rig")).display().to_string())?;
        Ok(rig)
    }
}
