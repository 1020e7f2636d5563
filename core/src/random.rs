//! Numbers for tests: well mixed, and the same each time.

/// The next number after a seed.
pub(crate) fn next(seed: &mut u32) -> u32 {
    *seed = seed.wrapping_mul(0x9e37_79b1).wrapping_add(0x7f4a_7c15);
    (*seed ^ *seed >> 15).wrapping_mul(0x85eb_ca6b)
}
