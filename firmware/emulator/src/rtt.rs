//! The log: SEGGER RTT's first up channel, read as a probe reads it.

use rigless::emulator::{Error, Memory};
use rigless::soc::Width;

/// Where the first up channel lies in the control block, after the name and two counts.
const CHANNEL: u64 = 24;
/// And in the channel: the buffer, its size, and the positions of writer and reader.
const BUFFER: u64 = 4;
const SIZE: u64 = 8;
const WRITE: u64 = 12;
const READ: u64 = 16;

/// A reader of the log.
#[derive(Debug)]
pub struct Rtt {
    block: u64,
    /// The bytes of each run of the program, from one reset to the next.
    pub runs: Vec<Vec<u8>>,
}

impl Rtt {
    pub fn new(block: u64) -> Self {
        Self { block, runs: vec![Vec::new()] }
    }

    /// Takes what is there and makes room for more.
    ///
    /// # Errors
    /// If the control block is where nothing can be read or written.
    pub fn drain(&mut self, memory: &mut dyn Memory) -> Result<(), Error> {
        if !self.is_set_up(memory)? {
            return Ok(());
        }
        let channel = self.block + CHANNEL;
        let mut field = |offset| memory.read(channel + offset, Width::W32);
        let (buffer, size, write, mut read) = (field(BUFFER)?, field(SIZE)?, field(WRITE)?, field(READ)?);
        let Some(run) = self.runs.last_mut().filter(|_| size > 0) else { return Ok(()) };
        while read != write {
            run.push(memory.read(buffer + read, Width::W8)?.to_le_bytes()[0]);
            read = (read + 1) % size;
        }
        memory.write(channel + READ, Width::W32, read)
    }

    /// The part is about to start anew: takes what is left, and empties the channel as the program will when
    /// it sets its memory up, so that a look in between finds nothing.
    ///
    /// # Errors
    /// As with [`Self::drain`].
    pub fn restart(&mut self, memory: &mut dyn Memory) -> Result<(), Error> {
        let drained = self.drain(memory);
        self.runs.push(Vec::new());
        drained?;
        if self.is_set_up(memory)? {
            for offset in [WRITE, READ] {
                memory.write(self.block + CHANNEL + offset, Width::W32, 0)?;
            }
        }
        Ok(())
    }

    fn is_set_up(&self, memory: &mut dyn Memory) -> Result<bool, Error> {
        let mut id = [0; 8];
        for (at, byte) in (self.block..).zip(&mut id) {
            *byte = memory.read(at, Width::W8)?.to_le_bytes()[0];
        }
        Ok(&id == b"SEGGER R")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK: u64 = 0x100;
    const BYTES: u64 = 0x200;

    /// From address 0 on.
    struct Ram(Vec<u8>);

    impl Memory for Ram {
        fn read(&mut self, address: u64, width: Width) -> Result<u64, Error> {
            let from = usize::try_from(address).unwrap();
            let bytes = &self.0[from..from + usize::try_from(width.bytes()).unwrap()];
            Ok(bytes.iter().rev().fold(0, |value, &byte| value << 8 | u64::from(byte)))
        }

        fn write(&mut self, address: u64, width: Width, value: u64) -> Result<(), Error> {
            let (from, len) = (usize::try_from(address).unwrap(), usize::try_from(width.bytes()).unwrap());
            self.0[from..from + len].copy_from_slice(&value.to_le_bytes()[..len]);
            Ok(())
        }
    }

    #[test]
    fn a_log_survives_a_reset() {
        let mut ram = Ram(vec![0; 0x400]);
        let mut rtt = Rtt::new(BLOCK);
        rtt.drain(&mut ram).unwrap();
        assert_eq!(rtt.runs, [b""], "not set up");
        ram.0[0x100..0x10A].copy_from_slice(b"SEGGER RTT");
        for (offset, value) in [(BUFFER, BYTES), (SIZE, 8), (WRITE, 3), (READ, 0)] {
            ram.write(BLOCK + CHANNEL + offset, Width::W32, value).unwrap();
        }
        ram.0[0x200..0x208].copy_from_slice(b"abcdefgh");
        rtt.drain(&mut ram).unwrap();
        ram.write(BLOCK + CHANNEL + WRITE, Width::W32, 1).unwrap();
        rtt.restart(&mut ram).unwrap();
        rtt.drain(&mut ram).unwrap();
        assert_eq!(rtt.runs, [b"abcdefgha".as_slice(), b""]);
        ram.write(BLOCK + CHANNEL + WRITE, Width::W32, 2).unwrap();
        rtt.drain(&mut ram).unwrap();
        assert_eq!(rtt.runs, [b"abcdefgha".as_slice(), b"ab"]);
    }
}
