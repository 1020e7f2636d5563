//! Evidence: could this piece of the left row be taken for another piece of the left row, and is there anything to see?
//!
//! A margin between labels says how sure the choice *among the labels* is. It says nothing of surfaces that are no label
//! (the next bar of a fence), nor of walls that fit everywhere. So an answer gains merit by how much better it fits than the
//! left row fits itself 4 and 8 px beside and at the distance of like contours ([`Repetition`]). It can be sure only if
//!
//! - it is *unique*: it fits better than what lies at that distance, and clearly so where the row repeats itself; there in the
//!   right view, too, and each cell by itself;
//! - it is *seen*: the views differ less than the left one varies, and the features around are stronger than noise;
//! - it is no *fringe*: not at the side of a contour where hardly anything else is to be seen, nor above or below what ends on
//!   a blank. The contour's surface is right there, where it ends is not.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bytes are cut out, labels are below 256")]

use crate::Config;
use crate::answer::neighbourhood::{along, fill_up, mean, means_around, words, words_mut, words_of};
use crate::answer::repetition::Repetition;
use crate::front_end::camera_view::Row;
use crate::front_end::noise::{Noise, SmoothingLevel};
use crate::lanes::evidence_rows::{CellSums, CellWindows, least_with_before};
use crate::lanes::{ONES, halved_sum, max, min, min_max, select_ge, splat, sub, unseen};

/// Most that likeness adds to the merit of a cell.
const MOST_BONUS: u32 = 40;
/// By how much the answer must fit better than what lies at the distance of like contours.
const UNIQUE: u32 = 6;
/// The same where the row repeats itself.
const UNIQUE_IN_REPETITION: u32 = 24;
/// What [`Worth::bonus`] is of a cell that cannot be sure.
pub(crate) const NEVER_SURE: u32 = 0xff;
/// Set in [`Worth::bonus`] of a cell that could be sure but for its being a fringe.
pub(crate) const FRINGE: u32 = 0x80;

/// The thresholds that the frame's noise asks for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Floor {
    /// The byte of a feature that is zero.
    pub(crate) zero: u32,
    /// Mean magnitude of a feature that noise explains, 1/16.
    pub(crate) noise: u32,
    /// The merit, bonus included, from which on an answer is sure.
    pub(crate) sure: u32,
    /// Mean magnitude of a feature up to which there is nothing to see, 1/16. On a blank wall noise makes 3/8 of `noise`.
    pub(crate) blank: u32,
    /// Whether the noise, 26 grey levels and more after the gain, lets hardly anything stand out.
    pub(crate) is_drowned: bool,
    /// Whether noise is so great that smoothing reaches from a cell into those above and below.
    pub(crate) is_noisy: bool,
}

impl Floor {
    /// - `zero`: the byte of a feature that is zero; `agreement`: whether merits are made of path sums.
    pub(crate) fn of(noise: Noise, zero: u32, agreement: bool) -> Self {
        // Near a noise of 0.4 grey levels the camera's rounding hides it.
        const LEAST: u32 = 26;
        let floor = noise.haar_floor().max(LEAST);
        // With one limit features are half as large.
        let is_noisy = noise.level >= SmoothingLevel::Medium;
        let floor = if is_noisy { floor / 2 } else { floor };
        let sure = match (noise.level, agreement) {
            (SmoothingLevel::Off, true) => 116 + (floor - LEAST) / 16,
            (SmoothingLevel::Light, true) => 136,
            (SmoothingLevel::Medium, true) => 145 + 7 * floor / 20,
            (SmoothingLevel::Strong, true) => 180,
            (SmoothingLevel::Off, false) => 89,
            (SmoothingLevel::Light | SmoothingLevel::Medium, false) => 100,
            (SmoothingLevel::Strong, false) => 101,
        };
        let percent = match noise.level {
            SmoothingLevel::Off => 48,
            SmoothingLevel::Light => 55,
            SmoothingLevel::Medium | SmoothingLevel::Strong => 50,
        };
        let blank = (floor * percent / 100).clamp(1, 255);
        let is_drowned = noise.level == SmoothingLevel::Strong && floor > 99;
        Self { zero, noise: floor, sure, blank, is_drowned, is_noisy }
    }
}

/// What the cells of a row are worth.
#[derive(Debug, Clone)]
pub(crate) struct Worth<const WORDS: usize> {
    /// What likeness adds to the merit, [`FRINGE`] more at fringes; or [`NEVER_SURE`].
    pub(crate) bonus: [u8; WORDS],
    /// 255 where there is nothing to see, here and around, else 0.
    pub(crate) blank: [u8; WORDS],
}

