//! From cells to pixels: median, plane through the neighbours, choice of surface at jumps, hidden pixels, confidence.

use crate::front_end::camera_view::Row;
use crate::lanes::rows::window_sad;
use crate::lanes::{max, min, select_ge, splat, sub};

/// Cell rows that are kept: those that the answer of two needs, and the two under way.
pub(crate) const CELL_ROWS: usize = 6;
/// Surfaces that differ by less than this are one, 1/256 px.
const SAME_SURFACE: i32 = 384;
/// Confidence of a guess: 1 to 15.
const GUESS: u32 = 8;

/// The cells of a row.
#[derive(Debug, Clone)]
pub(crate) struct CellRow<const WORDS: usize> {
    /// Disparity less the least one searched, 1/256 px; smoothed along the row once it is final.
    pub(crate) value: [i32; WORDS],
    /// Half of what `value` rises from the cell before to the cell after.
    slope: [i16; WORDS],
    pub(crate) label: [[u8; 4]; WORDS],
    pub(crate) merit: [[u8; 4]; WORDS],
}

impl<const WORDS: usize> CellRow<WORDS> {
    pub(crate) const EMPTY: Self =
        Self { value: [0; WORDS], slope: [0; WORDS], label: [[0; 4]; WORDS], merit: [[0; 4]; WORDS] };

    #[inline(always)]
    pub(crate) fn set(&mut self, cell: usize, found: crate::answer::cell::Cell) {
        self.value[cell] = found.value;
        self.label.as_flattened_mut()[cell] = found.label;
        self.merit.as_flattened_mut()[cell] = found.merit;
    }

    /// Smooths the values along the row, each with those neighbours that are the same surface.
    pub(crate) fn smooth(&mut self, cells: usize) {
        let Some(value) = self.value.get_mut(..cells) else { return };
        let (mut before, mut is_before) = (0, false);
        for i in 0..cells {
            let here = value[i];
            let after = value.get(i + 1).copied();
            let is_after = after.is_some_and(|after| (after - here).abs() < SAME_SURFACE);
            let after = after.unwrap_or(here);
            let (smooth, slope) = blend(here, before, is_before, after, is_after);
            value[i] = smooth;
            self.slope[i] = slope as i16;
            (before, is_before) = (here, is_after);
        }
    }
}

/// A value smoothed by its neighbours on the same surface, and its slope.
#[inline(always)]
fn blend(here: i32, before: i32, is_before: bool, after: i32, is_after: bool) -> (i32, i32) {
    match (is_before, is_after) {
        (true, true) => ((before + after + 2 * here) >> 2, (after - before) >> 1),
        (true, false) => (here, here - before),
        (false, true) => (here, after - here),
        (false, false) => (here, 0),
    }
}

/// Two image rows of answers, cell by cell.
#[derive(Debug, Clone)]
pub(crate) struct AnswerRow<const WORDS: usize> {
    /// Disparity less the least one searched, 1/64 px and [`OFFSET`] more, of the columns 0, 1 and 2, 3 of a cell; two in a word.
    pub(crate) pixels: [[u32; 2]; WORDS],
    /// What the lower row has more than the middle, the upper one less; the same in both halves.
    pub(crate) slope: [u32; WORDS],
    /// Confidence of the four columns.
    pub(crate) confidence: [u32; WORDS],
}

/// What is added to the pixels of [`AnswerRow`], so that none is negative.
pub(crate) const OFFSET: i32 = 64 * 64;

impl<const WORDS: usize> AnswerRow<WORDS> {
    pub(crate) const EMPTY: Self = Self { pixels: [[0; 2]; WORDS], slope: [0; WORDS], confidence: [0; WORDS] };
}

