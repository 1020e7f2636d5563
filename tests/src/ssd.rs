//! Block matching by squared differences: the reference `ssd`.

use crate::stereo_bm::{BlockMatcher, Measure, RunningSums};

/// [`StereoBm`](crate::StereoBm) with the sum of squared differences (SSD) instead of absolute ones; all else is the same.
///
/// A difference counts by its square, so an outlier spoils a window sooner. The gates are StereoBM's on
/// the squared costs. It takes `WIDTH * (4 * DISPARITIES + 2 * WINDOW + 13)` bytes and less than 2 KB more.
pub type Ssd<const WIDTH: usize, const DISPARITIES: usize, const WINDOW: usize = 9> =
    BlockMatcher<RunningSums<Squared, WIDTH, DISPARITIES>, WIDTH, WINDOW>;

/// Squared differences, at most 126 each squared: 7.0e6 over a window of 21 px.
#[derive(Debug, Clone, Copy)]
pub struct Squared;

impl Measure for Squared {
    type Sum = u32;

    fn term(left: u8, right: u8, _: u8) -> u32 {
        u32::from(left.abs_diff(right)).pow(2)
    }
}
