//! `haarline rig rectify`: a recording's views, rectified as the core does it.

use std::collections::HashSet;
use std::path::PathBuf;

use anyhow::{Result, ensure};

use super::super::shared::{FrameArgs, progress, warn_skipped};
use super::super::{Finding, print};
use crate::input::recording::RecordedFrame;
use crate::input::rig_file;
use crate::output::claims::Claims;
use crate::output::{self, encode_grey_png};
use crate::stereo::pipeline;

/// Arguments of `haarline rig rectify`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The recording, as its cameras took it
    recording: PathBuf,
    /// Description of the rig
    #[arg(long, value_name = "FILE")]
    rig: PathBuf,
    /// Where the rectified views go: left/<frame>.png and right/<frame>.png, black where a row needs what no camera saw
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    frames: FrameArgs,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let rig = rig_file::read(&self.rig)?;
        let rectification = rig.rectification()?;
        let frames = self.frames.choose(&self.recording, Some(&rig), usize::MAX)?;
        // That all views have another size is told once.
        if let Some(Ok(pair)) = frames.get(frames.len() / 2).map(RecordedFrame::read) {
            rig_file::check_size(&rig, [pair.width(), pair.height()])?;
        }
        let sides = ["left", "right"].map(|side| self.output.join(side));
        let names: HashSet<String> = frames.iter().map(|frame| format!("{}.png", frame.name)).collect();
        let mut claims = Claims::new();
        claims.read([&self.rig]);
        claims.read_recording(&self.recording, frames.iter().flat_map(RecordedFrame::files));
        for side in &sides {
            claims.write_in("-o", side, |name| names.contains(name))?;
        }
        let (bar, mut damaged) = (progress(frames.len(), "frames")?, 0);
        for frame in &frames {
            bar.inc(1);
            let pair = frame.read().and_then(|pair| {
                rig_file::check_size(&rig, [pair.width(), pair.height()])?;
                Ok(pair)
            });
            match pair {
                Ok(pair) => {
                    let pair = pipeline::rectified_views(&rectification, &pair)?;
                    for (side, view) in sides.iter().zip([&pair.left, &pair.right]) {
                        let file = encode_grey_png(&view.luma, [view.width, view.height])?;
                        output::write(&side.join(format!("{}.png", frame.name)), &file)?;
                    }
                }
                Err(error) => {
                    warn_skipped(frame.index, &format!("{error:#}"));
                    damaged += 1;
                }
            }
        }
        bar.finish_and_clear();
        ensure!(damaged < frames.len(), "no frame could be rectified");
        print(&format!("{} pairs in {}\n", frames.len() - damaged, self.output.display()))?;
        ensure!(damaged == 0, Finding(format!("{damaged} of {} frames were damaged and skipped", frames.len())));
        Ok(())
    }
}
