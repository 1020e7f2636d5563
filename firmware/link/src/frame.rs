//! Frames on the wire: the bytes below with their CRC-32, little-endian, COBS-encoded, then a zero.
//!
//! | kind | bytes after it |
//! |---|---|
//! | 0, a piece of a request | sequence u16, index u8, pieces u8, 1 if an answer is wanted u8, payload |
//! | 1, a piece of an answer | the same |
//! | 2, what came of a request | sequence u16, a bit for each piece u32 |
//! | 3, send what is missing of the answer | sequence u16, a bit for each piece that came u32 |

use crc::{CRC_32_ISO_HDLC, Crc};

use crate::{PIECE, PIECES};

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// Bytes of a piece before its payload.
const HEAD: usize = 6;
/// Bytes of a frame before COBS.
const PLAIN: usize = HEAD + PIECE + 4;
/// Bytes of a frame on the wire.
pub const FRAME: usize = PLAIN + 2;

/// A frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame<'a> {
    /// A piece of a request (`is_answer` false) or of an answer.
    Piece {
        /// Whether it is one of an answer.
        is_answer: bool,
        /// The request's number.
        sequence: u16,
        /// Which piece, from 0.
        index: u8,
        /// Pieces of the message, 1 to [`PIECES`].
        pieces: u8,
        /// Whether the sender waits to hear what came.
        asks: bool,
        /// [`PIECE`] bytes, or fewer in the last one.
        payload: &'a [u8],
    },
    /// The pieces of a request that came.
    Came {
        /// The request's number.
        sequence: u16,
        /// A bit for each.
        came: u32,
    },
    /// Asks for the pieces of an answer that are missing.
    Missing {
        /// The request's number.
        sequence: u16,
        /// A bit for each that came.
        came: u32,
    },
}

impl Frame<'_> {
    /// The frame as it goes over the wire; its bytes are the first of `room`.
    pub fn encode<'r>(&self, room: &'r mut [u8; FRAME]) -> &'r [u8] {
        let mut plain = [0; PLAIN];
        let count = self.write(&mut plain).unwrap_or(0);
        let Some((body, rest)) = plain.split_at_mut_checked(count) else { return &[] };
        let sum = CRC.checksum(body).to_le_bytes();
        rest.iter_mut().zip(sum).for_each(|(to, from)| *to = from);
        let Some(whole) = plain.get(..count + 4) else { return &[] };
        let encoded = cobs::try_encode(whole, room).unwrap_or(0);
        if let Some(zero) = room.get_mut(encoded) {
            *zero = 0;
        }
        room.get(..=encoded).unwrap_or(&[])
    }

    /// Writes what is to be sent; how many bytes.
    fn write(&self, to: &mut [u8; PLAIN]) -> Option<usize> {
        let (kind, sequence) = match *self {
            Self::Piece { is_answer, sequence, .. } => (u8::from(is_answer), sequence),
            Self::Came { sequence, .. } => (2, sequence),
            Self::Missing { sequence, .. } => (3, sequence),
        };
        *to.first_mut()? = kind;
        to.get_mut(1..3)?.copy_from_slice(&sequence.to_le_bytes());
        match *self {
            Self::Piece { index, pieces, asks, payload, .. } => {
                to.get_mut(3..HEAD)?.copy_from_slice(&[index, pieces, u8::from(asks)]);
                to.get_mut(HEAD..HEAD + payload.len())?.copy_from_slice(payload);
                Some(HEAD + payload.len())
            }
            Self::Came { came, .. } | Self::Missing { came, .. } => {
                to.get_mut(3..7)?.copy_from_slice(&came.to_le_bytes());
                Some(7)
            }
        }
    }

    /// Reads what a frame says.
    fn read(plain: &[u8]) -> Option<Frame<'_>> {
        let (body, sum) = plain.split_last_chunk::<4>()?;
        if CRC.checksum(body) != u32::from_le_bytes(*sum) {
            return None;
        }
        let (&[kind, low, high], rest) = body.split_first_chunk::<3>()?;
        let sequence = u16::from_le_bytes([low, high]);
        match kind {
            0 | 1 => {
                let (&[index, pieces, asks], payload) = rest.split_first_chunk::<3>()?;
                let is_last = index + 1 == pieces;
                let fits = index < pieces && usize::from(pieces) <= PIECES && payload.len() <= PIECE;
                (fits && (is_last || payload.len() == PIECE)).then_some(Frame::Piece {
                    is_answer: kind == 1,
                    sequence,
                    index,
                    pieces,
                    asks: asks == 1,
                    payload,
                })
            }
            2 | 3 => {
                let came = u32::from_le_bytes(*rest.first_chunk::<4>().filter(|_| rest.len() == 4)?);
                Some(if kind == 2 { Frame::Came { sequence, came } } else { Frame::Missing { sequence, came } })
            }
            _ => None,
        }
    }
}

