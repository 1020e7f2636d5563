//! Evidence: could this piece of the left row be taken for another piece of the left row, and is there anything to see?
//!
//! A margin between labels says how sure the choice *among the labels* is. It says nothing of surfaces that are no label
//! (the next bar of a fence), nor of walls that fit everywhere. So a cell is *unique* only if its answer fits better than
//! the left row fits itself 4 and 8 px beside, and *blank* if its features are no stronger than the noise.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "sums are limited to 255 before, columns are below 1280"
)]

use crate::Config;
use crate::front_end::camera_view::Row;
use crate::front_end::noise::{Noise, SmoothingLevel};
use crate::lanes::rows::load;
use crate::lanes::{halved_sum, sad, sad_add, splat};
use crate::matching::tile_seed::ANY;

/// What uniqueness adds to the merit of a cell.
const UNIQUE: u32 = 90;

/// What is known of a cell, a byte each: sums over its 4 x 2 px, at most 255.
///
/// - lane 0: absolute differences at the answer;
/// - lanes 1 and 2: absolute differences of the left row against itself 4 and 8 px to the right;
/// - lane 3: magnitudes of the features, of the weaker view.
type Sums = u32;

/// The thresholds that the frame's noise asks for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Floor {
    /// The byte of a feature that is zero.
    pub(crate) zero: u32,
    /// Mean magnitude of a feature that noise explains, 1/16.
    pub(crate) noise: u32,
    /// The merit, uniqueness included, that an answer must exceed by 64 to be sure.
    pub(crate) sure: u32,
}

impl Floor {
    /// - `zero`: the byte of a feature that is zero; `agreement`: whether merits are made of path sums.
    pub(crate) fn of(noise: Noise, zero: u32, agreement: bool) -> Self {
        // Near a noise of 0.4 grey levels the camera's rounding hides it.
        const LEAST: u32 = 26;
        let floor = noise.haar_floor().max(LEAST);
        let is_noisy = noise.level >= SmoothingLevel::Medium;
        let sure = match (agreement, is_noisy) {
            (true, false) => 154,
            (true, true) => 179,
            (false, false) => 132,
            (false, true) => 138,
        };
        // With one limit features are half as large.
        Self { zero, noise: if is_noisy { floor / 2 } else { floor }, sure }
    }
}

/// What the cells of a row are worth.
pub(crate) struct Worth<const WORDS: usize> {
    /// What uniqueness adds to the merit.
    pub(crate) unique: [u8; WORDS],
    /// 255 where there is nothing to see, here and around, else 0.
    pub(crate) blank: [u8; WORDS],
}

impl<const WORDS: usize> Worth<WORDS> {
    /// Everything is unique and nothing blank.
    pub(crate) const TRUSTED: Self = Self { unique: [UNIQUE as u8; WORDS], blank: [0; WORDS] };

    /// A cell whose surface the nearest contour could as well be given another partner on is not unique.
    ///
    /// - `rivals`: as [`TileSeeds::rivals`](crate::matching::tile_seed::TileSeeds::rivals) has them.
    #[inline(never)]
    pub(crate) fn doubt_rivals(&mut self, labels: &[u8; WORDS], rivals: &[[u16; 2]], cells: usize) {
        let pairs = self.unique[..cells].chunks_mut(2).zip(labels[..cells].chunks(2));
        for (tile, (unique, labels)) in pairs.enumerate() {
            for (unique, &label) in unique.iter_mut().zip(labels) {
                if *unique != 0 && !is_alone(tile, label.into(), rivals) {
                    *unique = 0;
                }
            }
        }
    }
}

/// Whether the nearest contour of a tile that has to do with a label has no rival for it.
#[inline(always)]
fn is_alone(tile: usize, label: u16, rivals: &[[u16; 2]]) -> bool {
    for at in [tile, tile.wrapping_sub(1), tile + 1, tile.wrapping_sub(2), tile + 2] {
        let Some(&[first, second]) = rivals.get(at) else { continue };
        if first == ANY {
            return false;
        }
        if first.abs_diff(label) <= 1 || second.abs_diff(label) <= 1 {
            return first == second;
        }
    }
    true
}

