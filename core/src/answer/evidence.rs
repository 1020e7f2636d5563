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
use crate::lanes::{add, halved_sum, lane, min, sad, sad_add, select_ge, splat};
use crate::matching::tile_seed::ANY;

/// What uniqueness adds to the merit of a cell.
const UNIQUE: u32 = 90;

/// What is known of the cells of a row; sums over their 4 x 2 px, at most 255.
#[derive(Debug, Clone)]
struct EvidenceRow<const WORDS: usize> {
    /// Absolute differences at the answer.
    fit: [u8; WORDS],
    /// Absolute differences of the left row against itself 4 and 8 px to the right.
    near: [u8; WORDS],
    far: [u8; WORDS],
    /// Magnitudes of the features, of the weaker view.
    strength: [u8; WORDS],
}

impl<const WORDS: usize> EvidenceRow<WORDS> {
    const EMPTY: Self = Self { fit: [0; WORDS], near: [0; WORDS], far: [0; WORDS], strength: [0; WORDS] };
}

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
    /// 255 where there is nothing to see, else 0.
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
        for (c, (unique, &label)) in self.unique.iter_mut().zip(labels).enumerate().take(cells) {
            if *unique == 0 {
                continue;
            }
            let tile = c / 2;
            for at in [tile, tile.wrapping_sub(1), tile + 1, tile.wrapping_sub(2), tile + 2] {
                let Some(&[first, second]) = rivals.get(at) else { continue };
                let is_near = |other: u16| other.abs_diff(u16::from(label)) <= 1;
                if first == ANY {
                    *unique = 0;
                    break;
                }
                if is_near(first) || is_near(second) {
                    if first != second {
                        *unique = 0;
                    }
                    break;
                }
            }
        }
    }
}

/// The evidence of the newest three cell rows.
#[derive(Debug, Clone)]
pub(crate) struct Evidence<const WORDS: usize> {
    rows: [EvidenceRow<WORDS>; 3],
}

impl<const WORDS: usize> Evidence<WORDS> {
    pub(crate) const EMPTY: Self = Self { rows: [const { EvidenceRow::EMPTY }; 3] };

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
        let row = &mut self.rows[(number % 3) as usize];
        let cells = usize::from(config.width).div_ceil(4);
        let zero = splat(floor.zero);
        let byte = |sum: u32| sum.min(255) as u8;
        let origin = 4 - i32::from(config.min_disparity);
        for c in 0..cells {
            let [a, b] = left.map(|row| [row[c + 1], row[(c + 2).min(cells + 1)], row[(c + 3).min(cells + 1)]]);
            let at = usize::try_from(4 * c as i32 + origin - i32::from(labels[c])).unwrap_or(usize::MAX);
            let [x, y] = right.map(|row| load(row, at));
            row.fit[c] = byte(sad_add(b[0], y, sad(a[0], x)));
            row.near[c] = byte(sad_add(b[0], b[1], sad(a[0], a[1])));
            row.far[c] = byte(sad_add(b[0], b[2], sad(a[0], a[2])));
            row.strength[c] = byte(sad_add(b[0], zero, sad(a[0], zero)).min(sad_add(y, zero, sad(x, zero))));
        }
    }

    /// Judges the cells of row `number` by those around them; the rows above and below must be measured.
    #[inline(never)]
    pub(crate) fn judge(&self, number: u32, cells: usize, floor: Floor) -> Worth<WORDS> {
        let rows = [number.saturating_sub(1), number, number + 1].map(|row| &self.rows[(row % 3) as usize]);
        let mut worth = Worth { unique: [0; WORDS], blank: [0; WORDS] };
        // Means over three rows, of columns before the first and after the last, too.
        let mean = |of: fn(&EvidenceRow<WORDS>) -> &[u8; WORDS], c: usize| {
            let [a, b, c] = rows.map(|row| quad(of(row), c, cells));
            halved_sum(halved_sum(a, c), b)
        };
        let fields: [fn(&EvidenceRow<WORDS>) -> &[u8; WORDS]; 4] =
            [|row| &row.fit, |row| &row.near, |row| &row.far, |row| &row.strength];
        let mut smooth_before = [u32::MAX; 2];
        let mut here = fields.map(|field| mean(field, 0));
        let mut before = [here[0], here[1], here[2]].map(|word| splat(lane(word, 0)));
        let above = splat((floor.noise * 5 / 32).min(255));
        let blank = splat((floor.noise / 8).clamp(1, 255));
        for at in (0..cells).step_by(4) {
            let next = fields.map(|field| mean(field, at + 4));
            let across = |i: usize| {
                let word = here[i];
                halved_sum(halved_sum(word << 8 | before[i] >> 24, word >> 8 | next[i] << 24), word)
            };
            let (fit, near, far) = (across(0), across(1), across(2));
            // Another piece may lie to the left as well: what is true of the cells 4 and 8 px before.
            let left_near = near << 8 | smooth_before[0] >> 24;
            let left_far = far << 16 | smooth_before[1] >> 16;
            let likeness = min(min(near, left_near), min(far, left_far));
            let unique = select_ge(likeness, add(fit, above), splat(UNIQUE), 0);
            put(&mut worth.unique, at, unique);
            put(&mut worth.blank, at, select_ge(blank, quad(&rows[1].strength, at, cells), u32::MAX, 0));
            before = [here[0], here[1], here[2]];
            smooth_before = [near, far];
            here = next;
        }
        worth
    }
}

/// Four bytes of a row; the last one again beyond its end.
#[inline(always)]
fn quad<const WORDS: usize>(row: &[u8; WORDS], at: usize, len: usize) -> u32 {
    match row[..len].get(at..at + 4).and_then(|bytes| bytes.first_chunk::<4>()) {
        Some(&bytes) => u32::from_le_bytes(bytes),
        None => u32::from_le_bytes([0, 1, 2, 3].map(|i| row[(at + i).min(len - 1)])),
    }
}

/// Stores four bytes of a row, as far as it goes.
#[inline(always)]
fn put<const WORDS: usize>(row: &mut [u8; WORDS], at: usize, word: u32) {
    for (to, from) in row.iter_mut().skip(at).zip(word.to_le_bytes()) {
        *to = from;
    }
}
