//! `haarline power`: what the program takes, from the recordings of a current meter.

mod measure;
mod summary;

use anyhow::Result;

/// Arguments of `haarline power`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Energy by phase and by segment from what a PPK2 or a Joulescope recorded
    Measure(measure::Args),
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        match self.command {
            Command::Measure(args) => args.run(),
        }
    }
}
