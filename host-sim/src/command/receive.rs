//! `haarline receive`: the row packets that a chip sent as disparity maps.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, ensure};
use haarline::frame_figures::{Bend, Input};
use haarline::packet::VERSION;
use serde::Serialize;

use super::shared::{MinConfidence, bent_words};
use super::{Finding, print};
use crate::input::packet_stream::{PacketStream, ReceivedFrame};
use crate::output::claims::Claims;
use crate::output::growing::GrowingTable;
use crate::output::{self, pfm};
use crate::stereo::frame_check::row_error_px;

/// Bytes that are read at once.
const PIECE: usize = 16 << 10;

/// Arguments of `haarline receive`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The bytes as they came over the serial line; - is the standard input. Each frame is written as soon as it
    /// ended
    packets: PathBuf,
    /// Where the maps go: <number>.pfm, and frames.csv; <number>_1.pfm and so on after the sender began anew
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    min_confidence: MinConfidence,
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
    repeated: u64,
    restarts: u64,
    frames: usize,
    whole: usize,
    empty: u64,
    cut: u64,
    unsent_frames: u64,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let min_confidence = self.min_confidence.get(None)?;
        let name = self.packets.display();
        let unreadable = |error: io::Error| anyhow!("{name}: cannot be read: {error}");
        let mut packets = open(&self.packets).map_err(unreadable)?;
        let mut claims = Claims::new();
        claims.read([&self.packets]);
        claims.write_in("-o", &self.output, |name| name == "frames.csv" || name.ends_with(".pfm"))?;
        let mut maps = Maps::begin(&self.output, min_confidence)?;
        let (mut stream, mut piece) = (PacketStream::new(), vec![0; PIECE]);
        loop {
            match packets.read(&mut piece) {
                Ok(0) => break,
                Ok(count) => stream.push(&piece[..count]).try_for_each(|frame| maps.add(frame))?,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(unreadable(error)),
            }
        }
        stream.finish().into_iter().try_for_each(|frame| maps.add(frame))?;
        let (tally, Maps { frames, whole, .. }) = (stream.tally(), maps);
        let summary = Summary {
            packets: tally.packets,
            damaged: tally.damaged,
            lost: tally.lost,
            repeated: tally.repeated,
            restarts: tally.restarts,
            frames,
            whole,
            empty: tally.empty,
            cut: tally.cut,
            unsent_frames: tally.unsent_frames,
        };
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.text() })?;
        if let Some((count, version)) = tally.other_version {
            return Err(Finding(format!(
                "{count} packets are of version {version}, this program reads version {VERSION}: build sender and receiver \
                 from the same release"
            ))
            .into());
        }
        ensure!(frames > 0, Finding("no frame came: are these the bytes of the row packets' port?".to_owned()));
        Ok(())
    }
}

fn open(path: &Path) -> io::Result<Box<dyn Read>> {
    Ok(if path == Path::new("-") { Box::new(io::stdin().lock()) } else { Box::new(File::open(path)?) })
}

/// The maps as they come.
struct Maps<'a> {
    folder: &'a Path,
    min_confidence: u8,
    table: GrowingTable,
    names: Names,
    frames: usize,
    whole: usize,
    warned: bool,
    bend: Bend,
    is_bent: bool,
}

impl<'a> Maps<'a> {
    fn begin(folder: &'a Path, min_confidence: u8) -> Result<Self> {
        let table = GrowingTable::create(&folder.join("frames.csv"))?;
        Ok(Self {
            folder,
            min_confidence,
            table,
            names: Names::default(),
            frames: 0,
            whole: 0,
            warned: false,
            bend: Bend::default(),
            is_bent: false,
        })
    }

    fn add(&mut self, mut frame: ReceivedFrame) -> Result<()> {
        frame.map.drop_below(self.min_confidence);
        let input = frame.figures.map_or(Input::Ok, |figures| figures.input);
        if let Some(advice) = input.advice().filter(|_| !self.warned) {
            self.warned = true;
            eprintln!("warning: frame {}: {advice}", frame.number);
        }
        let is_bent = self.bend.take(frame.figures);
        if let Some(error) = frame.figures.and_then(|figures| figures.row_error_q8).filter(|_| is_bent && !self.is_bent)
        {
            eprintln!("warning: frame {}: {}", frame.number, bent_words(row_error_px(error)));
        }
        self.is_bent = is_bent;
        output::write(&self.folder.join(self.names.next(frame.number)), &pfm::encode(&frame.map))?;
        self.table.add(&Row::of(&frame))?;
        self.frames += 1;
        self.whole += usize::from(frame.is_whole);
        Ok(())
    }
}

