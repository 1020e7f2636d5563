//! Where a report goes as JSON.

use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::command::print;
use crate::output;

/// Where a report goes as JSON.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct JsonOutput {
    /// Prints everything as JSON instead of the tables, or writes it to FILE beside them
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
}

impl JsonOutput {
    /// The file, if it does not go to the standard output.
    pub(in crate::command) fn file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|path| *path != Path::new("-"))
    }

    /// Delivers the report: as JSON where it was asked for, as text unless that went to the standard output.
    pub(in crate::command) fn deliver(
        &self,
        json: impl FnOnce() -> Result<String>,
        text: impl FnOnce() -> String,
    ) -> Result<()> {
        match (&self.json, self.file()) {
            (Some(_), None) => return print(&json()?),
            (_, Some(path)) => output::write(path, json()?.as_bytes())?,
            (None, None) => {}
        }
        print(&text())
    }
}
