//! One camera's view in words of four columns: rows as they came, smoothed rows, features.

use crate::front_end::exposure::Gain;
use crate::front_end::noise::SmoothingLevel;
use crate::lanes;
use crate::lanes::rows::{Clips, fill, gradient_across, gradient_down, mean_across, mean_down};

/// Rows as they came that are kept: those of the widest filter.
const RAW_ROWS: u32 = 5;
/// Smoothed rows that are kept: those of a tile.
const SMOOTH_ROWS: u32 = 4;
/// Rows of a tile.
pub(crate) const TILE_ROWS: u32 = 4;

/// A row: a word of margin, the columns, a word of margin; four columns a word, the lowest byte leftmost.
pub(crate) type Row<const WORDS: usize> = [u32; WORDS];

/// The features of a row of tiles.
pub(crate) type TileRows<const WORDS: usize> = [Row<WORDS>; TILE_ROWS as usize];

/// Features of so many rows of tiles: the newest.
pub trait FeatureRows<const WORDS: usize> {
    /// Before any.
    const EMPTY: Self;
    /// Those of a row of tiles.
    fn tiles(&self, tile_row: u32) -> &[[u32; WORDS]; 4];
    /// The same, to be filled.
    fn tiles_mut(&mut self, tile_row: u32) -> &mut [[u32; WORDS]; 4];
}

impl<const WORDS: usize, const KEPT: usize> FeatureRows<WORDS> for [[[u32; WORDS]; 4]; KEPT] {
    const EMPTY: Self = [[[0; WORDS]; 4]; KEPT];

    #[inline(always)]
    fn tiles(&self, tile_row: u32) -> &[[u32; WORDS]; 4] {
        &self[tile_row as usize % KEPT]
    }

    #[inline(always)]
    fn tiles_mut(&mut self, tile_row: u32) -> &mut [[u32; WORDS]; 4] {
        &mut self[tile_row as usize % KEPT]
    }
}

/// What is kept of one view. Grey levels are signed bytes, 128 less than the camera's.
#[derive(Debug, Clone)]
pub(crate) struct CameraView<const WORDS: usize, F> {
    raw: [Row<WORDS>; RAW_ROWS as usize],
    smooth: [Row<WORDS>; SMOOTH_ROWS as usize],
    pub(super) features: F,
    /// Of the newest 32 smoothed rows, those that were really smoothed; the others are as they came.
    is_smoothed: u32,
    raw_len: u32,
    smooth_len: u32,
    pub(super) features_len: u32,
}

impl<const WORDS: usize, F: FeatureRows<WORDS>> CameraView<WORDS, F> {
    pub(crate) const fn new() -> Self {
        Self {
            raw: [[0; WORDS]; RAW_ROWS as usize],
            smooth: [[0; WORDS]; SMOOTH_ROWS as usize],
            features: F::EMPTY,
            is_smoothed: 0,
            raw_len: 0,
            smooth_len: 0,
            features_len: 0,
        }
    }

    /// Forgets the frame.
    pub(crate) fn clear(&mut self) {
        (self.raw_len, self.smooth_len, self.features_len, self.is_smoothed) = (0, 0, 0, 0);
    }

    /// Rows that came.
    pub(crate) const fn len(&self) -> u32 {
        self.raw_len
    }

    /// Rows whose features are known.
    pub(crate) const fn features_len(&self) -> u32 {
        self.features_len
    }

    /// Takes a row of the camera.
    pub(crate) fn push(&mut self, pixels: &[u8], gain: Gain) {
        let row = &mut self.raw[(self.raw_len % RAW_ROWS) as usize];
        self.raw_len += 1;
        fill(row, pixels, gain.doublings());
        replicate_borders(row, pixels.len());
    }

    /// Takes the newest row once more; mid-grey if there is none.
    pub(crate) fn push_again(&mut self) {
        let newest = match self.raw_len {
            0 => [0; WORDS],
            len => self.raw[((len - 1) % RAW_ROWS) as usize],
        };
        self.raw[(self.raw_len % RAW_ROWS) as usize] = newest;
        self.raw_len += 1;
    }

