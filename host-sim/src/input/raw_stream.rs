//! Raw frames as they come through a pipe: any number of them, one in memory.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use anyhow::{Result, anyhow};

use super::raw_dump::RawFormat;
use crate::StereoPair;

/// What a pipe, a device or the standard input delivers.
pub struct RawStream {
    from: Box<dyn Read + Send>,
    name: String,
    format: RawFormat,
    frame: Vec<u8>,
    has_ended: bool,
}

impl RawStream {
    /// Whether `path` is read as a stream: `-`, the standard input, or what is neither a file nor a folder.
    #[must_use]
    pub fn is_one(path: &Path) -> bool {
        path == Path::new("-") || path.metadata().is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
    }

    /// Opens it.
    ///
    /// # Errors
    /// If that cannot be.
    pub fn open(path: &Path, format: RawFormat) -> Result<Self> {
        let name = if path == Path::new("-") { "the standard input".to_owned() } else { path.display().to_string() };
        let from: Box<dyn Read + Send> = if path == Path::new("-") {
            Box::new(io::stdin())
        } else {
            Box::new(File::open(path).map_err(|error| anyhow!("{name}: cannot be read: {error}"))?)
        };
        Ok(Self::of(from, name, format))
    }

    /// The frames that `from` delivers.
    pub fn of(from: Box<dyn Read + Send>, name: String, format: RawFormat) -> Self {
        Self { from, name, format, frame: vec![0; format.frame_bytes()], has_ended: false }
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Fills the frame; how many bytes came before the end.
    fn fill(&mut self) -> io::Result<usize> {
        let mut filled = 0;
        while filled < self.frame.len() {
            match self.from.read(&mut self.frame[filled..]) {
                Ok(0) => break,
                Ok(count) => filled += count,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(filled)
    }
}

/// One frame after the other. One that is cut off at the end is an error, and nothing comes after an error.
impl Iterator for RawStream {
    type Item = Result<StereoPair>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.has_ended {
            return None;
        }
        let (filled, size) = (self.fill(), self.frame.len());
        self.has_ended = !matches!(&filled, Ok(filled) if *filled == size);
        match filled {
            Ok(0) => None,
            Ok(filled) if filled == size => Some(self.format.decode(&self.frame)),
            Ok(filled) => Some(Err(anyhow!(
                "{}: ends after {filled} of the {size} bytes of a frame: it is cut off, or --raw is another size",
                self.name
            ))),
            Err(error) => Some(Err(anyhow!("{}: cannot be read: {error}", self.name))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::raw_dump::ViewSize;
    use haarline::Wiring;
    use haarline::wiring::{First, Kind};

    /// Delivers a few bytes at a time, as pipes do.
    struct Trickle(Vec<u8>, usize);

    impl Read for Trickle {
        fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
            let count = room.len().min(7).min(self.0.len() - self.1);
            room[..count].copy_from_slice(&self.0[self.1..][..count]);
            self.1 += count;
            Ok(count)
        }
    }

    #[test]
    fn frames_come_one_by_one_and_a_cut_off_one_is_told() {
        let format =
            RawFormat { size: ViewSize { width: 32, height: 2 }, wiring: Wiring::new(Kind::SideBySide, First::Left) };
        for (extra, wanted) in [(0, [true, true].to_vec()), (5, vec![true, true, false])] {
            let bytes: Vec<u8> = (0..2 * format.frame_bytes() + extra).map(|i| i as u8).collect();
            let stream = RawStream::of(Box::new(Trickle(bytes.clone(), 0)), "pipe".to_owned(), format);
            let frames: Vec<Result<StereoPair>> = stream.collect();
            assert_eq!(frames.iter().map(Result::is_ok).collect::<Vec<_>>(), wanted);
            assert_eq!(frames[1].as_ref().unwrap(), &format.decode(&bytes[128..256]).unwrap());
        }
        assert_eq!(RawStream::of(Box::new(io::empty()), "pipe".to_owned(), format).count(), 0);
    }
}
