//! Medians of the labels over 3 x 3 cells, and confidence from their merits: four cells a word.

use crate::answer::cell_row::CellRow;
use crate::lanes::{add, halved_sum, max, min, select_ge, splat, sub};

/// What a cell pays for neighbours on another surface, in merit.
const JUMP: u32 = 5;
/// Least confidence of a measured answer.
const MEASURED: u32 = 16;

/// What nine cells around each cell say.
pub(crate) struct Neighbourhood<const WORDS: usize> {
    /// The median of their labels.
    pub(crate) median: [u8; WORDS],
    /// Confidence, [`MEASURED`] to 255.
    pub(crate) confidence: [u8; WORDS],
}

impl<const WORDS: usize> Neighbourhood<WORDS> {
    /// Of the cells of the middle one of three rows.
    #[inline(never)]
    pub(crate) fn of(rows: [&CellRow<WORDS>; 3], cells: usize) -> Self {
        let mut result = Self { median: [0; WORDS], confidence: [0; WORDS] };
        // Sorted columns: the least, the middle and the greatest label; and the mean of the merits.
        let mut columns = [[0u8; WORDS]; 4];
        for at in (0..cells).step_by(4) {
            let [a, b, c] = rows.map(|row| quad(&row.label, at));
            let (least, most) = (min(a, b), max(a, b));
            let lower = min(most, c);
            put(&mut columns[0], at, min(least, c));
            put(&mut columns[1], at, max(least, lower));
            put(&mut columns[2], at, max(most, c));
            let [a, b, c] = rows.map(|row| quad(&row.merit, at));
            put(&mut columns[3], at, halved_sum(halved_sum(a, c), b));
        }
        // The columns beyond the last cell are like it.
        for column in &mut columns {
            let last = column[cells - 1];
            column[cells..].fill(last);
        }
        let mut before = columns.each_ref().map(|column| splat(u32::from(column[0])));
        for at in (0..cells).step_by(4) {
            let here = columns.each_ref().map(|column| quad(column, at));
            let around = |i: usize| {
                let column = &columns[i];
                let next = u32::from(column.get(at + 4).copied().unwrap_or(column[WORDS - 1]));
                [here[i] << 8 | before[i] >> 24, here[i], here[i] >> 8 | next << 24]
            };
            let [a, b, c] = around(0);
            let (most_low, least) = (max(max(a, b), c), min(min(a, b), c));
            let [a, b, c] = around(1);
            let middle = max(min(a, b), min(max(a, b), c));
            let [a, b, c] = around(2);
            let (least_high, most) = (min(min(a, b), c), max(max(a, b), c));
            let median = max(min(most_low, middle), min(max(most_low, middle), least_high));
            put(&mut result.median, at, median);
            let [a, b, c] = around(3);
            let mean = halved_sum(halved_sum(a, c), b);
            let jump = select_ge(sub(most, least), splat(2), splat(JUMP), 0);
            let merit = sub(mean, jump + splat(64));
            put(&mut result.confidence, at, max(add(merit, merit), splat(MEASURED)));
            before = here;
        }
        result
    }
}

/// Four bytes of a row; the last ones again beyond its end.
#[inline(always)]
fn quad<const WORDS: usize>(row: &[u8; WORDS], at: usize) -> u32 {
    match row.get(at..at + 4).and_then(|bytes| bytes.first_chunk::<4>()) {
        Some(&bytes) => u32::from_le_bytes(bytes),
        None => u32::from_le_bytes([0, 1, 2, 3].map(|i| row[(at + i).min(WORDS - 1)])),
    }
}

/// Stores four bytes of a row, as far as it goes.
#[inline(always)]
fn put<const WORDS: usize>(row: &mut [u8; WORDS], at: usize, word: u32) {
    let bytes = word.to_le_bytes();
    match row.get_mut(at..at + 4) {
        Some(four) => four.copy_from_slice(&bytes),
        None => {
            for (to, from) in row.iter_mut().skip(at).zip(bytes) {
                *to = from;
            }
        }
    }
}
