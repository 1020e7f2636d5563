//! Cells that decide alone: each takes its least cost, and pays a little for a label that its neighbours have not.
#![cfg_attr(haarline_sse2, allow(dead_code, reason = "what goes word by word is held against the quads in tests"))]
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "clamped before"
)]

#[cfg(haarline_sse2)]
mod quad;

use crate::answer::cell::{Cell, winner};
use crate::lanes::add;
use crate::matching::agreement::{Penalties, normalised};
use crate::matching::tile::Tile;

/// What the cells of the tile before took, upper and lower; more than 255 at the left edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Alone {
    left: [u32; 2],
}

impl Alone {
    pub(crate) const fn new() -> Self {
        Self { left: [u32::MAX; 2] }
    }

    /// Passes over a tile whose cells are decided, the right ones to have these labels.
    #[inline(always)]
    pub(crate) const fn pass(&mut self, labels: [u32; 2]) {
        self.left = labels;
    }

    /// Decides the cells of a tile, the upper and the lower ones.
    ///
    /// - `above`: what the cells above took; more than 255 where there is none.
    #[inline(always)]
    pub(crate) fn decide(&mut self, penalties: Penalties, found: &Tile, above: [u32; 2]) -> [[Cell; 2]; 2] {
        #[cfg(haarline_sse2)]
        return self.decide_all(penalties, found, above);
        #[cfg(not(haarline_sse2))]
        self.decide_by_words(penalties, found, above)
    }

    /// [`Self::decide`], one cell at a time.
    #[inline(always)]
    fn decide_by_words(&mut self, penalties: Penalties, found: &Tile, above: [u32; 2]) -> [[Cell; 2]; 2] {
        let labels = found.labels;
        let beside = penalties.steps(labels).both();
        let mut last = Price { label: u32::MAX, price: 0 };
        let [a, b, c, d] = found.costs;
        let mut decide = |costs, left, above| last.decide(penalties, labels, beside, costs, [left, above]);
        let a = decide(a, self.left[0], above[0]);
        let b = decide(b, u32::from(a.label), above[1]);
        let c = decide(c, self.left[1], u32::from(a.label));
        let d = decide(d, u32::from(c.label), u32::from(b.label));
        self.left = [u32::from(b.label), u32::from(d.label)];
        [[a, b], [c, d]]
    }
}

/// What the labels of a tile paid last: mostly the next cell asks the same.
struct Price {
    /// For not being this label.
    label: u32,
    price: u32,
}

impl Price {
    /// Decides a cell whose neighbours took `others`.
    #[inline(always)]
    fn decide(&mut self, penalties: Penalties, labels: u32, beside: u32, costs: u32, [left, above]: [u32; 2]) -> Cell {
        let sums = add(add(costs, self.of(penalties, labels, left)), self.of(penalties, labels, above));
        winner(normalised(sums), labels, costs, beside)
    }

    #[inline(always)]
    fn of(&mut self, penalties: Penalties, labels: u32, other: u32) -> u32 {
        if other != self.label {
            let price = if other > 255 { 0 } else { penalties.of(labels, other) };
            *self = Self { label: other, price };
        }
        self.price
    }
}
