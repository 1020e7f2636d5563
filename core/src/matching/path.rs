//! The paths of the agreement along a row of tiles: from the left, from the right, from the top and from below.
#![cfg_attr(haarline_sse2, allow(dead_code, reason = "what goes word by word is held against the quads in tests"))]
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "clamped before"
)]

#[cfg(haarline_sse2)]
pub(crate) mod quad;

use crate::answer::cell::{label, winner};
use crate::answer::cell_row::CellRow;
use crate::lanes::add;
use crate::matching::agreement::{Penalties, extend, normalised};
use crate::matching::tile::Tile;

/// Four columns of a row of tiles: two cells, one above the other.
#[derive(Debug, Clone, Copy)]
struct Column {
    /// Labels of the tile in its left column, of the tile above in its right one.
    labels: u32,
    /// Costs of the upper and the lower cell.
    costs: [u32; 2],
    /// Sums of the paths along the row.
    along: [u32; 2],
    /// Of the lower cell above: sums of the path from the top and then what they tell the cell below, sums of all paths so
    /// far, and its costs.
    from_top: u32,
    pending: u32,
    costs_above: u32,
}

/// What a row of tiles knows of itself and of the one above.
#[derive(Debug, Clone)]
pub struct Paths<const WORDS: usize> {
    columns: [Column; WORDS],
}

impl<const WORDS: usize> Paths<WORDS> {
    pub(crate) const fn new() -> Self {
        let nothing = Column { labels: 0, costs: [0; 2], along: [0; 2], from_top: 0, pending: 0, costs_above: 0 };
        Self { columns: [nothing; WORDS] }
    }

    /// Takes what the search found of a tile.
    #[inline(always)]
    pub(crate) fn set(&mut self, tile: usize, found: Tile) {
        if let Some([first, second]) = self.columns.as_chunks_mut::<2>().0.get_mut(tile) {
            first.labels = found.labels;
            let [a, b, c, d] = found.costs;
            (first.costs, second.costs) = ([a, c], [b, d]);
        }
    }

    fn tiles(&mut self, tiles: usize) -> &mut [[Column; 2]] {
        &mut self.columns.as_chunks_mut::<2>().0[..tiles]
    }

    /// The paths from the left.
    #[inline(never)]
    pub(crate) fn pass_rightwards(&mut self, tiles: usize, penalties: Penalties) {
        #[cfg(haarline_sse2)]
        self.pass::<false>(tiles, penalties);
        #[cfg(not(haarline_sse2))]
        self.pass_by_words::<false>(tiles, penalties);
    }

    /// The paths from the left, or those from the right, added to these; one cell at a time.
    #[inline(always)]
    fn pass_by_words<const LEFTWARDS: bool>(&mut self, tiles: usize, penalties: Penalties) {
        let mut sums = [0; 2];
        let mut before = None;
        let mut pass = |pair: &mut [Column; 2]| {
            let labels = pair[0].labels;
            let steps = penalties.steps(labels);
            let mut messages = match before {
                Some(before) if before != labels => penalties.both_other_labels(sums, before, labels),
                _ => sums.map(|sums| penalties.same_labels(sums, steps)),
            };
            before = Some(labels);
            let halves = if LEFTWARDS { [1, 0] } else { [0, 1] };
            for row in 0..2 {
                for half in halves {
                    let column = &mut pair[half];
                    sums[row] = extend(column.costs[row], messages[row]);
                    column.along[row] = if LEFTWARDS { add(column.along[row], sums[row]) } else { sums[row] };
                    messages[row] = penalties.same_labels(sums[row], steps);
                }
            }
        };
        if LEFTWARDS {
            self.tiles(tiles).iter_mut().rev().for_each(&mut pass);
        } else {
            self.tiles(tiles).iter_mut().for_each(&mut pass);
        }
    }

    /// The paths from the right, added to those from the left.
    #[inline(never)]
    fn pass_leftwards(&mut self, tiles: usize, penalties: Penalties) {
        self.pass_by_words::<true>(tiles, penalties);
    }

