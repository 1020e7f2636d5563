//! COBS in place: a packet without zeros, and one at its end.
//!
//! Reading is left to a crate. Writing is here because postcard's way, a byte at a time through checksum
//! and COBS, has an assertion in it, and took a Cortex-M4 8 to 9 percent more instructions a packet.

/// Bytes to leave free before `count` bytes for [`stuff`]: one before each 254, one for the rest, and
/// one for the zero.
pub(super) const fn gap(count: usize) -> usize {
    count / 254 + 2
}

/// Encodes the bytes of `buffer` from `gap` up to `end` to its beginning, and adds a zero; how many that
/// are. `None` if there is no such gap.
pub(super) fn stuff(buffer: &mut [u8], gap: usize, end: usize) -> Option<usize> {
    // How far it is from the last code to here, and so what to write there. Bytes are written behind
    // those that are read: what was added is never more than the gap.
    let (mut code_at, mut code, mut to) = (0, 1, 1);
    let mut from = gap;
    while from < end {
        // Mostly four bytes without a zero.
        if from + 4 <= end && code <= 250 {
            let four = *buffer.get(from..)?.first_chunk()?;
            let word = u32::from_le_bytes(four);
            if word.wrapping_sub(0x0101_0101) & !word & 0x8080_8080 == 0 {
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
    Some(to + 1)
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
        let count = stuff(&mut buffer[..end], begin, end).unwrap();
        assert!(count <= end);
        assert_eq!(buffer[..count].iter().position(|&byte| byte == 0), Some(count - 1));
        let decoded = cobs::decode_in_place(&mut buffer[..count]).unwrap();
        assert_eq!(&buffer[..decoded], bytes);
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
