//! Two image rows of answers: planes through neighbouring cells, the choice of surface at jumps, hidden pixels.
#![allow(
    clippy::needless_range_loop,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "columns are below 1280, disparities within 16 bits of 1/64 px"
)]

use core::ops::Range;

use crate::answer::cell::HALF;
use crate::answer::cell_row::{CellRow, SAME_SURFACES, blend, is_same_surface};
use crate::answer::confidence;
use crate::answer::evidence::Worth;
use crate::answer::median::{MOST_DOUBTFUL, confidences, medians};
use crate::answer::neighbourhood::{words, words_of};
use crate::answer::right_view::{RightView, Stretch, columns};
use crate::front_end::camera_view::Row;
use crate::lanes::answer_rows::{PlanePairs, WordAligned, down_bits, lay_planes, raised, write_moved};
use crate::lanes::smoothing::Values;
use crate::lanes::windows::{strongest_window, window_sad};
use crate::lanes::{ONES, difference, min, select_ge, splat, splat_half};
use crate::{Config, Disparity};

/// Confidence of a guess: 1 to 15.
const GUESS: u32 = 8;
/// What seems to lie so much further right in the right view than something that is right of it in the left view, px, is
/// doubtful.
const OUT_OF_ORDER: i32 = 8;

/// From this difference of labels on the right border is doubtful; 2 px are a jump.
const LEAST_STEP: u8 = 4;
/// The contour of a nearer surface lies within so many columns of where it seems to begin, and one for each px that it is
/// nearer, as many as may be hidden, up to [`MOST_HIDDEN`].
const CONTOUR_REACH: usize = 6;
/// So many hidden columns are reckoned with at most.
const MOST_HIDDEN: usize = 10;

/// Confidence comes in steps of so much.
const STEP: u32 = 8;
/// The left two columns of a cell.
const LEFT: u32 = 0x0000_ffff;

/// Two image rows of answers, cell by cell.
#[derive(Debug, Clone)]
pub(crate) struct AnswerRow<const WORDS: usize> {
    /// Disparity of the columns 0, 1 and 2, 3 of a cell, as [`Disparity::into_bits`]; two in a word.
    pixels: [[u32; 2]; WORDS],
    /// What the next half row down has more, in the same unit.
    slope: [i16; WORDS],
    /// Confidence of the four columns.
    pub(crate) confidence: WordAligned<[[u8; 4]; WORDS]>,
}

/// What the answers of a cell row are made of.
pub(crate) struct Sources<'a, const WORDS: usize> {
    /// The row above, the row itself and the row below, all smoothed along the row.
    pub(crate) rows: [&'a CellRow<WORDS>; 3],
    /// The two feature rows of the cells, of either view.
    pub(crate) left: &'a [Row<WORDS>; 2],
    pub(crate) right: &'a [Row<WORDS>; 2],
    /// What the cells are worth, and the merit from which on an answer is sure.
    pub(crate) worth: &'a Worth<WORDS>,
    pub(crate) sure: u32,
    /// The byte of a feature that is zero.
    pub(crate) zero: u32,
}

impl<const WORDS: usize> AnswerRow<WORDS> {
    pub(crate) const EMPTY: Self =
        Self { pixels: [[0; 2]; WORDS], slope: [0; WORDS], confidence: WordAligned([[0; 4]; WORDS]) };

    /// Answers a row of cells that are so many rows high.
    pub(crate) fn answer<const HEIGHT: u32>(&mut self, config: &Config, sources: &Sources<'_, WORDS>) {
        let cells = usize::from(config.width).div_ceil(4);
        let mut median = [0; WORDS];
        self.survey(sources, cells, &mut median);
        self.lay_planes::<HEIGHT>(config, sources.rows, &median, cells);
        self.part(config, sources, &median, cells);
        self.doubt_blank(cells, &median, sources.worth);
    }

