//! What is asked and answered, written by postcard.

use serde::{Deserialize, Serialize};

/// The version of all this: others are refused by name.
pub const VERSION: u16 = 1;
/// Columns of the widest view.
pub const WIDTH: usize = 320;
/// Disparities of every search.
pub const DISPARITIES: usize = 48;
/// Rows that the board keeps until they are taken.
pub const KEPT: usize = 64;
/// Stages of the pipeline, in the core's order.
pub const STAGES: usize = 10;

/// A stereo method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Method {
    /// `full`
    Full,
    /// `lite`
    Lite,
    /// `wavelet-block`
    WaveletBlock,
    /// `block`
    Block,
    /// `sgm`
    Sgm,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Full, Self::Lite, Self::WaveletBlock, Self::Block, Self::Sgm];

    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Lite => "lite",
            Self::WaveletBlock => "wavelet-block",
            Self::Block => "block",
            Self::Sgm => "sgm",
        }
    }
}

/// What the host asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Request<'a> {
    /// Who is there?
    Hello,
    /// Begins a frame with a method anew.
    Begin {
        /// The method.
        method: Method,
        /// Columns of a view, up to [`WIDTH`].
        width: u16,
        /// The least disparity of the [`DISPARITIES`] that are searched.
        min_disparity: i16,
    },
    /// The next row of the frame: the left view's pixels, then the right one's.
    Push(&'a [u8]),
    /// The frame has ended.
    Finish,
    /// The row that was delivered as the `0`th, `1`st, ... since the beginning.
    Take(u32),
    /// What it cost since the beginning.
    Figures,
}

/// What the board answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Answer<'a> {
    /// Who is here.
    Hello {
        /// [`VERSION`].
        version: u16,
        /// The chip's name.
        chip: &'a str,
        /// Its silicon's revision.
        revision: &'a str,
        /// The core's clock, MHz.
        mhz: u16,
        /// The compiler that made the program.
        compiler: &'a str,
    },
    /// Done; rows delivered since the beginning.
    Done(u32),
    /// A row.
    Row {
        /// Its number in the frame.
        y: u32,
        /// Disparities, 1/16 px, little-endian, two bytes each.
        disparity: &'a [u8],
        /// Confidences.
        confidence: &'a [u8],
    },
    /// What it cost.
    Figures(Figures),
    /// It cannot be done, and why.
    Refused(&'a str),
}

/// What a frame cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Figures {
    /// Cycles of each stage.
    pub stages: [u64; STAGES],
    /// Cycles of the most expensive push.
    pub worst: u32,
    /// Bytes of the method's state, and of the stack at its deepest.
    pub state: u32,
    /// Bytes of the stack at its deepest, the state in it.
    pub stack: u32,
}

/// Writes a message into `room`; its length. None if it does not fit.
#[must_use]
pub fn write<T: Serialize>(message: &T, room: &mut [u8]) -> Option<usize> {
    postcard::to_slice(message, room).ok().map(|written| written.len())
}

/// Reads a message.
#[must_use]
pub fn read<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Option<T> {
    postcard::from_bytes(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MOST;

    #[test]
    fn the_longest_messages_fit() {
        let mut room = [0; MOST];
        let row = [0x7F; 2 * WIDTH];
        let answer = Answer::Row { y: u32::MAX, disparity: &row, confidence: &row[..WIDTH] };
        let len = write(&answer, &mut room).unwrap();
        assert_eq!(read::<Answer<'_>>(&room[..len]), Some(answer));
        assert!(write(&Request::Push(&row), &mut room).is_some());
        let figures = Figures { stages: [u64::MAX; STAGES], worst: u32::MAX, state: u32::MAX, stack: u32::MAX };
        assert!(write(&Answer::Figures(figures), &mut room).is_some());
    }
}
