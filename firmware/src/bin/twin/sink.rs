//! Results into a file.

use haarline_firmware::edge::RowSink;
use haarline_firmware::ring::{MAX_WIDTH, ResultRow};
use semihosting::fs::File;
use semihosting::io::Write;
use semihosting::{eprintln, process};

use crate::clock::TwinClock;
use crate::file;
use crate::report;

/// Rows one after the other: frame and row as 32 bits, disparities as 16, confidences as 8, little-endian.
pub struct FileSink {
    file: File,
    clock: &'static TwinClock,
    counters: haarline::Counters,
    startup_stack: usize,
}

impl FileSink {
    pub fn create(clock: &'static TwinClock, startup_stack: usize) -> Result<Self, &'static str> {
        Ok(Self { file: file::create(file::ROWS)?, clock, counters: haarline::Counters::ZERO, startup_stack })
    }
}

impl RowSink for FileSink {
    async fn send(&mut self, row: &ResultRow) {
        self.counters = row.counters;
        let mut bytes = heapless::Vec::<u8, { 8 + 3 * MAX_WIDTH }>::new();
        let mut put = |part: &[u8]| {
            let _ = bytes.extend_from_slice(part);
        };
        put(&row.place.frame.to_le_bytes());
        put(&row.place.row.to_le_bytes());
        for disparity in row.disparity.iter().take(row.width) {
            put(&disparity.into_bits().to_le_bytes());
        }
        put(row.confidence.get(..row.width).unwrap_or(&[]));
        if self.file.write_all(&bytes).is_err() {
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
