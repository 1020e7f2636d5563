//! `haarline power`: what the program takes, planned before there is a board, and measured from the recordings of a current meter.

mod count;
mod measure;
mod plan;
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
    /// What a method would take on a board, from counted instructions and documented currents: no hardware needed
    Plan(plan::Args),
    /// Counts what every method costs and scores it: the figures that plan rests on
    Count(count::Args),
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        match self.command {
            Command::Measure(args) => args.run(),
            Command::Plan(args) => args.run(),
            Command::Count(args) => args.run(),
        }
    }
}
