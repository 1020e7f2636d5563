//! The steps, word by word.

use core::cell::Cell;

use super::{Column, Merits, P1};
use crate::simd::{count_ones, greatest, max, saturating_sub, splat};

/// For each of `candidates`, four in a word, how many bits are those of `pixel`, the same byte four times.
pub fn agree(pixel: u32, candidates: &[u8], agreement: &mut [u32]) {
    for (agreement, &candidates) in agreement.iter_mut().zip(candidates.as_chunks().0) {
        *agreement = count_ones(!pixel ^ u32::from_le_bytes(candidates));
    }
}

/// The path from the right: from `before` to the next column. `floor` is that of `before`. Gives the greatest merit.
pub fn step_from_right<const WORDS: usize>(
    before: &mut Column<WORDS>,
    column: &mut Column<WORDS>,
    words: usize,
    floor: u32,
) -> u32 {
    step(cells(&mut before.right, words), floor, &column.agreement, cells(&mut column.right, words))
}

/// The path from the left: from the pixel before to that of `column`, and adds its merits to those of the path from the right.
pub fn step_from_left<const WORDS: usize>(
    left: &mut Merits<WORDS>,
    column: &mut Column<WORDS>,
    words: usize,
    floor: u32,
) -> u32 {
    let path = cells(&mut left.labels, words);
    let greatest = step(path, floor, &column.agreement, path);
    column.right.iter_mut().zip(path).for_each(|(sum, merits)| *sum += merits.get());
    greatest
}

/// The path from above, and the sums of all three. Gives the greatest merit and the greatest sum.
pub fn step_from_above<const WORDS: usize>(column: &mut Column<WORDS>, words: usize, floor: u32) -> (u32, u32) {
    let path = cells(&mut column.above, words);
    let most = step(path, floor, &column.agreement, path);
    let mut best = 0;
    for ((sum, above), others) in column.agreement.iter_mut().zip(path).zip(&column.right) {
        *sum = above.get() + others;
        best = max(best, *sum);
    }
    (most, greatest(best))
}

fn cells(words: &mut [u32], count: usize) -> &[Cell<u32>] {
    Cell::from_mut(&mut words[..count]).as_slice_of_cells()
}

/// One pixel on, along a path; `before` and `after` may be the same.
fn step(before: &[Cell<u32>], floor: u32, agreement: &[u32], after: &[Cell<u32>]) -> u32 {
    let change = floor + splat(P1);
    let (mut below, mut most) = (0, 0);
    for (at, (&agreement, after)) in agreement.iter().zip(after).enumerate() {
        let here = before[at].get();
        let above = before.get(at + 1).map_or(0, Cell::get);
        let beside = max(here << 8 | below >> 24, here >> 8 | above << 24);
        let merit = max(saturating_sub(here, floor), saturating_sub(beside, change)) + agreement;
        most = max(most, merit);
        below = here;
        after.set(merit);
    }
    greatest(most)
}
