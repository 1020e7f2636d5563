//! Repetition along the row: at which distance contours of the left view have their like.
//!
//! Before a fence, slats or ribs every contour has its like one period further on, and so has what lies between them: any
//! match may as well be the next bar's. The distance that most pairs of like contours have is found once a row of tiles;
//! the cells are then compared with what lies there.

/// Least and greatest distance of like contours, px: not one edge seen twice, and the next bar.
const LEAST: u32 = 6;
const MOST: u32 = 46;
/// Each contour is compared with so many next ones.
const NEXT: usize = 3;
/// Pairs of the most common distance from which on the row repeats itself, percent of its contours.
const STRONG_PERCENT: u32 = 35;
/// Weight of a pair of this row; that of the rows before is halved with each.
const WEIGHT: u16 = 4;

/// How often pairs of like contours have which distance, in the newest rows of tiles.
#[derive(Debug, Clone)]
pub(crate) struct Repetition {
    /// Pairs of each distance from one less than [`LEAST`] to one more than [`MOST`], times [`WEIGHT`].
    pairs: [u16; (MOST - LEAST + 3) as usize],
    /// The most common distance, px.
    pub(crate) distance: u32,
    /// Whether a good part of the contours has its like there.
    pub(crate) is_strong: bool,
}

impl Repetition {
    pub(crate) const NONE: Self = Self { pairs: [0; (MOST - LEAST + 3) as usize], distance: LEAST, is_strong: false };

    /// Looks at the contours of a row of tiles: column and strength of each, from left to right, of one polarity.
    #[inline(never)]
    pub(crate) fn observe(&mut self, contours: impl Iterator<Item = (u32, u32)> + Clone) {
        halve(&mut self.pairs);
        let mut count = 0;
        let mut rest = contours;
        while let Some((column, strength)) = rest.next() {
            count += 1;
            for (other, others) in rest.clone().take(NEXT) {
                let distance = other - column;
                if distance > MOST {
                    break;
                }
                let is_like = 2 * strength <= 3 * others && 2 * others <= 3 * strength;
                if is_like && let Some(pairs) = self.pairs.get_mut((distance + 1).wrapping_sub(LEAST) as usize) {
                    *pairs = pairs.saturating_add(WEIGHT);
                }
            }
        }
        // A distance that is no whole number is shared by two.
        let (mut most, mut at) = (0, LEAST);
        for (distance, around) in (LEAST..).zip(self.pairs.windows(3)) {
            let sum = u32::from(around[0]) + 2 * u32::from(around[1]) + u32::from(around[2]);
            if sum > most {
                (most, at) = (sum, distance);
            }
        }
        self.distance = at;
        self.is_strong = most * 100 >= STRONG_PERCENT * 2 * u32::from(WEIGHT) * count.max(1);
    }
}

/// Of any length, so that it is not written out in full.
#[inline(never)]
fn halve(numbers: &mut [u16]) {
    for number in numbers {
        *number /= 2;
    }
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, reason = "a handful")]
mod tests {
    use super::*;

    fn observed(rows: usize, contours: &[(u32, u32)]) -> (u32, bool) {
        let mut repetition = Repetition::NONE;
        for _ in 0..rows {
            repetition.observe(contours.iter().copied());
        }
        (repetition.distance, repetition.is_strong)
    }

    #[test]
    fn bars_tell_their_period_at_once() {
        for period in [8, 11, 24, 40] {
            let bars: [(u32, u32); 12] = core::array::from_fn(|i| (20 + i as u32 * period, 30 + i as u32 % 3));
            assert_eq!(observed(1, &bars), (period, true));
        }
    }

    #[test]
    fn what_differs_in_strength_or_lies_too_close_is_no_pair() {
        assert_eq!(observed(3, &[(10, 10), (20, 20), (30, 50), (35, 50)]), (LEAST, false));
        assert_eq!(observed(3, &[]), (LEAST, false));
    }

    #[test]
    fn contours_of_all_kinds_are_no_repetition() {
        let contours: [(u32, u32); 40] = core::array::from_fn(|i| {
            let i = i as u32;
            (8 * i + (i.wrapping_mul(0x9e37_79b1) >> 29), 4 + (i.wrapping_mul(0xc2b2_ae35) >> 25))
        });
        assert!(!observed(5, &contours).1);
    }
}
