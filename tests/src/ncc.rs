//! Block matching by normalised cross-correlation: the reference `ncc`.

use crate::stereo_bm::{BlockMatcher, Measure, Place, RunningSums, Step, Sums, Winner};

/// [`StereoBm`](crate::StereoBm) with the normalised cross-correlation (NCC) instead of absolute differences; all else is the same.
///
/// It is the plain NCC of the prefilter's responses, `sum(l r) / sqrt(sum(l l) sum(r r))`: these are
/// derivatives, so a mean has gone already, and the prefilter is the other references' too. A
/// factor between the views' contrasts does not change it.
///
/// The cost is `2^15 (1 - ncc |ncc|)`, which has the same order without a root; a window without
/// texture in one view costs 2^15. The gates are StereoBM's on these costs.
///
/// It takes `WIDTH * (4 * DISPARITIES + 2 * WINDOW + 21)` bytes and `12 * DISPARITIES` and 512 more.
///
/// # Source
/// J. P. Lewis, Fast Normalized Cross-Correlation, Vision Interface (1995): energies by running sums.
pub type Ncc<const WIDTH: usize, const DISPARITIES: usize, const WINDOW: usize = 9> =
    BlockMatcher<Correlation<WIDTH, DISPARITIES>, WIDTH, WINDOW>;

/// The cost of no correlation.
const ONE: i64 = 1 << 15;

/// Products of responses.
#[derive(Debug, Clone, Copy)]
struct Product;

impl Measure for Product {
    type Sum = i32;

    fn term(left: u8, right: u8, cap: u8) -> i32 {
        let cap = i32::from(cap);
        (i32::from(left) - cap) * (i32::from(right) - cap)
    }
}

/// The sums that a correlation is made of.
#[derive(Debug, Clone)]
pub struct Correlation<const WIDTH: usize, const DISPARITIES: usize> {
    products: RunningSums<Product, WIDTH, DISPARITIES>,
    /// Squared responses over the window's rows, by column of each view.
    left_columns: [u32; WIDTH],
    right_columns: [u32; WIDTH],
    /// The same over the whole window; of the right view by disparity.
    left: u32,
    right: [u32; DISPARITIES],
    costs: [u32; DISPARITIES],
}

impl<const WIDTH: usize, const DISPARITIES: usize> Sums for Correlation<WIDTH, DISPARITIES> {
    const DISPARITIES: usize = DISPARITIES;

    fn new() -> Self {
        Self {
            products: RunningSums::empty(),
            left_columns: [0; WIDTH],
            right_columns: [0; WIDTH],
            left: 0,
            right: [0; DISPARITIES],
            costs: [0; DISPARITIES],
        }
    }

    fn reset(&mut self) {
        self.products.clear();
        self.left_columns.fill(0);
        self.right_columns.fill(0);
    }

    fn enter_row(&mut self, left: Step<&[u8]>, right: Step<&[u8]>, cap: u8) {
        for (columns, view) in [(&mut self.left_columns, left), (&mut self.right_columns, right)] {
            for (sum, (&entering, &leaving)) in columns.iter_mut().zip(view.entering.iter().zip(view.leaving)) {
                *sum = *sum + squared(entering, cap) - squared(leaving, cap);
            }
        }
    }

    fn enter(&mut self, column: usize, left: Step<u8>, right: Step<&[u8]>, cap: u8) {
        self.products.update(column, left, right, cap);
    }

    fn begin(&mut self, searched: usize) {
        self.products.clear_window(searched);
        self.left = 0;
        self.right[..searched].fill(0);
    }

    fn add(&mut self, entering: Place, searched: usize) {
        self.products.take(entering.column, searched);
        self.left += self.left_columns[entering.left];
        let columns = &self.right_columns[entering.right..][..searched];
        for (sum, entering) in self.right.iter_mut().zip(columns) {
            *sum += entering;
        }
    }

    fn slide(&mut self, columns: Step<Place>, searched: usize) {
        self.products.shift(columns, searched);
        let Step { entering, leaving } = columns;
        self.left = self.left + self.left_columns[entering.left] - self.left_columns[leaving.left];
        let (entering, leaving) = (&self.right_columns[entering.right..], &self.right_columns[leaving.right..]);
        for (sum, (entering, leaving)) in self.right[..searched].iter_mut().zip(entering.iter().zip(leaving)) {
            *sum = *sum + entering - leaving;
        }
    }

    fn winner(&mut self, searched: usize) -> Winner {
        // Two products, a quotient; from one.
        let sums = self.products.window(searched).iter().zip(&self.right);
        for (cost, (&product, &right)) in self.costs.iter_mut().zip(sums) {
            *cost = cost_of(product, self.left, right);
        }
        Winner::find(&self.costs[..searched])
    }
}

/// `2^15 (1 - ncc |ncc|)`, within `0..=2^16`. The sums are below 1.76e6 over 21 x 21 px, so the product
/// below stays under 2^57.
fn cost_of(product: i32, left: u32, right: u32) -> u32 {
    let (product, energies) = (i64::from(product), i64::from(left) * i64::from(right));
    let correlation = (ONE * product * product.abs()).checked_div(energies).unwrap_or(0);
    u32::try_from(ONE - correlation).unwrap_or(0)
}

fn squared(response: u8, cap: u8) -> u32 {
    u32::from(response.abs_diff(cap)).pow(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cost_spans_equal_to_opposite_whatever_the_contrast() {
        for gain in [1, 7, 500] {
            let energies = (100, 100 * gain * gain);
            let cost = |product: i32| cost_of(product * i32::try_from(gain).unwrap(), energies.0, energies.1);
            assert_eq!([100, 50, 0, -50, -100].map(cost), [0, 24_576, 32_768, 40_960, 65_536]);
        }
        assert_eq!(cost_of(0, 0, 7), 32_768);
    }

    #[test]
    fn the_greatest_sums_do_not_overflow() {
        let most = 21 * 21 * 63 * 63;
        assert_eq!(cost_of(most, most.unsigned_abs(), most.unsigned_abs()), 0);
        assert_eq!(cost_of(-most, most.unsigned_abs(), most.unsigned_abs()), 65_536);
    }
}
