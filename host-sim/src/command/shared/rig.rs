//! The rig's description, with what options tell otherwise.

use std::path::PathBuf;

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

    /// The description, if there is one, with the search range, focal length in px and baseline in mm of the
    /// options where these tell some: of views of `size` once they are shrunk, if that is known.
    pub(in crate::command) fn read(
        &self,
        search: &SearchRange,
        [focal_px, baseline_mm]: [Option<f64>; 2],
        shrink: Shrink,
        size: Option<[usize; 2]>,
    ) -> Result<Option<Description>> {
        let (Some(path), Some(mut rig)) = (&self.rig, self.description()?) else { return Ok(None) };
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
        rig.check().with_context(|| path.display().to_string())?;
        Ok(Some(rig))
    }

    /// Refuses views of another size than the rig's that was read, after `shrink`.
    pub(in crate::command) fn check_size(&self, rig: &Description, shrink: Shrink, size: [usize; 2]) -> Result<()> {
        match &self.rig {
            Some(path) => rig_file::check_shrunk_size(path, rig, shrink, size),
            None => rig_file::check_size(rig, size),
        }
    }
}
