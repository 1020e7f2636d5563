//! The agreement of neighbouring cells: what one cell's paths tell the next, four labels a word.
//!
//! In the manner of semi-global matching (H. Hirschmueller, Stereo processing by semi-global matching and mutual information,
//! IEEE TPAMI 30, 2008), but over the four labels of a tile instead of all disparities.

use crate::lanes::{ONES, add, difference, lane, least, min, select_ge, splat, sub, wrapping_sub};

/// What a change of the label from one cell to the next costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Penalties {
    /// By one.
    slope: u32,
    /// By more, in each lane.
    jump: u32,
}

/// What a step from one label of a tile to the next one costs: the slope's price where that is one more, else 255.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Steps {
    /// From the label of a lane to that of the next one.
    up: u32,
    /// From the label of a lane to that of the one before.
    down: u32,
}

impl Steps {
    /// Less than 255 in the lanes whose neighbours are the labels one less and one more.
    #[inline(always)]
    pub(crate) const fn both(self) -> u32 {
        self.up | self.down
    }
}

impl Penalties {
    pub(crate) const fn new(slope: u32, jump: u32) -> Self {
        Self { slope, jump: splat(jump) }
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

    /// What a cell with the labels `from` and the path sums `sums` tells one with the labels `to`.
    #[inline(never)]
    pub(crate) fn other_labels(self, sums: u32, from: u32, to: u32) -> u32 {
        let mut message = self.jump;
        for i in 0..4 {
            let distance = difference(to, splat(lane(from, i)));
            let price = select_ge(ONES, distance, (distance & ONES) * self.slope, u32::MAX);
            message = min(message, add(splat(lane(sums, i)), price));
        }
        message
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
