//! Raw dumps: the bytes that a camera port stored, frame after frame, without any header.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::str::FromStr;

use anyhow::{Context, Result, anyhow, ensure};
use haarline::{Config, ScanlinePair, Wiring};

use crate::{Frame, StereoPair};

/// The size of one view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ViewSize {
    /// Pixels in a row, within the limits of [`Config`].
    pub width: u16,
    /// Rows, 1 or more.
    pub height: u16,
}

impl FromStr for ViewSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let form = || "must be WIDTHxHEIGHT of one view, px, as in 320x240".to_owned();
        let (width, height) = text.split_once(['x', 'X']).ok_or_else(form)?;
        let width: u16 = width.parse().map_err(|_| form())?;
        let height: u16 = height.parse().map_err(|_| form())?;
        let (min, max) = (Config::MIN_WIDTH, Config::MAX_WIDTH);
        if !(min..=max).contains(&width) {
            return Err(format!("one view may be {min} to {max} px wide"));
        }
        if height == 0 {
            return Err("a view must have 1 row or more".to_owned());
        }
        Ok(Self { width, height })
    }
}

/// What the bytes of a dump mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawFormat {
    /// The size of one view.
    pub size: ViewSize,
    /// In which order the pixels were stored.
    pub wiring: Wiring,
}

impl RawFormat {
    /// Bytes of a frame.
    #[must_use]
    pub fn frame_bytes(&self) -> usize {
        self.wiring.row_bytes(self.size.width) * usize::from(self.size.height)
    }

    /// The views in the bytes of a frame.
    ///
    /// # Errors
    /// If they are not [`RawFormat::frame_bytes`].
    pub fn decode(&self, bytes: &[u8]) -> Result<StereoPair> {
        let ViewSize { width, height } = self.size;
        let (expected, found) = (self.frame_bytes(), bytes.len());
        ensure!(found == expected, "a raw frame of {found} bytes where {expected} were expected");
        let (width, height) = (width.into(), height.into());
        let (mut left, mut right) = (vec![0; width * height], vec![0; width * height]);
        let views = left.chunks_mut(width).zip(right.chunks_mut(width));
        for (raw, (left, right)) in bytes.chunks(self.wiring.row_bytes(self.size.width)).zip(views) {
            self.wiring.unpack(raw, left, right)?;
        }
        let frame = |luma| Frame::from_luma(width, height, luma);
        Ok(StereoPair { left: frame(left), right: frame(right) })
    }

    /// Reads frame `index` of the dump in `path`.
    ///
    /// # Errors
    /// If the file cannot be read or ends before the frame does.
    pub fn read(&self, path: &Path, index: usize) -> Result<StereoPair> {
        let size = self.frame_bytes() as u64;
        let mut bytes = Vec::new();
        let mut fetch = || {
            let mut file = File::open(path)?;
            file.seek(SeekFrom::Start(index as u64 * size))?;
            file.take(size).read_to_end(&mut bytes)
        };
        let found = fetch().map_err(|error| anyhow!("{}: cannot be read: {error}", path.display()))? as u64;
        ensure!(
            found == size,
            "{}: ends after {found} of the {size} bytes of frame {index}: the dump is cut off, or of another size",
            path.display()
        );
        self.decode(&bytes).with_context(|| path.display().to_string())
    }

    /// Frames of the dump in `path`, one that is cut off at the end included.
    ///
    /// # Errors
    /// If the file cannot be read or has not even one whole frame.
    pub fn count_frames(&self, path: &Path) -> Result<usize> {
        let name = path.display();
        let metadata = path.metadata().map_err(|error| anyhow!("{name}: cannot be read: {error}"))?;
        ensure!(metadata.is_file(), "{name}: is a folder, where a file with a raw dump is expected");
        let (bytes, frame) = (metadata.len(), self.frame_bytes() as u64);
        let ViewSize { width, height } = self.size;
        ensure!(
            bytes >= frame,
            "{name}: has {bytes} bytes, not even one frame of two views of {width}x{height} px, which is {frame} bytes"
        );
        Ok(bytes.div_ceil(frame) as usize)
    }
}

/// Appends a frame to a dump.
///
/// # Errors
/// If it cannot be written.
pub fn write_frame(wiring: Wiring, pair: &StereoPair, to: &mut dyn Write) -> Result<()> {
    let mut raw = vec![0; 2 * pair.width()];
    for y in 0..pair.height() {
        wiring.pack(ScanlinePair { left: pair.left.row(y), right: pair.right.row(y) }, &mut raw)?;
        to.write_all(&raw)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::wiring::{First, Kind, Skew};

    #[test]
    fn a_size_is_that_of_one_view_within_the_limits() {
        assert_eq!("320x240".parse(), Ok(ViewSize { width: 320, height: 240 }));
        for text in ["", "320", "320x", "x240", "320x0", "31x240", "1281x1", "320x70000", "-320x240", "320x240x2"] {
            assert!(text.parse::<ViewSize>().is_err(), "{text:?}");
        }
    }

    #[test]
    fn frames_come_back_from_a_dump_of_every_wiring() {
        let size = ViewSize { width: 33, height: 3 };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dump.raw");
        for &kind in Kind::ALL {
            // Fourteen lines carry seven bits of each view.
            let keep = if kind == Kind::Pairs14 { 0xfe } else { 0xff };
            let view = |frame: usize, seed: usize| {
                let luma = (0..99).map(|i| (i * i * seed + frame * 31) as u8 & keep).collect();
                Frame::from_luma(33, 3, luma)
            };
            let pairs = [0, 1].map(|frame| StereoPair { left: view(frame, 7), right: view(frame, 13) });
            for &first in First::ALL {
                let format = RawFormat { size, wiring: Wiring { kind, first, skew: Skew::None } };
                let mut bytes = Vec::new();
                for pair in &pairs {
                    write_frame(format.wiring, pair, &mut bytes).unwrap();
                }
                std::fs::write(&path, &bytes).unwrap();
                assert_eq!(format.count_frames(&path).unwrap(), 2);
                assert_eq!([0, 1].map(|index| format.read(&path, index).unwrap()), pairs, "{format:?}");

                std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
                assert_eq!(format.count_frames(&path).unwrap(), 2);
                assert_eq!(format.read(&path, 0).unwrap(), pairs[0]);
                let told = format.read(&path, 1).unwrap_err().to_string();
                assert!(told.contains("197 of the 198 bytes"), "{told}");
                std::fs::write(&path, &bytes[..197]).unwrap();
                assert!(format.count_frames(&path).is_err());
            }
        }
    }
}