    /// Medians and confidence of the cells.
    #[inline(never)]
    fn survey(&mut self, sources: &Sources<'_, WORDS>, cells: usize, median: &mut [u8; WORDS]) {
        let mut price = [0; WORDS];
        medians(sources.rows, cells, median, &mut price);
        let columns = self.confidence.0.as_chunks_mut::<4>().0;
        let columns = &mut columns[..words_of(cells)];
        confidences(sources.rows, cells, &price, &sources.worth.bonus, sources.sure, |i, certain| {
            // What is finer than a step says nothing, and costs room in packets.
            let certain = certain & splat(!(STEP - 1) & 0xff);
            columns[i] = certain.to_le_bytes().map(|certain| splat(u32::from(certain)).to_le_bytes());
        });
    }

    /// Lays a plane through each cell and its neighbours on the same surface.
    #[inline(never)]
    fn lay_planes<const HEIGHT: u32>(
        &mut self,
        config: &Config,
        rows: [&CellRow<WORDS>; 3],
        median: &[u8; WORDS],
        cells: usize,
    ) {
        let count = cells.div_ceil(2);
        let Values { mut value, mut slope } = rows[1].values;
        // Some cells take the label of their neighbours.
        let labels = words(&rows[1].label, words_of(cells)).iter().zip(words(median, words_of(cells)));
        for (four, (labels, medians)) in labels.enumerate() {
            if labels != medians {
                for lane in 0..4 {
                    let cell = 4 * four + lane;
                    if medians[lane] != labels[lane] && cell < cells {
                        (value[cell], slope[cell]) = outvoted(&rows[1].values.value[..cells], cell, medians[lane]);
                    }
                }
            }
        }
        // What makes disparities of values that are divided by 16.
        let base = Disparity::from_px(config.min_disparity).into_bits() - HALF as i16 / 16;
        let planes = PlanePairs {
            values: [&rows[0].values.value, &value, &rows[2].values.value].map(|row| &row.as_chunks::<2>().0[..count]),
            slopes: &slope.as_chunks::<2>().0[..count],
            same: SAME_SURFACES,
            bases: [raised(7) as i16, -(raised(7) as i16)].map(|raised| pair_of((base + raised).into())),
            raised: splat_half(raised(down_bits(HEIGHT))),
        };
        let (pixels, downs) =
            (&mut self.pixels.as_chunks_mut::<2>().0[..count], &mut self.slope.as_chunks_mut::<2>().0[..count]);
        lay_planes::<HEIGHT>(&planes, pixels, downs);
    }

    /// Where surfaces part: at a jump along the row the half of a cell beside it takes the neighbour's surface, if that fits
    /// better by a quarter; left of a jump upwards, as at the margins of the right view, something may be hidden there.
    #[inline(never)]
    fn part(&mut self, config: &Config, sources: &Sources<'_, WORDS>, median: &[u8; WORDS], cells: usize) {
        let mut halves = [*median; 2];
        let fours = words(median, words_of(cells));
        let median = &median[..cells];
        // Made where it is: one that is returned would be copied.
        let mut right_view = RightView::EMPTY;
        right_view.start(config, cells);
        let (mut stretch, mut done) = (right_view.left_margin(median), 0);
        let mut before = u32::from(median.first().copied().unwrap_or(0)) << 24;
        for (four, &labels) in fours.iter().enumerate() {
            let here = u32::from_le_bytes(labels);
            // Set in the lanes of the cells that a jump is before.
            let mut jumps = select_ge(difference(here, here << 8 | before >> 24), splat(2), ONES, 0);
            before = here;
            while jumps != 0 {
                let c = 4 * four + jumps.trailing_zeros() as usize / 8;
                jumps &= jumps - 1;
                let Some(&[far, near]) = c.checked_sub(1).and_then(|c| median.get(c..)).and_then(|m| m.first_chunk())
                else {
                    continue;
                };
                let end = self.choose_at(config, sources, [far, near], c, &mut halves);
                if far < near {
                    let reach = CONTOUR_REACH + usize::from(near - far).min(MOST_HIDDEN);
                    self.doubt_left_border(sources, end..(end + reach).min(4 * cells - 1));
                    let jump = right_view.around(config, c, far, near);
                    if jump.from > stretch.to {
                        self.hide(&mut right_view, stretch, &halves);
                        (done, stretch) = (stretch.to, jump);
                    } else {
                        stretch = stretch.with(jump, done..cells);
                    }
                } else {
                    self.doubt_right_border([far, near], end);
                }
            }
        }
        self.hide(&mut right_view, stretch, &halves);
        let margin = right_view.right_margin(config, stretch.to);
        self.hide(&mut right_view, margin, &halves);
    }

