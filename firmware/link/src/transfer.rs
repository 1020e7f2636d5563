//! A message in pieces, of which some arrive.

use crate::frame::Frame;
use crate::{MOST, PIECE, PIECES};

/// Bits of the first `pieces` pieces.
const fn whole(pieces: usize) -> u32 {
    if pieces >= PIECES { u32::MAX } else { (1 << pieces) - 1 }
}

/// Calls `send` for every piece of `message` that did not come; the last one asks for an answer.
pub fn send_missing(message: &[u8], is_answer: bool, sequence: u16, came: u32, mut send: impl FnMut(&Frame<'_>)) {
    let count = pieces(message);
    let missing = |index: &usize| came >> index & 1 == 0;
    let last = (0..count).rfind(missing);
    for index in (0..count).filter(missing) {
        let payload = message.chunks(PIECE).nth(index).unwrap_or(&[]);
        let [index_u8, pieces] = [index, count].map(|number| u8::try_from(number).unwrap_or(0));
        send(&Frame::Piece { is_answer, sequence, index: index_u8, pieces, asks: last == Some(index), payload });
    }
}

/// Pieces of a message; an empty one has one.
#[must_use]
pub const fn pieces(message: &[u8]) -> usize {
    let count = message.len().div_ceil(PIECE);
    if count == 0 { 1 } else { count }
}

/// Whether all of a message came.
#[must_use]
pub const fn is_whole(message: &[u8], came: u32) -> bool {
    came & whole(pieces(message)) == whole(pieces(message))
}

/// A message as it comes.
#[derive(Debug, Clone)]
pub struct Incoming {
    bytes: [u8; MOST],
    len: usize,
    sequence: Option<u16>,
    pieces: usize,
    came: u32,
}

impl Default for Incoming {
    fn default() -> Self {
        Self { bytes: [0; MOST], len: 0, sequence: None, pieces: 0, came: 0 }
    }
}

impl Incoming {
    /// Begins anew, for the message of that number.
    pub const fn expect(&mut self, sequence: u16) {
        (self.sequence, self.pieces, self.came, self.len) = (Some(sequence), 0, 0, 0);
    }

    /// The number of the message that is coming.
    #[must_use]
    pub const fn sequence(&self) -> Option<u16> {
        self.sequence
    }

    /// Takes a piece; of another message than the one expected it is dropped.
    pub fn take(&mut self, sequence: u16, index: u8, pieces: u8, payload: &[u8]) {
        let (index, pieces) = (usize::from(index), usize::from(pieces));
        if self.sequence != Some(sequence) || (self.pieces != 0 && self.pieces != pieces) {
            return;
        }
        let from = index * PIECE;
        let Some(place) = self.bytes.get_mut(from..from + payload.len()) else { return };
        place.copy_from_slice(payload);
        self.pieces = pieces;
        self.came |= 1 << index;
        if index + 1 == pieces {
            self.len = from + payload.len();
        }
    }

    /// A bit for each piece that came.
    #[must_use]
    pub const fn came(&self) -> u32 {
        self.came
    }

    /// The message, if all of it came.
    #[must_use]
    pub fn message(&self) -> Option<&[u8]> {
        let is_whole = self.pieces > 0 && self.came == whole(self.pieces);
        self.bytes.get(..self.len).filter(|_| is_whole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_missing_is_sent_until_all_came(len in 0..=MOST, lost in any::<u64>()) {
            let message: Vec<u8> = (0..=u8::MAX).cycle().take(len).collect();
            let mut incoming = Incoming::default();
            incoming.expect(5);
            let mut draw = lost;
            for _ in 0..200 {
                let came = incoming.came();
                if is_whole(&message, came) {
                    break;
                }
                send_missing(&message, false, 5, came, |frame| {
                    draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    let Frame::Piece { sequence, index, pieces, payload, .. } = *frame else { panic!() };
                    if draw >> 62 != 0 {
                        incoming.take(sequence, index, pieces, payload);
                        incoming.take(sequence + 1, index, pieces, &[9; 3]);
                    }
                });
            }
            prop_assert_eq!(incoming.message(), Some(&message[..]));
        }
    }

    #[test]
    fn the_last_piece_that_is_sent_asks() {
        let mut asked = Vec::new();
        send_missing(&[0; 3 * PIECE], true, 1, 0b100, |frame| {
            let Frame::Piece { index, asks, .. } = *frame else { panic!() };
            asked.push((index, asks));
        });
        assert_eq!(asked, [(0, false), (1, true)]);
    }
}
