//! Medians of the labels over 3 x 3 cells, and confidence from their merits: four cells a word.

use crate::answer::cell_row::CellRow;
use crate::answer::confidence;
use crate::answer::evidence::{FRINGE, NEVER_SURE};
use crate::answer::neighbourhood::{along, means_around, words, words_mut, words_of};
use crate::lanes::{ONES, add, max, min, min_max, select_ge, splat, sub};

/// Most steps beyond the first, between the labels around a cell, that it pays for: 14 in merit each.
const MOST_STEPS: u32 = 5;
/// What a cell pays that cannot be sure, in merit.
const DOUBT: u32 = 40;
/// Least confidence of a sure answer.
const SURE: u32 = confidence::SURE as u32;
/// Confidence of what is sure but for its being a fringe.
const SURE_FRINGE: u32 = 60;
/// Most confidence of anything else that is not sure.
pub(super) const MOST_DOUBTFUL: u32 = confidence::FRINGE as u32 - 1;
/// Least confidence of a measured answer.
const MEASURED: u32 = confidence::MEASURED as u32;

/// Of each cell of the middle one of three rows: the median of nine labels, and what it pays in merit for their spread.
#[inline(never)]
pub(crate) fn medians<const WORDS: usize>(
    rows: [&CellRow<WORDS>; 3],
    cells: usize,
    median: &mut [u8; WORDS],
    price: &mut [u8; WORDS],
) {
    let count = words_of(cells);
    let labels = rows.map(|row| words(&row.label, count));
    let (median, price) = (words_mut(median, count), words_mut(price, count));
    // The least, the middle and the greatest label of each column.
    let columns = |i: usize| {
        let [a, b, c] = labels.map(|row| u32::from_le_bytes(row[i]));
        let (least, most) = min_max(a, b);
        let (lower, most) = min_max(most, c);
        let (least, middle) = min_max(least, lower);
        [least, middle, most]
    };
    along(count, columns, |i, [leasts, middles, mosts]| {
        let [a, b, c] = leasts;
        let (low, high) = min_max(a, b);
        let (least, most_low) = (min(low, c), max(high, c));
        let [a, b, c] = middles;
        let (low, high) = min_max(a, b);
        let middle = max(low, min(high, c));
        let [a, b, c] = mosts;
        let (low, high) = min_max(a, b);
        let (least_high, most) = (min(low, c), max(high, c));
        let (low, high) = min_max(most_low, middle);
        median[i] = max(low, min(high, least_high)).to_le_bytes();
        let steps = min(sub(sub(most, least), ONES), splat(MOST_STEPS));
        // No lane borrows: 14 = 16 - 2.
        price[i] = ((steps << 4) - (steps << 1)).to_le_bytes();
    });
}

/// Of each four cells of the middle one of three rows: confidence, [`MEASURED`] and more.
///
/// - `price`: what they pay for the spread of labels around; `bonus`: what evidence adds to the merit of a cell, or
///   [`NEVER_SURE`]; `sure`: the merit from which on it is sure.
#[inline(always)]
pub(crate) fn confidences<const WORDS: usize>(
    rows: [&CellRow<WORDS>; 3],
    cells: usize,
    price: &[u8; WORDS],
    bonus: &[u8; WORDS],
    sure: u32,
    mut take: impl FnMut(usize, u32),
) {
    let count = words_of(cells);
    let mut means = [0; WORDS];
    means_around(rows.map(|row| words(&row.merit, count)), words_mut(&mut means, count));
    let merits = words(&means, count);
    let (prices, bonuses) = (words(price, count), words(bonus, count));
    let sure_less_64 = splat(sure - SURE);
    for i in 0..count {
        let merit = sub(u32::from_le_bytes(merits[i]), u32::from_le_bytes(prices[i]));
        let bonus = u32::from_le_bytes(bonuses[i]);
        // What is added is below the fringe's bit.
        let certain = sub(add(merit, bonus & splat(FRINGE / 2 - 1)), sure_less_64);
        let doubtful = min(sub(merit, add(sure_less_64, splat(DOUBT))), splat(MOST_DOUBTFUL));
        let as_fringe = select_ge(bonus, splat(NEVER_SURE), doubtful, splat(SURE_FRINGE));
        let if_sure = select_ge(bonus, splat(FRINGE), as_fringe, certain);
        let if_not = select_ge(bonus, splat(FRINGE), doubtful, min(certain, splat(MOST_DOUBTFUL)));
        let confidence = select_ge(certain, splat(SURE), if_sure, if_not);
        take(i, max(confidence, splat(MEASURED)));
    }
}
