//! Sums of absolute differences of many labels, two in a word.
//!
//! Of four labels the first and the third share a word, and the second and the fourth: so bytes are widened to sums by
//! one instruction a word. Labels that are left over from fours keep their order.

#[cfg(dsp)]
mod dsp;
mod portable;

#[cfg(dsp)]
pub use dsp::{descend, first_of_group, least_of_group, slide};
#[cfg(not(dsp))]
pub use portable::{descend, first_of_group, least_of_group, slide};

/// Labels whose least sum is kept.
pub const GROUP: usize = 16;

/// Sums by label.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(4))]
pub struct Labels<const LABELS: usize>(pub [u16; LABELS]);

impl<const LABELS: usize> Labels<LABELS> {
    /// Sums of nothing.
    pub const EMPTY: Self = Self([0; LABELS]);
}

/// Where the sum of a label is, of `labels`; and which label is there.
#[inline(always)]
pub fn place(label: usize, labels: usize) -> usize {
    if label < labels / 4 * 4 { label & !3 | (label & 1) << 1 | (label >> 1) & 1 } else { label }
}
