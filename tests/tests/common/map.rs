//! What a method makes of a frame.

use haarline::{Config, DisparityRow, StereoMethod};

use super::content::hash;
use super::frame::Frame;

/// The rows that were delivered, one after the other.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Map {
    pub width: usize,
    /// Rows delivered.
    pub rows: usize,
    /// Disparities, 1/16 px.
    pub disparity: Vec<Option<i16>>,
    pub confidence: Vec<u8>,
}

/// Which rows the camera loses: one in so many by chance, none if that is 0.
#[derive(Debug, Clone, Copy, Default)]
pub struct Losses {
    pub seed: u32,
    pub one_in: u8,
}

impl Losses {
    pub fn has(self, y: usize) -> bool {
        self.one_in > 0 && hash(self.seed, 0, i32::try_from(y).unwrap()).is_multiple_of(self.one_in)
    }
}

impl Map {
    pub fn new(width: usize) -> Self {
        Self { width, ..Self::default() }
    }

    /// Takes the next row: it must be the next one, and as wide as configured.
    pub fn add(&mut self, row: DisparityRow<'_>) {
        assert_eq!(usize::try_from(row.y), Ok(self.rows), "rows come in order and each once");
        assert_eq!((row.disparity.len(), row.confidence.len()), (self.width, self.width), "width of row {}", row.y);
        self.rows += 1;
        self.disparity.extend(row.disparity.iter().map(|d| d.known()));
        self.confidence.extend(row.confidence);
    }

    /// Column, row and disparity of the pixels that have one.
    pub fn known(&self) -> impl Iterator<Item = (usize, usize, i16)> {
        let pixels = self.disparity.iter().enumerate();
        pixels.filter_map(|(i, d)| Some((i % self.width, i / self.width, (*d)?)))
    }

    pub fn at(&self, x: usize, y: usize) -> Option<i16> {
        self.disparity[y * self.width + x]
    }

    /// Disparities and confidences of one row.
    pub fn row(&self, y: usize) -> (&[Option<i16>], &[u8]) {
        let pixels = y * self.width..(y + 1) * self.width;
        (&self.disparity[pixels.clone()], &self.confidence[pixels])
    }

    pub fn is_row_unknown(&self, y: usize) -> bool {
        self.row(y).0.iter().all(Option::is_none)
    }

    /// Checks what holds for the answer to any frame:
    /// - a known disparity lies in the search range, give or take the half pixel of the sub-pixel
    ///   refinement;
    /// - the column of the right view where the pixel is seen, by the whole disparity nearest to the
    ///   answer (one of the two if it lies half way between them), is in the image;
    /// - the confidence is 0 exactly where the disparity is unknown.
    pub fn check(&self, config: &Config) {
        let (min, num) = (i32::from(config.min_disparity), i32::from(config.num_disparities));
        for (x, y, bits) in self.known() {
            let bits = i32::from(bits);
            assert!((16 * min - 8..=16 * (min + num - 1) + 8).contains(&bits), "{bits}/16 px at ({x}, {y})");
            let is_seen = |px: i32| (0..self.width).contains(&x.wrapping_add_signed(isize::try_from(-px).unwrap()));
            assert!(
                is_seen((bits + 7) >> 4) || is_seen((bits + 8) >> 4),
                "{bits}/16 px at ({x}, {y}) leaves the image"
            );
        }
        for (i, (disparity, confidence)) in self.disparity.iter().zip(&self.confidence).enumerate() {
            assert_eq!(disparity.is_some(), *confidence > 0, "{disparity:?} with confidence {confidence} at {i}");
        }
    }
}

/// Least confidence of what is measured; less is a guess.
pub const LEAST_SURE: u8 = 16;

impl Map {
    /// Checks what holds for the answer of a method that guesses where it has not measured, to any frame:
    /// - all pixels of a row are answered, or, if it was lost, none, with confidence 0;
    /// - an answer lies in the search range, give or take the [`OVERSHOOT`] of a plane through cells;
    /// - what is surer than a guess is seen by the right view, or less than a cell, 4 px, beside it.
    pub fn check_dense(&self, config: &Config) {
        let (min, num) = (i32::from(config.min_disparity), i32::from(config.num_disparities));
        for y in 0..self.rows {
            let (disparity, confidence) = self.row(y);
            let is_lost = self.is_row_unknown(y);
            for (x, (disparity, &confidence)) in disparity.iter().zip(confidence).enumerate() {
                assert_eq!(disparity.is_none(), is_lost, "pixel ({x}, {y})");
                assert_eq!(confidence == 0, is_lost, "confidence {confidence} at ({x}, {y})");
            }
        }
        for (x, y, bits) in self.known() {
            let bits = i32::from(bits);
            let range = 16 * min - OVERSHOOT..=16 * (min + num - 1) + OVERSHOOT;
            assert!(range.contains(&bits), "{bits}/16 px at ({x}, {y})");
            let column = 16 * i32::try_from(x).unwrap() - bits;
            let beside = 16 * 4;
            let seen = 1 - beside..16 * (i32::try_from(self.width).unwrap() - 1) + beside;
            let is_sure = self.row(y).1[x] >= LEAST_SURE;
            assert!(!is_sure || seen.contains(&column), "{bits}/16 px at ({x}, {y}) leaves the image");
        }
    }

    /// The same without guesses.
    pub fn without_guesses(mut self) -> Self {
        for (disparity, confidence) in self.disparity.iter_mut().zip(&mut self.confidence) {
            if *confidence < LEAST_SURE {
                (*disparity, *confidence) = (None, 0);
            }
        }
        self
    }
}

/// By how much an answer may lie outside the whole disparities searched, 1/16 px: the fraction of a cell, and what a plane
/// through it and its neighbours on the same surface adds towards its corner.
const OVERSHOOT: i32 = 8 + 15;

/// Runs a whole frame through a method.
pub fn run(method: &mut dyn StereoMethod, frame: &Frame) -> Map {
    run_with_losses(method, frame, |_| false)
}

/// Runs a whole frame through a method, but for the rows for which `is_lost` holds.
pub fn run_with_losses(method: &mut dyn StereoMethod, frame: &Frame, is_lost: impl Fn(usize) -> bool) -> Map {
    let mut map = Map::new(frame.width);
    for (y, pair) in frame.rows().enumerate() {
        if is_lost(y) {
            method.miss(&mut |row| map.add(row));
        } else {
            method.push(pair, &mut |row| map.add(row)).unwrap();
        }
    }
    method.finish(&mut |row| map.add(row));
    assert_eq!(map.rows, frame.height, "as many rows as pushed or missed");
    map
}
