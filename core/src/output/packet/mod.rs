//! Row packets: a disparity row as a few bytes that survive a wire (feature `packet`).
//!
//! A frame is a packet that begins it, packets of one to four rows, and one that ends it. Every packet carries a sequence
//! number and the frame's number; the first and the last the [`Counters`], the last what the frame is worth
//! ([`FrameEnd`]). Integers are postcard's variable-length ones. A CRC-32 follows, and COBS takes the zeros out: a zero
//! ends each packet and occurs nowhere else, so a receiver that lost its place goes on at the next one.
//!
//! Rows come back exactly, whatever is in them. Those of a row of cells go together, two of [`Full`](crate::Full) and four of
//! [`Lite`](crate::Lite), as what was decided of each cell ([`Content::Cells`]); rows of other methods one at a time,
//! equal neighbours once ([`Content::Runs`]); a row in which that does not pay is sent as it is, so that no packet is longer than
//! [`max_bytes`] tells: 1050 bytes for 320 px. Bytes a row and instructions: `docs/cost.md`.
//!
//! This is version 3. The version is added to the checksum, so that a packet of another version is told from a damaged one
//! ([`PacketError::Version`]).
//!
//! ```
//! use haarline::packet::{Content, Encoder, Packet, max_bytes};
//! use haarline::{Disparity, DisparityRow};
//! let row = DisparityRow { y: 7, disparity: &[Disparity::from_px(3); 64], confidence: &[200; 64] };
//! let mut buffer = [0; max_bytes(64)];
//! let bytes = Encoder::new().row(0, row, &mut buffer)?;
//! assert!(bytes.len() < 48 && bytes.iter().position(|&b| b == 0) == Some(bytes.len() - 1));
//!
//! let packet = Packet::decode(bytes)?;
//! assert!(matches!(packet.content, Content::Cells { y: 7, width: 64, rows: 1 }));
//! let (mut disparity, mut confidence) = ([Disparity::UNKNOWN; 64], [0; 64]);
//! packet.read_row(0, &mut disparity, &mut confidence)?;
//! assert_eq!((&disparity[..], &confidence[..]), (row.disparity, row.confidence));
//! # Ok::<(), haarline::packet::PacketError>(())
//! ```

use core::fmt;
use core::ops::Range;

use crc::{CRC_32_ISO_HDLC, Crc};
use serde::{Deserialize, Serialize};

use crate::frame_figures::FrameFigures;
use crate::{Counters, Disparity, DisparityRow};

mod cells;
mod runs;
mod stuffing;
mod writer;

/// The checksum: that of Ethernet and zip. Its table is 1 KB.
static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// Bytes of the checksum, little-endian at the end.
const CRC_BYTES: usize = 4;
/// Bytes of the longest header: sequence, frame, nine counters, rows and unsent frames of up to 5 bytes each, three figures
/// of up to 3, and 1 each of the kind, whether the frame is cut, whether there are figures, a mismatch, a row error, and the
/// verdict.
const MAX_HEADER: usize = (1 + 1 + 9 + 2) * 5 + 3 * 3 + 6;
/// The version of the packets: added to the checksum of all but the first one.
pub const VERSION: u32 = 3;
/// What is added to the checksum for a version.
const fn mark(version: u32) -> u32 {
    version - 1
}
/// Most rows that go together.
pub const MAX_CELL_ROWS: u8 = 4;
/// Versions that are told from damage.
const VERSIONS: core::ops::RangeInclusive<u32> = 1..=16;

/// Bytes of the longest packet for rows of `width` px, its final zero included: the room an [`Encoder`]
/// needs.
#[must_use]
pub const fn max_bytes(width: u16) -> usize {
    let plain = max_plain(width);
    stuffing::gap(plain) + plain + 1
}

/// Bytes of the longest packet before its zeros are taken out.
const fn max_plain(width: u16) -> usize {
    MAX_HEADER + runs::BYTES * width as usize + CRC_BYTES
}

