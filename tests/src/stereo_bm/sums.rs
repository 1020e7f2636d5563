//! The sums over windows that block matching slides along: what two pixels add to them is a measure's.

use core::fmt::Debug;
use core::ops::{Add, Sub};

use haarline::count;

/// What enters a window, and what leaves it on the other side.
#[derive(Debug, Clone, Copy)]
pub struct Step<T> {
    /// Enters.
    pub entering: T,
    /// Leaves.
    pub leaving: T,
}

/// A cost column and what it compares.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Its number.
    pub column: usize,
    /// Column of the left view.
    pub left: usize,
    /// First column of the right view.
    pub right: usize,
}

/// The costs of a window that moves down and to the right. Responses of the prefilter are `cap` too great.
pub trait Sums: Clone + Debug {
    /// A cost: less is better.
    type Cost: Copy + Into<u32>;
    /// Disparities that there is room for.
    const DISPARITIES: usize;

    /// Sums of nothing.
    fn new() -> Self;

    /// Forgets all rows: the window is over flat ones.
    fn reset(&mut self);

    /// The window moves down by a row: once for each row, with all of it.
    fn enter_row(&mut self, left: Step<&[u8]>, right: Step<&[u8]>, cap: u8) {
        let _ = (left, right, cap);
    }

    /// The same for one cost column: a pixel of the left view, and all that it is compared with.
    fn enter(&mut self, column: usize, left: Step<u8>, right: Step<&[u8]>, cap: u8);

    /// Empties the window, for a new row of `searched` disparities.
    fn begin(&mut self, searched: usize);

    /// Takes a column in.
    fn add(&mut self, entering: Place, searched: usize);

    /// Moves on by a column.
    fn slide(&mut self, columns: Step<Place>, searched: usize);

    /// The costs of the window, the greatest disparity's first.
    fn costs(&mut self, searched: usize) -> &[Self::Cost];
}

/// What two responses add to a sum.
pub trait Measure: Clone + Debug {
    /// The sum, which holds that of any window.
    type Sum: Copy + Debug + Default + Add<Output = Self::Sum> + Sub<Output = Self::Sum>;

    /// The part of one pair, each `cap` too great.
    fn term(left: u8, right: u8, cap: u8) -> Self::Sum;

    /// Moves a cost column's sums down by a row, each by what its own response of the right view makes of `left`.
    fn descend(column: &mut [Self::Sum], left: Step<u8>, right: Step<&[u8]>, cap: u8) {
        for (sum, (&entering, &leaving)) in column.iter_mut().zip(right.entering.iter().zip(right.leaving)) {
            *sum = *sum + Self::term(left.entering, entering, cap) - Self::term(left.leaving, leaving, cap);
        }
    }

    /// Slides the sums of a window on: what enters is added, what leaves is subtracted.
    fn slide(window: &mut [Self::Sum], entering: &[Self::Sum], leaving: &[Self::Sum]) {
        for (sum, (&entering, &leaving)) in window.iter_mut().zip(entering.iter().zip(leaving)) {
            *sum = *sum + entering - leaving;
        }
    }

    /// Counts what `terms` of them take.
    fn count(terms: usize);
}

/// Sums of a measure by running sums: down within each cost column, then along the row.
#[derive(Debug, Clone)]
pub struct RunningSums<M: Measure, const WIDTH: usize, const DISPARITIES: usize> {
    /// Over the window's rows, by cost column and disparity.
    columns: [[M::Sum; DISPARITIES]; WIDTH],
    /// Over the whole window, by disparity.
    window: [M::Sum; DISPARITIES],
}

impl<M: Measure, const WIDTH: usize, const DISPARITIES: usize> RunningSums<M, WIDTH, DISPARITIES> {
    /// The sums over the window.
    pub fn window(&self, searched: usize) -> &[M::Sum] {
        &self.window[..searched]
    }
}

