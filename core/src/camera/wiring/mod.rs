//! How two cameras share one parallel port, and how their pixels come apart again.
//!
//! A *row* is the same line of both views, a *raw row* its bytes in the order in which the port stored
//! them. Whatever the wiring, a raw row of views of `width` px has `2 * width` bytes: two line buffers
//! on the chip, and no frame is ever kept. Frame-interleaved wiring would need one and is not supported.
//!
//! ```
//! use haarline::wiring::{First, Kind, Wiring};
//! let wiring = Wiring::new(Kind::PixelInterleaved, First::Right);
//! let (mut left, mut right) = ([0; 2], [0; 2]);
//! wiring.unpack(&[1, 10, 2, 20], &mut left, &mut right)?;
//! assert_eq!((left, right), ([10, 20], [1, 2]));
//! # Ok::<(), haarline::wiring::WiringError>(())
//! ```

use core::fmt;

use crate::ScanlinePair;

mod interleave;
mod name;

/// In which order the pixels of the two cameras arrive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A pixel of one camera, then one of the other.
    PixelInterleaved,
    /// A line of one camera, then the same line of the other: two camera lines a row.
    LineInterleaved,
    /// One long line: that of one camera, then that of the other.
    SideBySide,
    /// Two sensors of 4 bits on a port of 8: each pixel comes as two nibbles, the high one first; the
    /// first camera is on the low four data lines.
    Nibbles,
    /// Two sensors of 8 bits on a port of 16: a word each pixel clock, the first camera in the low byte,
    /// stored little-endian.
    Pairs16,
    /// Two sensors on a port of 14 lines: a word of 16 bits each pixel clock, the first camera's highest seven bits in
    /// the low seven, the second's in the next seven, the rest zero, stored little-endian. The lowest bit of a pixel is
    /// lost, and comes out as zero.
    Pairs14,
}

/// The camera that comes first: in time, in the left half, on the low data lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum First {
    /// The left camera.
    #[default]
    Left,
    /// The right camera.
    Right,
}

/// Which camera's pixels come one late, that is in the slot of the next pair of pixels, as on TU Delft's
/// stereo board. For [`Kind::PixelInterleaved`] only; the other kinds have no skew.
///
/// The late camera's slot in the first pair of a row holds no pixel of it, and its last pixel never
/// comes: unpacking repeats the last but one in its place, packing repeats the first in the first slot.
/// A row packed and unpacked is therefore the same but for that one pixel at the right border.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Skew {
    /// Neither.
    #[default]
    None,
    /// The left camera's.
    Left,
    /// The right camera's.
    Right,
}

/// How a pair of cameras is wired to the port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wiring {
    /// The order of the pixels.
    pub kind: Kind,
    /// The camera that comes first.
    pub first: First,
    /// The camera whose pixels come late; without effect unless `kind` is [`Kind::PixelInterleaved`].
    pub skew: Skew,
}

/// Why a raw row is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum WiringError {
    /// A raw row of another length than two views of this width have.
    Length {
        /// Bytes that two such views have.
        expected: usize,
        /// Bytes found.
        found: usize,
    },
    /// An odd number of bytes, which is no two views.
    Odd {
        /// Bytes found.
        found: usize,
    },
    /// Room for views of different widths.
    Views {
        /// Room for the left view, px.
        left: usize,
        /// Room for the right view, px.
        right: usize,
    },
}

impl fmt::Display for WiringError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { expected, found } => write!(f, "a raw row of {found} bytes where {expected} were expected"),
            Self::Odd { found } => write!(f, "a raw row of {found} bytes, an odd number, which is no two views"),
            Self::Views { left, right } => {
                write!(f, "a left row of {left} px and a right one of {right} px, where both must be equally wide")
            }
        }
    }
}

impl core::error::Error for WiringError {}

impl Wiring {
    /// A wiring without skew.
    #[must_use]
    pub const fn new(kind: Kind, first: First) -> Self {
        Self { kind, first, skew: Skew::None }
    }

    /// Camera lines in one row.
    #[inline]
    #[must_use]
    pub const fn lines_per_row(&self) -> usize {
        match self.kind {
            Kind::LineInterleaved => 2,
            _ => 1,
        }
    }

    /// Bytes in one line as the port sees it, from one line signal to the next, for views of `width` px.
    #[inline]
    #[must_use]
    pub const fn line_bytes(&self, width: u16) -> usize {
        self.row_bytes(width) / self.lines_per_row()
    }

    /// Bytes in a raw row, all its lines joined, for views of `width` px.
    #[inline]
    #[must_use]
    pub const fn row_bytes(&self, width: u16) -> usize {
        2 * width as usize
    }

