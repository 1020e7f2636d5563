//! Holes of maps, filled on request.

use anyhow::Result;

use super::MinConfidence;
use crate::stereo::method::MethodKind;

/// Whether holes are filled.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct FillArg {
    /// Shows the guesses of full and lite, too, and fills what is still unknown with the farther of the next known
    /// pixels beside it, confidence 1
    #[arg(long)]
    pub(in crate::command) fill: bool,
}

impl FillArg {
    /// The least confidence that is shown: filled maps show the guesses of a method that has its own.
    pub(in crate::command) fn least(&self, limit: &MinConfidence, method: MethodKind) -> Result<u8> {
        let shows_guesses = self.fill && method.has_guesses() && !limit.is_told();
        if shows_guesses { Ok(0) } else { limit.get(Some(method)) }
    }
}