impl<M: Measure, const WIDTH: usize, const DISPARITIES: usize> Sums for RunningSums<M, WIDTH, DISPARITIES>
where
    M::Sum: Into<u32>,
{
    type Cost = M::Sum;
    const DISPARITIES: usize = DISPARITIES;

    fn new() -> Self {
        Self::empty()
    }

    fn reset(&mut self) {
        self.clear();
    }

    fn enter(&mut self, column: usize, left: Step<u8>, right: Step<&[u8]>, cap: u8) {
        self.update(column, left, right, cap);
    }

    fn begin(&mut self, searched: usize) {
        self.clear_window(searched);
    }

    fn add(&mut self, entering: Place, searched: usize) {
        self.take(entering.column, searched);
    }

    fn slide(&mut self, columns: Step<Place>, searched: usize) {
        self.shift(columns, searched);
    }

    fn costs(&mut self, searched: usize) -> &[M::Sum] {
        self.window(searched)
    }
}

/// The work itself, also for sums that are no costs.
impl<M: Measure, const WIDTH: usize, const DISPARITIES: usize> RunningSums<M, WIDTH, DISPARITIES> {
    pub(crate) fn empty() -> Self {
        let zero = M::Sum::default();
        Self { columns: [[zero; DISPARITIES]; WIDTH], window: [zero; DISPARITIES] }
    }

    pub(crate) fn clear(&mut self) {
        self.columns.as_flattened_mut().fill(M::Sum::default());
    }

    pub(crate) fn clear_window(&mut self, searched: usize) {
        self.window[..searched].fill(M::Sum::default());
    }

    pub(crate) fn update(&mut self, column: usize, left: Step<u8>, right: Step<&[u8]>, cap: u8) {
        M::count(2 * right.entering.len());
        count::additions(right.entering.len());
        count::subtractions(right.entering.len());
        M::descend(&mut self.columns[column], left, right, cap);
    }

    pub(crate) fn take(&mut self, column: usize, searched: usize) {
        count::additions(searched);
        for (sum, &entering) in self.window[..searched].iter_mut().zip(&self.columns[column]) {
            *sum = *sum + entering;
        }
    }

    pub(crate) fn shift(&mut self, columns: Step<Place>, searched: usize) {
        count::additions(searched);
        count::subtractions(searched);
        let (entering, leaving) = (&self.columns[columns.entering.column], &self.columns[columns.leaving.column]);
        M::slide(&mut self.window[..searched], &entering[..searched], &leaving[..searched]);
    }
}

/// Absolute differences: StereoBM's SAD.
#[derive(Debug, Clone, Copy)]
pub struct Absolute;

impl Measure for Absolute {
    type Sum = u16;

    fn term(left: u8, right: u8, _: u8) -> u16 {
        u16::from(left.abs_diff(right))
    }

    /// Four differences at once, a byte each, and two sums of 16 bits in a word as in [`slide`](Self::slide).
    fn descend(column: &mut [u16], left: Step<u8>, right: Step<&[u8]>, cap: u8) {
        let [entering_left, leaving_left] = [left.entering, left.leaving].map(|left| u32::from_le_bytes([left; 4]));
        let (sums, odd) = column[..right.entering.len()].as_chunks_mut::<4>();
        let (entering, entering_odd) = right.entering.as_chunks::<4>();
        let (leaving, leaving_odd) = right.leaving.as_chunks::<4>();
        for (sums, (&entering, &leaving)) in sums.iter_mut().zip(entering.iter().zip(leaving)) {
            let entering = differences(entering_left, u32::from_le_bytes(entering));
            let leaving = differences(leaving_left, u32::from_le_bytes(leaving));
            let [low, high] = widened((entering | TOPS) - leaving);
            let [first, second, third, fourth] = *sums;
            let [first, second] = halves(word([first, second]).wrapping_add(low).wrapping_sub(TOP_PAIR));
            let [third, fourth] = halves(word([third, fourth]).wrapping_add(high).wrapping_sub(TOP_PAIR));
            *sums = [first, second, third, fourth];
        }
        for (sum, (&entering, &leaving)) in odd.iter_mut().zip(entering_odd.iter().zip(leaving_odd)) {
            *sum = *sum + Self::term(left.entering, entering, cap) - Self::term(left.leaving, leaving, cap);
        }
    }

