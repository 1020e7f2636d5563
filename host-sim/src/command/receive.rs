//! `haarline receive`: the row packets that a chip sent as disparity maps.

use std::collections::HashMap;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use serde::Serialize;

use super::{Finding, print};
use crate::input::packet_stream::{PacketStream, ReceivedFrame};
use crate::output::{self, pfm};

/// Arguments of `haarline receive`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The bytes as they came over the serial line
    packets: PathBuf,
    /// Where the maps go: <number>.pfm, and frames.csv; <number>_1.pfm and so on if the sender began anew
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
    /// Prints the summary as JSON
    #[arg(long)]
    json: bool,
}

/// What is told about a stream.
#[derive(Debug, Serialize)]
struct Summary {
    packets: u64,
    damaged: u64,
    lost: u64,
    restarts: u64,
    frames: usize,
    whole: usize,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let bytes = fs::read(&self.packets).with_context(|| self.packets.display().to_string())?;
        output::prepare_folder("-o", &self.output)?;
        let mut stream = PacketStream::new();
        let mut frames: Vec<ReceivedFrame> = stream.push(&bytes).collect();
        frames.extend(stream.finish());
        for (frame, name) in frames.iter().zip(names(frames.iter().map(|frame| frame.number))) {
            output::write(&self.output.join(name), &pfm::encode(&frame.map))?;
        }
        output::write(&self.output.join("frames.csv"), table(&frames).as_bytes())?;
        let tally = stream.tally();
        let whole = frames.iter().filter(|frame| frame.is_whole).count();
        let summary = Summary {
            packets: tally.packets,
            damaged: tally.damaged,
            lost: tally.lost,
            restarts: tally.restarts,
            frames: frames.len(),
            whole,
        };
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.text() })?;
        ensure!(!frames.is_empty(), Finding("no frame came: are these the bytes of the row packets' port?".to_owned()));
        Ok(())
    }
}

/// The files' names by the frames' numbers, which a sender that begins anew gives again.
fn names(numbers: impl Iterator<Item = u32>) -> impl Iterator<Item = String> {
    let mut times = HashMap::new();
    numbers.map(move |number| {
        let before = times.entry(number).or_insert(0_u32);
        let again = if *before > 0 { format!("_{before}") } else { String::new() };
        *before += 1;
        format!("{number:06}{again}.pfm")
    })
}

impl Summary {
    fn text(&self) -> String {
        let Self { packets, damaged, lost, restarts, frames, whole } = self;
        format!(
            "{frames} frames, {whole} of them whole; {packets} packets, {damaged} damaged, {lost} lost; \
             the sender began anew {restarts} times\n"
        )
    }
}

/// A line for each frame: what came of it, and the chip's counters at its end.
fn table(frames: &[ReceivedFrame]) -> String {
    let mut text = String::from(
        "frame,whole,missing_rows,frames,rows,dropped_rows,dropped_frames,overruns,short,long,stalled,dma_errors\n",
    );
    for frame in frames {
        let c = &frame.counters;
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{},{}",
            frame.number,
            u8::from(frame.is_whole),
            frame.missing_rows.len(),
            c.frames,
            c.rows,
            c.dropped_rows,
            c.dropped_frames,
            c.overruns,
            c.short,
            c.long,
            c.stalled,
            c.dma_errors
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DisparityMap;
    use haarline::Counters;

    #[test]
    fn a_sender_that_begins_anew_replaces_no_file() {
        let found: Vec<String> = names([0, 1, 0, 1, 2, 0].into_iter()).collect();
        let wanted = ["000000", "000001", "000000_1", "000001_1", "000002", "000000_2"];
        assert_eq!(found, wanted.map(|name| format!("{name}.pfm")));
    }

    #[test]
    fn a_frames_line_tells_what_is_missing_and_the_chips_counters() {
        let frame = ReceivedFrame {
            number: 7,
            map: DisparityMap::with_capacity(4, 2),
            counters: Counters { frames: 8, rows: 2, overruns: 1, ..Counters::ZERO },
            missing_rows: vec![1],
            is_whole: false,
        };
        assert_eq!(table(&[frame]).lines().nth(1), Some("7,0,1,8,2,0,0,1,0,0,0,0"));
    }
}
