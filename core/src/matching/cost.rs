//! What a disparity costs: sums of absolute differences over windows of features.

use crate::Config;
use crate::answer::texture::{Texture, mismatch};
use crate::count;
use crate::front_end::ring::MARGIN;
use crate::front_end::view::CLIP;
use crate::matching::block::{Block, Floor, SIZE};

/// Rows of a block's window, from one row above the block.
pub(crate) const ROWS: usize = 6;

/// Sum of absolute differences of two windows, `WIDTH` columns of each row; `None` if one overhangs.
///
/// - `left`, `right`: the rows, with margins.
/// - `left_column`, `right_column`: first column of each window, margins counted.
#[inline]
pub(crate) fn sad<const WIDTH: usize>(
    left: &[&[u8]],
    right: &[&[u8]],
    left_column: usize,
    right_column: usize,
) -> Option<i32> {
    let mut sum = 0;
    for (left, right) in left.iter().zip(right) {
        let left = left.get(left_column..)?.first_chunk::<WIDTH>()?;
        let right = right.get(right_column..)?.first_chunk::<WIDTH>()?;
        sum += left.iter().zip(right).map(|(&a, &b)| i32::from(a.abs_diff(b))).sum::<i32>();
    }
    count::sad_words(left.len() * WIDTH.div_ceil(4));
    count::evaluations(1);
    count::subtractions(left.len() * WIDTH);
    count::comparisons(left.len() * WIDTH);
    count::additions(left.len() * WIDTH);
    Some(sum)
}

/// Sum of the features' magnitudes in a window: its texture.
#[inline]
fn energy<const WIDTH: usize>(rows: &[&[u8]], column: usize) -> Option<i32> {
    let mut sum = 0;
    count::subtractions(rows.len() * WIDTH);
    count::comparisons(rows.len() * WIDTH);
    count::additions(rows.len() * WIDTH);
    for row in rows {
        let row = row.get(column..)?.first_chunk::<WIDTH>()?;
        sum += row.iter().map(|&a| (i32::from(a) - CLIP).abs()).sum::<i32>();
    }
    Some(sum)
}

/// The windows of one block row, `WIDTH` columns around each block.
pub(crate) struct BlockCost<'a, const WIDTH: usize> {
    pub(crate) config: &'a Config,
    /// Feature rows of both views from one row above the block row on.
    pub(crate) left: [&'a [u8]; ROWS],
    pub(crate) right: [&'a [u8]; ROWS],
}

impl<const WIDTH: usize> BlockCost<'_, WIDTH> {
    /// Pixels of the window.
    #[expect(clippy::cast_possible_truncation, reason = "at most 8 x 6")]
    pub(crate) const PIXELS: u8 = (WIDTH * ROWS) as u8;

    /// What a match costs, `0..=3072`: the SAD of the windows, and a third of a grey level for each
    /// px farther than the nearest disparity, so that the nearer of two equal matches wins: a vehicle
    /// had better brake. `None` outside the search range or where a window leaves the view.
    pub(crate) fn of(&self, index: usize, disparity: i32) -> Option<i32> {
        if !self.config.contains(disparity) {
            return None;
        }
        let (left_column, right_column) = columns::<WIDTH>(index, disparity)?;
        let sad = sad::<WIDTH>(&self.left, &self.right, left_column, right_column)?;
        Some(sad + self.farness(disparity))
    }

    /// The block of a match: its cost and its texture.
    pub(crate) fn examine(&self, texture: Texture, index: usize, disparity: i32, cost: i32) -> Option<Block> {
        let (left_column, right_column) = columns::<WIDTH>(index, disparity)?;
        let energies = [energy::<WIDTH>(&self.left, left_column)?, energy::<WIDTH>(&self.right, right_column)?];
        let mismatch = mismatch(cost - self.farness(disparity), energies[0] + energies[1], i32::from(Self::PIXELS));
        let window = texture.is_at_floor(i32::midpoint(energies[0], energies[1]), u32::from(Self::PIXELS));
        let mut pixels = 0;
        // The features within the noise, then mismatch, floor and verdict.
        count::subtractions(SIZE * SIZE + 1);
        count::comparisons(2 * SIZE * SIZE + 3);
        count::additions(2);
        count::multiplications(4);
        // The block's own rows within the window, last one first.
        for row in self.left[1..=SIZE].iter().rev() {
            for &feature in row.get(SIZE * index + MARGIN..)?.first_chunk::<SIZE>()?.iter().rev() {
                pixels = pixels << 1 | u16::from(texture.pixel_is_at_floor((i32::from(feature) - CLIP).abs()));
            }
        }
        // Until the blocks around it are known, it speaks for itself.
        let blank = window && texture.is_blank(u16::from(mismatch), 1);
        Some(Block {
            disparity: i16::try_from(disparity).ok()?,
            cost: u16::try_from(cost).ok()?,
            mismatch,
            floor: Floor { pixels, window, blank },
            ..Block::default()
        })
    }

    fn farness(&self, disparity: i32) -> i32 {
        count::additions(1);
        count::subtractions(1);
        count::multiplications(1);
        (i32::from(self.config.min_disparity) + i32::from(self.config.num_disparities) - 1 - disparity) / 3
    }
}

/// First columns of the block's window in both views, margins counted.
fn columns<const WIDTH: usize>(index: usize, disparity: i32) -> Option<(usize, usize)> {
    let left = SIZE * index + MARGIN - (WIDTH - SIZE) / 2;
    let right = i32::try_from(left).ok()? - disparity;
    Some((left, usize::try_from(right).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sad_is_that_of_the_two_windows_and_an_overhang_has_none() {
        let left: [&[u8]; 2] = [&[9, 1, 2, 3], &[9, 4, 5, 6]];
        let right: [&[u8]; 2] = [&[1, 4, 3, 9], &[4, 5, 0, 9]];
        assert_eq!(sad::<2>(&left, &right, 1, 0), Some(2));
        assert_eq!(sad::<3>(&left, &right, 1, 0), Some(2 + 6));
        assert_eq!(sad::<3>(&left, &right, 2, 0), None);
        assert_eq!(sad::<3>(&left, &right, 0, 2), None);
    }

    #[test]
    fn the_energy_counts_both_signs_from_the_offset() {
        let clip = u8::try_from(CLIP).unwrap();
        let row = [clip, clip + 3, clip - 5, clip];
        assert_eq!(energy::<2>(&[&row, &row], 1), Some(2 * (3 + 5)));
        assert_eq!(energy::<2>(&[&row], 3), None);
    }
}