    /// Two sums of 16 bits in a word of 32: all that is carried from the lower to the upper one while adding is
    /// carried back while subtracting, since the sums themselves fit.
    fn slide(window: &mut [u16], entering: &[u16], leaving: &[u16]) {
        let (pairs, odd) = window.as_chunks_mut::<2>();
        let (entering_pairs, entering_odd) = entering.as_chunks::<2>();
        let (leaving_pairs, leaving_odd) = leaving.as_chunks::<2>();
        for (pair, (&entering, &leaving)) in pairs.iter_mut().zip(entering_pairs.iter().zip(leaving_pairs)) {
            *pair = halves(word(*pair).wrapping_add(word(entering)).wrapping_sub(word(leaving)));
        }
        for (sum, (&entering, &leaving)) in odd.iter_mut().zip(entering_odd.iter().zip(leaving_odd)) {
            *sum = *sum + entering - leaving;
        }
    }

    fn count(terms: usize) {
        count::subtractions(terms);
        count::comparisons(terms);
    }
}

fn word([low, high]: [u16; 2]) -> u32 {
    u32::from(low) | u32::from(high) << 16
}

/// The pair that a [`word`] holds.
fn halves(word: u32) -> [u16; 2] {
    let [a, b, c, d] = word.to_le_bytes();
    [u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d])]
}

/// The top bit of each byte: free in responses, at most 126, and in their differences.
const TOPS: u32 = 0x8080_8080;
/// What [`TOPS`] adds to each half of a widened word.
const TOP_PAIR: u32 = 0x0080_0080;

/// Absolute differences of four pairs of responses, a byte each.
///
/// A top bit lent to each byte of `left` keeps borrows inside the byte, and is used up where `right` is greater: there
/// the seven bits below are 128 less the difference.
fn differences(left: u32, right: u32) -> u32 {
    let lent = (left | TOPS).wrapping_sub(right);
    let is_less = !lent & TOPS;
    let flip = is_less - (is_less >> 7);
    ((lent & !TOPS) ^ flip) + (is_less >> 7)
}

/// The four bytes in their order, 16 bits each: the first two, the last two.
fn widened(bytes: u32) -> [u32; 2] {
    let (even, odd) = (bytes & 0x00ff_00ff, (bytes >> 8) & 0x00ff_00ff);
    [(even & 0xffff) | (odd << 16), (even >> 16) | (odd & 0xffff_0000)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_differences_at_once_are_the_four_differences() {
        for left in 0..=126_u8 {
            for right in 0..=126 {
                let others = [right, 126 - right, left, 0];
                let seen = differences(u32::from_le_bytes([left; 4]), u32::from_le_bytes(others)).to_le_bytes();
                assert_eq!(seen, others.map(|other| left.abs_diff(other)), "{left} {others:?}");
            }
        }
    }

    #[test]
    fn widened_bytes_keep_their_order() {
        assert_eq!(widened(0x0403_0201).map(halves), [[1, 2], [3, 4]]);
    }

    #[test]
    fn sums_descend_by_what_enters_less_what_leaves() {
        // Six: four at once and two that are left over.
        let mut column = [126, 0, 55_566, 1000, 7, 126];
        let right = Step { entering: &[126, 0, 5, 60, 126, 0][..], leaving: &[126, 0, 120, 61, 1, 126] };
        Absolute::descend(&mut column, Step { entering: 126, leaving: 0 }, right, 63);
        assert_eq!(column, [0, 126, 55_567, 1005, 6, 126]);
    }
}
