//! Cells that decide alone: each takes its least cost, and pays a little for a label that its neighbours have not.

use crate::answer::cell::winner;
use crate::answer::cell_row::TileCells;
use crate::lanes::add;
use crate::matching::agreement::{Penalties, normalised};
use crate::matching::tile::Tile;

/// What the cells of the tile before took, upper and lower; nothing at the left edge.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Alone {
    left: Option<[u8; 2]>,
}

impl Alone {
    /// Decides the cells of a tile.
    ///
    /// - `above`: what the cells above took, if there are any.
    #[inline(never)]
    pub(crate) fn decide(
        &mut self,
        penalties: Penalties,
        tile: usize,
        found: &Tile,
        above: Option<[u8; 2]>,
        rows: &mut [TileCells<'_>; 2],
    ) {
        let labels = found.labels;
        let beside = penalties.steps(labels).both();
        let mut above = above;
        let mut lefts = [0; 2];
        for (y, (costs, row)) in found.costs.as_chunks::<2>().0.iter().zip(rows).enumerate() {
            let mut left = self.left.map(|left| left[y]);
            let mut below = [0; 2];
            for (x, &costs) in costs.iter().enumerate() {
                let mut sums = costs;
                if let Some(left) = left {
                    sums = add(sums, penalties.of(labels, u32::from(left)));
                }
                if let Some(above) = above {
                    sums = add(sums, penalties.of(labels, u32::from(above[x])));
                }
                let cell = winner(normalised(sums), labels, costs, beside);
                left = Some(cell.label);
                below[x] = cell.label;
                row.value[tile][x] = cell.value;
                row.label[tile][x] = cell.label;
                row.merit[tile][x] = cell.merit;
            }
            lefts[y] = below[1];
            above = Some(below);
        }
        self.left = Some(lefts);
    }
}
