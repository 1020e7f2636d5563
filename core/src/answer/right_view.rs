//! What the right view sees of a cell row: which label claims each of its columns, and where in the left view to look for
//! what it does not see.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "columns are below 1280"
)]

use core::ops::Range;

use crate::Config;
use crate::lanes::rows::{least_of_three, load, update};
use crate::lanes::{add, max, select_ge, splat};

/// Cells beyond a jump's reach that are looked at, too: of a slanted surface, and of windows that begin between words.
const BESIDE: usize = 2;

/// Cells among which something may be hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Stretch {
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// What may be hidden ends here, before the last jump.
    pub(crate) near: usize,
}

impl Stretch {
    /// The stretch and that around one more jump, further right, of those `within`.
    pub(crate) fn with(self, jump: Self, within: Range<usize>) -> Self {
        Self {
            from: self.from.min(jump.from).max(within.start),
            to: self.to.max(jump.to).min(within.end),
            near: self.near.max(jump.near),
        }
    }
}

/// The columns of the right view, and what claims them.
#[derive(Debug, Clone)]
pub(crate) struct RightView<const WORDS: usize> {
    /// For each column the greatest label that claims it, a word of margin before; all bits are set outside of the view.
    claims: [u32; WORDS],
    words: usize,
    /// The byte of `claims` that label 0 of the first cell begins at.
    pub(crate) origin: i32,
}

impl<const WORDS: usize> RightView<WORDS> {
    /// Of no cells.
    pub(crate) const EMPTY: Self = Self { claims: [0; WORDS], words: 0, origin: 0 };

    /// Begins a row of so many cells, in an empty one: nothing is claimed.
    #[inline(always)]
    pub(crate) fn start(&mut self, config: &Config, cells: usize) {
        (self.words, self.origin) = (cells + 2, 4 - i32::from(config.min_disparity));
        let width = usize::from(config.width);
        if let [first, .., inner, last] = &mut self.claims[..self.words] {
            (*first, *last) = (u32::MAX, u32::MAX);
            if !width.is_multiple_of(4) {
                *inner = u32::MAX << (8 * (width % 4));
            }
        }
    }

    /// The cells that lie left of the right view, from the first on.
    pub(crate) fn left_margin(&self, labels: &[u8]) -> Stretch {
        let columns = (self.origin..).step_by(4);
        let to = labels.iter().zip(columns).take_while(|&(&label, column)| column - i32::from(label) < 4).count();
        Stretch { from: 0, to, near: to }
    }

    /// The cells from `first` on that may lie right of the right view.
    pub(crate) fn right_margin(&self, config: &Config, first: usize) -> Stretch {
        let cells = self.cells();
        let beyond =
            usize::from(config.min_disparity.min(0).unsigned_abs()) + usize::from(!config.width.is_multiple_of(4));
        let margin = if beyond > 0 { beyond / 4 + 2 } else { 0 };
        Stretch { from: cells.saturating_sub(margin).max(first), to: cells, near: cells }
    }

    /// The cells around a jump from one label up to another, before a cell, that may be hidden by what is nearer, or hide it.
    pub(crate) fn around(&self, config: &Config, cell: usize, far: u8, near: u8) -> Stretch {
        let reach = usize::from(near.abs_diff(far)) / 4 + BESIDE;
        let to = (cell + reach).min(self.cells());
        // What is nearer may lie outside of the view.
        let is_inside = self.origin + 4 * cell as i32 - i32::from(near) >= 4 && to <= self.right_margin(config, 0).from;
        Stretch { from: cell.saturating_sub(reach), to, near: if is_inside { cell } else { to } }
    }

    /// How many cells there are.
    pub(crate) fn cells(&self) -> usize {
        self.words - 2
    }

    /// A label claims four columns, or some of them, from a byte on.
    #[inline(always)]
    pub(crate) fn claim(&mut self, byte: usize, label: u8, columns: u32) {
        let labels = splat(u32::from(label)) & columns;
        update(&mut self.claims[..self.words], byte, |claimed| max(claimed, labels));
    }

    /// Those of four columns, from a byte on, that are claimed by something nearer than a label, with both beside them.
    #[inline(always)]
    pub(crate) fn hidden(&self, byte: usize, label: u8) -> u32 {
        let claims = &self.claims[..self.words];
        let nearer = add(splat(u32::from(label)), splat(2));
        // Mostly nothing nearer is there.
        match select_ge(load(claims, byte), nearer, u32::MAX, 0) {
            0 => 0,
            _ => select_ge(least_of_three(claims, byte), nearer, u32::MAX, 0),
        }
    }
}

/// How cells are walked along: their labels' bytes of the right view.
#[inline(always)]
pub(crate) fn columns(cells: Range<usize>, origin: i32) -> impl DoubleEndedIterator<Item = i32> + ExactSizeIterator {
    cells.map(move |cell| origin + 4 * cell as i32)
}