    /// Row `y` as it came; below the newest is the newest.
    pub(crate) fn raw(&self, y: u32) -> &Row<WORDS> {
        &self.raw[(clamp(y, self.raw_len) % RAW_ROWS) as usize]
    }

    /// Row `y` after smoothing; below the newest is the newest.
    pub(crate) fn smooth(&self, y: u32) -> &Row<WORDS> {
        smoothed(&self.raw, &self.smooth, self.is_smoothed, clamp(y, self.smooth_len))
    }

    /// Smooths the next row, two rows behind the newest, of `words` words.
    pub(crate) fn smooth_row(&mut self, level: SmoothingLevel, width: usize) {
        let y = self.smooth_len;
        self.smooth_len += 1;
        let bit = 1 << (y % 32);
        let Some(means) = level.means() else {
            self.is_smoothed &= !bit;
            return;
        };
        self.is_smoothed |= bit;
        let words = words_for(width);
        let mut line = [0; WORDS];
        let rows = [y.saturating_sub(2), y.saturating_sub(1), y, y + 1, y + 2]
            .map(|y| &self.raw[(clamp(y, self.raw_len) % RAW_ROWS) as usize][..words]);
        let out = &mut self.smooth[(y % SMOOTH_ROWS) as usize];
        mean_down(rows, means.0, &mut line[..words]);
        mean_across(&line[..words], means.1, &mut out[..words]);
        replicate_borders(out, width);
    }

    /// Makes the features of the next row, one row behind the newest smoothed one.
    pub(crate) fn feature_row(&mut self, clips: Clips, width: usize) {
        let y = self.features_len;
        self.features_len += 1;
        let words = words_for(width);
        let out = &mut self.features.tiles_mut(y / TILE_ROWS)[(y % TILE_ROWS) as usize];
        let smooth = |y: u32| {
            let row = smoothed(&self.raw, &self.smooth, self.is_smoothed, clamp(y, self.smooth_len));
            &row[..words]
        };
        if y.is_multiple_of(2) {
            gradient_across([smooth(y), smooth(y + 1)], clips, &mut out[..words]);
        } else {
            gradient_down([smooth(y - 1), smooth(y + 1)], clips, &mut out[..words]);
        }
        replicate_borders(out, width);
    }

    /// The features of a row of tiles.
    pub(crate) fn tiles(&self, tile_row: u32) -> &TileRows<WORDS> {
        self.features.tiles(tile_row)
    }
}

/// Words of a row of `width` columns, margins included.
pub(crate) const fn words_for(width: usize) -> usize {
    width.div_ceil(4) + 2
}

/// Row `y`, or the newest of `len`.
const fn clamp(y: u32, len: u32) -> u32 {
    if y < len { y } else { len.saturating_sub(1) }
}

/// Row `y` after smoothing, or as it came if it was not smoothed.
#[inline(never)]
fn smoothed<'a, const WORDS: usize>(
    raw: &'a [Row<WORDS>; RAW_ROWS as usize],
    smooth: &'a [Row<WORDS>; SMOOTH_ROWS as usize],
    is_smoothed: u32,
    y: u32,
) -> &'a Row<WORDS> {
    if is_smoothed >> (y % 32) & 1 == 1 { &smooth[(y % SMOOTH_ROWS) as usize] } else { &raw[(y % RAW_ROWS) as usize] }
}

/// Fills the margins of a row of `width` columns with its first and its last column.
pub(crate) fn replicate_borders(row: &mut [u32], width: usize) {
    if width == 0 || row.len() < words_for(width) {
        return;
    }
    row[0] = lanes::splat(row[1] & 0xff);
    let (last, inside) = (1 + (width - 1) / 4, (width - 1) % 4);
    let value = lanes::splat(row[last] >> (8 * inside) & 0xff);
    let keep = u32::MAX >> (8 * (3 - inside));
    row[last] = row[last] & keep | value & !keep;
    row[last + 1] = value;
}
