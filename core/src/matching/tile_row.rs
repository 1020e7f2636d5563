//! A row of tiles: searched from left to right, each tile with what its neighbours decided.

use crate::answer::cell_row::TileCells;
use crate::lanes::trials::Trials;
use crate::matching::agreement::Penalties;
use crate::matching::alone::Alone;
use crate::matching::path::Paths;
use crate::matching::tile::{CellCost, Found, TileRow};

/// No label: nothing comes near it.
const NOBODY: u32 = u32::MAX / 2;

impl<C: CellCost, const WORDS: usize> TileRow<'_, C, WORDS> {
    /// Decides the cells, each for itself.
    ///
    /// - `seeds`: labels of a tile's nearest contours; `above`: those of the cells above the row, a pair a tile.
    #[inline(always)]
    pub(crate) fn decide_alone<const ROWS: usize>(
        &self,
        penalties: Penalties,
        seeds: impl Fn(usize) -> [u32; 2],
        above: &[[u8; 2]],
        mut rows: [TileCells<'_>; ROWS],
    ) {
        let mut alone = Alone::new();
        let tiles = rows[0].label.len();
        self.search_all(tiles, seeds, above, |tile, found: Found<ROWS>, above| match found {
            Found::Settled(settled) => alone.pass(settled.decide(penalties, tile, &mut rows)),
            Found::Open(found) => {
                let cells = alone.decide(penalties, &found, above);
                for (row, [first, second]) in rows.iter_mut().zip(cells) {
                    row.value[tile] = [first.value, second.value];
                    row.label[tile] = [first.label, second.label];
                    row.merit[tile] = [first.merit, second.merit];
                }
            }
        });
    }

    /// Decides the cells of settled tiles; those of the others wait for the agreement of the `paths`.
    #[inline(always)]
    pub(crate) fn begin_paths(
        &self,
        penalties: Penalties,
        seeds: impl Fn(usize) -> [u32; 2],
        above: &[[u8; 2]],
        mut rows: [TileCells<'_>; 2],
        paths: &mut Paths<WORDS>,
    ) {
        let tiles = rows[0].label.len();
        self.search_all(tiles, seeds, above, |tile, found, _| match found {
            Found::Settled(settled) => {
                paths.set_settled(tile, penalties, &settled);
                settled.decide(penalties, tile, &mut rows);
            }
            Found::Open(found) => paths.set(tile, &found),
        });
        paths.pass_rightwards(tiles, penalties);
    }

    /// Searches the tiles: `take` is told what was found of each, and the labels of the two cells above it.
    #[inline(always)]
    fn search_all<const ROWS: usize>(
        &self,
        tiles: usize,
        seeds: impl Fn(usize) -> [u32; 2],
        above: &[[u8; 2]],
        mut take: impl FnMut(usize, Found<ROWS>, [u32; 2]),
    ) {
        let pair = |tile: usize| above.get(tile).map_or([NOBODY; 2], |pair| pair.map(u32::from));
        let mut here = pair(0);
        let mut left = NOBODY;
        let mut trials = Trials::new();
        for tile in 0..tiles {
            let next = pair(tile + 1);
            let ([a, b], after) = (here, next[0]);
            let [before, behind] = seeds(tile);
            let found = self.search(&mut trials, tile, [a, b, after, left, before, behind], left, a);
            left = found.best();
            take(tile, found, here);
            here = next;
        }
    }
}
