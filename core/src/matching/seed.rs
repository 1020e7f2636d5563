//! Seeds: disparities at contours seen by both views.

use crate::Config;
use crate::front_end::contour::{Contour, ContourLine};
use crate::matching::cost::sad;
use crate::matching::pairing::Pairing;

/// Columns of the window that compares two contours.
const WINDOW: usize = 8;
/// Percent of the least cost by which the second least must exceed it.
const UNIQUENESS: u32 = 20;
/// Marks a block without a seed.
const NONE: i16 = i16::MIN;

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

    /// Matches the contours of the two lines by [`Pairing`] and spreads the seeds over the blocks.
    ///
    /// - `left_rows`, `right_rows`: feature rows around the line, with margins.
    pub(crate) fn find(&mut self, config: &Config, left_rows: &[&[u8]], right_rows: &[&[u8]]) {
        self.from_left.fill(NONE);
        self.from_right.fill(NONE);
        let (left, right) = (self.left.as_slice(), self.right.as_slice());
        let pairing =
            Pairing::<BLOCKS>::of(config, left, right, UNIQUENESS, |l, r| contour_cost(l, r, left_rows, right_rows));
        for (i, j, _) in pairing.pairs() {
            let (Some(contour), Some(other)) = (left.get(i), right.get(j)) else { continue };
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
        self.spread();
    }

    /// Gives the blocks without a seed that of the nearest one on either side.
    fn spread(&mut self) {
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
    use crate::front_end::ring::MARGIN;

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