    /// Chooses at the jump from one label to the other before a cell; the first column of the surface behind the jump.
    #[inline(never)]
    fn choose_at(
        &mut self,
        config: &Config,
        sources: &Sources<'_, WORDS>,
        labels: [u8; 2],
        c: usize,
        halves: &mut [[u8; WORDS]; 2],
    ) -> usize {
        let mut end = 4 * c;
        let last = 4 * (usize::from(config.width).div_ceil(4) + 1);
        // Windows of four columns around the two halves beside the jump.
        for (half, cell) in [(1, c - 1), (0, c)] {
            let column = 4 * cell + 2 * half + 3;
            let fit = |label: u8| {
                let at = usize::try_from(column as i32 - i32::from(label) - i32::from(config.min_disparity)).ok()?;
                (at <= last).then(|| {
                    window_sad(
                        sources.left.each_ref().map(|r| &r[..]),
                        column,
                        sources.right.each_ref().map(|r| &r[..]),
                        at,
                    )
                })
            };
            let (own, other) = (labels[1 - half], labels[half]);
            if let (Some(own), Some(others)) = (fit(own), fit(other))
                && 4 * others < 3 * own
            {
                let neighbour = if half == 1 { c } else { c - 1 };
                // Of a label that the median put in the place of another only the whole disparity is known.
                let row = sources.rows[1];
                let value = if row.label[neighbour] == other {
                    i32::from(row.values.value[neighbour])
                } else {
                    (i32::from(other) << 8) + HALF.cast_signed()
                };
                let value = ((value - HALF.cast_signed() + 8) >> 4) + 16 * i32::from(config.min_disparity);
                self.pixels[cell][half] = pair_of(value);
                halves[half][cell] = other;
                end = end + 2 - 4 * half;
            }
        }
        end
    }

    /// Where a nearer surface ends on its right, before column `end`, is not sure: answers reach over it by two columns.
    #[inline(always)]
    fn doubt_right_border(&mut self, [before, after]: [u8; 2], end: usize) {
        if before >= after.saturating_add(LEAST_STEP) {
            self.doubt_border(end - 2..end);
        }
    }

    /// Where a nearer surface seems to begin, at the first of some columns, is not sure: what the right view does not see is
    /// taken for it, up to its contour. That is the strongest one within the columns, of windows of four around each.
    #[inline(never)]
    fn doubt_left_border(&mut self, sources: &Sources<'_, WORDS>, columns: Range<usize>) {
        // A window begins two columns before its middle; the margin has four.
        let windows = columns.start + 3..columns.end + 2;
        let contour = strongest_window(&sources.left[0], splat(sources.zero), windows) - 2;
        self.doubt_border(columns.start..contour);
    }

    /// Takes columns for a border of a surface.
    #[inline(never)]
    fn doubt_border(&mut self, columns: Range<usize>) {
        let mut column = columns.start;
        while let Some(confidence) = self.confidence.0.get_mut(column / 4).filter(|_| column < columns.end) {
            let next = column / 4 * 4 + 4;
            // Nothing is limited before the first column and from the last on.
            let most = splat(confidence::FRINGE.into()) | !(u32::MAX << (8 * (column % 4)));
            let beyond = if columns.end < next { u32::MAX << (8 * (columns.end % 4)) } else { 0 };
            limit(confidence, most | beyond);
            column = next;
        }
    }

