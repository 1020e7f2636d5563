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

#[cfg(not(haarline_dsp))]
use crate::answer::cell::{label, winner};
use crate::answer::cell_row::CellRow;
use crate::lanes::add;
use crate::lanes::columns::{Column, Decided, Steps};
#[cfg(haarline_dsp)]
use crate::lanes::{decide_column, decide_pending};
#[cfg(not(haarline_dsp))]
use crate::matching::agreement::normalised;
use crate::matching::agreement::{Penalties, extend};
use crate::matching::settled::SettledTile;
use crate::matching::tile::Tile;

/// What a row of tiles knows of itself and of the one above.
#[derive(Debug, Clone)]
pub struct Paths<const WORDS: usize> {
    columns: [Column; WORDS],
    /// Of each tile, whether it is settled and whether the one above it is.
    settled: [bool; WORDS],
}

/// The columns of a tile, and whether it and the one above it are settled.
type TileColumns<'a> = (&'a mut [Column; 2], &'a mut [bool; 2]);

impl<const WORDS: usize> Paths<WORDS> {
    pub(crate) const fn new() -> Self {
        Self { columns: [Column::EMPTY; WORDS], settled: [false; WORDS] }
    }

    /// Takes what the search found of a tile.
    #[inline(always)]
    pub(crate) fn set(&mut self, tile: usize, found: &Tile<2>) {
        let Some(([first, second], settled)) = self.tile(tile) else { return };
        settled[0] = false;
        first.labels = found.labels;
        let [[a, b], [c, d]] = found.costs;
        (first.costs, second.costs) = ([a, c], [b, d]);
    }

    /// Takes a settled tile, whose path sums are known.
    #[inline(always)]
    pub(crate) fn set_settled(&mut self, tile: usize, penalties: Penalties, found: &SettledTile<2>) {
        let Some(([first, second], settled)) = self.tile(tile) else { return };
        settled[0] = true;
        first.labels = found.labels();
        let [[a, b], [c, d]] = found.told(penalties);
        (first.costs, second.costs) = ([a, c], [b, d]);
        (first.along, second.along) = ([a, c].map(|sums| add(sums, sums)), [b, d].map(|sums| add(sums, sums)));
    }

    #[inline(always)]
    fn tile(&mut self, tile: usize) -> Option<TileColumns<'_>> {
        self.columns.as_chunks_mut::<2>().0.get_mut(tile).zip(self.settled.as_chunks_mut::<2>().0.get_mut(tile))
    }

    fn tiles(&mut self, tiles: usize) -> impl DoubleEndedIterator<Item = TileColumns<'_>> {
        let columns = &mut self.columns.as_chunks_mut::<2>().0[..tiles];
        columns.iter_mut().zip(&mut self.settled.as_chunks_mut::<2>().0[..tiles])
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
        let mut pass = |(pair, &mut [is_settled, _]): TileColumns<'_>| {
            let labels = pair[0].labels;
            if is_settled {
                sums = pair[usize::from(!LEFTWARDS)].costs;
                before = Some(labels);
                return;
            }
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
            self.tiles(tiles).rev().for_each(&mut pass);
        } else {
            self.tiles(tiles).for_each(&mut pass);
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
            self.tiles(tiles).flat_map(|(pair, _)| pair).for_each(|column| column.from_top = 0);
        } else {
            self.decide_above(tiles, penalties, above_row);
        }
        self.decide(tiles, penalties, upper_row, lower_row);
    }

    /// Decides the lower cells of the last row of tiles: nothing is below them.
    ///
    /// - `row`: the lower cell row.
    #[inline(never)]
    pub(crate) fn end(&mut self, tiles: usize, penalties: Penalties, row: &mut CellRow<WORDS>) {
        for (pair, settled) in self.tiles(tiles) {
            settled[0] = false;
            pair[0].labels = pair[1].labels;
            pair.iter_mut().for_each(|column| column.along[0] = 0);
        }
        self.decide_above(tiles, penalties, row);
    }

    /// Decides the cells above, now that those below them have their say.
    #[inline(never)]
    fn decide_above(&mut self, tiles: usize, penalties: Penalties, row: &mut CellRow<WORDS>) {
        let cells = row.tiles(tiles);
        let cells = cells.value.iter_mut().zip(cells.label).zip(cells.merit);
        for ((pair, &mut [is_settled, is_above_settled]), ((value, label), merit)) in self.tiles(tiles).zip(cells) {
            if is_settled && is_above_settled {
                continue;
            }
            let (labels, above) = (pair[0].labels, pair[1].labels);
            let steps = penalties.steps(above);
            let upper = [pair[0].along[0], pair[1].along[0]];
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
                if is_above_settled {
                    continue;
                }
                (value[half], label[half], merit[half]) = decide_pending(column, above, steps.both(), from_below[half]);
            }
        }
    }

    /// The paths from the top, and from below within the tiles: decides the upper cells, and for the time being the lower ones.
    #[inline(never)]
    fn decide(&mut self, tiles: usize, penalties: Penalties, upper: &mut CellRow<WORDS>, lower: &mut CellRow<WORDS>) {
        let cells = upper.tiles(tiles);
        let cells = cells.value.iter_mut().zip(cells.label).zip(cells.merit).zip(lower.tiles(tiles).label);
        for ((pair, settled), (((value, upper_label), merit), lower_label)) in self.tiles(tiles).zip(cells) {
            let labels = pair[0].labels;
            pair[1].labels = labels;
            settled[1] = settled[0];
            if settled[0] {
                pair.iter_mut().for_each(|column| column.from_top = column.costs[1]);
                continue;
            }
            let steps = penalties.steps(labels);
            for half in 0..2 {
                let found = decide(&mut pair[half], penalties, steps);
                value[half] = found.value;
                upper_label[half] = found.label;
                merit[half] = found.merit;
                lower_label[half] = found.lower_label;
            }
        }
    }
}

/// Decides the upper cell of a column, whose labels stand in it: its paths along the row, from the top, and from the lower
/// cell; the lower one for the time being.
#[cfg(not(haarline_dsp))]
#[inline(always)]
fn decide(column: &mut Column, penalties: Penalties, steps: Steps) -> Decided {
    let [costs, costs_below] = column.costs;
    let [along, along_below] = column.along;
    let top = extend(costs, column.from_top);
    let lower = penalties.same_labels(along_below, steps);
    let found = winner(extend(add(along, top), lower), column.labels, costs, steps.both());
    let lower_top = extend(costs_below, penalties.same_labels(top, steps));
    let sums = normalised(add(along_below, lower_top));
    (column.from_top, column.pending, column.costs_above) = (lower_top, sums, costs_below);
    let lower_label = label(sums, column.labels);
    Decided { value: found.value, label: found.label, merit: found.merit, lower_label }
}

/// Decides the lower cell above a column, now that `message` tells what lies below it: value, label and merit.
///
/// - `labels`: of its tile; `beside`: less than 255 in the lanes whose neighbours are the labels one less and one more.
#[cfg(not(haarline_dsp))]
#[inline(always)]
fn decide_pending(column: &Column, labels: u32, beside: u32, message: u32) -> (u16, u8, u8) {
    let found = winner(extend(column.pending, message), labels, column.costs_above, beside);
    (found.value, found.label, found.merit)
}

/// The same in one piece.
#[cfg(haarline_dsp)]
#[inline(always)]
fn decide(column: &mut Column, penalties: Penalties, steps: Steps) -> Decided {
    decide_column(column, steps, penalties.jump())
}
