//! Repetition along the row: at which distance contours of the left view have their like.
//!
//! Before a fence, slats or ribs every contour has its like one period further on, and so has what lies between them: any
//! match may as well be the next bar's. The distance that most pairs of like contours have is found once a row of tiles;
//! the cells are then compared with what lies there.

use crate::lanes::unseen;

/// Least and greatest distance of like contours, px: not one edge seen twice, and the next bar.
const LEAST: u32 = 6;
const MOST: u32 = 61;
/// Each contour is compared with so many next ones: what noise makes may lie between bars.
const NEXT: usize = 6;
/// Pairs that each contour has with those after it: with the first ones that are like it.
const LIKES: u32 = 3;
/// Pairs of the most common distance from which on the row repeats itself, percent of its contours.
const STRONG_PERCENT: u32 = 32;
/// Weight of a pair of this row; that of the rows before is halved with each.
const WEIGHT: u16 = 4;
/// Distances that are counted; nothing is as far as the last one.
const COUNTED: usize = MOST as usize + 2;
// Those after the first two are looked at by fours.
const _: () = assert!((COUNTED - LEAST as usize - 1).is_multiple_of(4));

/// How often pairs of like contours have which distance, in the newest rows of tiles.
#[derive(Debug, Clone)]
pub(crate) struct Repetition {
    /// Pairs of each distance, times [`WEIGHT`], as much as they will count in the next row; of those too near to count, all so far.
    pairs: [u16; COUNTED],
    /// The most common distance, px.
    pub(crate) distance: u32,
    /// Whether a good part of the contours has its like there.
    pub(crate) is_strong: bool,
}

impl Repetition {
    pub(crate) const NONE: Self = Self { pairs: [0; COUNTED], distance: LEAST, is_strong: false };

    /// Looks at the contours of a row of tiles, from left to right, of one polarity: column in the upper half, strength in the
    /// lower one.
    #[inline(never)]
    pub(crate) fn observe(&mut self, contours: impl Iterator<Item = u32> + Clone) {
        let mut count = 0;
        let mut rest = contours;
        while let Some(contour) = rest.next() {
            count += 1;
            let (column, strength) = (contour & 0xffff_0000, contour & 0xffff);
            let [least, span] = alike(strength);
            let mut likes = 0;
            for other in rest.clone().take(NEXT) {
                let (distance, others) = ((other - column) >> 16, other & 0xffff);
                let is_alike = others.wrapping_sub(least) <= span;
                if cfg!(haarline_dsp) {
                    if distance > MOST {
                        break;
                    }
                    if is_alike {
                        let pairs = &mut self.pairs[distance as usize];
                        *pairs = pairs.saturating_add(WEIGHT);
                        likes += 1;
                        if likes == LIKES {
                            break;
                        }
                    }
                } else {
                    // Without branches, which nobody could foresee.
                    let is_like = is_alike & (distance <= MOST) & (likes < LIKES);
                    let pairs = &mut self.pairs[distance.min(MOST + 1) as usize];
                    *pairs = pairs.saturating_add(WEIGHT * u16::from(is_like));
                    likes += u32::from(is_like);
                }
            }
        }
        let (most, distance) = self.most_common();
        self.distance = distance;
        self.is_strong = most * 100 >= STRONG_PERCENT * 2 * u32::from(WEIGHT) * count.max(1);
    }

    /// How common the most common distance is, times 4, and which it is, the first of equals: one that is no whole number is
    /// shared by two. After that pairs count half.
    #[inline(always)]
    fn most_common(&mut self) -> (u32, u32) {
        let [a, b, rest @ ..] = &mut self.pairs[LEAST as usize - 1..] else { return (0, LEAST) };
        let (mut before, mut here, mut best) = (u32::from(*a), u32::from(*b), 0);
        (*a, *b) = (*a / 2, *b / 2);
        for (i, four) in (0..).step_by(4).zip(rest.as_chunks_mut::<4>().0) {
            for (place, pairs) in (i..).zip(unseen(four)) {
                let after = u32::from(*pairs);
                best = best.max((before + 2 * here + after) << 6 | (63 - place));
                (before, here) = (here, after);
                *pairs /= 2;
            }
        }
        (best >> 6, LEAST + 63 - best % 64)
    }
}

/// The least strength that is like it, about 2/3, and how much more that may be, up to 3/2 of it.
#[inline(always)]
const fn alike(strength: u32) -> [u32; 2] {
    [(11 * strength).div_ceil(16), 13 * strength / 16]
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, reason = "a handful")]
mod tests {
    use super::*;

    fn observed(rows: usize, contours: &[(u32, u32)]) -> (u32, bool) {
        let mut repetition = Repetition::NONE;
        for _ in 0..rows {
            repetition.observe(contours.iter().map(|&(column, strength)| column << 16 | strength));
        }
        (repetition.distance, repetition.is_strong)
    }

    #[test]
    fn bars_tell_their_period_at_once() {
        for period in [8, 11, 24, 40, 61] {
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
    fn contours_too_near_to_count_never_overflow() {
        let contours: [(u32, u32); 64] = core::array::from_fn(|i| (4 * i as u32, 40));
        assert!(observed(2000, &contours).0 >= LEAST);
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
                let is_like = |&&(other, others): &&(u32, u32)| {
                    let [least, span] = alike(strength);
                    let is_alike = (least..=least + span).contains(&others);
                    is_alike && other - column <= MOST
                };
                for &(other, _) in contours.iter().skip(i + 1).take(NEXT).filter(is_like).take(LIKES as usize) {
                    pairs[(other - column) as usize] += 1;
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
            let mixed = (i as u32 + 1).wrapping_mul(0x9e37_79b1);
            let number = (mixed ^ mixed >> 15).wrapping_mul(0x85eb_ca6b);
            (8 * i as u32 + (number >> 29), 4 + (number >> 16) % 128)
        });
        assert!(!observed(5, &contours).1);
    }
}