/// Puts frames together from bytes. What is none is dropped.
#[derive(Debug, Clone)]
pub struct Decoder {
    bytes: [u8; FRAME],
    count: usize,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { bytes: [0; FRAME], count: 0 }
    }
}

impl Decoder {
    /// Takes a byte; the frame, if that was the end of a good one.
    pub fn take(&mut self, byte: u8) -> Option<Frame<'_>> {
        if byte != 0 {
            // One that is too long stays so until its end.
            if let Some(place) = self.bytes.get_mut(self.count) {
                *place = byte;
            }
            self.count = (self.count + 1).min(FRAME + 1);
            return None;
        }
        let count = core::mem::take(&mut self.count);
        let encoded = self.bytes.get_mut(..count)?;
        let plain = cobs::decode_in_place(encoded).ok()?;
        Frame::read(encoded.get(..plain)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn decoded(bytes: &[u8]) -> usize {
        let mut decoder = Decoder::default();
        bytes.iter().filter(|&&byte| decoder.take(byte).is_some()).count()
    }

    proptest! {
        #[test]
        fn a_frame_comes_back(sequence: u16, came: u32, index in 0_u8..31, payload in prop::collection::vec(any::<u8>(), PIECE)) {
            let piece = |is_answer| Frame::Piece { is_answer, sequence, index, pieces: 32, asks: is_answer, payload: &payload };
            let frames = [piece(false), piece(true), Frame::Came { sequence, came }, Frame::Missing { sequence, came }];
            for frame in frames {
                let mut room = [0; FRAME];
                let bytes = frame.encode(&mut room).to_vec();
                prop_assert_eq!(bytes.iter().filter(|&&byte| byte == 0).count(), 1);
                let mut decoder = Decoder::default();
                let (&last, before) = bytes.split_last().unwrap();
                prop_assert!(before.iter().all(|&byte| decoder.take(byte).is_none()));
                prop_assert_eq!(decoder.take(last), Some(frame));
            }
        }

        #[test]
        fn a_garbled_frame_is_none_and_the_next_one_is_whole(at in 0_usize..20, flip in 1_u8..=255, is_lost: bool) {
            let frame = Frame::Piece { is_answer: false, sequence: 7, index: 0, pieces: 1, asks: true, payload: &[1; 12] };
            let mut room = [0; FRAME];
            let good = frame.encode(&mut room).to_vec();
            let mut bad = good.clone();
            if is_lost {
                bad.remove(at);
            } else {
                bad[at] ^= flip;
            }
            // The end of the bad one may be lost with it: then the next one is, too.
            prop_assert_eq!(decoded(&bad), 0);
            prop_assert_eq!(decoded(&[bad, vec![0], good].concat()), 1);
        }

        #[test]
        fn any_bytes_are_read_without_harm(bytes in prop::collection::vec(any::<u8>(), 0..500)) {
            decoded(&bytes);
        }
    }
}
