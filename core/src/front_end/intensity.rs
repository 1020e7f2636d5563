//! Features of the reading by intensities: pixels less the mean around them.

use crate::front_end::camera_view::{CameraView, FeatureRows, Row, TILE_ROWS, replicate_borders, words_for};
use crate::lanes::rows::{Clips, Mean, mean_across, mean_down};
use crate::lanes::{signed_add, signed_sub};

impl<const WORDS: usize, F: FeatureRows<WORDS>> CameraView<WORDS, F> {
    /// Makes the features of the next row, one row behind the newest smoothed one: twice what a pixel differs from the mean
    /// around it, `[1 2 1]` down and 17 columns across.
    pub(crate) fn intensity_row(&mut self, clips: Clips, width: usize) {
        let y = self.features_len();
        let words = words_for(width);
        let above = y.saturating_sub(1);
        let rows = [above, above, y, y + 1, y + 1].map(|y| &self.smooth(y)[..words]);
        let mut mean: Row<WORDS> = [0; WORDS];
        mean_down(rows, Mean::Three, &mut mean[..words]);
        for _ in 0..2 {
            let mut wider: Row<WORDS> = [0; WORDS];
            replicate_borders(&mut mean, width);
            mean_across(&mean[..words], Mean::Nine, &mut wider[..words]);
            mean = wider;
        }
        let mut row: Row<WORDS> = [0; WORDS];
        for ((out, &pixel), &mean) in row.iter_mut().zip(self.smooth(y)).zip(&mean).take(words) {
            let difference = signed_sub(pixel, mean);
            *out = clips.of(signed_add(difference, difference));
        }
        replicate_borders(&mut row, width);
        self.push_features(y, row);
    }

    /// Keeps the features of a row.
    fn push_features(&mut self, y: u32, row: Row<WORDS>) {
        self.features.tiles_mut(y / TILE_ROWS)[(y % TILE_ROWS) as usize] = row;
        self.features_len += 1;
    }
}
