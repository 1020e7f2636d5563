//! A camera made of a file: the recording is played from its beginning again until all frames are done.

use embassy_time::Timer;
use haarline_firmware::app::edge::{RowSource, SourceEvent};
use semihosting::fs::File;
use semihosting::io::{Read, Seek, SeekFrom};
use semihosting::{eprintln, process};

use crate::chip::PATIENCE;
use crate::fault::{Fault, FaultKind};
use crate::file;
use crate::options::Options;

/// Rows of the recording, one by one.
pub struct FileSource {
    file: File,
    raw_len: usize,
    height: u32,
    /// Frames of the file, and to play.
    recorded: u32,
    frames: u32,
    fault: Option<Fault>,
    frame: u32,
    /// Events of the frame so far: its start, its rows, its end.
    at: u32,
    random: u32,
}

impl FileSource {
    pub fn open(options: &Options) -> Result<Self, &'static str> {
        Ok(Self {
            file: file::open(file::RAW)?,
            raw_len: options.raw_len,
            height: options.height,
            recorded: options.recorded,
            frames: options.frames,
            fault: options.fault,
            frame: 0,
            at: 0,
            random: 1,
        })
    }

    /// The trouble of the frame under way.
    fn trouble(&self) -> Option<FaultKind> {
        self.fault.filter(|fault| fault.frame == self.frame).map(|fault| fault.kind)
    }

    fn end_frame(&mut self) -> SourceEvent {
        self.frame += 1;
        self.at = 0;
        SourceEvent::End
    }

    /// The row of the recording.
    fn read(&mut self, row: u32, bytes: &mut [u8]) -> SourceEvent {
        let index = u64::from(self.frame % self.recorded) * u64::from(self.height) + u64::from(row);
        let start = SeekFrom::Start(index * u64::try_from(self.raw_len).unwrap_or(0));
        let bytes = bytes.get_mut(..self.raw_len).unwrap_or(&mut []);
        if self.file.seek(start).and_then(|_| self.file.read_exact(bytes)).is_err() {
            eprintln!("error: the recording ends early");
            process::exit(1);
        }
        SourceEvent::Row(self.raw_len)
    }

    /// Noise; of every other row the last byte is missing.
    fn noise(&mut self, row: u32, bytes: &mut [u8]) -> SourceEvent {
        for byte in bytes {
            self.random = self.random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *byte = self.random.to_be_bytes()[0];
        }
        SourceEvent::Row(self.raw_len - usize::from(row % 2 == 1))
    }
}

impl RowSource for FileSource {
    async fn next(&mut self, bytes: &mut [u8]) -> SourceEvent {
        if self.frame == self.frames {
            return SourceEvent::Over;
        }
        let at = self.at;
        self.at += 1;
        let Some(row) = at.checked_sub(1) else { return SourceEvent::Start };
        let middle = self.height / 2;
        match self.trouble() {
            Some(FaultKind::LostLine) if row == middle => return SourceEvent::Lost,
            Some(FaultKind::Overrun) if row == middle => return SourceEvent::Overrun,
            Some(FaultKind::Short) if row == middle => return self.end_frame(),
            Some(FaultKind::Garbage) if (middle..middle + 8).contains(&row) => return self.noise(row, bytes),
            Some(FaultKind::Stall) if row == middle => Timer::after(PATIENCE.within * 3 / 2).await,
            Some(FaultKind::Long) if (self.height..self.height + self.height / 4).contains(&row) => {
                return self.read(self.height - 1, bytes);
            }
            Some(FaultKind::Long) if row > self.height => return self.end_frame(),
            _ => {}
        }
        let ends = row >= self.height;
        if ends { self.end_frame() } else { self.read(row, bytes) }
    }

    fn is_waiting(&self) -> bool {
        self.trouble() == Some(FaultKind::Burst)
    }
}
