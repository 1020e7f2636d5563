//! Four bytes in a word, worked on at once.

/// The same byte four times.
#[inline(always)]
pub fn splat(byte: u8) -> u32 {
    u32::from(byte) * 0x0101_0101
}

/// The greater byte of each pair.
#[inline(always)]
pub fn max(a: u32, b: u32) -> u32 {
    each(a, b, u8::max)
}

/// Differences of bytes, 0 where they would be negative.
#[inline(always)]
pub fn saturating_sub(a: u32, b: u32) -> u32 {
    each(a, b, u8::saturating_sub)
}

/// How many bits are set in each byte.
#[inline(always)]
pub fn count_ones(word: u32) -> u32 {
    let pairs = word - ((word >> 1) & 0x5555_5555);
    let nibbles = (pairs & 0x3333_3333) + ((pairs >> 2) & 0x3333_3333);
    (nibbles + (nibbles >> 4)) & 0x0f0f_0f0f
}

/// The greatest of the four bytes.
#[inline(always)]
pub fn greatest(word: u32) -> u8 {
    let pairs = max(word, word >> 16);
    max(pairs, pairs >> 8).to_le_bytes()[0]
}

#[inline(always)]
fn each(a: u32, b: u32, op: impl Fn(u8, u8) -> u8) -> u32 {
    let (a, b) = (a.to_le_bytes(), b.to_le_bytes());
    u32::from_le_bytes([op(a[0], b[0]), op(a[1], b[1]), op(a[2], b[2]), op(a[3], b[3])])
}
