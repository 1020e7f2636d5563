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
        let pairs = right.entering.iter().zip(right.leaving);
        for (sum, (&entering, &leaving)) in self.columns[column].iter_mut().zip(pairs) {
            *sum = *sum + M::term(left.entering, entering, cap) - M::term(left.leaving, leaving, cap);
        }
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

    /// Two sums of 16 bits in a word of 32: all that is carried from the lower to the upper one while adding is
    /// carried back while subtracting, since the sums themselves fit.
    fn slide(window: &mut [u16], entering: &[u16], leaving: &[u16]) {
        let (pairs, odd) = window.as_chunks_mut::<2>();
        let (entering_pairs, entering_odd) = entering.as_chunks::<2>();
        let (leaving_pairs, leaving_odd) = leaving.as_chunks::<2>();
        for (pair, (&entering, &leaving)) in pairs.iter_mut().zip(entering_pairs.iter().zip(leaving_pairs)) {
            let slid = word(*pair).wrapping_add(word(entering)).wrapping_sub(word(leaving)).to_le_bytes();
            *pair = [u16::from_le_bytes([slid[0], slid[1]]), u16::from_le_bytes([slid[2], slid[3]])];
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
