//! Merits along the paths of semi-global matching, four labels in a word.
//!
//! A path cost is `L(d) = C(d) + min(L'(d), L'(d - 1) + P1, L'(d + 1) + P1, P2)` with L' that of the pixel before, whose
//! least is 0. Kept are merits, `G = max G - L`: what a merit of the pixel before is above `floor = max G' - P2`
//! counts, so that the minimum with P2 is a subtraction that stops at 0 and takes the floor away, too, and `8 - C`, the
//! agreement, is added. The greatest merit is at least P2 and at most P2 + 8.

#[cfg(dsp)]
mod dsp;
#[cfg(not(dsp))]
mod portable;

#[cfg(dsp)]
use dsp as chosen;
#[cfg(not(dsp))]
use portable as chosen;

pub use chosen::{agree, step_from_above, step_from_left, step_from_right};

use super::splat;

/// Penalty for a step of one disparity.
pub const P1: u8 = 3;
/// Penalty for any other step.
pub const P2: u8 = 14;
/// Words that are worked on together.
pub const UNROLLED: usize = 4;

/// What a column has of every label, four in a word. Words of zeros keep the labels apart from others in memory.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Column<const WORDS: usize> {
    below_above: u32,
    /// Merits of the path from above.
    pub above: [u32; WORDS],
    below_right: u32,
    /// Merits of the path from the right, and then those of the path from the left added.
    pub right: [u32; WORDS],
    below_agreement: u32,
    /// Of eight signs, how many are alike; afterwards the sums of the merits.
    pub agreement: [u32; WORDS],
}

/// The merits of one pixel.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Merits<const WORDS: usize> {
    below: u32,
    /// Four in a word.
    pub labels: [u32; WORDS],
    beyond: u32,
}

impl<const WORDS: usize> Column<WORDS> {
    /// Nothing.
    pub const EMPTY: Self = Self {
        below_above: 0,
        above: [0; WORDS],
        below_right: 0,
        right: [0; WORDS],
        below_agreement: 0,
        agreement: [0; WORDS],
    };

    /// Lets the path from above begin.
    pub fn begin_above(&mut self, words: usize) {
        self.above[..words].fill(splat(P2));
    }

    /// Lets the path from the right begin: this stands for the column before the first.
    pub fn begin_right(&mut self, words: usize) {
        self.right[..words].fill(splat(P2));
    }
}

impl<const WORDS: usize> Merits<WORDS> {
    /// Nothing.
    pub const EMPTY: Self = Self { below: 0, labels: [0; WORDS], beyond: 0 };

    /// Lets the path begin.
    pub fn begin(&mut self, words: usize) {
        self.labels[..words].fill(splat(P2));
    }
}

/// The floor that goes with a greatest merit, each in all bytes.
pub fn floor(greatest: u32) -> u32 {
    greatest - splat(P2)
}