/// The files' names by the frames' numbers, which a sender that begins anew gives again.
#[derive(Debug, Default)]
struct Names {
    last: Option<u32>,
    /// Times that the numbers went back.
    restarts: u64,
}

impl Names {
    fn next(&mut self, number: u32) -> String {
        self.restarts += u64::from(self.last.is_some_and(|last| number <= last));
        self.last = Some(number);
        match self.restarts {
            0 => format!("{number:06}.pfm"),
            restarts => format!("{number:06}_{restarts}.pfm"),
        }
    }
}

impl Summary {
    fn text(&self) -> String {
        let Self { packets, damaged, lost, repeated, restarts, frames, whole, empty, cut, unsent_frames } = self;
        format!(
            "{frames} frames, {whole} of them whole, {empty} more without a single row; {packets} packets, \
             {damaged} damaged, {lost} lost, {repeated} repeated; {cut} frames came in part and were dropped, the sender \
             left out {unsent_frames}; it began anew {restarts} times\n"
        )
    }
}

/// A line for each frame: what came of it, and the chip's counters at its end.
#[derive(Debug, Serialize)]
struct Row {
    frame: u32,
    whole: u8,
    missing_rows: usize,
    input: Option<&'static str>,
    mismatch_percent: Option<f64>,
    share_sure: Option<f64>,
    row_error_px: Option<f64>,
    frames: u32,
    rows: u32,
    dropped_rows: u32,
    dropped_frames: u32,
    overruns: u32,
    short: u32,
    long: u32,
    stalled: u32,
    dma_errors: u32,
}

/// Percent of per mille.
fn percent(per_mille: u16) -> f64 {
    f64::from(per_mille) / 10.0
}

impl Row {
    fn of(frame: &ReceivedFrame) -> Self {
        let c = &frame.counters;
        Self {
            frame: frame.number,
            whole: u8::from(frame.is_whole),
            missing_rows: frame.missing_rows.len(),
            input: frame.figures.map(|figures| figures.input.name()),
            mismatch_percent: frame.figures.and_then(|figures| figures.mismatch).map(percent),
            share_sure: frame.figures.map(|figures| percent(figures.sure)),
            row_error_px: frame.figures.and_then(|figures| figures.row_error_q8).map(row_error_px),
            frames: c.frames,
            rows: c.rows,
            dropped_rows: c.dropped_rows,
            dropped_frames: c.dropped_frames,
            overruns: c.overruns,
            short: c.short,
            long: c.long,
            stalled: c.stalled,
            dma_errors: c.dma_errors,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DisparityMap;
    use haarline::Counters;
    use haarline::frame_figures::{FrameFigures, Input};
    use std::fs;

    #[test]
    fn a_sender_that_begins_anew_replaces_no_file() {
        let mut names = Names::default();
        let found = [0, 1, 0, 1, 2, 0].map(|number| names.next(number));
        let wanted = ["000000", "000001", "000000_1", "000001_1", "000002_1", "000000_2"];
        assert_eq!(found, wanted.map(|name| format!("{name}.pfm")));
    }

    #[test]
    fn a_frames_line_tells_what_is_missing_and_the_chips_counters() {
        let frame = ReceivedFrame {
            number: 7,
            map: DisparityMap::with_capacity(4, 2),
            counters: Counters { frames: 8, rows: 2, overruns: 1, ..Counters::ZERO },
            figures: Some(FrameFigures { input: Input::Ok, mismatch: Some(123), sure: 750, row_error_q8: Some(-160) }),
            missing_rows: vec![1],
            is_whole: false,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frames.csv");
        GrowingTable::create(&path).unwrap().add(&Row::of(&frame)).unwrap();
        let wanted = "frame,whole,missing_rows,input,mismatch_percent,share_sure,row_error_px,frames,rows,dropped_rows,dropped_frames,overruns,short,long,stalled,\
                      dma_errors\n7,0,1,ok,12.3,75.0,-0.625,8,2,0,0,1,0,0,0,0\n";
        assert_eq!(fs::read_to_string(&path).unwrap(), wanted);
    }
}