    /// The two views as parts of `raw`, where they lie in one piece each: line-interleaved and side by
    /// side. `None` for the other kinds, and where the bytes are no two views.
    #[inline]
    #[must_use]
    pub fn split<'a>(&self, raw: &'a [u8]) -> Option<ScanlinePair<'a>> {
        if !self.is_split() || !raw.len().is_multiple_of(2) {
            return None;
        }
        let (first, second) = raw.split_at_checked(raw.len() / 2)?;
        let (left, right) = self.order(first, second);
        Some(ScanlinePair { left, right })
    }

    /// Takes a raw row apart into its two views.
    ///
    /// # Errors
    /// If `raw` has not twice as many bytes as either view has room for.
    pub fn unpack(&self, raw: &[u8], left: &mut [u8], right: &mut [u8]) -> Result<(), WiringError> {
        check(raw.len(), left.len(), right.len())?;
        if let Some(pair) = self.split(raw) {
            copy(left, pair.left);
            copy(right, pair.right);
            return Ok(());
        }
        let (first, second) = self.order(&mut *left, &mut *right);
        match self.kind {
            Kind::Nibbles => interleave::join_nibbles(raw, first, second),
            Kind::Pairs14 => interleave::part_sevens(raw, first, second),
            _ => interleave::take_apart(raw, first, second),
        }
        match self.late() {
            Skew::None => {}
            Skew::Left => forward(left),
            Skew::Right => forward(right),
        }
        Ok(())
    }

    /// The two views of a raw row: parts of it where they lie in one piece, else unpacked into the room
    /// given.
    ///
    /// # Errors
    /// If `raw` has not twice as many bytes as either view has room for.
    #[inline]
    pub fn pair<'a>(
        &self,
        raw: &'a [u8],
        left: &'a mut [u8],
        right: &'a mut [u8],
    ) -> Result<ScanlinePair<'a>, WiringError> {
        check(raw.len(), left.len(), right.len())?;
        if let Some(pair) = self.split(raw) {
            return Ok(pair);
        }
        self.unpack(raw, left, right)?;
        Ok(ScanlinePair { left, right })
    }

    /// The inverse of [`Wiring::unpack`]: what such a port stores of two views. Exact but for the border
    /// pixel that a [`Skew`] costs, and the lowest bit that [`Kind::Pairs14`] has no line for.
    ///
    /// # Errors
    /// If `raw` has not room for twice as many bytes as either view has.
    pub fn pack(&self, pair: ScanlinePair<'_>, raw: &mut [u8]) -> Result<(), WiringError> {
        check(raw.len(), pair.left.len(), pair.right.len())?;
        let (first, second) = self.order(pair.left, pair.right);
        match self.kind {
            Kind::LineInterleaved | Kind::SideBySide => {
                let (one, other) = raw.split_at_mut(first.len());
                copy(one, first);
                copy(other, second);
            }
            Kind::Nibbles => interleave::part_nibbles(first, second, raw),
            Kind::Pairs14 => interleave::join_sevens(first, second, raw),
            Kind::PixelInterleaved | Kind::Pairs16 => {
                let late = self.late();
                let first_is_late =
                    matches!((late, self.first), (Skew::Left, First::Left) | (Skew::Right, First::Right));
                interleave::put(first, first_is_late, raw);
                interleave::put(second, late != Skew::None && !first_is_late, raw.get_mut(1..).unwrap_or(&mut []));
            }
        }
        Ok(())
    }

    const fn is_split(&self) -> bool {
        matches!(self.kind, Kind::LineInterleaved | Kind::SideBySide)
    }

    /// The skew where it has an effect.
    const fn late(&self) -> Skew {
        match self.kind {
            Kind::PixelInterleaved => self.skew,
            _ => Skew::None,
        }
    }

    /// Left and right to first and second, and back.
    fn order<T>(&self, one: T, other: T) -> (T, T) {
        match self.first {
            First::Left => (one, other),
            First::Right => (other, one),
        }
    }
}

fn check(raw: usize, left: usize, right: usize) -> Result<(), WiringError> {
    if left != right {
        return Err(WiringError::Views { left, right });
    }
    if !raw.is_multiple_of(2) {
        return Err(WiringError::Odd { found: raw });
    }
    let expected = left.saturating_mul(2);
    if raw == expected { Ok(()) } else { Err(WiringError::Length { expected, found: raw }) }
}

/// Copies as much as both have.
fn copy(to: &mut [u8], from: &[u8]) {
    let n = to.len().min(from.len());
    if let (Some(to), Some(from)) = (to.get_mut(..n), from.get(..n)) {
        to.copy_from_slice(from);
    }
}

/// Moves a late view by one pixel to where it belongs; the last pixel repeats.
fn forward(view: &mut [u8]) {
    if view.len() > 1 {
        view.copy_within(1.., 0);
    }
}

#[cfg(test)]
mod tests;