    /// Pixels whose column of the right view, and both beside it, are seen by something nearer are hidden there: they take the
    /// surface behind, as a guess.
    #[inline(never)]
    fn hide(&mut self, right_view: &mut RightView<WORDS>, stretch: Stretch, halves: &[[u8; WORDS]; 2]) {
        let cells = stretch.from..stretch.to;
        let [left, right] = halves.each_ref().map(|labels| &labels[cells.clone()]);
        let origin = right_view.origin;
        // Seen past a nearer thing to the right of it: that is mostly a strip that the right view does not see, and that looks
        // like what only the right view sees at the thing's other side.
        let mut leftmost = i32::MAX - OUT_OF_ORDER;
        let confidence = &mut self.confidence.0[cells.clone()];
        let mut column = origin + 4 * cells.end as i32;
        for i in (0..left.len().min(right.len()).min(confidence.len())).rev() {
            let (a, b, confidence) = (left[i], right[i], &mut confidence[i]);
            column -= 4;
            let at = |label: u8| (column - i32::from(label)).cast_unsigned() as usize;
            let here = column - i32::from(b);
            if here > leftmost + OUT_OF_ORDER {
                limit(confidence, splat(MOST_DOUBTFUL));
            }
            leftmost = leftmost.min(here);
            let mut columns = u32::MAX;
            if a != b {
                right_view.claim(at(b), b, !LEFT);
                columns = LEFT;
            }
            right_view.claim(at(a), a, columns);
        }
        let (mut first_hidden, mut seen_before) = (None, cells.start.checked_sub(1));
        // What lies after the last jump is nearer than all before it.
        let cells = stretch.from..stretch.near.min(stretch.to);
        for ((c, (&a, &b)), column) in cells.clone().zip(left.iter().zip(right)).zip(columns(cells.clone(), origin)) {
            let at = |label: u8| (column - i32::from(label)).cast_unsigned() as usize;
            let mut mask = right_view.hidden(at(a), a);
            if a != b {
                mask = mask & LEFT | right_view.hidden(at(b), b) & !LEFT;
            }
            if mask == 0 {
                if let Some(first) = first_hidden.take() {
                    self.fill(first..c, seen_before, right_view.cells());
                }
                seen_before = Some(c);
            } else {
                let confidence = u32::from_le_bytes(self.confidence.0[c]) & !mask | splat(GUESS) & mask;
                self.confidence.0[c] = confidence.to_le_bytes();
                first_hidden = first_hidden.or(Some(c));
            }
        }
        if let Some(first) = first_hidden {
            self.fill(first..cells.end, seen_before, right_view.cells());
        }
    }

    /// Where there is nothing to see an answer is a guess, unless the nearest cells to the left and to the right that show
    /// something agree with it.
    #[inline(never)]
    fn doubt_blank(&mut self, cells: usize, median: &[u8; WORDS], worth: &Worth<WORDS>) {
        let (blank, median) = (&worth.blank[..cells], &median[..cells]);
        let (fours, _) = blank.as_chunks::<4>();
        let mut c = 0;
        while c < cells {
            if c.is_multiple_of(4) && fours.get(c / 4).is_some_and(|&four| u32::from_le_bytes(four) == 0) {
                c += 4;
            } else if blank[c] == 0 {
                c += 1;
            } else {
                let end = (c..cells).find(|&i| blank[i] == 0).unwrap_or(cells);
                self.doubt(c..end, median);
                c = end;
            }
        }
    }

    /// Doubts cells that show nothing, between two that do.
    #[inline(never)]
    fn doubt(&mut self, cells: Range<usize>, median: &[u8]) {
        const NEAR: u8 = 2;
        let before = cells.start.checked_sub(1).and_then(|before| median.get(before));
        let after = median.get(cells.end);
        for (label, confidence) in median[cells.clone()].iter().zip(&mut self.confidence.0[cells]) {
            let agrees = |other: Option<&u8>| other.is_some_and(|other| other.abs_diff(*label) <= NEAR);
            if !(agrees(before) && agrees(after)) {
                limit(confidence, splat(GUESS));
            }
        }
    }

