//! Row packets: a disparity row as a few bytes that survive a wire (feature `packet`).
//!
//! A frame is a packet that begins it, one for each row and one that ends it. Every packet carries a
//! sequence number, the frame's number and the [`Counters`]; integers are postcard's variable-length
//! ones, so that a count that is 0 costs a byte. A CRC-32 follows, and COBS takes the zeros out: a zero
//! ends each packet and occurs nowhere else, so a receiver that lost its place goes on at the next one.
//!
//! A row comes back exactly, whatever is in it. Where all is known four columns are sent at a time, by their steps
//! ([`Coding::Cells`]), else equal neighbours once ([`Coding::Runs`]); a row in which that does not pay is sent as it is, so that no packet is longer than [`max_bytes`]
//! tells: 1035 bytes for 320 px. A row of 320 px of a real scene is about 200 bytes from `lite` and
//! `full` and takes a Cortex-M4 about 14 000 instructions; one of `block` is 410 to 520 bytes.
//!
//! ```
//! use haarline::packet::{Content, Encoder, Packet, max_bytes};
//! use haarline::{Counters, Disparity, DisparityRow};
//! let row = DisparityRow { y: 7, disparity: &[Disparity::from_px(3); 64], confidence: &[200; 64] };
//! let mut buffer = [0; max_bytes(64)];
//! let bytes = Encoder::new().row(0, row, &Counters::ZERO, &mut buffer)?;
//! assert!(bytes.len() < 48 && bytes.iter().position(|&b| b == 0) == Some(bytes.len() - 1));
//!
//! let packet = Packet::decode(bytes)?;
//! assert!(matches!(packet.content, Content::Row { y: 7, width: 64, .. }));
//! let (mut disparity, mut confidence) = ([Disparity::UNKNOWN; 64], [0; 64]);
//! packet.read_row(&mut disparity, &mut confidence)?;
//! assert_eq!((&disparity[..], &confidence[..]), (row.disparity, row.confidence));
//! # Ok::<(), haarline::packet::PacketError>(())
//! ```

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc};
use serde::{Deserialize, Serialize};

use crate::{Counters, Disparity, DisparityRow};

mod coding;
mod stuffing;

/// The checksum: that of Ethernet and zip. Its table is 1 KB.
static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// Bytes of the checksum, little-endian at the end.
const CRC_BYTES: usize = 4;
/// Bytes of the longest header: sequence, frame, nine counters and `y` of up to 5 bytes each, the width
/// of up to 3, kind and coding of 1 each.
const MAX_HEADER: usize = (1 + 1 + 9 + 1) * 5 + 3 + 1 + 1;

/// Bytes of the longest packet for rows of `width` px, its final zero included: the room an [`Encoder`]
/// needs.
#[must_use]
pub const fn max_bytes(width: u16) -> usize {
    let plain = max_plain(width);
    plain + stuffing::gap(plain)
}

/// Bytes of the longest packet before its zeros are taken out.
const fn max_plain(width: u16) -> usize {
    MAX_HEADER + coding::max_bytes(width) + CRC_BYTES
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
    },
    /// A row of it.
    Row {
        /// Row of the image, from 0 at the top.
        y: u32,
        /// Pixels of it.
        width: u16,
        /// How they are written.
        coding: Coding,
    },
    /// It ends.
    End {
        /// Rows that the method delivered, those without any measurement included.
        rows: u32,
    },
}

/// How the pixels of a row are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Coding {
    /// Neighbours of the same disparity and confidence once, with their number.
    Runs,
    /// Three bytes each: the disparity, little-endian, and the confidence.
    Plain,
    /// Four columns at a time, by their steps.
    Cells,
}

