//! Arithmetic on four bytes at once, in one word of 32 bits.
//!
//! Lane 0 is the least significant byte. Each operation exists twice: in portable code, and as one or two
//! instructions of the DSP extension of Cortex-M4, M7 and M33 (ARM DDI 0403, chapter A7). `build.rs` selects by the
//! target; both are held against each other over random and extreme input, on the host and in the emulator.

#[cfg(haarline_dsp)]
mod cortex_m;
#[cfg(not(haarline_dsp))]
mod portable;

#[cfg(haarline_dsp)]
pub(crate) use cortex_m::*;
#[cfg(not(haarline_dsp))]
pub(crate) use portable::*;

pub(crate) mod rows;

/// One in each lane.
pub(crate) const ONES: u32 = 0x0101_0101;

/// The same byte in each lane.
#[inline(always)]
pub(crate) const fn splat(byte: u32) -> u32 {
    byte.wrapping_mul(ONES)
}

/// Lane `lane` of a word.
#[inline(always)]
pub(crate) const fn lane(word: u32, lane: u32) -> u32 {
    word >> (8 * lane) & 0xff
}

/// The least of the four lanes, in each of them.
#[inline(always)]
pub(crate) fn least(word: u32) -> u32 {
    let pair = min(word, word.rotate_right(16));
    min(pair, pair.rotate_right(8))
}

/// The greatest of the four lanes, in each of them.
#[inline(always)]
pub(crate) fn greatest(word: u32) -> u32 {
    let pair = max(word, word.rotate_right(16));
    max(pair, pair.rotate_right(8))
}

/// `|a - b|` of unsigned lanes.
#[inline(always)]
pub(crate) fn difference(a: u32, b: u32) -> u32 {
    sub(a, b) | sub(b, a)
}

/// By how many bits the first lane that is 0 lies above lane 0; one must be.
#[inline(always)]
pub(crate) fn zero_lane_bits(word: u32) -> u32 {
    select_ge(0, word, ONES, 0).trailing_zeros() & 24
}

/// `|a - b|` of unsigned halves.
#[inline(always)]
pub(crate) fn difference_of_halves(a: u32, b: u32) -> u32 {
    sub_saturating_halves(a, b) | sub_saturating_halves(b, a)
}

/// The same 16 bits in each half.
#[inline(always)]
pub(crate) const fn splat_half(half: u32) -> u32 {
    half * 0x0001_0001
}
