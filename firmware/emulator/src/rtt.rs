//! The log: SEGGER RTT's first up channel, read as a probe reads it.

use rigless::emulator::{Error, Memory};
use rigless::soc::Width;

/// Where the first up channel lies in the control block, after the name and two counts.
const CHANNEL: u64 = 24;

/// A reader of the log.
#[derive(Debug)]
pub struct Rtt {
    block: u64,
    pub bytes: Vec<u8>,
}

impl Rtt {
    pub fn new(block: u64) -> Self {
        Self { block, bytes: Vec::new() }
    }

    /// Takes what is there and makes room for more.
    pub fn drain(&mut self, memory: &mut dyn Memory) -> Result<(), Error> {
        let mut id = [0; 8];
        for (at, byte) in (self.block..).zip(&mut id) {
            *byte = memory.read(at, Width::W8)?.to_le_bytes()[0];
        }
        if &id != b"SEGGER R" {
            return Ok(()); // not set up yet
        }
        let channel = self.block + CHANNEL;
        let mut field = |nth: u64| memory.read(channel + 4 * nth, Width::W32);
        let (buffer, size, write, mut read) = (field(1)?, field(2)?, field(3)?, field(4)?);
        if size == 0 {
            return Ok(());
        }
        while read != write {
            self.bytes.push(memory.read(buffer + read, Width::W8)?.to_le_bytes()[0]);
            read = (read + 1) % size;
        }
        memory.write(channel + 16, Width::W32, read)
    }
}
