//! `haarline record`: pairs as the bytes that a camera port would store of them.

use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use serde::Serialize;

use super::shared::{LayoutKind, WiringArgs, layout, progress, warn_skipped};
use super::{Finding, print};
use crate::raw_dump::write_frame;
use crate::recording::{FrameRange, Side, find_frames};
use crate::{StereoPair, output};

/// Arguments of `haarline record`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The left and the right view: a dump of one frame
    #[arg(value_names = ["LEFT", "RIGHT"], num_args = 2, required_unless_present = "recording",
        conflicts_with = "recording")]
    views: Vec<PathBuf>,
    /// A recording instead, as for haarline play: all its frames one after the other
    #[arg(long, value_name = "DIR")]
    recording: Option<PathBuf>,
    /// How the recording's views are stored
    #[arg(long, value_enum, default_value_t = LayoutKind::Folders, requires = "recording")]
    layout: LayoutKind,
    /// Which camera the left half of the recording's side-by-side frames belongs to
    #[arg(long, value_enum, value_name = "CAMERA", requires = "recording")]
    layout_first: Option<Side>,
    /// Only these frames of the recording, counted from 0: A..B without B, A.. or ..B
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, requires = "recording")]
    frames: Option<FrameRange>,
    /// The dump: frame after frame without any header
    #[arg(short, long = "output", value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    wiring: WiringArgs,
    /// Prints the summary as JSON
    #[arg(long)]
    json: bool,
}

/// What is told about a dump.
#[derive(Debug, Serialize)]
struct Summary {
    file: PathBuf,
    width: usize,
    height: usize,
    wiring: &'static str,
    first: &'static str,
    skew: &'static str,
    frames: usize,
    damaged: usize,
    bytes: usize,
}

/// Where a frame comes from.
type Reader<'a> = Box<dyn Fn() -> Result<StereoPair> + 'a>;

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let wiring = self.wiring.get_required()?;
        output::check_writable("-o", &self.output)?;
        let recorded = match &self.recording {
            Some(folder) => find_frames(folder, layout(self.layout, self.layout_first, "--layout-first")?)?,
            None => Vec::new(),
        };
        let range = self.frames.unwrap_or_default();
        let count = recorded.len();
        let recorded = range.choose(recorded, 1);
        let readers: Vec<Reader<'_>> = match &self.views[..] {
            [left, right] => {
                for view in [left, right] {
                    let same = output::is_same_file(view, &self.output);
                    ensure!(!same, "-o {}: is one of the views, give another name", self.output.display());
                }
                vec![Box::new(|| StereoPair::read(left, right))]
            }
            _ => recorded.iter().map(|frame| -> Reader<'_> { Box::new(|| frame.read()) }).collect(),
        };
        ensure!(!readers.is_empty(), "--frames {range}: the recording has {count} frames only, counted from 0");
        let mut size = None;
        let mut written = 0;
        let bar = progress(readers.len(), "frames")?;
        output::write_with(&self.output, |file| {
            for (index, read) in readers.iter().enumerate() {
                let pair = read().and_then(|pair| {
                    let [width, height] = *size.get_or_insert([pair.width(), pair.height()]);
                    ensure!(
                        [pair.width(), pair.height()] == [width, height],
                        "the views are {}x{} px, but those of the first frame are {width}x{height} px",
                        pair.width(),
                        pair.height()
                    );
                    Ok(pair)
                });
                match pair {
                    Ok(pair) => {
                        write_frame(wiring, &pair, file)?;
                        written += 1;
                    }
                    Err(error) if self.recording.is_none() => return Err(error),
                    Err(error) => bar.suspend(|| warn_skipped(recorded[index].index, &format!("{error:#}"))),
                }
                bar.inc(1);
            }
            if written == 0 {
                bail!("none of the {} frames can be read", readers.len());
            }
            Ok(())
        })?;
        bar.finish_and_clear();
        let [width, height] = size.context("a frame was written")?;
        let damaged = readers.len() - written;
        let summary = Summary {
            file: self.output.clone(),
            width,
            height,
            wiring: wiring.kind.name(),
            first: wiring.first.name(),
            skew: wiring.skew.name(),
            frames: written,
            damaged,
            bytes: written * 2 * width * height,
        };
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.text() })?;
        ensure!(damaged == 0, Finding(format!("{damaged} of {} frames were damaged and skipped", readers.len())));
        Ok(())
    }
}

impl Summary {
    fn text(&self) -> String {
        let Self { file, width, height, wiring, first, skew, frames, bytes, .. } = self;
        let (file, s) = (file.display(), if *frames == 1 { "" } else { "s" });
        let skew = if *skew == "none" { String::new() } else { format!(" --skew {skew}") };
        format!(
            "{frames} frame{s} of {width}x{height} px a view, {bytes} bytes: haarline play {file} --raw \
             {width}x{height} --wiring {wiring} --first {first}{skew} -o DIR\n"
        )
    }
}