/// What a packet tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Content {
    /// A frame begins.
    Begin {
        /// Pixels of a row.
        width: u16,
        /// Rows it should have.
        height: u16,
        /// The sender's counts.
        counters: Counters,
    },
    /// Some rows of it, one below the other; four columns of all of them at a time, by confidence, step and slopes.
    Cells {
        /// Row of the image, from 0 at the top; the uppermost.
        y: u32,
        /// Pixels of a row.
        width: u16,
        /// How many, 1 to [`MAX_CELL_ROWS`].
        rows: u8,
    },
    /// A row of it: neighbours of the same disparity and confidence once, with their number.
    Runs {
        /// Row of the image, from 0 at the top.
        y: u32,
        /// Pixels of it.
        width: u16,
    },
    /// A row of it, pixel by pixel.
    Plain {
        /// Row of the image, from 0 at the top.
        y: u32,
        /// Pixels of it.
        width: u16,
    },
    /// It ends.
    End {
        /// What became of it.
        end: FrameEnd,
        /// The sender's counts.
        counters: Counters,
    },
}

impl Content {
    /// The first row and how many, and the pixels of each; none of what is no row.
    #[must_use]
    pub const fn rows(&self) -> Option<Rows> {
        let (y, count, width) = match *self {
            Self::Cells { y, width, rows } => (y, rows, width),
            Self::Runs { y, width } | Self::Plain { y, width } => (y, 1, width),
            Self::Begin { .. } | Self::End { .. } => return None,
        };
        Some(Rows { y, count, width })
    }
}

/// Which rows a packet has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rows {
    /// The first of them.
    pub y: u32,
    /// 1 to [`MAX_CELL_ROWS`].
    pub count: u8,
    /// Pixels of each.
    pub width: u16,
}

/// What is told of a frame once it is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameEnd {
    /// Rows that were sent, those without any measurement included.
    pub rows: u32,
    /// Frames since the start that were not sent to their end, because the wire was too slow; whoever receives a part of
    /// one drops it. With this one, if it is one of them.
    pub unsent_frames: u32,
    /// Whether this is such a frame.
    pub is_cut: bool,
    /// The figures of the frame as a whole, if the method has any.
    pub figures: Option<FrameFigures>,
}

impl FrameEnd {
    /// Of a frame of which nothing was sent.
    pub const NONE: Self = Self { rows: 0, unsent_frames: 0, is_cut: false, figures: None };
}

/// What stands before the pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Header {
    sequence: u32,
    frame: u32,
    content: Content,
}

/// Why a packet cannot be written or read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PacketError {
    /// The buffer is smaller than [`max_bytes`] for this width.
    Buffer {
        /// Bytes needed.
        needed: usize,
        /// Bytes there are.
        found: usize,
    },
    /// A row whose disparities and confidences differ in number, or are more than 65 535.
    Row,
    /// The bytes are no packet: some are missing or the checksum differs.
    Damaged,
    /// The packet is whole, but of another version of the packets.
    Version {
        /// Which one.
        found: u32,
    },
    /// The packet is whole, but of a form that this version does not know.
    Unknown,
    /// The packet is no row, or the room given is not as wide as the row.
    Width,
}

impl fmt::Display for PacketError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Buffer { needed, found } => write!(f, "a buffer of {found} bytes where a packet may need {needed}"),
            Self::Row => f.write_str("a row must have as many confidences as disparities, 65535 at most"),
            Self::Damaged => f.write_str("the packet is damaged"),
            Self::Version { found } => write!(
                f,
                "a packet of version {found}, this is version {VERSION}: build sender and receiver from the same release"
            ),
            Self::Unknown => f.write_str("the packet is whole, but of an unknown form"),
            Self::Width => f.write_str("the packet is not a row of this width"),
        }
    }
}

impl core::error::Error for PacketError {}

/// Writes packets and numbers them.
#[derive(Debug, Clone, Default)]
pub struct Encoder {
    /// Number of the next packet; after [`u32::MAX`] comes 0.
    sequence: u32,
}

impl Encoder {
    /// Begins with packet 0.
    #[must_use]
    pub const fn new() -> Self {
        Self { sequence: 0 }
    }

