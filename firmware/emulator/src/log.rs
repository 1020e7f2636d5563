//! The log as text: what a probe shows.

use std::fmt::Write;

use anyhow::{Context, Result};
use defmt_decoder::{DecodeError, Table};

/// The lines of the log's bytes, by the table in the ELF file. Bytes that are none are said so. Of `runs`
/// each has a log of its own, and one of `resets` lies between two.
///
/// # Errors
/// If the program logs nothing.
pub fn text(elf: &[u8], runs: &[Vec<u8>], resets: &[String]) -> Result<String> {
    let table = Table::parse(elf)?.context("the program has no table of its log's texts")?;
    let mut text = String::new();
    for (nth, run) in runs.iter().enumerate() {
        if let Some(reset) = nth.checked_sub(1).and_then(|before| resets.get(before)) {
            let _ = writeln!(text, "-- {reset}");
        }
        lines(&table, run, &mut text);
    }
    Ok(text)
}

fn lines(table: &Table, bytes: &[u8], text: &mut String) {
    let mut decoder = table.new_stream_decoder();
    decoder.received(bytes);
    loop {
        match decoder.decode() {
            Ok(frame) => {
                let level = frame.level().map_or("", |level| level.as_str());
                let time = frame.display_timestamp().map_or_else(String::new, |time| time.to_string());
                let _ = writeln!(text, "{time} {level} {}", frame.display_message());
            }
            Err(DecodeError::UnexpectedEof) => return,
            Err(DecodeError::Malformed) => {
                let _ = writeln!(text, "(bytes that are no log)");
                if !table.encoding().can_recover() {
                    return;
                }
            }
        }
    }
}