    /// Gives the hidden pixels of cells the farther of the surfaces beside them: of the cell seen before, and of the next one,
    /// which may be what lies behind them.
    #[inline(never)]
    fn fill(&mut self, hidden: Range<usize>, seen_before: Option<usize>, cells: usize) {
        let before = seen_before.map(|c| (self.pixels[c][1] >> 16) as i16);
        let next = hidden.end;
        let after = (next < cells).then(|| self.pixels[next][0] as i16);
        let Some(farther) = before.into_iter().chain(after).min() else { return };
        let value = pair_of(farther.into());
        for c in hidden {
            for (i, &confidence) in self.confidence.0[c].iter().enumerate() {
                if u32::from(confidence) == GUESS {
                    let pair = &mut self.pixels[c][i / 2];
                    *pair = if i % 2 == 0 { *pair & !LEFT | value & LEFT } else { *pair & LEFT | value & !LEFT };
                }
            }
        }
    }

    /// Writes the disparities of a row, so many half rows below the middle of the cells: -3, -1, 1 or 3.
    #[inline(never)]
    pub(crate) fn write(&self, config: &Config, half_rows: i32, out: &mut [[Disparity; 4]; WORDS]) {
        let pairs = usize::from(config.width).div_ceil(8);
        // Nothing is farther than the least disparity searched.
        let least = pair_of(i32::from(config.min_disparity) << Disparity::FRAC_BITS);
        let (pixels, slopes) = (self.pixels.as_chunks().0, self.slope.as_chunks().0);
        let (pixels, slopes, out) = (&pixels[..pairs], &slopes[..pairs], &mut out.as_chunks_mut().0[..pairs]);
        match half_rows {
            ..-1 => write_moved::<-3>(pixels, slopes, least, out),
            -1 => write_moved::<-1>(pixels, slopes, least, out),
            0..=1 => write_moved::<1>(pixels, slopes, least, out),
            _ => write_moved::<3>(pixels, slopes, least, out),
        }
    }
}

/// Limits the confidence of the four columns of a cell.
#[inline(always)]
fn limit(confidence: &mut [u8; 4], most: u32) {
    *confidence = min(u32::from_le_bytes(*confidence), most).to_le_bytes();
}

/// The value of a cell that takes the label of its neighbours, and its slope along the row.
#[inline(never)]
fn outvoted(row: &[u16], cell: usize, label: u8) -> (u16, i16) {
    let here = (i32::from(label) << 8) + HALF.cast_signed();
    let beside = |value: Option<&u16>| {
        let value = value.map(|&value| i32::from(value));
        (value.unwrap_or(0), value.is_some_and(|value| is_same_surface(value, here)))
    };
    let neighbours = [beside(cell.checked_sub(1).and_then(|before| row.get(before))), beside(row.get(cell + 1))];
    let (value, slope) = blend(here, neighbours);
    (value as u16, slope as i16)
}

/// Two numbers of 16 bits in a word.
#[inline(always)]
const fn pair(low: i32, high: i32) -> u32 {
    low.cast_unsigned() & 0xffff | high.cast_unsigned() << 16
}

/// The same number twice.
#[inline(always)]
const fn pair_of(value: i32) -> u32 {
    pair(value, value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_border_is_limited_from_its_first_column_to_its_last() {
        for (columns, limited) in
            [(5..11, 5..11), (6..8, 6..8), (4..16, 4..16), (7..7, 0..0), (8..8, 0..0), (18..30, 18..20)]
        {
            let mut row = AnswerRow::<5>::EMPTY;
            row.confidence.0 = [[200, 50, 200, 120]; 5];
            row.doubt_border(columns.clone());
            for (column, &certain) in row.confidence.0.as_flattened().iter().enumerate() {
                let before = [200, 50, 200, 120][column % 4];
                let expected = if limited.contains(&column) { before.min(confidence::FRINGE) } else { before };
                assert_eq!(certain, expected, "column {column} of {columns:?}");
            }
        }
    }
}
