//! Repetition along the row: at which distance contours of the left view have their like.
//!
//! Before a fence, slats or ribs every contour has its like one period further on, and so has what lies between them: any
//! match may as well be the next bar's. The distance that most pairs of like contours have is found once a row of tiles;
//! the cells are then compared with what lies there.

use crate::lanes::unseen;

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
                #[cfg(haarline_dsp)]
                if distance > MOST {
                    break;
                }
                self.count(distance, strength, others);
            }
        }
        let (most, at) = self.most_common();
        self.distance = at;
        self.is_strong = most * 100 >= STRONG_PERCENT * 2 * u32::from(WEIGHT) * count.max(1);
    }
}

#[cfg(haarline_dsp)]
impl Repetition {
    /// Counts a pair of contours, if they are alike.
    #[inline(always)]
    fn count(&mut self, distance: u32, strength: u32, others: u32) {
        let is_like = 2 * strength <= 3 * others && 2 * others <= 3 * strength;
        if is_like && let Some(pairs) = self.pairs.get_mut((distance + 1).wrapping_sub(LEAST) as usize) {
            *pairs = pairs.saturating_add(WEIGHT);
        }
    }

    /// How common the most common distance is, times 4, and which it is. One that is no whole number is shared by two.
    #[inline(always)]
    fn most_common(&self) -> (u32, u32) {
        let (mut most, mut at) = (0, LEAST);
        for (distance, around) in (LEAST..).zip(self.pairs.windows(3)) {
            let sum = u32::from(around[0]) + 2 * u32::from(around[1]) + u32::from(around[2]);
            if sum > most {
                (most, at) = (sum, distance);
            }
        }
        (most, at)
    }
}

/// The same without branches, which nobody could foresee.
#[cfg(not(haarline_dsp))]
impl Repetition {
    #[inline(always)]
    fn count(&mut self, distance: u32, strength: u32, others: u32) {
        let last = self.pairs.len() - 1;
        // Nothing is as far as the last one.
        let place = ((distance + 1).wrapping_sub(LEAST) as usize).min(last);
        let is_like = (2 * strength <= 3 * others) & (2 * others <= 3 * strength) & (place < last);
        self.pairs[place] = self.pairs[place].saturating_add(WEIGHT * u16::from(is_like));
    }

    #[inline(always)]
    fn most_common(&self) -> (u32, u32) {
        // The first of equals is the greatest.
        let mut best = 0;
        for (i, around) in (0..).zip(self.pairs.windows(3)) {
            let sum = i32::from(around[0]) + 2 * i32::from(around[1]) + i32::from(around[2]);
            best = best.max(sum << 6 | (63 - i));
        }
        let best = best.cast_unsigned();
        (best >> 6, LEAST + 63 - best % 64)
    }
}

#[inline(never)]
fn halve(numbers: &mut [u16]) {
    let (fours, rest) = unseen(numbers).as_chunks_mut::<4>();
    for four in fours {
        unseen(four).iter_mut().for_each(|number| *number /= 2);
    }
    rest.iter_mut().for_each(|number| *number /= 2);
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
    fn the_most_common_distance_is_that_of_all_pairs() {
        for seed in 1..200_u32 {
            let mut column = 0;
            let contours: [(u32, u32); 30] = core::array::from_fn(|i| {
                let number = (seed * 64 + i as u32).wrapping_mul(0x9e37_79b1);
                column += 5 + (number >> 28) * (seed % 4);
                (column, 4 + (number >> 16) % 12)
            });
            let mut pairs = [0; 64];
            for (i, &(column, strength)) in contours.iter().enumerate() {
                for &(other, others) in contours.iter().skip(i + 1).take(NEXT) {
                    let is_like = 2 * strength <= 3 * others && 2 * others <= 3 * strength;
                    if is_like && (LEAST - 1..=MOST).contains(&(other - column)) {
                        pairs[(other - column) as usize] += 1;
                    }
                }
            }
            let sum = |distance: u32| {
                let at = distance as usize;
                pairs[at - 1] + 2 * pairs[at] + pairs[at + 1]
            };
            let most = (LEAST..=MOST).map(sum).max().unwrap();
            let first = (LEAST..=MOST).find(|&distance| sum(distance) == most).unwrap();
            let is_strong = most * 100 >= 2 * STRONG_PERCENT * 30;
            assert_eq!(observed(1, &contours), (first, is_strong), "{seed}");
        }
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
