//! For every block of 8 x 8 px and every row offset the least difference over the disparities.

use super::gradient::GradientRing;

/// Columns and rows of a block.
pub(super) const SIDE: usize = 8;
/// Greatest row offset on each side.
pub(super) const MAX_REACH: usize = 9;
/// Most row offsets.
pub(super) const MAX_OFFSETS: usize = 2 * MAX_REACH + 1;
/// Rows of gradients, of the full width and both planes, that two passes need at most: half the width and 26 rows
/// of the left view and 17 of the right one, or the full width and 14 and 11.
pub(super) const LEFT_ROWS: usize = 28;
pub(super) const RIGHT_ROWS: usize = 22;

/// The left view's gradients.
pub(super) type LeftRing<const WIDTH: usize> = GradientRing<WIDTH, LEFT_ROWS>;
/// The right view's gradients.
pub(super) type RightRing<const WIDTH: usize> = GradientRing<WIDTH, RIGHT_ROWS>;

/// What a pass compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Comparison {
    /// Columns and rows of the views at the pass's size.
    pub(super) size: [usize; 2],
    /// Greatest row offset on each side; at most [`MAX_REACH`].
    pub(super) reach: usize,
    /// Least and greatest disparity: the left view shows so many columns further right what the right one shows.
    pub(super) disparities: [i32; 2],
}

/// A row of blocks: the least sums of absolute differences, and the disparities that have them.
#[derive(Debug, Clone)]
pub(super) struct BlockRow<const WIDTH: usize> {
    offsets: usize,
    /// `offsets` of each block, 19 at most: under 3 * 8 columns.
    least: [[u16; WIDTH]; 3],
    disparity: [[i16; WIDTH]; 3],
    /// Sums of four rows, and of all rows, of a column.
    few: [u8; WIDTH],
    all: [u16; WIDTH],
}

impl<const WIDTH: usize> BlockRow<WIDTH> {
    pub(super) const fn new() -> Self {
        Self { offsets: 0, least: [[0; WIDTH]; 3], disparity: [[0; WIDTH]; 3], few: [0; WIDTH], all: [0; WIDTH] }
    }

    /// Compares the blocks of the right view's rows from `top` on with the left view. Rows of the left view beyond its
    /// border are its border row.
    pub(super) fn compare(
        &mut self,
        comparison: &Comparison,
        left: &LeftRing<WIDTH>,
        right: &RightRing<WIDTH>,
        top: u32,
    ) {
        let Comparison { size: [width, height], reach, disparities } = *comparison;
        self.offsets = 2 * reach + 1;
        self.least.as_flattened_mut().fill(u16::MAX);
        let last = i64::try_from(height).unwrap_or(1) - 1;
        for offset in 0..self.offsets {
            let rows: [u32; SIDE] = core::array::from_fn(|row| {
                let y = i64::from(top) + i64::try_from(row + offset).unwrap_or(0) - i64::try_from(reach).unwrap_or(0);
                u32::try_from(y.clamp(0, last)).unwrap_or(0)
            });
            for disparity in disparities[0]..=disparities[1] {
                self.compare_at(width, left, right, (top, rows), offset, disparity);
            }
        }
    }

    /// The same at one row offset and disparity.
    fn compare_at(
        &mut self,
        width: usize,
        left: &LeftRing<WIDTH>,
        right: &RightRing<WIDTH>,
        (top, rows): (u32, [u32; SIDE]),
        offset: usize,
        disparity: i32,
    ) {
        let by = usize::try_from(disparity.unsigned_abs()).unwrap_or(usize::MAX);
        let Some(common) = width.checked_sub(by) else { return };
        // The blocks of the right view whose pixels all have a partner.
        let (first, end) = if disparity < 0 { (by.div_ceil(SIDE), width / SIDE) } else { (0, common / SIDE) };
        if first >= end {
            return;
        }
        let columns = first * SIDE..end * SIDE;
        let partner = if disparity < 0 { columns.start - by } else { columns.start + by };
        let count = columns.len();
        let (few, all) = (&mut self.few[..count], &mut self.all[..count]);
        all.fill(0);
        for (four, rows) in rows.chunks(4).enumerate() {
            for plane in 0..2 {
                few.fill(0);
                for (row, &y) in rows.iter().enumerate() {
                    let here = top + u32::try_from(4 * four + row).unwrap_or(0);
                    let (one, other) = (right.row(here)[plane], left.row(y)[plane]);
                    let (one, other) = (one.get(columns.clone()), other.get(partner..partner + count));
                    add_differences(few, one.unwrap_or(&[]), other.unwrap_or(&[]));
                }
                for (all, &few) in all.iter_mut().zip(few.iter()) {
                    *all += u16::from(few);
                }
            }
        }
        let (least, found) = (self.least.as_flattened_mut(), self.disparity.as_flattened_mut());
        for (block, columns) in (first..end).zip(all.as_chunks::<SIDE>().0) {
            let sum: u16 = columns.iter().sum();
            let at = block * self.offsets + offset;
            if sum < least[at] {
                least[at] = sum;
                found[at] = i16::try_from(disparity).unwrap_or(0);
            }
        }
    }

    /// The least sums of a block by row offset, the least first; none where nothing could be compared.
    pub(super) fn profile(&self, block: usize) -> Option<&[u16]> {
        let profile = self.least.as_flattened().get(block * self.offsets..(block + 1) * self.offsets)?;
        profile.iter().all(|&sum| sum < u16::MAX).then_some(profile)
    }

    /// The disparity of a block's least sum at a row offset.
    pub(super) fn disparity(&self, block: usize, offset: usize) -> i16 {
        self.disparity.as_flattened().get(block * self.offsets + offset).copied().unwrap_or(0)
    }
}

/// Adds absolute differences, of which four fit.
fn add_differences(sums: &mut [u8], one: &[u8], other: &[u8]) {
    for ((sum, one), other) in sums.iter_mut().zip(one).zip(other) {
        *sum += one.abs_diff(*other);
    }
}
