//! What a disparity costs: sums of absolute differences over windows of features.

use crate::view::CLIP;

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
    Some(sum)
}

/// Sum of the features' magnitudes in a window: its texture.
#[inline]
pub(crate) fn energy<const WIDTH: usize>(rows: &[&[u8]], column: usize) -> Option<i32> {
    let mut sum = 0;
    for row in rows {
        let row = row.get(column..)?.first_chunk::<WIDTH>()?;
        sum += row.iter().map(|&a| (i32::from(a) - CLIP).abs()).sum::<i32>();
    }
    Some(sum)
}
