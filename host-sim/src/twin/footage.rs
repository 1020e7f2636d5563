//! What the cameras' port stores, and what the chip makes of it.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use haarline::Wiring;

use crate::StereoPair;
use crate::input::raw_dump::{RawFormat, ViewSize, write_frame};
use crate::input::whole_file;

/// No dump that is played at once is longer.
const MAX_RAW_BYTES: u64 = 1 << 30;

/// Frames as the bytes of a camera port.
#[derive(Debug, Clone)]
pub struct Footage {
    /// What the bytes mean.
    pub format: RawFormat,
    /// The bytes of all frames.
    pub raw: Vec<u8>,
    /// The views in them: with a skew not quite the recorded ones, since a pixel of each row is lost.
    pub pairs: Vec<StereoPair>,
}

impl Footage {
    /// What a port of that wiring would store of the pairs.
    ///
    /// # Errors
    /// If they are none, or of several sizes.
    pub fn record(pairs: &[StereoPair], wiring: Wiring) -> Result<Self> {
        let first = pairs.first().context("the recording has no frame")?;
        let (width, height) = (first.width(), first.height());
        let other = pairs.iter().position(|pair| (pair.width(), pair.height()) != (width, height));
        ensure!(other.is_none(), "frame {} has another size than the first", other.unwrap_or_default());
        let size = ViewSize { width: u16::try_from(width)?, height: u16::try_from(height)? };
        let mut raw = Vec::new();
        pairs.iter().try_for_each(|pair| write_frame(wiring, pair, &mut raw))?;
        Self::of(RawFormat { size, wiring }, raw)
    }

    /// The bytes that a port did store. A frame that is cut off at the end is left out.
    ///
    /// # Errors
    /// If the file cannot be read or has not even one whole frame.
    pub fn read(path: &Path, format: RawFormat) -> Result<Self> {
        format.count_frames(path)?;
        let mut raw = whole_file::bytes(path, MAX_RAW_BYTES)?;
        raw.truncate(raw.len() - raw.len() % format.frame_bytes());
        Self::of(format, raw)
    }

    fn of(format: RawFormat, raw: Vec<u8>) -> Result<Self> {
        let pairs = raw.chunks(format.frame_bytes()).map(|frame| format.decode(frame)).collect::<Result<_>>()?;
        Ok(Self { format, raw, pairs })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Frame;
    use haarline::wiring::{First, Kind};
    use std::fs;

    fn pair(width: usize) -> StereoPair {
        let view = |factor: usize| Frame::from_luma(width, 3, (0..width * 3).map(|i| (i * factor) as u8).collect());
        StereoPair { left: view(7), right: view(11) }
    }

    #[test]
    fn what_is_recorded_is_read_again_without_the_frame_that_is_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dump.raw");
        for &kind in Kind::ALL {
            let recorded = Footage::record(&[pair(40), pair(40)], Wiring::new(kind, First::Right)).unwrap();
            assert_eq!(recorded.pairs.len(), 2);
            fs::write(&path, [&recorded.raw[..], &[0; 9]].concat()).unwrap();
            let read = Footage::read(&path, recorded.format).unwrap();
            assert_eq!((read.raw, read.pairs), (recorded.raw, recorded.pairs), "{kind:?}");
        }
    }

    #[test]
    fn frames_of_one_size_are_wanted() {
        let wiring = |kind| Wiring::new(kind, First::Left);
        assert_eq!(Footage::record(&[pair(40)], wiring(Kind::SideBySide)).unwrap().pairs, [pair(40)]);
        assert!(Footage::record(&[pair(40), pair(44)], wiring(Kind::SideBySide)).is_err());
        assert!(Footage::record(&[], wiring(Kind::SideBySide)).is_err());
    }
}