impl<const WORDS: usize> Worth<WORDS> {
    /// Everything is unique and nothing blank.
    pub(crate) const TRUSTED: Self = Self { bonus: [MOST_BONUS as u8; WORDS], blank: [0; WORDS] };
}

/// What is known of the cells of a row, a byte each: sums over 4 x 2 px of theirs, at most 255.
#[derive(Debug, Clone)]
struct Sums<const WORDS: usize> {
    /// Absolute differences at the answer.
    fit: [u8; WORDS],
    /// The least absolute differences of the left row against itself 4 and 8 px to the left and to the right.
    beside: [u8; WORDS],
    /// The same at the distance of like contours, and where the row repeats itself those of the answer's rivals.
    like: [u8; WORDS],
    /// Magnitudes of the left row's features.
    strength: [u8; WORDS],
}

impl<const WORDS: usize> Sums<WORDS> {
    /// Where a row repeats itself, asks the right view, too: of a bar beside something nearer the left view may not show the
    /// next one. What the right view shows nearer or farther by the distance of like contours, beyond the search as well, looks
    /// like the answer as well as it fits.
    fn doubt_rivals(&mut self, windows: &CellWindows<'_, WORDS>, sums: &mut CellSums<WORDS>) {
        let distance = windows.distance.cast_signed();
        self.doubt_rivals_at(windows, sums, -distance);
        self.doubt_rivals_at(windows, sums, distance);
    }

    /// The same of those so much nearer.
    #[inline(never)]
    fn doubt_rivals_at(&mut self, windows: &CellWindows<'_, WORDS>, sums: &mut CellSums<WORDS>, step: i32) {
        let mut rivals = [0; WORDS];
        for (cell, (rival, &label)) in rivals.iter_mut().zip(windows.labels).enumerate() {
            let other = i32::from(label) + step;
            // Where there is none it is the answer itself.
            *unseen(rival) = match u8::try_from(other) {
                Ok(rival) if windows.is_inside(cell, other) => rival,
                _ => label,
            };
        }
        let labels = &rivals[..windows.labels.len()];
        // What lies 8 px beside is not asked any more.
        CellWindows { labels, ..*windows }.sum_fits(&mut sums.far);
        let cells = self.like.iter_mut().zip(&sums.far).zip(labels.iter().zip(windows.labels));
        for ((like, &fit), (rival, label)) in cells {
            let like = unseen(like);
            *like = if rival == label { *like } else { fit.min(*like) };
        }
    }
}

/// The evidence of the newest three cell rows of those that are measured, every second one.
#[derive(Debug, Clone)]
pub(crate) struct Evidence<const WORDS: usize> {
    rows: [Sums<WORDS>; 3],
    len: u32,
    /// Whether the newest row repeats itself.
    is_repeated: bool,
}

impl<const WORDS: usize> Evidence<WORDS> {
    pub(crate) const EMPTY: Self = Self {
        rows: [const { Sums { fit: [0; WORDS], beside: [0; WORDS], like: [0; WORDS], strength: [0; WORDS] } }; 3],
        len: 0,
        is_repeated: false,
    };

    /// Forgets the frame.
    pub(crate) const fn clear(&mut self) {
        self.len = 0;
    }

    /// Rows that are measured.
    pub(crate) const fn len(&self) -> u32 {
        self.len
    }

    /// Of the newest row, four cells a word: absolute differences at the answer, and magnitudes of the features.
    pub(crate) fn newest(&self, cells: usize) -> impl ExactSizeIterator<Item = [&[u8; 4]; 2]> {
        let row = &self.rows[(self.len.saturating_sub(1) % 3) as usize];
        let count = words_of(cells);
        words(&row.fit, count).iter().zip(words(&row.strength, count)).map(|(fit, strength)| [fit, strength])
    }