/// The evidence of the newest three cell rows.
#[derive(Debug, Clone)]
pub(crate) struct Evidence<const WORDS: usize> {
    rows: [[Sums; WORDS]; 3],
}

impl<const WORDS: usize> Evidence<WORDS> {
    pub(crate) const EMPTY: Self = Self { rows: [[0; WORDS]; 3] };

    /// Measures the cells of row `number`.
    ///
    /// - `left`, `right`: its two feature rows of either view; `labels`: what it answers.
    #[inline(never)]
    pub(crate) fn measure(
        &mut self,
        number: u32,
        config: &Config,
        [left, right]: [[&Row<WORDS>; 2]; 2],
        labels: &[u8; WORDS],
        floor: Floor,
    ) {
        let cells = usize::from(config.width).div_ceil(4);
        let zero = splat(floor.zero);
        let Some(row) = self.rows[(number % 3) as usize].get_mut(..cells) else { return };
        // The words of a cell and of those beside it; beyond the row its margin stands.
        let [upper, lower] = left.map(|row| &row[1..cells + 2]);
        let words = |row: &[u32], at: usize| row.get(at).or(row.last()).copied().unwrap_or(0);
        let (mut a, mut b) = ([words(upper, 0), words(lower, 0)], [words(upper, 1), words(lower, 1)]);
        let mut column = 4 - i32::from(config.min_disparity);
        for (at, (sums, &label)) in (2..).zip(row.iter_mut().zip(labels)) {
            let c = [words(upper, at), words(lower, at)];
            let byte = (column - i32::from(label)).cast_unsigned() as usize;
            let [x, y] = right.map(|row| load(row, byte));
            let fit = sad_add(a[1], y, sad(a[0], x));
            let near = sad_add(a[1], b[1], sad(a[0], b[0]));
            let far = sad_add(a[1], c[1], sad(a[0], c[0]));
            let strength = sad_add(a[1], zero, sad(a[0], zero)).min(sad_add(y, zero, sad(x, zero)));
            *sums = fit.min(255) | near.min(255) << 8 | far.min(255) << 16 | strength.min(255) << 24;
            column += 4;
            (a, b) = (b, c);
        }
    }

    /// Judges the cells of row `number` by those around them; the rows above and below must be measured.
    #[inline(never)]
    pub(crate) fn judge(&self, number: u32, cells: usize, floor: Floor) -> Worth<WORDS> {
        let [above, here, below] =
            [number.saturating_sub(1), number, number + 1].map(|row| &self.rows[(row % 3) as usize][..cells]);
        let mut worth = Worth { unique: [0; WORDS], blank: [0; WORDS] };
        // Means over three rows, all four sums at once; then over three columns.
        let mean = |c: usize| Some(halved_sum(halved_sum(*above.get(c)?, *below.get(c)?), *here.get(c)?));
        let unique_from = (floor.noise * 5 / 32).min(255);
        let blank_to = (floor.noise * 2 / 5).clamp(1, 255);
        let mut middle = mean(0).unwrap_or(0);
        let mut before = middle;
        // Another piece may lie to the left as well: what is true of the cells 4 and 8 px before.
        let (mut near_before, mut far_before) = (255, [255; 2]);
        let cells = worth.unique[..cells].iter_mut().zip(&mut worth.blank[..cells]);
        for (c, (unique, blank)) in (1..).zip(cells) {
            let after = mean(c).unwrap_or(middle);
            let around = halved_sum(halved_sum(before, after), middle);
            (before, middle) = (middle, after);
            let (fit, near, far) = (around & 0xff, around >> 8 & 0xff, around >> 16 & 0xff);
            let likeness = near.min(near_before).min(far).min(far_before[0]);
            (near_before, far_before) = (near, [far_before[1], far]);
            *unique = if likeness >= fit + unique_from { UNIQUE as u8 } else { 0 };
            *blank = if around >> 24 <= blank_to { u8::MAX } else { 0 };
        }
        worth
    }
}
