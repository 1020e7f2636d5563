//! The search range.

use anyhow::{Context, Result};
use haarline::Config;
use haarline_rig::Description;

use crate::command::whole_number;
use crate::stereo::method::check_config;

/// The search range.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct SearchRange {
    /// How many whole disparities to search, 1 to 256 [default: a quarter of the width, up to a multiple of 16]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole_number)]
    num_disparities: Option<i64>,
    /// Least disparity to search, px, -128 to 128 [default: 0]
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = whole_number)]
    min_disparity: Option<i64>,
}

impl SearchRange {
    /// The configuration for views of `width` px.
    pub(in crate::command) fn config(&self, width: u16) -> Result<Config> {
        let default = Config::for_width(width);
        let asked = self.num_disparities.unwrap_or_else(|| default.num_disparities.into());
        let num_disparities = u16::try_from(asked);
        let num_disparities =
            num_disparities.ok().with_context(|| format!("--num-disparities {asked}: must be 1 to 256"))?;
        let asked = self.min_disparity.unwrap_or(0);
        let min_disparity = i16::try_from(asked);
        let min_disparity =
            min_disparity.ok().with_context(|| format!("--min-disparity {asked}: must be -128 to 128 px"))?;
        let config = Config { width, min_disparity, num_disparities };
        check_config(&config, "--num-disparities")?;
        Ok(config)
    }

    /// The same, with the rig's values where nothing was told.
    pub(super) fn or(&self, rig: &Description) -> Self {
        let num_disparities = self.num_disparities.unwrap_or_else(|| rig.num_disparities.into());
        let min_disparity = self.min_disparity.unwrap_or_else(|| rig.min_disparity.into());
        Self { num_disparities: Some(num_disparities), min_disparity: Some(min_disparity) }
    }
}
