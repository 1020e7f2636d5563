//! Packets into a file.

use haarline_firmware::app::edge::PacketSink;
use semihosting::fs::File;
use semihosting::io::Write;
use semihosting::{eprintln, process};

use crate::clock::TwinClock;
use crate::options::Options;
use crate::{file, report};

/// Keeps the packets of the first and of the last frames.
pub struct FileSink {
    file: File,
    clock: &'static TwinClock,
    startup_stack: usize,
    /// Frames to keep at either end, of how many.
    keep: u32,
    frames: u32,
}

impl FileSink {
    pub fn create(options: &Options, clock: &'static TwinClock, startup_stack: usize) -> Result<Self, &'static str> {
        let Options { keep, frames, .. } = *options;
        Ok(Self { file: file::create(file::ROWS)?, clock, startup_stack, keep, frames })
    }
}

impl PacketSink for FileSink {
    async fn send(&mut self, frame: u32, packet: &[u8]) {
        let is_kept = frame < self.keep || frame >= self.frames.saturating_sub(self.keep);
        if is_kept && self.file.write_all(packet).is_err() {
            eprintln!("error: results cannot be written");
            process::exit(1);
        }
    }

    async fn finish(&mut self) {
        let done = report::write(self.clock, self.startup_stack);
        if done.is_err() {
            eprintln!("error: the report cannot be written");
        }
        process::exit(i32::from(done.is_err()));
    }
}
