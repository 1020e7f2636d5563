//! What the colours of pictures span.

use crate::output::colour_range::ColourRange;

/// What the colours of pictures span.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct RangeArg {
    /// Disparities that the colours and greys of pictures span, px
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub(in crate::command) range: Option<ColourRange>,
}