    /// The packet that begins frame `frame`: the used part of `buffer`.
    ///
    /// # Errors
    /// If the buffer is smaller than `max_bytes(0)`.
    pub fn begin<'a>(
        &mut self,
        frame: u32,
        [width, height]: [u16; 2],
        counters: &Counters,
        buffer: &'a mut [u8],
    ) -> Result<&'a mut [u8], PacketError> {
        self.write(frame, Content::Begin { width, height, counters: *counters }, &[], buffer)
    }

    /// The packet of the first of some rows of frame `frame`, one below the other: of as many as go together, as those of a row
    /// of cells do, all of them, two or one. How many these are, and the used part of `buffer`.
    ///
    /// # Errors
    /// If the buffer is smaller than [`max_bytes`] of the rows' width, or they are not 1 to [`MAX_CELL_ROWS`] such rows.
    pub fn rows<'a>(
        &mut self,
        frame: u32,
        rows: &[DisparityRow<'_>],
        buffer: &'a mut [u8],
    ) -> Result<(usize, &'a mut [u8]), PacketError> {
        let (Some(&first), Ok(count @ 1..=MAX_CELL_ROWS)) = (rows.first(), u8::try_from(rows.len())) else {
            return Err(PacketError::Row);
        };
        let width = width_of(first)?;
        for (nth, &row) in (0..).zip(rows) {
            if width_of(row)? != width || first.y.checked_add(nth) != Some(row.y) {
                return Err(PacketError::Row);
            }
        }
        let fewer = (count > 2).then_some(2);
        for count in [Some(count).filter(|&count| count > 1), fewer].into_iter().flatten() {
            let content = Content::Cells { y: first.y, width, rows: count };
            let together = rows.get(..count.into()).ok_or(PacketError::Row)?;
            match self.place(frame, content, together, &mut *buffer) {
                // They do not go together.
                Err(PacketError::Row) => {}
                Err(error) => return Err(error),
                Ok(range) => return Ok((count.into(), buffer.get_mut(range).ok_or(PacketError::Row)?)),
            }
        }
        self.row(frame, first, buffer).map(|packet| (1, packet))
    }

    /// The packet of a row of frame `frame`: the used part of `buffer`.
    ///
    /// # Errors
    /// If the buffer is smaller than [`max_bytes`] of the row's width, or the row is no row.
    pub fn row<'a>(
        &mut self,
        frame: u32,
        row: DisparityRow<'_>,
        buffer: &'a mut [u8],
    ) -> Result<&'a mut [u8], PacketError> {
        let (y, width) = (row.y, width_of(row)?);
        // Methods that answer everything answer in cells; where something is unknown it comes in runs.
        for content in [Content::Cells { y, width, rows: 1 }, Content::Runs { y, width }] {
            match self.place(frame, content, &[row], &mut *buffer) {
                // More bytes than the plain pixels.
                Err(PacketError::Row) => {}
                Err(error) => return Err(error),
                Ok(range) => return buffer.get_mut(range).ok_or(PacketError::Row),
            }
        }
        self.write(frame, Content::Plain { y, width }, &[row], buffer)
    }

    /// The packet that ends frame `frame`: the used part of `buffer`.
    ///
    /// # Errors
    /// If the buffer is smaller than `max_bytes(0)`.
    pub fn end<'a>(
        &mut self,
        frame: u32,
        end: &FrameEnd,
        counters: &Counters,
        buffer: &'a mut [u8],
    ) -> Result<&'a mut [u8], PacketError> {
        self.write(frame, Content::End { end: *end, counters: *counters }, &[], buffer)
    }

    /// Writes a packet and gives it the next number. [`PacketError::Row`] if the pixels need more bytes in this coding than
    /// plain, or cannot be written in it.
    fn write<'a>(
        &mut self,
        frame: u32,
        content: Content,
        rows: &[DisparityRow<'_>],
        buffer: &'a mut [u8],
    ) -> Result<&'a mut [u8], PacketError> {
        let range = self.place(frame, content, rows, &mut *buffer)?;
        buffer.get_mut(range).ok_or(PacketError::Row)
    }

    /// The same; where in the buffer it is.
    fn place(
        &mut self,
        frame: u32,
        content: Content,
        rows: &[DisparityRow<'_>],
        buffer: &mut [u8],
    ) -> Result<Range<usize>, PacketError> {
        let width = content.rows().map_or(0, |rows| rows.width);
        let (needed, found) = (max_bytes(width), buffer.len());
        if found < needed {
            return Err(PacketError::Buffer { needed, found });
        }
        let header = Header { sequence: self.sequence, frame, content };
        let gap = stuffing::gap(max_plain(width));
        let plain = buffer.get_mut(gap..).and_then(|room| write_plain(&header, rows, room)).ok_or(PacketError::Row)?;
        let range = stuffing::stuff(buffer, gap, gap + plain).ok_or(PacketError::Row)?;
        self.sequence = self.sequence.wrapping_add(1);
        Ok(range)
    }
}