/// What the answers of a cell row are made of.
pub(crate) struct Answering<'a, const WORDS: usize> {
    /// The row above, the row itself and the row below, all smoothed along the row.
    pub(crate) rows: [&'a CellRow<WORDS>; 3],
    /// The two feature rows of the cells, of either view.
    pub(crate) left: [&'a Row<WORDS>; 2],
    pub(crate) right: [&'a Row<WORDS>; 2],
    pub(crate) min_disparity: i32,
    pub(crate) width: usize,
}

impl<const WORDS: usize> Answering<'_, WORDS> {
    pub(crate) fn answer(&self, out: &mut AnswerRow<WORDS>) {
        let cells = self.width.div_ceil(4);
        let mut medians = [[0u8; 4]; WORDS];
        let mut spread = [[0u8; 4]; WORDS];
        self.medians(cells, medians.as_flattened_mut(), spread.as_flattened_mut());
        let medians = medians.as_flattened();
        let [above, row, below] = self.rows;
        let labels = row.label.as_flattened();
        let mut surfaces = [[0u8; 2]; WORDS];
        for c in 0..cells {
            let (mut here, mut across) = (row.value[c], i32::from(row.slope[c]));
            if medians[c] != labels[c] {
                here = i32::from(medians[c]) << 8;
                let beside = |c: Option<usize>| match c.and_then(|c| row.value.get(c)) {
                    Some(&value) => (value, (value - here).abs() < SAME_SURFACE),
                    None => (0, false),
                };
                let (before, after) = (beside(c.checked_sub(1)), beside(Some(c + 1).filter(|&c| c < cells)));
                (here, across) = blend(here, before.0, before.1, after.0, after.1);
            }
            let (up, low) = (above.value[c], below.value[c]);
            let (is_up, is_low) = ((up - here).abs() < SAME_SURFACE, (low - here).abs() < SAME_SURFACE);
            let (here, down) = blend(here, up, is_up, low, is_low);
            // A quarter of the slope lies between two columns.
            let middle = (here >> 2) + OFFSET;
            let (near, far) = (across >> 5, (across * 3) >> 5);
            let pair = |a: i32, b: i32| (a.cast_unsigned() & 0xffff) | b.cast_unsigned() << 16;
            out.pixels[c] = [pair(middle - far, middle - near), pair(middle + near, middle + far)];
            out.slope[c] = pair(down >> 4, down >> 4);
            surfaces[c] = [medians[c]; 2];
        }
        if crate::tuning::t(2, 1) != 0 { self.choose_surfaces(cells, medians, out, &mut surfaces); }
        self.rate(cells, &spread, out);
        if crate::tuning::t(1, 1) != 0 { self.hide(cells, &surfaces, out); }
    }

    /// The median of the labels over 3 x 3 cells, and by how much they differ.
    fn medians(&self, cells: usize, medians: &mut [u8], spread: &mut [u8]) {
        let rows = self.rows.map(|row| row.label.as_flattened());
        // Sorted columns, with a column before the first and one after the last.
        let mut low = [[0u8; 4]; WORDS];
        let mut mid = [[0u8; 4]; WORDS];
        let mut high = [[0u8; 4]; WORDS];
        let count = cells.div_ceil(4);
        for i in 0..count {
            let [a, b, c] = rows.map(|row| quad(row, 4 * i));
            let (least, most) = (min(a, b), max(a, b));
            let lower = min(most, c);
            low[i] = min(least, c).to_le_bytes();
            mid[i] = max(least, lower).to_le_bytes();
            high[i] = max(most, c).to_le_bytes();
        }
        let (low, mid, high) = (low.as_flattened(), mid.as_flattened(), high.as_flattened());
        for i in 0..count {
            let around = |row: &[u8]| {
                let here = quad(row, 4 * i);
                let before = if i == 0 { here << 8 | here & 0xff } else { quad(row, 4 * i - 1) };
                let mut after = quad(row, 4 * i + 1);
                if 4 * i + 4 >= cells {
                    let last = (cells - 1) % 4;
                    let keep = u32::MAX.checked_shr(8 * (4 - u32::try_from(last).unwrap_or(0))).unwrap_or(0);
                    after = after & keep | (here & !keep);
                }
                [before, here, after]
            };
            let [a, b, c] = around(low);
            let most_low = max(max(a, b), c);
            let least = min(min(a, b), c);
            let [a, b, c] = around(mid);
            let middle = max(min(a, b), min(max(a, b), c));
            let [a, b, c] = around(high);
            let least_high = min(min(a, b), c);
            let most = max(max(a, b), c);
            let (x, y) = (min(most_low, middle), max(most_low, middle));
            let median = max(x, min(y, least_high));
            medians[4 * i..4 * i + 4].copy_from_slice(&median.to_le_bytes());
            spread[4 * i..4 * i + 4].copy_from_slice(&sub(most, least).to_le_bytes());
        }
    }

    /// At a jump along the row the half of a cell beside it takes the neighbour's surface, if that fits twice as well.
    fn choose_surfaces(&self, cells: usize, medians: &[u8], out: &mut AnswerRow<WORDS>, surfaces: &mut [[u8; 2]; WORDS]) {
        let last = 4 * (cells + 2) - 4;
        for c in 1..cells {
            let (a, b) = (medians[c - 1], medians[c]);
            if a.abs_diff(b) <= 1 {
                continue;
            }
            let fit = |column: usize, label: u8| {
                let at = column as i32 - i32::from(label) - self.min_disparity;
                (at >= 0 && at as usize <= last).then(|| window_sad::<1>(self.left.map(|r| &r[..]), column, self.right.map(|r| &r[..]), at as usize))
            };
            // Windows of four columns around the two halves beside the jump, margin included.
            for (cell, half, own, other) in [(c - 1, 1, a, b), (c, 0, b, a)] {
                let column = 4 * cell + 2 * half + 3;
                if let (Some(own), Some(others)) = (fit(column, own), fit(column, other))
                    && 2 * others < own
                {
                    let neighbour = if half == 1 { c } else { c - 1 };
                    let value = ((self.rows[1].value[neighbour] >> 2) + OFFSET).cast_unsigned() & 0xffff;
                    out.pixels[cell][half] = value | value << 16;
                    surfaces[cell][half] = other;
                }
            }
        }
    }

    /// Confidence: the merits of 3 x 3 cells, less where they disagree.
    fn rate(&self, cells: usize, spread: &[[u8; 4]; WORDS], out: &mut AnswerRow<WORDS>) {
        let rows = self.rows.map(|row| row.merit.as_flattened());
        let mut columns = [[0u8; 4]; WORDS];
        for i in 0..cells.div_ceil(4) {
            let [a, b, c] = rows.map(|row| quad(row, 4 * i));
            columns[i] = crate::lanes::halved_sum(crate::lanes::halved_sum(a, c), b).to_le_bytes();
        }
        let columns = columns.as_flattened();
        for c in 0..cells {
            let here = u32::from(columns[c]);
            let before = if c == 0 { here } else { u32::from(columns[c - 1]) };
            let after = if c + 1 == cells { here } else { u32::from(columns[c + 1]) };
            let mean = (before + 2 * here + after) / 4;
            let jump = if spread.as_flattened()[c] > 1 { crate::tuning::t(55, 10) as u32 } else { 0 };
            let value = (2 * mean).saturating_sub(128 + jump).clamp(16, 255);
            out.confidence[c] = splat(value);
        }
    }

    /// Pixels whose column of the right view, and both beside it, are seen by something nearer are hidden there: they take the
    /// surface behind, as a guess.
    fn hide(&self, cells: usize, surfaces: &[[u8; 2]; WORDS], out: &mut AnswerRow<WORDS>) {
        use crate::lanes::rows::{load, store};
        let mut claims = [0u32; WORDS];
        let words = cells + 2;
        claims[0] = u32::MAX;
        claims[words - 1] = u32::MAX;
        if self.width % 4 != 0 {
            claims[words - 2] = u32::MAX << (8 * (self.width % 4));
        }
        let claims = &mut claims[..words];
        let origin = |c: usize| 4 * c as i32 + 4 - self.min_disparity;
        for c in 0..cells {
            let [a, b] = surfaces[c];
            let at = |label: u8| usize::try_from(origin(c) - i32::from(label)).unwrap_or(usize::MAX);
            if a == b {
                let at = at(a);
                let seen = load(claims, at);
                store(claims, at, max(seen, splat(u32::from(a))));
            } else {
                for (label, mask) in [(a, 0x0000_ffff), (b, 0xffff_0000)] {
                    let at = at(label);
                    let seen = load(claims, at);
                    store(claims, at, max(seen, splat(u32::from(label)) & mask));
                }
            }
        }
        let claims = &*claims;
        let mut first_hidden = None;
        let mut last_good: Option<(i32, u32)> = None;
        for c in 0..cells {
            let [a, b] = surfaces[c];
            let hidden = |label: u8| {
                let at = origin(c) - i32::from(label);
                if at < 1 || at as usize + 5 > 4 * words {
                    return u32::MAX;
                }
                let at = at as usize;
                let nearer = min(min(load(claims, at - 1), load(claims, at)), load(claims, at + 1));
                select_ge(nearer, splat((u32::from(label) + 2).min(255)), u32::MAX, 0)
            };
            let mask = if a == b { hidden(a) } else { hidden(a) & 0x0000_ffff | hidden(b) & 0xffff_0000 };
            if mask == 0 {
                // Seen: it may be what lies behind the hidden ones before it.
                if let Some(first) = first_hidden.take() {
                    fill(out, first..c, last_good, Some(out.pixels[c][0]));
                }
                last_good = Some((0, out.pixels[c][1] >> 16));
                continue;
            }
            out.confidence[c] = out.confidence[c] & !mask | splat(GUESS) & mask;
            first_hidden.get_or_insert(c);
            let _ = mask;
        }
        if let Some(first) = first_hidden {
            fill(out, first..cells, last_good, None);
        }
    }
}

/// Gives the hidden pixels of the cells the farther of the surfaces beside them.
fn fill<const WORDS: usize>(out: &mut AnswerRow<WORDS>, cells: core::ops::Range<usize>, before: Option<(i32, u32)>, after: Option<u32>) {
    let before = before.map(|(_, value)| value & 0xffff);
    let after = after.map(|pair| pair & 0xffff);
    let Some(value) = (match (before, after) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }) else {
        return;
    };
    for c in cells {
        for half in 0..2 {
            let mut pair = out.pixels[c][half];
            for i in 0..2 {
                let column = 2 * half as u32 + i;
                if out.confidence[c] >> (8 * column) & 0xff == GUESS {
                    pair = pair & !(0xffff << (16 * i)) | value << (16 * i);
                }
            }
            out.pixels[c][half] = pair;
        }
    }
}

/// Four bytes of a row; 0 beyond its end.
#[inline(always)]
fn quad(row: &[u8], at: usize) -> u32 {
    row.get(at..at + 4).and_then(|bytes| bytes.first_chunk::<4>()).map_or(0, |&bytes| u32::from_le_bytes(bytes))
}
