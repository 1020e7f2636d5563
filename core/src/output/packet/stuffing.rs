//! COBS in place: a packet without zeros, and one at its end.
//!
//! Reading is left to a crate. Writing is here because postcard's way, a byte at a time through checksum
//! and COBS, has an assertion in it, and took a Cortex-M4 8 to 9 percent more instructions a packet.

use core::ops::Range;

use crate::lanes;

/// Bytes to leave free before `count` bytes for [`stuff`]: one before each 254, and one for the rest. One more must be free
/// after them, for the zero.
pub(super) const fn gap(count: usize) -> usize {
    count / 254 + 1
}

/// Encodes the bytes of `buffer` from `gap` up to `end`, and adds a zero: where they are then. `None` if there is no such
/// gap, or no byte after them.
pub(super) fn stuff(buffer: &mut [u8], gap: usize, end: usize) -> Option<Range<usize>> {
    // Nothing moves where all comes before the first code that must stand between other bytes.
    if end.checked_sub(gap)? < 254 { mark(buffer, gap.checked_sub(1)?, end) } else { move_up(buffer, gap, end) }
}

/// Writes how far it is to the next zero to `begin` and over each zero up to `end`, and a zero there.
fn mark(buffer: &mut [u8], begin: usize, end: usize) -> Option<Range<usize>> {
    *buffer.get_mut(end)? = 0;
    let packet = buffer.get_mut(begin..=end)?;
    let mut code_at = 0;
    while let Some(distance) = next_zero(packet.get(code_at + 1..)?) {
        // Below 256, as the packet is.
        *packet.get_mut(code_at)? = u8::try_from(distance + 1).ok()?;
        code_at += distance + 1;
    }
    Some(begin..end + 1)
}

/// Where the first zero is.
fn next_zero(bytes: &[u8]) -> Option<usize> {
    let fours = bytes.as_chunks::<4>().0;
    let begin = 4 * fours.iter().position(has_zero).unwrap_or(bytes.len() / 4);
    bytes.get(begin..)?.iter().position(|&byte| byte == 0).map(|after| begin + after)
}

#[inline(always)]
fn has_zero(four: &[u8; 4]) -> bool {
    // Of 1 a zero leaves something, and nothing else does.
    lanes::sub(lanes::ONES, u32::from_le_bytes(*four)) != 0
}

/// Encodes the bytes from `gap` up to `end` to the beginning of the buffer.
fn move_up(buffer: &mut [u8], gap: usize, end: usize) -> Option<Range<usize>> {
    // How far it is from the last code to here, and so what to write there. Bytes are written behind
    // those that are read: what was added is never more than the gap.
    let (mut code_at, mut code, mut to) = (0, 1, 1);
    let mut from = gap;
    while from < end {
        // Mostly four bytes without a zero.
        if from + 4 <= end && code <= 250 {
            let four = *buffer.get(from..)?.first_chunk()?;
            if !has_zero(&four) {
                *buffer.get_mut(to..)?.first_chunk_mut()? = four;
                (from, to, code) = (from + 4, to + 4, code + 4);
                continue;
            }
        }
        let byte = *buffer.get(from)?;
        from += 1;
        if byte != 0 {
            *buffer.get_mut(to)? = byte;
            to += 1;
            code += 1;
        }
        if byte == 0 || code == 255 {
            *buffer.get_mut(code_at)? = code;
            (code_at, code) = (to, 1);
            to += 1;
        }
    }
    *buffer.get_mut(code_at)? = code;
    *buffer.get_mut(to)? = 0;
    Some(0..to + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// What comes out of `bytes`, after checking that an independent decoder restores them.
    fn through(bytes: &[u8]) -> usize {
        let mut buffer = [0xEE; 1400];
        let begin = gap(bytes.len());
        let end = begin + bytes.len();
        buffer[begin..end].copy_from_slice(bytes);
        let packet = &mut buffer[..=end];
        let range = stuff(packet, begin, end).unwrap();
        let packet = &mut packet[range];
        let count = packet.len();
        assert_eq!(packet.iter().position(|&byte| byte == 0), Some(count - 1));
        let decoded = cobs::decode_in_place(packet).unwrap();
        assert_eq!(&packet[..decoded], bytes);
        count
    }

    #[test]
    fn lengths_around_a_full_block_come_back() {
        for count in [0, 1, 253, 254, 255, 507, 508, 509, 762, 1016] {
            assert!(through(&[7; 1016][..count]) >= count + 2);
            assert_eq!(through(&[0; 1016][..count]), count + 2);
        }
    }

    proptest! {
        #[test]
        fn any_bytes_come_back(bytes in prop::collection::vec(prop_oneof![Just(0), Just(1), any::<u8>()], 0..600)) {
            through(&bytes);
        }

        #[test]
        fn bytes_with_few_zeros_come_back(bytes in prop::collection::vec(any::<u8>(), 0..1300)) {
            through(&bytes);
        }
    }
}
