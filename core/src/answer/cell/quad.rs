//! The answers of four cells at once.
#![allow(clippy::cast_possible_truncation, reason = "labels and merits have 8 bits, values 16")]

use super::{Cell, HALF, MOST_MARGIN};
use crate::lanes::splat;
use crate::lanes::x86_64::quad::Quad;

/// All bits of the first lane of each word that is 0.
#[inline(always)]
pub(crate) fn first_zero_lane(sums: Quad) -> Quad {
    let zero = sums.equal(Quad::splat(0));
    let before = zero.up::<8>().or(zero.up::<16>()).or(zero.up::<24>());
    before.not_and(zero)
}

/// [`winner`](super::winner) of four cells.
#[inline(always)]
pub(crate) fn winners(sums: Quad, labels: Quad, costs: Quad, beside: Quad) -> [Cell; 4] {
    let here = first_zero_lane(sums);
    let pick = |word: Quad, lane: Quad| word.and(lane).sum_of_lanes();
    let label = pick(labels, here);
    let total = sums.add(costs);
    let (before, after) = (pick(total, here.down::<8>()), pick(total, here.up::<8>()));
    let rise = before.signed_max_halves(after).sub_words(pick(total, here));
    let has_both = Quad::splat(255).greater_words(pick(beside, here));
    let fraction = before.sub_words(after).limited_fraction(rise);
    let fraction = fraction.and(has_both).and(rise.greater_words(Quad::splat(0)));
    let value = label.up::<8>().add_words(Quad::splat(HALF)).add_words(fraction);
    // Between two labels these are the lanes beside it; at an end it takes a look at the labels.
    let lanes_beside = here.or(here.up::<8>()).or(here.down::<8>());
    let is_further = labels.difference(label.lowest_spread()).not_less(Quad::splat(splat(2)));
    let is_rival = lanes_beside.not_and(Quad::splat(u32::MAX)).where_or(has_both, is_further);
    let margin = sums.where_or(is_rival, Quad::splat(splat(MOST_MARGIN))).least().and(Quad::splat(0xff));
    let cost = pick(costs, here);
    let merit = margin.add_words(Quad::splat(128)).sub_saturating_halves(cost.add_words(cost));
    let (label, value, merit) = (label.words(), value.words(), merit.words());
    [0, 1, 2, 3].map(|i| Cell { label: label[i] as u8, value: value[i] as u16, merit: merit[i] as u8 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::cell::{label, winner};
    use crate::lanes::{least, sub};

    /// Words with lanes of all kinds, many of them extreme.
    pub(crate) fn random(seed: &mut u32) -> u32 {
        let mut next = || crate::random::next(seed) >> 3;
        let (word, kind, lanes) = (next(), next() % 4, next());
        match kind {
            0 => word,
            1 => word & 0x0303_0303,
            2 => word | 0xfcfc_fcfc,
            _ => word & lanes,
        }
    }

    #[test]
    fn four_winners_are_those_of_one_by_one() {
        let mut seed = 1;
        for _ in 0..200_000 {
            let [sums, labels, costs, beside] = [0; 4].map(|_: u32| [0; 4].map(|_: u32| random(&mut seed)));
            let sums = sums.map(|sums| sub(sums, least(sums)));
            // Neither the first lane nor the last is between two.
            let beside = beside.map(|beside| beside | 0xff00_00ff);
            let found = winners(Quad::of(sums), Quad::of(labels), Quad::of(costs), Quad::of(beside));
            for i in 0..4 {
                assert_eq!(
                    found[i],
                    winner(sums[i], labels[i], costs[i], beside[i]),
                    "{sums:x?} {labels:x?} {costs:x?}"
                );
                assert_eq!(found[i].label, label(sums[i], labels[i]));
            }
        }
    }
}
