//! Which columns of the right view a pixel is compared with.

use haarline::Config;

use crate::simd::paths::{UNROLLED, agree};
use crate::simd::{count_ones, splat};

/// Agreement with what lies outside the right view, of 8.
const OUTSIDE: u8 = 4;

/// The labels of a search, the greatest disparity's first: so the columns of the right view go up with them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search {
    width: usize,
    /// Labels.
    pub labels: usize,
    /// Words that are worked on; those without labels agree in nothing.
    pub words: usize,
    /// Disparity of the first label, px.
    pub greatest: isize,
}

/// Words that hold so many labels, four each: the capacity of [`Sgm`](crate::Sgm).
#[must_use]
pub const fn words_for(disparities: u16) -> usize {
    (disparities as usize).div_ceil(4 * UNROLLED) * UNROLLED
}

impl Search {
    pub fn new(config: &Config) -> Self {
        let labels = usize::from(config.num_disparities);
        Self {
            width: usize::from(config.width),
            labels,
            words: words_for(config.num_disparities),
            greatest: isize::from(config.min_disparity) + labels.cast_signed() - 1,
        }
    }

    /// Compares the signs `pixel` of the left view's column `x` with those of the `right` view. `agreement` has `words` words.
    #[inline(always)]
    pub fn compare(&self, x: usize, pixel: u8, right: &[u8], agreement: &mut [u32]) {
        let first = x.cast_signed() - self.greatest;
        match usize::try_from(first).ok().and_then(|first| right.get(first..first + 4 * self.words)) {
            Some(candidates) => {
                agree(splat(pixel), candidates, agreement);
                if self.labels < 4 * self.words {
                    self.clear_beyond(agreement);
                }
            }
            None => self.compare_partly(first, pixel, right, agreement),
        }
    }

    /// The same where not all columns exist, of which `first` is the first.
    #[inline(never)]
    fn compare_partly(&self, first: isize, pixel: u8, right: &[u8], agreement: &mut [u32]) {
        for (word, agreement) in agreement.iter_mut().enumerate() {
            let column = first + (4 * word).cast_signed();
            let inside = usize::try_from(column).ok().and_then(|column| right.get(column..)?.first_chunk::<4>());
            *agreement = match inside {
                Some(&candidates) => count_ones(!splat(pixel) ^ u32::from_le_bytes(candidates)),
                None if column <= -4 || column >= self.width.cast_signed() => splat(OUTSIDE),
                None => u32::from_le_bytes([0, 1, 2, 3].map(|label| {
                    let other = usize::try_from(column + label).ok().and_then(|column| right.get(column));
                    other.map_or(OUTSIDE, |other| count_ones(u32::from(!pixel ^ other)).to_le_bytes()[0])
                })),
            };
        }
        self.clear_beyond(agreement);
    }

    /// What is no label agrees in nothing.
    fn clear_beyond(&self, agreement: &mut [u32]) {
        let (whole, rest) = (self.labels / 4, self.labels % 4);
        for (word, agreement) in agreement[whole..].iter_mut().enumerate() {
            *agreement &= if word == 0 { (1 << (8 * rest)) - 1 } else { 0 };
        }
    }
}