/// What stands before the pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Header {
    sequence: u32,
    frame: u32,
    counters: Counters,
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
        self.write(frame, Content::Begin { width, height }, counters, None, buffer)
    }

    /// The packet of a row of frame `frame`: the used part of `buffer`.
    ///
    /// # Errors
    /// If the buffer is smaller than [`max_bytes`] of the row's width, or the row is no row.
    pub fn row<'a>(
        &mut self,
        frame: u32,
        row: DisparityRow<'_>,
        counters: &Counters,
        buffer: &'a mut [u8],
    ) -> Result<&'a mut [u8], PacketError> {
        let width = u16::try_from(row.disparity.len()).map_err(|_| PacketError::Row)?;
        if row.confidence.len() != row.disparity.len() {
            return Err(PacketError::Row);
        }
        let y = row.y;
        let content = |coding| Content::Row { y, width, coding };
        // Methods that answer everything answer in cells; where something is unknown it comes in runs.
        let is_whole = row.disparity.iter().all(|disparity| disparity.is_known());
        let coding = if is_whole { Coding::Cells } else { Coding::Runs };
        let short = self.write(frame, content(coding), counters, Some(row), &mut *buffer);
        match short.map(|bytes| bytes.len()) {
            // They need more bytes than the plain pixels.
            Err(PacketError::Row) => self.write(frame, content(Coding::Plain), counters, Some(row), buffer),
            Err(error) => Err(error),
            Ok(count) => buffer.get_mut(..count).ok_or(PacketError::Row),
        }
    }

    /// The packet that ends frame `frame` after `rows` rows: the used part of `buffer`.
    ///
    /// # Errors
    /// If the buffer is smaller than `max_bytes(0)`.
    pub fn end<'a>(
        &mut self,
        frame: u32,
        rows: u32,
        counters: &Counters,
        buffer: &'a mut [u8],
    ) -> Result<&'a mut [u8], PacketError> {
        self.write(frame, Content::End { rows }, counters, None, buffer)
    }

    /// Writes a packet and gives it the next number. [`PacketError::Row`] if the pixels need more bytes in
    /// this coding than plain.
    fn write<'a>(
        &mut self,
        frame: u32,
        content: Content,
        counters: &Counters,
        row: Option<DisparityRow<'_>>,
        buffer: &'a mut [u8],
    ) -> Result<&'a mut [u8], PacketError> {
        let width = if let Content::Row { width, .. } = content { width } else { 0 };
        let (needed, found) = (max_bytes(width), buffer.len());
        if found < needed {
            return Err(PacketError::Buffer { needed, found });
        }
        let header = Header { sequence: self.sequence, frame, counters: *counters, content };
        let gap = stuffing::gap(max_plain(width));
        let plain = buffer.get_mut(gap..).and_then(|room| write_plain(&header, row, room)).ok_or(PacketError::Row)?;
        let count = stuffing::stuff(buffer, gap, gap + plain).ok_or(PacketError::Row)?;
        self.sequence = self.sequence.wrapping_add(1);
        buffer.get_mut(..count).ok_or(PacketError::Row)
    }
}

/// Header, pixels and checksum one after the other; how many bytes that are. With room for the longest
/// packet, `None` only if the pixels need more bytes in this coding than plain.
fn write_plain(header: &Header, row: Option<DisparityRow<'_>>, room: &mut [u8]) -> Option<usize> {
    let mut count = postcard::to_slice(header, room).ok()?.len();
    if let (Content::Row { width, coding, .. }, Some(row)) = (header.content, row) {
        let room = room.get_mut(count..)?.get_mut(..coding::max_bytes(width))?;
        count += coding::write(coding, row, room)?;
    }
    let checksum = CRC.checksum(room.get(..count)?).to_le_bytes();
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
    /// The sender's counts when it was written.
    pub counters: Counters,
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
        if CRC.checksum(told) != u32::from_le_bytes(*checksum) {
            return Err(PacketError::Damaged);
        }
        let (header, pixels) = postcard::take_from_bytes::<Header>(told).map_err(|_| PacketError::Unknown)?;
        let Header { sequence, frame, counters, content } = header;
        let is_row = matches!(content, Content::Row { .. });
        if !is_row && !pixels.is_empty() {
            return Err(PacketError::Unknown);
        }
        Ok(Self { sequence, frame, counters, content, pixels })
    }

    /// The pixels of a row, into room for exactly as many.
    ///
    /// # Errors
    /// If the packet is no row of this width, or of an unknown form; the room may be partly written
    /// then.
    pub fn read_row(&self, disparity: &mut [Disparity], confidence: &mut [u8]) -> Result<(), PacketError> {
        let Content::Row { width, coding, .. } = self.content else { return Err(PacketError::Width) };
        if [disparity.len(), confidence.len()] != [usize::from(width); 2] {
            return Err(PacketError::Width);
        }
        coding::read(coding, self.pixels, disparity, confidence).ok_or(PacketError::Unknown)
    }
}

#[cfg(test)]
mod tests;