    /// Measures the cells of the next row.
    ///
    /// - `left`, `right`: its two feature rows of either view; `labels`: what it answers.
    #[inline(never)]
    pub(crate) fn measure(
        &mut self,
        config: &Config,
        [left, right]: [&[Row<WORDS>; 2]; 2],
        labels: &[u8],
        floor: Floor,
        repetition: &Repetition,
    ) {
        let windows = CellWindows {
            left,
            right,
            labels,
            origin: 4 - i32::from(config.min_disparity),
            distance: repetition.distance,
            zero: splat(floor.zero),
        };
        let mut sums = CellSums::EMPTY;
        self.is_repeated = repetition.is_strong;
        let row = &mut self.rows[(self.len % 3) as usize];
        self.len += 1;
        windows.sum(&mut sums, &mut row.fit);
        row.strength = sums.strength;
        // Another piece may lie to the left as well: what is true of the cells so much before.
        let steps = (repetition.distance as usize + 2) / 4;
        let count = words_of(labels.len());
        for (i, beside) in words_mut(&mut row.beside, count).iter_mut().enumerate() {
            let beside_it = min(least_with_before(&sums.near, 4 * i, 1), least_with_before(&sums.far, 4 * i, 2));
            *beside = beside_it.to_le_bytes();
        }
        for (i, like) in words_mut(&mut row.like, count).iter_mut().enumerate() {
            *like = least_with_before(&sums.like, 4 * i, steps).to_le_bytes();
        }
        if repetition.is_strong {
            row.doubt_rivals(&windows, &mut sums);
        }
        for plane in [&mut row.fit, &mut row.strength, &mut row.beside, &mut row.like] {
            fill_up(plane, labels.len());
        }
    }

    /// Judges the cells of the row measured as the `number`-th, and those of the row after it, by those around them.
    #[inline(never)]
    pub(crate) fn judge(&self, number: u32, cells: usize, floor: Floor, worth: &mut Worth<WORDS>) {
        let last = self.len.saturating_sub(1);
        let rows = [number.saturating_sub(1), number, number + 1].map(|row| &self.rows[(row.min(last) % 3) as usize]);
        let count = words_of(cells);
        // The means lie where the results of the same cells come.
        let (bonuses, blanks) = (words_mut(&mut worth.bonus, count), words_mut(&mut worth.blank, count));
        let mut likes = [0; WORDS];
        let likes = words_mut(&mut likes, count);
        means_around(rows.map(|row| words(&row.fit, count)), bonuses);
        means_around(rows.map(|row| words(&row.beside, count)), blanks);
        means_around(rows.map(|row| words(&row.like, count)), likes);
        let strengths = rows.map(|row| words(&row.strength, count));
        // Where the row repeats itself each cell must be unique by itself, too: what is beside it may belong to something else,
        // which has no like.
        let (unique, any) = if self.is_repeated { (UNIQUE_IN_REPETITION, 0) } else { (UNIQUE, u32::MAX) };
        let unique = splat(unique);
        let own = [&rows[1].fit, &rows[1].like].map(|row| words(row, count));
        let blank_to = splat(floor.blank);
        let noisy = if floor.is_noisy { u32::MAX } else { 0 };
        let down = |i: usize| {
            let [above, here, below] = strengths.map(|row| u32::from_le_bytes(row[i]));
            // What is strong above or below only is not seen here.
            let strength = min(halved_sum(above, here), halved_sum(below, here));
            // A 16th of the strongest.
            let least = max(max(above, below), here) >> 4 & splat(0x0f);
            let fringe = select_ge(min(above, below), least, 0, splat(FRINGE));
            [strength, fringe]
        };
        along(count, down, |i, [strengths, [_, fringe, _]]| {
            let strength = mean(strengths);
            let [a, b, c] = strengths;
            let (weakest, strongest) = min_max(a, c);
            let (weakest, strongest) = (min(weakest, b), max(strongest, b));
            let quarter = halved_sum(halved_sum(strongest, 0), 0);
            let fringe = fringe | select_ge(weakest, max(quarter, ONES), 0, splat(FRINGE));
            let [fit, beside, like] = [bonuses[i], blanks[i], likes[i]].map(u32::from_le_bytes);
            let blank = select_ge(blank_to, strength, u32::MAX, 0);
            blanks[i] = blank.to_le_bytes();
            // 3/4 of the strength.
            let half = halved_sum(strength, 0);
            let most_fit = halved_sum(strength, half);
            let bonus = min(sub(min(beside, like), fit), splat(MOST_BONUS)) | fringe;
            let [own_fit, own_like] = own.map(|row| u32::from_le_bytes(row[i]));
            let better = min(sub(like, fit), sub(own_like, own_fit) | any);
            let bonus = select_ge(better, unique, bonus, splat(NEVER_SURE));
            bonuses[i] = (select_ge(most_fit, fit, bonus, splat(NEVER_SURE)) | blank & noisy).to_le_bytes();
        });
    }
}
