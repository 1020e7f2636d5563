//! Row packets: a disparity row as a few bytes that survive a wire (feature `packet`).
//!
//! A frame is a packet that begins it, one for each row and one that ends it. Every packet carries a
//! sequence number, the frame's number and the [`Counters`]; integers are postcard's variable-length
//! ones, so that a count that is 0 costs a byte. A CRC-32 follows, and COBS takes the zeros out: a zero
//! ends each packet and occurs nowhere else, so a receiver that lost its place goes on at the next one.
//!
//! A row comes back exactly, whatever is in it. Equal neighbours are sent once ([`Coding::Runs`]); a row
//! in which that does not pay is sent as it is, so that no packet is longer than [`max_bytes`]
//! tells: 1030 bytes for 320 px.
//!
//! ```
//! use haarline::packet::{Content, Encoder, Packet, max_bytes};
//! use haarline::{Counters, Disparity, DisparityRow};
//! let row = DisparityRow { y: 7, disparity: &[Disparity::from_px(3); 64], confidence: &[200; 64] };
//! let mut buffer = [0; max_bytes(64)];
//! let bytes = Encoder::new().row(0, row, &Counters::ZERO, &mut buffer)?;
//! assert!(bytes.len() < 32 && bytes.iter().position(|&b| b == 0) == Some(bytes.len() - 1));
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
use postcard::ser_flavors::crc::CrcModifier;
use postcard::ser_flavors::{Cobs, Flavor, Slice};
use serde::{Deserialize, Serialize};

use crate::{Counters, Disparity, DisparityRow};

mod coding;

/// The checksum: that of Ethernet and zip. Its table is 1 KB.
static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// Bytes of the checksum, little-endian at the end.
const CRC_BYTES: usize = 4;
/// Bytes of the longest header: sequence, frame, eight counters and `y` of up to 5 bytes each, the width
/// of up to 3, kind and coding of 1 each.
const MAX_HEADER: usize = (1 + 1 + 8 + 1) * 5 + 3 + 1 + 1;

/// Bytes of the longest packet for rows of `width` px, its final zero included: the room an [`Encoder`]
/// needs.
#[must_use]
pub const fn max_bytes(width: u16) -> usize {
    let plain = MAX_HEADER + coding::max_bytes(width) + CRC_BYTES;
    // COBS adds a byte before each 254, one for the rest, and the zero.
    plain + plain / 254 + 2
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

/// Where the bytes go: a checksum over them, then COBS.
type Output<'a> = CrcModifier<'static, Cobs<Slice<'a>>, u32>;

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
        self.bare(frame, Content::Begin { width, height }, counters, buffer)
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
        check_room(width, buffer.len())?;
        let coding = if coding::pays(row) { Coding::Runs } else { Coding::Plain };
        let header = self.header(frame, Content::Row { y: row.y, width, coding }, counters);
        let mut output = begin(&header, buffer)?;
        coding::write(coding, row, &mut |byte| output.try_push(byte)).map_err(|_| PacketError::Row)?;
        self.finish(output)
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
        self.bare(frame, Content::End { rows }, counters, buffer)
    }

    fn bare<'a>(
        &mut self,
        frame: u32,
        content: Content,
        counters: &Counters,
        buffer: &'a mut [u8],
    ) -> Result<&'a mut [u8], PacketError> {
        check_room(0, buffer.len())?;
        let output = begin(&self.header(frame, content, counters), buffer)?;
        self.finish(output)
    }

    const fn header(&self, frame: u32, content: Content, counters: &Counters) -> Header {
        Header { sequence: self.sequence, frame, counters: *counters, content }
    }

    fn finish<'a>(&mut self, output: Output<'a>) -> Result<&'a mut [u8], PacketError> {
        let bytes = output.finalize().map_err(|_| PacketError::Row)?;
        self.sequence = self.sequence.wrapping_add(1);
        Ok(bytes)
    }
}

const fn check_room(width: u16, found: usize) -> Result<(), PacketError> {
    let needed = max_bytes(width);
    if found < needed { Err(PacketError::Buffer { needed, found }) } else { Ok(()) }
}

/// A packet with its header written. With the room checked, nothing can fail here.
fn begin<'a>(header: &Header, buffer: &'a mut [u8]) -> Result<Output<'a>, PacketError> {
    let cobs = Cobs::try_new(Slice::new(buffer)).map_err(|_| PacketError::Row)?;
    let mut serializer = postcard::Serializer { output: CrcModifier::new(cobs, CRC.digest()) };
    header.serialize(&mut serializer).map_err(|_| PacketError::Row)?;
    Ok(serializer.output)
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
