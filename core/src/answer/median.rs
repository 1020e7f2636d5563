//! Medians of the labels over 3 x 3 cells, and confidence from their merits: four cells a word.

use crate::answer::cell_row::CellRow;
use crate::lanes::{add, halved_sum, lane, max, min, min_max, select_ge, splat, sub};

/// What a cell pays for neighbours on another surface, in merit.
const JUMP: u32 = 20;
/// Merit of the least confidence.
const NO_MERIT: u32 = 69;
/// Least confidence of a sure answer.
const SURE: u32 = 64;
/// Least confidence of a measured answer.
const MEASURED: u32 = 16;

/// Four columns of three cells each: their least, middle and greatest label, and the mean of their merits.
type Columns = [u32; 4];

/// Of each four cells of the middle one of three rows: the medians of nine labels, and confidence, [`MEASURED`] to 127.
///
/// - `unique`: what uniqueness adds to the merit of a cell; `sure`: what merit must exceed by [`SURE`] to be sure.
#[inline(always)]
pub(crate) fn medians<const WORDS: usize>(
    rows: [&CellRow<WORDS>; 3],
    cells: usize,
    unique: &[u8; WORDS],
    sure: u32,
    mut take: impl FnMut(usize, u32, u32),
) {
    let count = cells.div_ceil(4);
    let labels = rows.map(|row| fours(&row.label, cells));
    let merits = rows.map(|row| fours(&row.merit, cells));
    let columns = |i: usize| -> Columns {
        let at = |row: &Fours<'_>| match row.0.get(i) {
            Some(&four) => u32::from_le_bytes(four),
            None => row.1,
        };
        let [a, b, c] = labels.each_ref().map(at);
        let (least, most) = min_max(a, b);
        let (lower, most) = min_max(most, c);
        let (least, middle) = min_max(least, lower);
        let [a, b, c] = merits.each_ref().map(at);
        [least, middle, most, halved_sum(halved_sum(a, c), b)]
    };
    if count == 0 {
        return;
    }
    let uniques = fours(unique, cells);
    let unique_at = |i: usize| match uniques.0.get(i) {
        Some(&four) => u32::from_le_bytes(four),
        None => uniques.1,
    };
    let mut unique_before = last(unique_at(0), 0);
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
        let jump = select_ge(sub(most, least), splat(2), splat(JUMP), 0);
        let here_unique = unique_at(i);
        let after = if i + 1 < count { unique_at(i + 1) } else { last(here_unique, 3) };
        let beside = halved_sum(here_unique << 8 | unique_before >> 24, here_unique >> 8 | after << 24);
        let certain = sub(sub(add(mean, halved_sum(beside, here_unique)), jump), splat(sure));
        unique_before = here_unique;
        let sure = select_ge(certain, splat(SURE), certain, 0);
        // What is not sure is ranked by its margin alone.
        let doubtful = sub(mean, add(splat(NO_MERIT), jump)) >> 1 & splat(SURE - 1);
        take(i, median, max(max(sure, doubtful), splat(MEASURED)));
        (before, here) = (here, next);
    }
}

/// The bytes of a row, four a word, and the word that is left, its last byte again beyond the row.
type Fours<'a> = (&'a [[u8; 4]], u32);

/// The first `len` bytes of a row.
fn fours<const WORDS: usize>(row: &[u8; WORDS], len: usize) -> Fours<'_> {
    let (fours, rest) = row[..len].as_chunks::<4>();
    let rest = [0, 1, 2, 3].map(|i| rest.get(i).or(rest.last()).copied().unwrap_or(0));
    (fours, u32::from_le_bytes(rest))
}

/// A lane in all lanes.
#[inline(always)]
fn last(word: u32, i: u32) -> u32 {
    splat(lane(word, i))
}
