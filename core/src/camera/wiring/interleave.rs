//! Pixels of two cameras by turns, and pixels cut into nibbles.
//!
//! Four pixels of each view at a time in words of 32 bits, the rest of the row byte by byte: on a Cortex-M4
//! 6 instructions for a pixel of both views, 7.5 where they are nibbles; 2.6 where they are sevens that lie at words.

use crate::lanes::sevens::part_eights;

/// Bytes 0, 2, 4, 6 and bytes 1, 3, 5, 7 of eight, as little-endian words.
#[inline]
const fn part(raw: [u8; 8]) -> [u32; 2] {
    let [a, b, c, d, e, f, g, h] = raw;
    let (low, high) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]));
    // Of each word the lower halves, then the upper ones: bytes (a b e f) and (c d g h).
    let lower = low & 0xFFFF | high << 16;
    let upper = low >> 16 | high & 0xFFFF_0000;
    let even = lower & 0x00FF_00FF | (upper & 0x00FF_00FF) << 8;
    let odd = lower >> 8 & 0x00FF_00FF | upper & 0xFF00_FF00;
    [even, odd]
}

/// Every even byte of `raw` into `first`, every odd one into `second`.
pub(super) fn take_apart(raw: &[u8], first: &mut [u8], second: &mut [u8]) {
    by_four(raw, first, second, |raw| part(raw).map(u32::to_le_bytes), |even, odd| [even, odd]);
}

/// Of each two bytes the low nibbles are a pixel for `first`, the high ones one for `second`; the first
/// byte has the more significant nibbles.
pub(super) fn join_nibbles(raw: &[u8], first: &mut [u8], second: &mut [u8]) {
    let of_word = |raw| {
        let [above, below] = part(raw);
        let low_lines = (above & 0x0F0F_0F0F) << 4 | below & 0x0F0F_0F0F;
        let high_lines = above & 0xF0F0_F0F0 | below >> 4 & 0x0F0F_0F0F;
        [low_lines, high_lines].map(u32::to_le_bytes)
    };
    by_four(raw, first, second, of_word, |above, below| [above << 4 | below & 0x0F, above & 0xF0 | below >> 4]);
}

/// Of each two bytes, a little-endian word, the lowest seven bits are the highest of a pixel for `first`, the next seven
/// those of one for `second`.
pub(super) fn part_sevens(raw: &[u8], first: &mut [u8], second: &mut [u8]) {
    let done = part_eights(raw, first, second);
    let rest = raw.get(2 * done..).zip(first.get_mut(done..)).zip(second.get_mut(done..));
    let Some(((raw, first), second)) = rest else { return };
    const SEVEN: u32 = 0x00FE_00FE;
    let of_word = |[a, b, c, d, e, f, g, h]: [u8; 8]| {
        let (low, high) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]));
        // Of four words of 16 bits the first and the third, and the second and the fourth.
        let odd = low & 0xFFFF | high << 16;
        let even = low >> 16 | high & 0xFFFF_0000;
        let low_lines = odd << 1 & SEVEN | (even << 1 & SEVEN) << 8;
        let high_lines = odd >> 6 & SEVEN | (even >> 6 & SEVEN) << 8;
        [low_lines, high_lines].map(u32::to_le_bytes)
    };
    by_four(raw, first, second, of_word, |low, high| [low << 1, low >> 6 & 2 | high << 2]);
}

/// Four pixels of each view from eight bytes by `words`, the rest one by one from two by `bytes`.
#[inline]
fn by_four(
    raw: &[u8],
    first: &mut [u8],
    second: &mut [u8],
    words: impl Fn([u8; 8]) -> [[u8; 4]; 2],
    bytes: impl Fn(u8, u8) -> [u8; 2],
) {
    let (eights, raw) = raw.as_chunks::<8>();
    let (first_fours, first) = first.as_chunks_mut::<4>();
    let (second_fours, second) = second.as_chunks_mut::<4>();
    for ((eight, one), other) in eights.iter().zip(first_fours).zip(second_fours) {
        [*one, *other] = words(*eight);
    }
    let (pairs, _) = raw.as_chunks::<2>();
    for ((&[a, b], one), other) in pairs.iter().zip(first).zip(second) {
        [*one, *other] = bytes(a, b);
    }
}

/// The inverse of [`join_nibbles`].
pub(super) fn part_nibbles(first: &[u8], second: &[u8], raw: &mut [u8]) {
    let (pairs, _) = raw.as_chunks_mut::<2>();
    for ((pair, &one), &other) in pairs.iter_mut().zip(first).zip(second) {
        *pair = [one >> 4 | other & 0xF0, one & 0x0F | other << 4];
    }
}

/// The inverse of [`part_sevens`].
pub(super) fn join_sevens(first: &[u8], second: &[u8], raw: &mut [u8]) {
    let (pairs, _) = raw.as_chunks_mut::<2>();
    for ((pair, &one), &other) in pairs.iter_mut().zip(first).zip(second) {
        *pair = (u16::from(one >> 1) | u16::from(other >> 1) << 7).to_le_bytes();
    }
}

/// Puts a view into every other byte of `raw`, one pixel late if asked: then the first one comes twice
/// and the last one not at all.
pub(super) fn put(view: &[u8], late: bool, raw: &mut [u8]) {
    let repeated = if late { view.get(..1).unwrap_or(&[]) } else { &[] };
    for (slot, &pixel) in raw.iter_mut().step_by(2).zip(repeated.iter().chain(view)) {
        *slot = pixel;
    }
}
