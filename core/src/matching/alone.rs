//! Cells that decide alone: each takes its least cost, and pays a little for a label that its neighbours have not.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "clamped before"
)]

use crate::answer::cell::{Cell, winner};
use crate::lanes::{add, array, choose};
use crate::matching::agreement::{Penalties, normalised};
use crate::matching::tile::Tile;

/// What the cells of the tile before took, row by row; more than 255 at the left edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Alone<const ROWS: usize> {
    left: [u32; ROWS],
}

impl<const ROWS: usize> Alone<ROWS> {
    pub(crate) const fn new() -> Self {
        Self { left: [u32::MAX; ROWS] }
    }

    /// Passes over a tile whose cells are decided, the right ones to have these labels.
    #[inline(always)]
    pub(crate) const fn pass(&mut self, labels: [u32; ROWS]) {
        self.left = labels;
    }

    /// Decides the cells of a tile, row by row.
    ///
    /// - `above`: what the cells above took; more than 255 where there is none.
    #[inline(always)]
    pub(crate) fn decide(
        &mut self,
        penalties: Penalties,
        found: &Tile<ROWS>,
        mut above: [u32; 2],
    ) -> [[Cell; 2]; ROWS] {
        let labels = found.labels;
        let beside = penalties.steps(labels).both();
        let mut last = Price { label: u32::MAX, price: 0 };
        array(|row| {
            let [first, second] = found.costs[row];
            let a = last.decide(penalties, labels, beside, first, [self.left[row], above[0]]);
            let b = last.decide(penalties, labels, beside, second, [a.label.into(), above[1]]);
            self.left[row] = b.label.into();
            above = [a.label.into(), b.label.into()];
            [a, b]
        })
    }
}

/// What the labels of a tile paid last: mostly the next cell asks the same. That is worth a branch to Cortex-M only.
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
        if cfg!(not(haarline_dsp)) {
            return choose(other > 255, 0, penalties.of(labels, other));
        }
        if other != self.label {
            let price = if other > 255 { 0 } else { penalties.of(labels, other) };
            *self = Self { label: other, price };
        }
        self.price
    }
}
