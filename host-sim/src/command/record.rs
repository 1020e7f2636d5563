//! `haarline record`: pairs as the bytes that a camera port would store of them.

use std::io::Write;
use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use haarline::Wiring;
use haarline_rig::Description;
use serde::Serialize;

use super::shared::{LayoutArgs, WiringArgs, progress, warn_skipped};
use super::{Finding, print};
use crate::input::raw_dump::write_frame;
use crate::input::recording::{FrameRange, RecordedFrame, find_frames};
use crate::input::rig_file;
use crate::output::claims::Claims;
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
    #[command(flatten)]
    layout: LayoutArgs,
    /// Only these frames of the recording, counted from 0: A..B without B, A.. or ..B
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, requires = "recording")]
    frames: Option<FrameRange>,
    /// The dump: frame after frame without any header
    #[arg(short, long = "output", value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    wiring: WiringArgs,
    /// Rig description: its wiring and first camera hold where no option tells otherwise
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
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

/// One frame, not read yet.
enum Source<'a> {
    Views(&'a [PathBuf]),
    Recorded(RecordedFrame),
}

/// A dump as it grows.
struct Dump<'a> {
    wiring: Wiring,
    file: &'a mut dyn Write,
    /// Of the first frame.
    size: Option<[usize; 2]>,
    frames: usize,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let rig = self.rig.as_deref().map(rig_file::read).transpose()?;
        let wiring = self.wiring.get_with(rig.as_ref())?;
        let sources = self.sources(rig.as_ref())?;
        let mut told = None;
        output::write_with(&self.output, |file| {
            let mut dump = Dump { wiring, file, size: None, frames: 0 };
            self.fill(&mut dump, &sources)?;
            told = dump.size.map(|size| (size, dump.frames));
            Ok(())
        })?;
        let ([width, height], frames) = told.context("no frame was written")?;
        let damaged = sources.len() - frames;
        let summary = Summary {
            file: self.output.clone(),
            width,
            height,
            wiring: wiring.kind.name(),
            first: wiring.first.name(),
            skew: wiring.skew.name(),
            frames,
            damaged,
            bytes: frames * 2 * width * height,
        };
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.text() })?;
        ensure!(damaged == 0, Finding(format!("{damaged} of {} frames were damaged and skipped", sources.len())));
        Ok(())
    }

    /// What is read; the dump may be none of it.
    fn sources(&self, rig: Option<&Description>) -> Result<Vec<Source<'_>>> {
        let mut claims = Claims::new();
        claims.read(self.views.iter().chain(&self.rig));
        let Some(folder) = &self.recording else {
            claims.write("-o", &self.output)?;
            return Ok(vec![Source::Views(&self.views)]);
        };
        let frames = find_frames(folder, self.layout.get(self.wiring.first_with(rig))?)?;
        claims.read_recording(folder, frames.iter().flat_map(RecordedFrame::files));
        claims.write("-o", &self.output)?;
        let (range, recorded) = (self.frames.unwrap_or_default(), frames.len());
        let frames = range.choose(frames, 1);
        ensure!(!frames.is_empty(), "--frames {range}: the recording has {recorded} frames only, counted from 0");
        Ok(frames.into_iter().map(Source::Recorded).collect())
    }

    /// Writes one frame after the other. Of a recording, a damaged one is told and skipped.
    fn fill(&self, dump: &mut Dump<'_>, sources: &[Source<'_>]) -> Result<()> {
        let bar = progress(sources.len(), "frames")?;
        for source in sources {
            match (source.read().and_then(|pair| dump.check_size(pair)), source) {
                (Ok(pair), _) => dump.add(&pair)?,
                (Err(error), Source::Views(_)) => return Err(error),
                (Err(error), Source::Recorded(frame)) => {
                    bar.suspend(|| warn_skipped(frame.index, &format!("{error:#}")));
                }
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
        ensure!(dump.frames > 0, "none of the {} frames can be read", sources.len());
        Ok(())
    }
}

impl Source<'_> {
    fn read(&self) -> Result<StereoPair> {
        match self {
            Self::Views([left, right]) => StereoPair::read(left, right),
            Self::Views(_) => bail!("a left and a right view are needed"),
            Self::Recorded(frame) => frame.read(),
        }
    }
}

impl Dump<'_> {
    /// The pair, if it has the size of the first one.
    fn check_size(&mut self, pair: StereoPair) -> Result<StereoPair> {
        let found = [pair.width(), pair.height()];
        let [width, height] = *self.size.get_or_insert(found);
        ensure!(
            found == [width, height],
            "the views are {}x{} px, but those of the first frame are {width}x{height} px",
            found[0],
            found[1]
        );
        Ok(pair)
    }

    fn add(&mut self, pair: &StereoPair) -> Result<()> {
        self.frames += 1;
        write_frame(self.wiring, pair, self.file)
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