    /// The other paths: from the right, from the top and, one cell row late, from below. Decides the upper cells and those
    /// above them; the lower ones for the time being.
    ///
    /// - `rows`: the cell row above, if there is one, the upper and the lower one of the tiles.
    #[inline(never)]
    pub(crate) fn agree(&mut self, tiles: usize, penalties: Penalties, is_first: bool, rows: [&mut CellRow<WORDS>; 3]) {
        #[cfg(haarline_sse2)]
        {
            self.pass::<true>(tiles, penalties);
            self.decide_all(tiles, penalties, is_first, rows);
        }
        #[cfg(not(haarline_sse2))]
        self.agree_by_words(tiles, penalties, is_first, rows);
    }

    /// [`Self::agree`], one cell at a time.
    #[inline(always)]
    fn agree_by_words(&mut self, tiles: usize, penalties: Penalties, is_first: bool, rows: [&mut CellRow<WORDS>; 3]) {
        self.pass_leftwards(tiles, penalties);
        let [above_row, upper_row, lower_row] = rows;
        if is_first {
            self.tiles(tiles).iter_mut().flatten().for_each(|column| column.from_top = 0);
        } else {
            self.decide_above(tiles, penalties, above_row);
        }
        self.decide(tiles, penalties, upper_row, lower_row);
    }

    /// Decides the cells above, now that those below them have their say.
    #[inline(never)]
    fn decide_above(&mut self, tiles: usize, penalties: Penalties, row: &mut CellRow<WORDS>) {
        let cells = row.tiles(tiles);
        let cells = cells.value.iter_mut().zip(cells.label).zip(cells.merit);
        for (pair, ((value, label), merit)) in self.tiles(tiles).iter_mut().zip(cells) {
            let (labels, above) = (pair[0].labels, pair[1].labels);
            let steps = penalties.steps(above);
            let upper = [normalised(pair[0].along[0]), normalised(pair[1].along[0])];
            let from_top = [pair[0].from_top, pair[1].from_top];
            let (from_below, from_above) = if above == labels {
                let same = |sums: u32| penalties.same_labels(sums, steps);
                (upper.map(same), from_top.map(same))
            } else {
                let prices = penalties.between(above, labels);
                let from_above = from_top.map(|sums| penalties.other_labels(sums, &prices));
                let prices = prices.reversed();
                (upper.map(|sums| penalties.other_labels(sums, &prices)), from_above)
            };
            for half in 0..2 {
                let column = &mut pair[half];
                column.from_top = from_above[half];
                let found = winner(extend(column.pending, from_below[half]), above, column.costs_above, steps.both());
                value[half] = found.value;
                label[half] = found.label;
                merit[half] = found.merit;
            }
        }
    }

    /// The paths from the top, and from below within the tiles: decides the upper cells, and for the time being the lower ones.
    #[inline(never)]
    fn decide(&mut self, tiles: usize, penalties: Penalties, upper: &mut CellRow<WORDS>, lower: &mut CellRow<WORDS>) {
        let cells = upper.tiles(tiles);
        let cells = cells.value.iter_mut().zip(cells.label).zip(cells.merit).zip(lower.tiles(tiles).label);
        for (pair, (((value, upper_label), merit), lower_label)) in self.tiles(tiles).iter_mut().zip(cells) {
            let labels = pair[0].labels;
            pair[1].labels = labels;
            let steps = penalties.steps(labels);
            for half in 0..2 {
                let column = &mut pair[half];
                let [costs, costs_below] = column.costs;
                let [along, along_below] = column.along;
                let top = extend(costs, column.from_top);
                let lower = penalties.same_labels(normalised(along_below), steps);
                let found = winner(extend(add(along, top), lower), labels, costs, steps.both());
                value[half] = found.value;
                upper_label[half] = found.label;
                merit[half] = found.merit;
                let lower_top = extend(costs_below, penalties.same_labels(top, steps));
                let sums = normalised(add(along_below, lower_top));
                lower_label[half] = label(sums, labels);
                column.from_top = lower_top;
                column.pending = sums;
                column.costs_above = costs_below;
            }
        }
    }
}
