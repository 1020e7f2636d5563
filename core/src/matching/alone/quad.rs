//! The cells of a tile with the prices of all their labels at once.

use super::Alone;
use crate::answer::cell::Cell;
use crate::answer::cell::quad::winners;
use crate::lanes::quad::Quad;
use crate::matching::agreement::Penalties;
use crate::matching::agreement::quad::{QuadPenalties, normalised};
use crate::matching::tile::Tile;

impl Alone {
    /// [`Alone::decide`].
    #[inline(always)]
    pub(super) fn decide_all(&mut self, penalties: Penalties, found: &Tile, above: [u32; 2]) -> [[Cell; 2]; 2] {
        let penalties = QuadPenalties::new(penalties);
        let labels = Quad::splat(found.labels);
        // What the labels pay if a neighbour took one of them, and what they pay for the neighbours that are known.
        let own = penalties.of(labels, labels.lanes_spread()).words();
        let others = Quad::of([self.left[0], above[0], self.left[1], above[1]]);
        let is_none = others.greater_words(Quad::splat(255)).or(Quad::splat(0).greater_words(others));
        let spread = others.and(Quad::splat(0xff)).lowest_spread();
        let [left_a, above_a, left_c, above_b] = is_none.not_and(penalties.of(labels, spread)).words();
        let price = |sums: Quad| {
            let least = sums.equal(sums.least_spread()).top_bits();
            own[least.trailing_zeros() as usize % 4]
        };
        let [a, b, c, d] = found.costs.map(Quad::of_word);
        let word = Quad::of_word;
        let a = a.add(word(left_a)).add(word(above_a));
        let beside_a = word(price(a));
        let b = b.add(word(above_b)).add(beside_a);
        let c = c.add(word(left_c)).add(beside_a);
        let d = d.add(word(price(b))).add(word(price(c)));
        let sums = normalised(a.in_turn(b).lower(c.in_turn(d)));
        let [a, b, c, d] = winners(sums, labels, Quad::of(found.costs), penalties.steps(labels).both());
        self.left = [u32::from(b.label), u32::from(d.label)];
        [[a, b], [c, d]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matching::path::quad::tests::random_tile;

    #[test]
    fn tiles_decide_as_cell_by_cell() {
        let mut seed = 1;
        for penalties in [Penalties::new(1, 3), Penalties::new(3, 16), Penalties::new(7, 255)] {
            let (mut quads, mut words) = (Alone::new(), Alone::new());
            for i in 0..50_000u32 {
                let found = random_tile(&mut seed);
                let above = [found.best, found.labels >> 24].map(|label| if i % 5 == 0 { u32::MAX / 2 } else { label });
                let expected = words.decide_by_words(penalties, &found, above);
                assert_eq!(quads.decide_all(penalties, &found, above), expected, "{found:x?}");
            }
        }
    }
}
