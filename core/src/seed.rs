//! Seeds: disparities at contours seen by both views.

use crate::Config;
use crate::contour::{Contour, ContourLine};
use crate::cost::sad;
use crate::count;

/// Columns of the window that compares two contours.
const WINDOW: usize = 8;
/// Marks a block without a seed.
const NONE: i16 = i16::MIN;

/// Marks a contour without a partner.
const NOBODY: u16 = u16::MAX;

/// The contours and the seeds of one block row.
#[derive(Debug, Clone)]
pub(crate) struct Seeds<const BLOCKS: usize> {
    pub(crate) left: ContourLine<BLOCKS>,
    pub(crate) right: ContourLine<BLOCKS>,
    /// For each block the disparity of its own last seed, or of the nearest one before it, px.
    from_left: [i16; BLOCKS],
    /// For each block the disparity of its own first seed, or of the nearest one after it, px.
    from_right: [i16; BLOCKS],
}

/// Who likes whom best: scratch of one search.
struct Preferences<const BLOCKS: usize> {
    /// For each left contour the index of the right one.
    choice: [[u16; 2]; BLOCKS],
    /// For each right contour the least cost so far, and the index of the left one it comes from.
    suitor: [[(u16, u16); 2]; BLOCKS],
}

impl<const BLOCKS: usize> Seeds<BLOCKS> {
    pub(crate) const fn new() -> Self {
        Self {
            left: ContourLine::new(),
            right: ContourLine::new(),
            from_left: [NONE; BLOCKS],
            from_right: [NONE; BLOCKS],
        }
    }

    /// The nearest seeds at or left of and at or right of a block, px.
    pub(crate) fn nearest(&self, block: usize) -> (Option<i32>, Option<i32>) {
        let known = |seeds: &[i16]| seeds.get(block).filter(|&&d| d != NONE).map(|&d| i32::from(d));
        (known(&self.from_left), known(&self.from_right))
    }

    /// Matches the contours of the two lines and spreads the seeds over the blocks.
    ///
    /// A left contour takes the right one of the least cost among those that resemble it within the
    /// search range, if no second one comes within 20 percent of that cost and if it is in turn the
    /// one that the right contour likes best.
    ///
    /// - `left_rows`, `right_rows`: feature rows around the line, with margins.
    pub(crate) fn find(&mut self, config: &Config, left_rows: &[&[u8]], right_rows: &[&[u8]]) {
        self.from_left.fill(NONE);
        self.from_right.fill(NONE);
        let preferences = self.compare(config, left_rows, right_rows);
        self.collect(config, &preferences);
        let mut last = NONE;
        for seed in &mut self.from_left {
            last = if *seed == NONE { last } else { *seed };
            *seed = last;
        }
        let mut next = NONE;
        for seed in self.from_right.iter_mut().rev() {
            next = if *seed == NONE { next } else { *seed };
            *seed = next;
        }
    }

    /// Compares every left contour with the right ones in range.
    fn compare(&self, config: &Config, left_rows: &[&[u8]], right_rows: &[&[u8]]) -> Preferences<BLOCKS> {
        let mut preferences = Preferences { choice: [[NOBODY; 2]; BLOCKS], suitor: [[(u16::MAX, NOBODY); 2]; BLOCKS] };
        let Preferences { choice, suitor } = &mut preferences;
        let least = 16 * i32::from(config.min_disparity) - 8;
        let most = 16 * (i32::from(config.min_disparity) + i32::from(config.num_disparities));
        let right = self.right.as_slice();
        let mut start = 0;
        for ((i, contour), choice) in (0u16..).zip(self.left.as_slice()).zip(choice.as_flattened_mut()) {
            let column = i32::from(contour.column);
            // Both lines are in order, so nobody looks further left than this again.
            while right.get(start).is_some_and(|c| column - i32::from(c.column) >= most) {
                start += 1;
            }
            let (mut best, mut second, mut partner) = (u16::MAX, u16::MAX, NOBODY);
            let in_range = |c: &&Contour| column - i32::from(c.column) >= least;
            let candidates = right.get(start..).unwrap_or(&[]).iter().take_while(in_range);
            // Uniqueness, after all candidates.
            count::multiplications(2);
            count::comparisons(1);
            let candidates = candidates.inspect(|_| count_resemblance());
            for (j, candidate) in (start..).zip(candidates).filter(|(_, c)| contour.resembles(**c)) {
                let Some(cost) = contour_cost(*contour, *candidate, left_rows, right_rows) else { continue };
                count::comparisons(3);
                let j16 = u16::try_from(j).unwrap_or(NOBODY);
                if cost < best {
                    (best, second, partner) = (cost, best, j16);
                } else {
                    second = second.min(cost);
                }
                if let Some(suitor) = suitor.as_flattened_mut().get_mut(j)
                    && cost < suitor.0
                {
                    *suitor = (cost, i);
                }
            }
            let unique = second == u16::MAX || 5 * u32::from(second) > 6 * u32::from(best);
            *choice = if unique { partner } else { NOBODY };
        }
        preferences
    }

