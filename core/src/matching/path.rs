//! The paths of the agreement along a row of tiles: from the left, from the right, from the top and from below.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "clamped before"
)]

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
    /// Sums of the paths from the left.
    from_left: [u32; 2],
    /// Of the lower cell above: sums of the path from the top, of all paths so far, and its costs.
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
        let nothing = Column { labels: 0, costs: [0; 2], from_left: [0; 2], from_top: 0, pending: 0, costs_above: 0 };
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
        let mut sums = [0; 2];
        let mut before = None;
        for [first, second] in self.tiles(tiles) {
            let labels = first.labels;
            let steps = penalties.steps(labels);
            let messages = match before {
                Some(before) if before != labels => penalties.both_other_labels(sums, before, labels),
                _ => sums.map(|sums| penalties.same_labels(sums, steps)),
            };
            for row in 0..2 {
                let sum = extend(first.costs[row], messages[row]);
                first.from_left[row] = sum;
                sums[row] = extend(second.costs[row], penalties.same_labels(sum, steps));
                second.from_left[row] = sums[row];
            }
            before = Some(labels);
        }
    }

    /// The other paths: from the right, from the top and, one cell row late, from below. Decides the upper cells and those
    /// above them; the lower ones for the time being.
    ///
    /// - `rows`: the cell row above, if there is one, the upper and the lower one of the tiles.
    #[inline(never)]
    pub(crate) fn agree(&mut self, tiles: usize, penalties: Penalties, is_first: bool, rows: [&mut CellRow<WORDS>; 3]) {
        let [above_row, upper_row, lower_row] = rows;
        let above_cells = above_row.tiles(tiles);
        let upper_cells = upper_row.tiles(tiles);
        let lower_labels = lower_row.tiles(tiles).label;
        let columns = self.tiles(tiles);
        let mut right = [0; 2];
        let mut after = None;
        for tile in (0..tiles).rev() {
            let pair = &mut columns[tile];
            let labels = pair[0].labels;
            let above = pair[1].labels;
            pair[1].labels = labels;
            let steps = penalties.steps(labels);
            let mut messages = match after {
                Some(after) if after != labels => penalties.both_other_labels(right, after, labels),
                _ => right.map(|sums| penalties.same_labels(sums, steps)),
            };
            after = Some(labels);
            // What the cells above tell these, and what is between these and those above.
            let from_above = [pair[0].from_top, pair[1].from_top];
            let (steps_above, from_above, prices) = if is_first {
                (steps, [0; 2], None)
            } else if above == labels {
                (steps, from_above.map(|sums| penalties.same_labels(sums, steps)), None)
            } else {
                let prices = penalties.between(above, labels);
                let messages = from_above.map(|sums| penalties.other_labels(sums, &prices));
                (penalties.steps(above), messages, Some(prices.reversed()))
            };
            for half in [1, 0] {
                let column = &mut pair[half];
                if half == 0 {
                    messages = right.map(|sums| penalties.same_labels(sums, steps));
                }
                right = [extend(column.costs[0], messages[0]), extend(column.costs[1], messages[1])];
                let along = [add(column.from_left[0], right[0]), add(column.from_left[1], right[1])];
                if !is_first {
                    let upper = normalised(along[0]);
                    let message = match &prices {
                        None => penalties.same_labels(upper, steps),
                        Some(prices) => penalties.other_labels(upper, prices),
                    };
                    let found = winner(extend(column.pending, message), above, column.costs_above, steps_above.both());
                    above_cells.value[tile][half] = found.value;
                    above_cells.label[tile][half] = found.label;
                    above_cells.merit[tile][half] = found.merit;
                }
                let top = extend(column.costs[0], from_above[half]);
                let lower = penalties.same_labels(normalised(along[1]), steps);
                let sums = add(along[0], top);
                let found = winner(extend(sums, lower), labels, column.costs[0], steps.both());
                upper_cells.value[tile][half] = found.value;
                upper_cells.label[tile][half] = found.label;
                upper_cells.merit[tile][half] = found.merit;
                let lower_top = extend(column.costs[1], penalties.same_labels(top, steps));
                let sums = normalised(add(along[1], lower_top));
                lower_labels[tile][half] = label(sums, labels);
                column.from_top = lower_top;
                column.pending = sums;
                column.costs_above = column.costs[1];
            }
        }
    }
}
