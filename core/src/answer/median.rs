//! Medians of the labels over 3 x 3 cells, and confidence from their merits: four cells a word.

use crate::answer::cell_row::CellRow;
use crate::answer::evidence::{FRINGE, NEVER_SURE};
use crate::lanes::{ONES, add, halved_sum, lane, max, min, min_max, select_ge, splat, sub};

/// Most steps beyond the first, between the labels around a cell, that it pays for: 14 in merit each.
const MOST_STEPS: u32 = 5;
/// What a cell pays that cannot be sure, in merit.
const DOUBT: u32 = 40;
/// Least confidence of a sure answer.
const SURE: u32 = 64;
/// Confidence of what is sure but for its being a fringe.
const SURE_FRINGE: u32 = 60;
/// Most confidence of anything else that is not sure.
pub(super) const MOST_DOUBTFUL: u32 = 55;
/// Least confidence of a measured answer.
const MEASURED: u32 = 16;

/// Four columns of three cells each: their least, middle and greatest label, and the mean of their merits.
type Columns = [u32; 4];

/// Of each four cells of the middle one of three rows: the medians of nine labels, and confidence, [`MEASURED`] and more.
///
/// - `bonus`: what evidence adds to the merit of a cell, or [`NEVER_SURE`]; `sure`: the merit from which on it is sure.
#[inline(always)]
pub(crate) fn medians<const WORDS: usize>(
    rows: [&CellRow<WORDS>; 3],
    cells: usize,
    bonus: &[u8; WORDS],
    sure: u32,
    mut take: impl FnMut(usize, u32, u32),
) {
    let count = cells.div_ceil(4);
    let labels = rows.map(|row| fours(&row.label, cells));
    let merits = rows.map(|row| fours(&row.merit, cells));
    let columns = |i: usize| -> Columns {
        let [a, b, c] = labels.each_ref().map(|row| row.at(i));
        let (least, most) = min_max(a, b);
        let (lower, most) = min_max(most, c);
        let (least, middle) = min_max(least, lower);
        let [a, b, c] = merits.each_ref().map(|row| row.at(i));
        [least, middle, most, halved_sum(halved_sum(a, c), b)]
    };
    if count == 0 {
        return;
    }
    let bonuses = fours(bonus, cells);
    let sure_less_64 = splat(sure - SURE);
    let mut here = columns(0);
    let mut before = here.map(|column| last(column, 0));
    for i in 0..count {
        let next = if i + 1 < count { columns(i + 1) } else { here.map(|column| last(column, 3)) };
        let around = |k: usize| [here[k] << 8 | before[k] >> 24, here[k], here[k] >> 8 | next[k] << 24];
        let [a, b, c] = around(0);
        let (low, high) = min_max(a, b);
        let (least, most_low) = (min(low, c), max(high, c));
        let [a, b, c] = around(1);
        let (low, high) = min_max(a, b);
        let middle = max(low, min(high, c));
        let [a, b, c] = around(2);
        let (low, high) = min_max(a, b);
        let (least_high, most) = (min(low, c), max(high, c));
        let (low, high) = min_max(most_low, middle);
        let median = max(low, min(high, least_high));
        let [a, b, c] = around(3);
        let mean = halved_sum(halved_sum(a, c), b);
        let steps = min(sub(sub(most, least), ONES), splat(MOST_STEPS));
        // No lane borrows: 14 = 16 - 2.
        let merit = sub(mean, (steps << 4) - (steps << 1));
        let bonus = bonuses.at(i);
        // What is added is below the fringe's bit.
        let certain = sub(add(merit, bonus & splat(FRINGE / 2 - 1)), sure_less_64);
        let doubtful = min(sub(merit, add(sure_less_64, splat(DOUBT))), splat(MOST_DOUBTFUL));
        let as_fringe = select_ge(bonus, splat(NEVER_SURE), doubtful, splat(SURE_FRINGE));
        let if_sure = select_ge(bonus, splat(FRINGE), as_fringe, certain);
        let if_not = select_ge(bonus, splat(FRINGE), doubtful, min(certain, splat(MOST_DOUBTFUL)));
        let confidence = select_ge(certain, splat(SURE), if_sure, if_not);
        take(i, median, max(confidence, splat(MEASURED)));
        (before, here) = (here, next);
    }
}

/// The bytes of a row, four a word, and the word that is left, its last byte again beyond the row.
pub(crate) struct Fours<'a>(&'a [[u8; 4]], u32);

impl Fours<'_> {
    #[inline(always)]
    pub(crate) fn at(&self, i: usize) -> u32 {
        match self.0.get(i) {
            Some(&four) => u32::from_le_bytes(four),
            None => self.1,
        }
    }
}

/// The first `len` bytes of a row.
pub(crate) fn fours<const WORDS: usize>(row: &[u8; WORDS], len: usize) -> Fours<'_> {
    let (fours, rest) = row[..len].as_chunks::<4>();
    let rest = [0, 1, 2, 3].map(|i| rest.get(i).or(rest.last()).copied().unwrap_or(0));
    Fours(fours, u32::from_le_bytes(rest))
}

/// A lane in all lanes.
#[inline(always)]
fn last(word: u32, i: u32) -> u32 {
    splat(lane(word, i))
}
