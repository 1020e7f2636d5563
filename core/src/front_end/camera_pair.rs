//! Both views of a frame as its rows come: how dark and how noisy they are, and which rows did not come.

use super::camera_view::{CameraView, FeatureRows, TileRows};
use super::exposure::{Exposure, Gain};
use super::missing_rows::MissingRows;
use super::noise::{Noise, NoiseHistogram, RawNoise};
use super::sampling::Sampling;
use crate::ScanlinePair;

/// The views, and what is judged of the rows so far.
#[derive(Debug, Clone)]
pub(crate) struct CameraPair<const WORDS: usize, F> {
    pub(crate) left: CameraView<WORDS, F>,
    pub(crate) right: CameraView<WORDS, F>,
    exposure: Exposure,
    histograms: [NoiseHistogram; 2],
    noise: Noise,
    /// Whether the noise is that of rows before they were interpolated.
    has_raw_noise: bool,
    rows: u32,
    missing: MissingRows,
}

impl<const WORDS: usize, F: FeatureRows<WORDS>> CameraPair<WORDS, F> {
    /// Of no rows. A constant, so that it is made where it stays.
    pub(crate) const EMPTY: Self = Self {
        left: CameraView::new(),
        right: CameraView::new(),
        exposure: Exposure::new(),
        histograms: [NoiseHistogram::new(), NoiseHistogram::new()],
        noise: Noise::NONE,
        has_raw_noise: false,
        rows: 0,
        missing: MissingRows::NONE,
    };

    /// Forgets the frame.
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        self.left.clear();
        self.right.clear();
        self.exposure = Exposure::new();
        self.histograms.iter_mut().for_each(NoiseHistogram::clear);
        (self.noise, self.has_raw_noise) = (Noise::NONE, false);
        (self.rows, self.missing) = (0, MissingRows::NONE);
    }

    /// Rows of this frame pushed or missed so far.
    pub(crate) const fn rows(&self) -> u32 {
        self.rows
    }

    /// Whether one of the newest rows was missed.
    pub(crate) const fn is_missing(&self, y: u32) -> bool {
        self.missing.has(y)
    }

    /// The features of a row of tiles, of the left view and of the right one.
    #[inline(always)]
    pub(crate) fn tiles(&self, tile_row: u32) -> [&TileRows<WORDS>; 2] {
        [self.left.tiles(tile_row), self.right.tiles(tile_row)]
    }

    /// The noise of the rows so far.
    pub(crate) const fn noise(&self) -> Noise {
        self.noise
    }

    /// Whether hardly anything is brighter than black.
    pub(crate) const fn is_dark(&self) -> bool {
        self.exposure.is_dark()
    }

    /// A row of both views, of the width of those before.
    #[inline(always)]
    pub(crate) fn push(&mut self, pair: ScanlinePair<'_>) {
        self.missing.set(self.rows, false);
        if let Some(sampling) = Sampling::of(self.rows) {
            self.exposure.sample(pair.left, sampling.first, sampling.stride);
            self.exposure.sample(pair.right, sampling.first, sampling.stride);
        }
        let gain = self.exposure.gain();
        self.left.push(pair.left, gain);
        self.right.push(pair.right, gain);
        self.measure_noise(pair.left.len());
        self.rows += 1;
    }

    /// A row that did not come: the one before stands in for it.
    pub(crate) fn miss(&mut self) {
        self.missing.set(self.rows, true);
        self.rows += 1;
        self.go_on();
    }

    /// A row below the image: the last one goes on.
    pub(crate) fn go_on(&mut self) {
        self.left.push_again();
        self.right.push_again();
    }

    /// The noise of the rows as they came, if those that are pushed are interpolated.
    pub(crate) fn take_noise(&mut self, noise: &RawNoise) {
        self.has_raw_noise = true;
        self.noise = noise.noise(self.exposure.gain());
    }

    /// Takes the noise of some pixels of the row that came before the newest.
    fn measure_noise(&mut self, width: usize) {
        let Some(sampling) = Sampling::of(self.rows).filter(|_| !self.has_raw_noise) else { return };
        if self.rows >= 2 && !self.missing.has_any_of_three(self.rows) {
            let y = self.rows - 1;
            for (view, histogram) in [&self.left, &self.right].into_iter().zip(&mut self.histograms) {
                let rows = [y - 1, y, y + 1].map(|y| view.raw(y));
                histogram.sample(rows, sampling.first, sampling.stride, sampling.weight, width);
            }
        }
        if self.rows < 16 || self.rows.is_multiple_of(8) {
            let [left, right] = &self.histograms;
            self.noise = Noise::of(left, right, Gain::default());
        }
    }
}
