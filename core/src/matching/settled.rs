//! A settled tile: of three labels in a row the middle one is clearly better than those beside it, and no other comes near. Its
//! neighbours could tell it no more: its cells decide at once, and what they tell is the same in every direction.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "labels and costs have 8 bits, values 16"
)]

use crate::answer::cell::{HALF, MOST_MARGIN};
use crate::answer::cell_row::TileCells;
use crate::lanes::{
    array, quotient, saturated_halves, select_ge_halves, splat_half, sub_halves, sub_saturating_halves,
};
use crate::matching::agreement::Penalties;

/// A tile of three labels, of so many rows of cells.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SettledTile<const ROWS: usize> {
    /// The middle one.
    pub(crate) label: u32,
    /// What the label before it, itself and the one after it cost the cells, at most 255: two in a word, row by row.
    pub(crate) costs: [[u32; ROWS]; 3],
}

impl<const ROWS: usize> SettledTile<ROWS> {
    /// Decides the cells, row by row; the labels of the right ones.
    #[inline(always)]
    pub(crate) fn decide(&self, penalties: Penalties, tile: usize, rows: &mut [TileCells<'_>; ROWS]) -> [u32; ROWS] {
        array(|y| self.decide_row(penalties, tile, y, &mut rows[y]))
    }

    #[inline(always)]
    fn decide_row(&self, penalties: Penalties, tile: usize, y: usize, row: &mut TileCells<'_>) -> u32 {
        let [value, label, merit] = self.decide_two(penalties.slope(), self.costs.map(|costs| costs[y]));
        row.value[tile] = [value as u16, (value >> 16) as u16];
        row.label[tile] = [label as u8, (label >> 8) as u8];
        row.merit[tile] = [merit as u8, (merit >> 16) as u8];
        label >> 8
    }

    /// Decides two cells: values in halves, labels in bytes, merits in halves. A cell takes the middle label, unless one beside
    /// it is cheaper by two slopes; the fraction is that of a V through the costs.
    #[inline(always)]
    fn decide_two(&self, slope: u32, [before, here, after]: [u32; 3]) -> [u32; 3] {
        let less = select_ge_halves(before, after, after, before);
        let most = select_ge_halves(before, after, before, after);
        let limit = less + splat_half(2 * slope);
        if select_ge_halves(here, limit, u32::MAX, 0) != 0 {
            return self.decide_aside(slope, [before, here, after]);
        }
        // No other label comes near: the margin is the greatest.
        let merit = sub_saturating_halves(splat_half(128 + MOST_MARGIN), here + here);
        let rise = sub_halves(most + splat_half(slope), here);
        let fall = sub_halves(before, after);
        let fraction = |fall: i32, rise: i32| quotient(fall << 7, rise.max(1)).clamp(-128, 127);
        let first = fraction((fall as i16).into(), (rise as i16).into());
        let second = fraction(fall.cast_signed() >> 16, rise.cast_signed() >> 16);
        let middle = (self.label << 8) + HALF;
        let value = middle.wrapping_add_signed(first) & 0xffff | middle.wrapping_add_signed(second) << 16;
        [value, self.label | self.label << 8, merit]
    }

    /// The same one by one.
    #[cold]
    #[inline(never)]
    fn decide_aside(&self, slope: u32, costs: [u32; 3]) -> [u32; 3] {
        let (mut values, mut labels, mut merits) = (0, 0, 0);
        for bits in [0, 16] {
            let [before, here, after] = costs.map(|costs| (costs >> bits & 0xffff).cast_signed());
            let rise = before.max(after) - here + slope.cast_signed();
            let fraction = quotient((before - after) << 7, rise.max(1)).clamp(-128, 127);
            // The label two steps away limits the margin.
            let (label, fraction, cost, margin) = if here < before.min(after) + 2 * slope.cast_signed() {
                (self.label, fraction, here, MOST_MARGIN.cast_signed())
            } else if before <= after {
                (self.label - 1, 0, before, (after - before).min(MOST_MARGIN.cast_signed()))
            } else {
                (self.label + 1, 0, after, (before - after).min(MOST_MARGIN.cast_signed()))
            };
            let value = ((label << 8) + HALF).wrapping_add_signed(fraction);
            let merit = (128 + margin - 2 * cost).max(0).cast_unsigned();
            (values, labels, merits) = (values | value << bits, labels | label << (bits / 2), merits | merit << bits);
        }
        [values, labels, merits]
    }

    /// What the cells tell the next ones in any direction, in the place of path sums.
    #[inline(always)]
    pub(crate) fn told(&self, penalties: Penalties) -> [[u32; 2]; ROWS] {
        core::array::from_fn(|y| self.told_by(penalties, y))
    }

    #[inline(always)]
    fn told_by(&self, penalties: Penalties, y: usize) -> [u32; 2] {
        let [before, here, after] = self.costs.map(|costs| costs[y]);
        let slope = splat_half(penalties.slope());
        let more = |beside: u32| saturated_halves(sub_saturating_halves(beside + slope, here));
        let (before, after) = (more(before), more(after));
        // The last label again, at a cost that nobody takes.
        [before & 0xffff | after << 16 | 0xff00_0000, before >> 16 | after & 0xffff_0000 | 0xff00_0000]
    }

    /// The three labels, the last one twice.
    #[inline(always)]
    pub(crate) const fn labels(&self) -> u32 {
        self.label * 0x0101_0101 + 0x0101_0000 - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(seed: &mut u32) -> SettledTile<2> {
        let mut next = || crate::random::next(seed) >> 3;
        let limit = [0x00ff_00ff, 0x0010_0010 + 0x000f_000f, 0x0003_0003][next() as usize % 3];
        let costs = [0; 3].map(|_: u32| [0; 2].map(|_: u32| next() & limit));
        SettledTile { label: 1 + next() % 254, costs }
    }

    #[test]
    fn two_cells_decide_as_one_by_one() {
        let mut seed = 1;
        for i in 0..200_000 {
            let found = tile(&mut seed);
            let [costs, _] = [0, 1].map(|y| found.costs.map(|costs| costs[y]));
            let slope = [1, 4, 5][i % 3];
            assert_eq!(found.decide_two(slope, costs), found.decide_aside(slope, costs), "{found:x?}");
        }
    }

    #[test]
    fn what_a_cell_tells_is_least_at_its_label() {
        let mut seed = 1;
        let penalties = Penalties::new(4, 24);
        for _ in 0..10_000 {
            let found = tile(&mut seed);
            for (y, told) in found.told(penalties).into_iter().enumerate() {
                for (x, told) in told.into_iter().enumerate() {
                    let [before, here, after] = found.costs.map(|costs| costs[y] >> (16 * x) & 0xffff);
                    let expected = [before, after].map(|beside| (beside + 4).saturating_sub(here).min(255) as u8);
                    assert_eq!(told.to_le_bytes(), [expected[0], 0, expected[1], 255]);
                }
            }
        }
    }
}
