//! Where the frames come from: a recording of known length, or a stream.

use std::path::Path;

use anyhow::{Result, ensure};

use super::Taken;
use crate::input::frame::Shrink;
use crate::input::raw_dump::{RawFormat, ViewSize};
use crate::input::raw_stream::RawStream;
use crate::input::recording::{FrameRange, RecordedFrame};

/// Frames that were not read yet.
pub enum Source {
    /// All of a recording.
    Recorded(Vec<RecordedFrame>),
    /// What a stream delivers, of views of this size.
    Stream {
        /// The frames as they come.
        frames: Box<dyn Iterator<Item = Taken> + Send>,
        /// Of a view before it is shrunk.
        size: ViewSize,
    },
}

impl Source {
    /// The frames of a recording, shrunk.
    #[must_use]
    pub fn recorded(frames: Vec<RecordedFrame>, shrink: Shrink) -> Self {
        Self::Recorded(frames.into_iter().map(|frame| frame.with_shrink(shrink)).collect())
    }

    /// The frames of a stream, shrunk.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn stream(path: &Path, format: RawFormat, shrink: Shrink) -> Result<Self> {
        let stream = RawStream::open(path, format)?;
        let file = stream.name().to_owned();
        let taken = move |(index, views): (usize, Result<crate::StereoPair>)| Taken {
            index,
            name: format!("{index:06}"),
            file: file.clone(),
            views: views.map(|pair| pair.shrunk(shrink)),
        };
        Ok(Self::Stream { frames: Box::new(stream.enumerate().map(taken)), size: format.size })
    }

    /// Keeps every `step`-th frame of the range; how many there were before, if that is known.
    ///
    /// # Errors
    /// If none is left of a recording.
    pub fn choose(&mut self, range: FrameRange, step: usize) -> Result<Option<usize>> {
        match self {
            Self::Recorded(frames) => {
                let recorded = frames.len();
                *frames = range.choose(std::mem::take(frames), step);
                ensure!(
                    !frames.is_empty(),
                    "--frames {range}: the recording has {recorded} frames only, counted from 0: the last one is {}",
                    recorded - 1
                );
                Ok(Some(recorded))
            }
            Self::Stream { frames, .. } => {
                let all = std::mem::replace(frames, Box::new(std::iter::empty()));
                *frames = Box::new(range.choose_from(all, step));
                Ok(None)
            }
        }
    }

    /// Frames, if that is known.
    #[must_use]
    pub fn known_length(&self) -> Option<usize> {
        if let Self::Recorded(frames) = self { Some(frames.len()) } else { None }
    }

    /// Width and height of the views, as the first frame of a recording that can be read has them; `shrink` is that of
    /// the stream.
    #[must_use]
    pub fn size(&self, shrink: Shrink) -> Option<(u16, usize)> {
        match self {
            Self::Recorded(frames) => {
                let pair = frames.iter().find_map(|frame| frame.read().ok())?;
                Some((pair.width() as u16, pair.height()))
            }
            Self::Stream { size, .. } => {
                Some((shrink.of(size.width.into()) as u16, shrink.of(size.height.into()) as usize))
            }
        }
    }

    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let frames = if let Self::Recorded(frames) = self { &frames[..] } else { &[] };
        frames.iter().flat_map(RecordedFrame::files)
    }

    /// Reads one frame after the other.
    #[must_use]
    pub fn taken(self) -> Box<dyn Iterator<Item = Taken> + Send> {
        match self {
            Self::Recorded(frames) => Box::new(frames.into_iter().map(|frame| Taken::of(&frame))),
            Self::Stream { frames, .. } => frames,
        }
    }
}
