//! The sums over windows that block matching slides along: what two pixels add to them is a measure's.

use core::fmt::Debug;
use core::ops::{Add, Sub};

use super::winner::Winner;
pub use crate::simd::Step;

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

    /// The least cost of the window, and what speaks against it.
    fn winner(&mut self, searched: usize) -> Winner;
}

/// What two responses add to a sum.
pub trait Measure: Clone + Debug {
    /// The sum, which holds that of any window.
    type Sum: Copy + Debug + Default + Add<Output = Self::Sum> + Sub<Output = Self::Sum>;

    /// The part of one pair, each `cap` too great.
    fn term(left: u8, right: u8, cap: u8) -> Self::Sum;
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

    fn winner(&mut self, searched: usize) -> Winner {
        Winner::find(self.window(searched))
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
        let sums = &mut self.columns[column];
        for (sum, (&entering, &leaving)) in sums.iter_mut().zip(right.entering.iter().zip(right.leaving)) {
            *sum = *sum + M::term(left.entering, entering, cap) - M::term(left.leaving, leaving, cap);
        }
    }

    pub(crate) fn take(&mut self, column: usize, searched: usize) {
        for (sum, &entering) in self.window[..searched].iter_mut().zip(&self.columns[column]) {
            *sum = *sum + entering;
        }
    }

    pub(crate) fn shift(&mut self, columns: Step<Place>, searched: usize) {
        let (entering, leaving) = (&self.columns[columns.entering.column], &self.columns[columns.leaving.column]);
        for (sum, (&entering, &leaving)) in self.window[..searched].iter_mut().zip(entering.iter().zip(leaving)) {
            *sum = *sum + entering - leaving;
        }
    }
}
