//! A whole frame of disparities.

use haarline::{Disparity, DisparityRow};

/// Disparity and confidence of every pixel of the left view, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DisparityMap {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` disparities.
    pub disparity: Vec<Disparity>,
    /// `width * height` confidences, 0 to 255; 0 where the disparity is unknown.
    pub confidence: Vec<u8>,
}

/// Least, middle and greatest known disparity, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Least known disparity, px.
    pub min_px: f64,
    /// The lower median, px.
    pub median_px: f64,
    /// Greatest known disparity, px.
    pub max_px: f64,
}

impl DisparityMap {
    /// A map without a row yet.
    #[must_use]
    pub fn with_capacity(width: usize, height: usize) -> Self {
        let pixels = width * height;
        Self { width, height: 0, disparity: Vec::with_capacity(pixels), confidence: Vec::with_capacity(pixels) }
    }

    /// Adds the next row at the bottom.
    pub(crate) fn push_row(&mut self, row: &DisparityRow<'_>) {
        self.disparity.extend_from_slice(row.disparity);
        self.confidence.extend_from_slice(row.confidence);
        self.height += 1;
    }

    /// The disparity in column `x` of row `y`.
    ///
    /// # Panics
    /// If `x` or `y` lies outside.
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> Disparity {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.disparity[y * self.width + x]
    }

    /// The known disparities in raw 1/16 px steps.
    pub fn known(&self) -> impl Iterator<Item = i16> {
        self.disparity.iter().filter_map(|d| d.known())
    }

    /// Share of known pixels, percent.
    #[must_use]
    pub fn density(&self) -> f64 {
        100.0 * self.known().count() as f64 / self.disparity.len().max(1) as f64
    }

    /// Makes every pixel of less than `min_confidence` unknown.
    pub fn drop_below(&mut self, min_confidence: u8) {
        for (disparity, confidence) in self.disparity.iter_mut().zip(&mut self.confidence) {
            if *confidence < min_confidence {
                *disparity = Disparity::UNKNOWN;
                *confidence = 0;
            }
        }
    }

    /// Fills the holes of every row from what lies beside them, see [`haarline::fill_holes`].
    pub fn fill_holes(&mut self) {
        let rows = self.disparity.chunks_mut(self.width).zip(self.confidence.chunks_mut(self.width));
        for (disparity, confidence) in rows {
            haarline::fill_holes(disparity, confidence);
        }
    }

    /// Range and median of what is known; `None` where nothing is.
    #[must_use]
    pub fn spread(&self) -> Option<Spread> {
        let mut known: Vec<i16> = self.known().collect();
        known.sort_unstable();
        let (min, max) = (*known.first()?, *known.last()?);
        let median = known[(known.len() - 1) / 2];
        Some(Spread { min_px: px(min), median_px: px(median), max_px: px(max) })
    }
}

/// Raw 1/16 px steps as pixels.
#[must_use]
pub fn px(bits: i16) -> f64 {
    f64::from(bits) / f64::from(1 << Disparity::FRAC_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> DisparityMap {
        let mut map = DisparityMap::with_capacity(4, 1);
        let disparity = [Disparity::from_px(3), Disparity::UNKNOWN, Disparity::from_bits(8), Disparity::from_px(7)];
        map.push_row(&DisparityRow { y: 0, disparity: &disparity, confidence: &[9, 0, 200, 50] });
        map
    }

    #[test]
    fn density_and_spread_count_known_pixels_only() {
        assert_eq!(map().density(), 75.0);
        assert_eq!(map().spread(), Some(Spread { min_px: 0.5, median_px: 3.0, max_px: 7.0 }));
    }

    #[test]
    fn less_confident_pixels_become_unknown() {
        let mut map = map();
        map.drop_below(50);
        assert_eq!(map.known().collect::<Vec<_>>(), [8, 112]);
        assert_eq!(map.confidence, [0, 0, 200, 50]);
        map.drop_below(255);
        assert_eq!(map.spread(), None);
    }
}