/// The width of a row that is one.
fn width_of(row: DisparityRow<'_>) -> Result<u16, PacketError> {
    let width = u16::try_from(row.disparity.len()).map_err(|_| PacketError::Row)?;
    if row.confidence.len() == row.disparity.len() { Ok(width) } else { Err(PacketError::Row) }
}

/// Header, pixels and checksum one after the other; how many bytes that are. With room for the longest
/// packet, `None` only if the pixels need more bytes in this coding than plain.
fn write_plain(header: &Header, rows: &[DisparityRow<'_>], room: &mut [u8]) -> Option<usize> {
    let mut count = postcard::to_slice(header, room).ok()?.len();
    if let Some(&row) = rows.first() {
        let room = room.get_mut(count..)?.get_mut(..runs::BYTES * row.disparity.len())?;
        count += match header.content {
            Content::Cells { .. } => cells::write(rows, room)?,
            Content::Runs { .. } => runs::write_runs(row, room)?,
            _ => runs::write_plain(row, room)?,
        };
    }
    let checksum = (CRC.checksum(room.get(..count)?) ^ mark(VERSION)).to_le_bytes();
    room.get_mut(count..)?.first_chunk_mut().map(|end| *end = checksum)?;
    Some(count + CRC_BYTES)
}

/// A packet that came in whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Packet<'a> {
    /// Its number: one more than that of the packet sent before, so a gap tells how many were lost.
    pub sequence: u32,
    /// The frame it belongs to, counted by the sender.
    pub frame: u32,
    /// What it tells.
    pub content: Content,
    pixels: &'a [u8],
}

impl<'a> Packet<'a> {
    /// Reads a packet in place: `bytes` are those between two zeros; one zero at the end may be there.
    ///
    /// # Errors
    /// If the bytes are no packet, whatever they are.
    pub fn decode(bytes: &'a mut [u8]) -> Result<Self, PacketError> {
        let count = cobs::decode_in_place(bytes).map_err(|_| PacketError::Damaged)?;
        let bytes: &'a [u8] = bytes;
        let bytes = bytes.get(..count).ok_or(PacketError::Damaged)?;
        let (told, checksum) = bytes.split_last_chunk::<CRC_BYTES>().ok_or(PacketError::Damaged)?;
        let difference = CRC.checksum(told) ^ u32::from_le_bytes(*checksum);
        if difference != mark(VERSION) {
            let other = VERSIONS.into_iter().find(|&version| mark(version) == difference);
            return Err(other.map_or(PacketError::Damaged, |found| PacketError::Version { found }));
        }
        let (header, pixels) = postcard::take_from_bytes::<Header>(told).map_err(|_| PacketError::Unknown)?;
        let Header { sequence, frame, content } = header;
        let is_known = match content.rows() {
            Some(rows) => (1..=MAX_CELL_ROWS).contains(&rows.count),
            None => pixels.is_empty(),
        };
        if !is_known {
            return Err(PacketError::Unknown);
        }
        Ok(Self { sequence, frame, content, pixels })
    }

    /// The pixels of a row, the `nth` of them from 0 at the top, into room for exactly as many.
    ///
    /// # Errors
    /// If the packet has no such row of this width, or is of an unknown form; the room may be partly written
    /// then.
    pub fn read_row(&self, nth: u8, disparity: &mut [Disparity], confidence: &mut [u8]) -> Result<(), PacketError> {
        let Some(Rows { width, count, .. }) = self.content.rows() else { return Err(PacketError::Width) };
        if nth >= count || [disparity.len(), confidence.len()] != [usize::from(width); 2] {
            return Err(PacketError::Width);
        }
        let read = match self.content {
            Content::Cells { .. } => cells::read(self.pixels, nth, disparity, confidence),
            Content::Runs { .. } => runs::read_runs(self.pixels, disparity, confidence),
            _ => runs::read_plain(self.pixels, disparity, confidence),
        };
        read.ok_or(PacketError::Unknown)
    }
}

#[cfg(test)]
mod tests;