    /// Keeps what both sides agree on: the first and the last seed of each block.
    fn collect(&mut self, config: &Config, preferences: &Preferences<BLOCKS>) {
        let choices = preferences.choice.as_flattened().iter();
        for ((i, contour), &partner) in (0u16..).zip(self.left.as_slice()).zip(choices) {
            let partner = usize::from(partner);
            let Some(&(_, suitor)) = preferences.suitor.as_flattened().get(partner) else { continue };
            let Some(other) = self.right.as_slice().get(partner).filter(|_| suitor == i) else { continue };
            let disparity = (contour.column - other.column + 8) >> 4;
            if !config.contains(i32::from(disparity)) {
                continue;
            }
            let block = usize::try_from(contour.column >> 6).unwrap_or(0);
            if let (Some(last), Some(first)) = (self.from_left.get_mut(block), self.from_right.get_mut(block)) {
                *last = disparity;
                if *first == NONE {
                    *first = disparity;
                }
            }
        }
    }
}

/// Whether it is in range; the polarities, and the strengths doubled and trebled.
fn count_resemblance() {
    count::additions(4);
    count::comparisons(4);
}

fn contour_cost(left: Contour, right: Contour, left_rows: &[&[u8]], right_rows: &[&[u8]]) -> Option<u16> {
    // With the margin of 4, the window's first column is the contour's whole column.
    let column = |c: Contour| usize::try_from(c.column >> 4).ok();
    let cost = sad::<WINDOW>(left_rows, right_rows, column(left)?, column(right)?)?;
    u16::try_from(cost).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring::MARGIN;

    const WIDTH: usize = 64;
    const BLOCKS: usize = 18;

    /// Random fields of 4 px, shifted.
    fn line(shift: usize) -> [u16; 4 * BLOCKS] {
        core::array::from_fn(|x| {
            let field = u32::try_from((x + shift) / 4).unwrap();
            u16::try_from(field.wrapping_mul(2_654_435_761) >> 22).unwrap()
        })
    }

    #[test]
    fn contours_seen_by_both_views_seed_every_block_with_their_shift() {
        let (left, right) = (line(0), line(3));
        let mut seeds = Seeds::<BLOCKS>::new();
        seeds.left.find(&left[MARGIN..][..WIDTH], 0, 2, 16);
        seeds.right.find(&right[MARGIN..][..WIDTH], 0, 2, 16);
        let [left, right] = [left, right].map(|line| line.map(|v| v.to_le_bytes()[0] % 60));
        let config = Config { width: 64, min_disparity: 0, num_disparities: 16 };
        seeds.find(&config, &[&left[..]; 3], &[&right[..]; 3]);
        // Beyond the last contour there is none to the right, before the first none to the left.
        for block in 3..WIDTH / 4 - 3 {
            assert_eq!(seeds.nearest(block), (Some(3), Some(3)), "block {block}");
        }
        assert_eq!(seeds.nearest(BLOCKS), (None, None));
    }
}
