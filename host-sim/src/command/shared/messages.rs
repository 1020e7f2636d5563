//! What is told on the way: warnings, progress, words for a shell.

use std::fmt;
use std::io::{self, Write as _};

use anyhow::Result;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};

/// One line about input that is not as it should be.
pub(in crate::command) fn warn_input(what: &str) {
    // Nowhere is left to tell if this fails, too.
    let _ = writeln!(io::stderr(), "warning: {what}");
}

/// What is told of a rig that has bent.
pub(in crate::command) fn bent_words(row_error_px: f64) -> String {
    format!(
        "the rig has bent: the right view lies {:.2} px {} than it should; haarline rig check tells more, haarline align \
         RECORDING -o RIG.toml --update puts it right",
        row_error_px.abs(),
        if row_error_px > 0.0 { "lower" } else { "higher" }
    )
}

/// One line about a damaged frame.
pub(in crate::command) fn warn_skipped(frame: usize, why: &str) {
    // Nowhere is left to tell if this fails, too.
    let _ = writeln!(io::stderr(), "frame {frame} skipped: {why}");
}

/// A word as a shell takes it.
pub(in crate::command) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/._-,+=:@%".contains(c);
    if word.chars().all(is_plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

/// A bar with rate and time left; shown only where the standard error is a terminal.
pub(in crate::command) fn progress(length: usize, what: &str) -> Result<ProgressBar> {
    let style =
        ProgressStyle::with_template("{bar:40} {pos}/{len} {msg}, {rate}, {eta} left")?.with_key("rate", write_rate);
    Ok(ProgressBar::new(length as u64).with_style(style).with_message(what.to_owned()))
}

/// The rate, to one digit after the point.
fn write_rate(state: &ProgressState, text: &mut dyn fmt::Write) {
    // A bar without its rate is still a bar.
    let _ = write!(text, "{:.1}/s", state.per_sec());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_can_be_given_to_a_shell() {
        assert_eq!(quoted("data/qvga"), "data/qvga");
        assert_eq!(quoted("my data"), "'my data'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
    }
}
