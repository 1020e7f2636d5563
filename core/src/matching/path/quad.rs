//! The paths with both cells of a column, or all of a tile, at once.
#![allow(clippy::cast_possible_truncation, reason = "labels have 8 bits")]

use super::{Paths, TileColumns};
use crate::answer::cell::quad::{first_zero_lane, winners};
use crate::answer::cell_row::CellRow;
use crate::lanes::x86_64::quad::Quad;
use crate::matching::agreement::Penalties;
use crate::matching::agreement::quad::{QuadPenalties, extend, normalised};

impl<const WORDS: usize> Paths<WORDS> {
    /// The paths from the left, or those from the right, added to these.
    #[inline(always)]
    pub(super) fn pass<const LEFTWARDS: bool>(&mut self, tiles: usize, penalties: Penalties) {
        let penalties = QuadPenalties::new(penalties);
        let mut sums = Quad::splat(0);
        let mut before = None;
        let mut pass = |(pair, &mut [is_settled, _]): TileColumns<'_>| {
            let labels = pair[0].labels;
            if is_settled {
                sums = Quad::of_two(pair[usize::from(!LEFTWARDS)].costs);
                before = Some(labels);
                return;
            }
            let to = Quad::splat(labels);
            let steps = penalties.steps(to);
            let mut messages = match before {
                Some(before) if before != labels => penalties.other_labels(sums, Quad::splat(before), to),
                _ => penalties.same_labels(sums, steps),
            };
            before = Some(labels);
            for half in if LEFTWARDS { [1, 0] } else { [0, 1] } {
                let column = &mut pair[half];
                sums = extend(Quad::of_two(column.costs), messages);
                let along = if LEFTWARDS { Quad::of_two(column.along).add(sums) } else { sums };
                column.along = along.two_words();
                messages = penalties.same_labels(sums, steps);
            }
        };
        if LEFTWARDS {
            self.tiles(tiles).rev().for_each(&mut pass);
        } else {
            self.tiles(tiles).for_each(&mut pass);
        }
    }

    /// Decides the cells above, now that those below them have their say, the upper cells, and for the time being the
    /// lower ones.
    #[inline(always)]
    pub(super) fn decide_all(
        &mut self,
        tiles: usize,
        penalties: Penalties,
        is_first: bool,
        rows: [&mut CellRow<WORDS>; 3],
    ) {
        let penalties = QuadPenalties::new(penalties);
        let [above_row, upper_row, lower_row] = rows;
        let above_cells = above_row.tiles(tiles);
        let upper_cells = upper_row.tiles(tiles);
        let lower_labels = lower_row.tiles(tiles).label;
        for (tile, ([first, second], settled)) in self.tiles(tiles).enumerate() {
            let (own, above) = (first.labels, if is_first { first.labels } else { second.labels });
            let [is_settled, is_above_settled] = *settled;
            settled[1] = is_settled;
            if is_settled && (is_above_settled || is_first) {
                second.labels = own;
                (first.from_top, second.from_top) = (first.costs[1], second.costs[1]);
                continue;
            }
            let (labels, labels_above) = (Quad::splat(own), Quad::splat(above));
            let steps = penalties.steps(labels);
            // Two cells a half of the quad: upper and lower ones.
            let costs = Quad::of([first.costs[0], second.costs[0], first.costs[1], second.costs[1]]);
            let along = Quad::of([first.along[0], second.along[0], first.along[1], second.along[1]]);
            let from_top = Quad::of_two([first.from_top, second.from_top]);
            // What these tell the cells above, and the other way.
            let between = along.lower(from_top);
            let messages = if above == own {
                penalties.same_labels(between, steps)
            } else {
                let [from, to] = [labels.lower(labels_above), labels_above.lower(labels)];
                penalties.other_labels(between, from, to)
            };
            let from_above = if is_first { Quad::splat(0) } else { messages.upper(messages) };
            let top = extend(costs, from_above);
            let from_below = penalties.same_labels(along, steps);
            let pending = Quad::of_two([first.pending, second.pending]).lower(along.add(top));
            let decided = extend(pending, messages.lower(from_below.upper(from_below)));
            let costs_above = Quad::of_two([first.costs_above, second.costs_above]);
            let labels_by_cell = labels_above.lower(labels);
            let beside = penalties.steps(labels_above).both().lower(steps.both());
            let [a, b, c, d] = winners(decided, labels_by_cell, costs_above.lower(costs), beside);
            if !(is_first || is_above_settled) {
                above_cells.value[tile] = [a.value, b.value];
                above_cells.label[tile] = [a.label, b.label];
                above_cells.merit[tile] = [a.merit, b.merit];
            }
            second.labels = own;
            if is_settled {
                (first.from_top, second.from_top) = (first.costs[1], second.costs[1]);
                continue;
            }
            upper_cells.value[tile] = [c.value, d.value];
            upper_cells.label[tile] = [c.label, d.label];
            upper_cells.merit[tile] = [c.merit, d.merit];
            // On to the lower cells.
            let costs = costs.upper(costs);
            let top = extend(costs, penalties.same_labels(top, steps));
            let sums = normalised(along.upper(along).add(top));
            let [left, right] = labels.and(first_zero_lane(sums)).sum_of_lanes().two_words();
            lower_labels[tile] = [left as u8, right as u8];
            ([first.from_top, second.from_top], [first.pending, second.pending]) = (top.two_words(), sums.two_words());
            [first.costs_above, second.costs_above] = costs.two_words();
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::matching::settled::SettledTile;
    use crate::matching::tile::Tile;

    /// A tile as the search may find it: labels ascend, and the last may stand twice.
    pub(crate) fn random_tile(seed: &mut u32) -> Tile<2> {
        let mut next = || random(seed);
        let first = next() % 4 * (next() % 60);
        let mut labels = first;
        let mut last = first;
        for i in 1..4 {
            last = (last + 1 + next() % 3 * (next() % 9)).min(255);
            labels |= last << (8 * i);
        }
        let limit = [0xffff_ffff, 0x1f1f_1f1f, 0x0303_0303][next() as usize % 3];
        let mut costs = [0; 4].map(|_: u32| next() << 2 & limit);
        if next() % 4 == 0 {
            labels = labels & 0x00ff_ffff | (labels & 0x00ff_0000) << 8;
            costs = costs.map(|costs| costs | 0xff00_0000);
        }
        let costs = [[costs[0], costs[1]], [costs[2], costs[3]]];
        Tile { labels, costs, best: labels >> 8 & 0xff }
    }

    fn random(seed: &mut u32) -> u32 {
        crate::random::next(seed) >> 3
    }

    /// A settled tile, its costs small or great.
    fn random_settled_tile(seed: &mut u32, label: u32) -> SettledTile<2> {
        let limit = [0x00ff_00ff, 0x000f_000f][random(seed) as usize % 2];
        let costs = [0; 3].map(|_: u32| [0; 2].map(|_: u32| random(seed) & limit));
        SettledTile { label: label.clamp(1, 254), costs }
    }

    #[test]
    fn rows_agree_as_cell_by_cell() {
        const WORDS: usize = 42;
        let mut seed = 1;
        for penalties in [Penalties::new(4, 24), Penalties::new(7, 34), Penalties::new(30, 90)] {
            let (mut quads, mut words) = (Paths::<WORDS>::new(), Paths::<WORDS>::new());
            let mut rows = [const { CellRow::<WORDS>::EMPTY }; 6];
            let mut before = random_tile(&mut seed);
            for row in 0..300 {
                for tile in 0..20 {
                    // Often as the tile before.
                    if (row + tile) % 3 != 0 {
                        let labels = before.labels;
                        before = random_tile(&mut seed);
                        before.labels = if tile % 2 == 0 { labels } else { before.labels };
                    }
                    if random(&mut seed).is_multiple_of(3) {
                        let settled = random_settled_tile(&mut seed, before.best);
                        quads.set_settled(tile, penalties, &settled);
                        words.set_settled(tile, penalties, &settled);
                    } else {
                        quads.set(tile, &before);
                        words.set(tile, &before);
                    }
                }
                quads.pass::<false>(20, penalties);
                words.pass_by_words::<false>(20, penalties);
                let [a, b, c, d, e, f] = &mut rows;
                quads.pass::<true>(20, penalties);
                quads.decide_all(20, penalties, row == 0, [a, b, c]);
                words.agree_by_words(20, penalties, row == 0, [d, e, f]);
                for (quads, words) in rows[..3].iter().zip(&rows[3..]) {
                    assert_eq!(quads.values.value, words.values.value);
                    assert_eq!(quads.label, words.label);
                    assert_eq!(quads.merit, words.merit);
                }
            }
        }
    }
}
