//! The limit below which pixels become unknown.

use anyhow::{Context, Result};

use crate::command::whole_number;
use crate::stereo::method::MethodKind;

/// The limit below which pixels become unknown.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct MinConfidence {
    /// Makes pixels of less confidence unknown, 0 to 255. Unless told, guesses (less than 16) of full and lite are
    #[arg(long, value_name = "C", allow_hyphen_values = true, value_parser = whole_number)]
    min_confidence: Option<i64>,
}

impl MinConfidence {
    /// Least confidence of an answer that is no guess.
    const MEASURED: u8 = 16;

    /// For maps of `method`, or of a chip's method that is not known.
    pub(in crate::command) fn get(&self, method: Option<MethodKind>) -> Result<u8> {
        let Some(min_confidence) = self.min_confidence else {
            let has_guesses = method.is_none_or(MethodKind::has_guesses);
            return Ok(if has_guesses { Self::MEASURED } else { 0 });
        };
        u8::try_from(min_confidence)
            .ok()
            .with_context(|| format!("--min-confidence {min_confidence}: must be 0 to 255"))
    }

    /// Whether a limit was told.
    pub(in crate::command) const fn is_told(&self) -> bool {
        self.min_confidence.is_some()
    }
}
