//! The agreement of neighbouring cells: what one cell's paths tell the next, four labels a word.
//!
//! In the manner of semi-global matching (H. Hirschmueller, Stereo processing by semi-global matching and mutual information,
//! IEEE TPAMI 30, 2008), but over the four labels of a tile instead of all disparities.
#![cfg_attr(haarline_sse2, allow(dead_code, reason = "what goes word by word is held against the quads in tests"))]

#[cfg(haarline_sse2)]
pub(crate) mod quad;

use crate::lanes::columns::Steps;
use crate::lanes::{ONES, add, difference, least, min, select_ge, splat, sub, wrapping_sub};

/// What a change of the label from one cell to the next costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Penalties {
    /// By one.
    slope: u32,
    /// By more, in each lane.
    jump: u32,
}

impl Penalties {
    pub(crate) const fn new(slope: u32, jump: u32) -> Self {
        Self { slope, jump: splat(jump) }
    }

    /// What a change by one costs.
    #[inline(always)]
    pub(crate) const fn slope(self) -> u32 {
        self.slope
    }

    /// What a change by more than one costs, in each lane.
    #[cfg(haarline_dsp)]
    pub(crate) const fn jump(self) -> u32 {
        self.jump
    }

    /// What each of `labels` pays for not being `other`.
    #[inline(always)]
    pub(crate) fn of(self, labels: u32, other: u32) -> u32 {
        let distance = difference(labels, splat(other));
        min(select_ge(ONES, distance, (distance & ONES) * self.slope, u32::MAX), self.jump)
    }

    /// What steps between the labels of a tile cost.
    #[inline(always)]
    pub(crate) fn steps(self, labels: u32) -> Steps {
        let gaps = wrapping_sub(labels >> 8, labels) ^ ONES;
        let up = select_ge(0, gaps, splat(self.slope), u32::MAX) | 0xff00_0000;
        Steps { up, down: up << 8 | 0xff }
    }

    /// What a cell whose path sums are `sums` tells one that has the same labels.
    #[inline(always)]
    pub(crate) fn same_labels(self, sums: u32, steps: Steps) -> u32 {
        let from_above = add(sums >> 8, steps.up);
        let from_below = add(sums << 8, steps.down);
        min(min(min(from_above, from_below), sums), self.jump)
    }

    /// What a label of one tile pays for each label of another.
    #[inline(always)]
    pub(crate) fn between(self, from: u32, to: u32) -> Prices {
        Prices([0, 8, 16, 24].map(|bits| self.price(from.rotate_right(bits), to)))
    }

    /// What each of `labels` pays for not being the same lane of `others`; at least a jump's price if it is not beside it.
    #[inline(always)]
    fn price(self, others: u32, labels: u32) -> u32 {
        let distance = difference(labels, others);
        select_ge(ONES, distance, (distance & ONES) * self.slope, u32::MAX)
    }

    /// What a cell whose path sums are `sums` tells one with other labels.
    #[inline(always)]
    pub(crate) fn other_labels(self, sums: u32, prices: &Prices) -> u32 {
        let mut message = self.jump;
        for (bits, price) in [0, 8, 16, 24].into_iter().zip(prices.0) {
            message = min(message, add(sums.rotate_right(bits), price));
        }
        message
    }

    /// The same of two cells of the same labels, `from`, to two of the labels `to`.
    #[inline(always)]
    pub(crate) fn both_other_labels(self, sums: [u32; 2], from: u32, to: u32) -> [u32; 2] {
        let mut messages = [self.jump; 2];
        for bits in [0, 8, 16, 24] {
            let price = self.price(from.rotate_right(bits), to);
            for (message, sums) in messages.iter_mut().zip(sums) {
                *message = min(*message, add(sums.rotate_right(bits), price));
            }
        }
        messages
    }
}

/// What the labels of a tile pay for those of another: in the word `i` each lane for the lane `i` further on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Prices([u32; 4]);

impl Prices {
    /// The same the other way.
    #[inline(always)]
    pub(crate) const fn reversed(self) -> Self {
        let Self([same, first, second, third]) = self;
        Self([same, third.rotate_right(8), second.rotate_right(16), first.rotate_right(24)])
    }
}

/// The path's sums after a cell: its costs and the message, the least of them 0.
#[inline(always)]
pub(crate) fn extend(costs: u32, message: u32) -> u32 {
    normalised(add(costs, message))
}

/// The same sums with the least of them 0.
#[inline(always)]
pub(crate) fn normalised(sums: u32) -> u32 {
    sub(sums, least(sums))
}
