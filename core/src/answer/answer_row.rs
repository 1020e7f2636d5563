//! Two image rows of answers: planes through neighbouring cells, the choice of surface at jumps, hidden pixels.
#![allow(
    clippy::needless_range_loop,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "columns are below 1280, disparities within 16 bits of 1/64 px"
)]

use crate::answer::cell::HALF;
use crate::answer::cell_row::{CellRow, blend, blend_pair, is_same_surface, word};
use crate::answer::evidence::Worth;
use crate::answer::median::{MOST_DOUBTFUL, medians};
use crate::front_end::camera_view::Row;
use crate::lanes::rows::{least_of_three, load, update, window_sad};
use crate::lanes::{
    ONES, add, add_halves, difference, max, min, select_ge, select_ge_halves, signed_halved_sum_halves, splat,
    splat_half, sub_halves,
};
use crate::{Config, Disparity};

/// What is added to the pixels of [`AnswerRow`], 1/64 px, so that none is negative.
const OFFSET: i32 = 64 * 64;
/// Keeps whole 1/16 px of two numbers of 1/64 px.
const WHOLE: u32 = 0xfffc_fffc;
/// Confidence of a guess: 1 to 15.
const GUESS: u32 = 8;
/// What seems to lie so much further right in the right view than something that is right of it in the left view, px, is
/// doubtful.
const OUT_OF_ORDER: i32 = 8;

/// Confidence comes in steps of so much.
const STEP: u32 = 8;

/// Two image rows of answers, cell by cell.
#[derive(Debug, Clone)]
pub(crate) struct AnswerRow<const WORDS: usize> {
    /// Disparity less the least one searched, 1/64 px and [`OFFSET`] more, of the columns 0, 1 and 2, 3 of a cell; two in a word.
    pixels: [[u32; 2]; WORDS],
    /// What the lower row has more than the middle, the upper one less, 1/64 px.
    slope: [i16; WORDS],
    /// Confidence of the four columns.
    pub(crate) confidence: [[u8; 4]; WORDS],
}

/// What the answers of a cell row are made of.
pub(crate) struct Sources<'a, const WORDS: usize> {
    /// The row above, the row itself and the row below, all smoothed along the row.
    pub(crate) rows: [&'a CellRow<WORDS>; 3],
    /// The two feature rows of the cells, of either view.
    pub(crate) left: [&'a Row<WORDS>; 2],
    pub(crate) right: [&'a Row<WORDS>; 2],
    /// What the cells are worth, and the merit from which on an answer is sure.
    pub(crate) worth: Worth<WORDS>,
    pub(crate) sure: u32,
}

/// The label of either half of a cell, two columns each.
type Surfaces<const WORDS: usize> = [[u8; 2]; WORDS];

impl<const WORDS: usize> AnswerRow<WORDS> {
    pub(crate) const EMPTY: Self = Self { pixels: [[0; 2]; WORDS], slope: [0; WORDS], confidence: [[0; 4]; WORDS] };

    /// Answers a cell row.
    pub(crate) fn answer(&mut self, config: &Config, sources: &Sources<'_, WORDS>) {
        let cells = usize::from(config.width).div_ceil(4);
        let (mut median, mut surfaces) = ([0; WORDS], [[0; 2]; WORDS]);
        self.survey(sources, cells, &mut median, &mut surfaces);
        self.lay_planes(sources.rows, &median, cells);
        self.choose_surfaces(config, sources, &median[..cells], &mut surfaces);
        self.hide(config, &surfaces[..cells]);
        self.doubt_blank(cells, &median, &sources.worth);
    }

    /// Medians and confidence of the cells; each is of one surface for the time being.
    #[inline(never)]
    fn survey(
        &mut self,
        sources: &Sources<'_, WORDS>,
        cells: usize,
        median: &mut [u8; WORDS],
        surfaces: &mut Surfaces<WORDS>,
    ) {
        const EVEN: u32 = 0x00ff_00ff;
        let (fours, rest) = self.confidence[..cells].as_chunks_mut::<4>();
        let (median_fours, median_rest) = median[..cells].as_chunks_mut::<4>();
        let (surface_fours, surface_rest) = surfaces[..cells].as_chunks_mut::<4>();
        medians(sources.rows, cells, &sources.worth.bonus, sources.sure, |i, labels, certain| {
            // What is finer than a step says nothing, and costs room in packets.
            let certain = (certain & splat(!(STEP - 1) & 0xff))
                .to_le_bytes()
                .map(|certain| splat(u32::from(certain)).to_le_bytes());
            let labels_by_cell = labels.to_le_bytes();
            if let (Some(four), Some(median), Some(surfaces)) =
                (fours.get_mut(i), median_fours.get_mut(i), surface_fours.get_mut(i))
            {
                *four = certain;
                *median = labels_by_cell;
                // Each label twice.
                let (even, odd) = ((labels & EVEN) * 0x101, (labels >> 8 & EVEN) * 0x101);
                let [a, b, c, d] = (even & 0xffff | odd << 16).to_le_bytes();
                let [e, f, g, h] = (even >> 16 | odd & 0xffff_0000).to_le_bytes();
                *surfaces = [[a, b], [c, d], [e, f], [g, h]];
            } else {
                let rest = rest.iter_mut().zip(median_rest.iter_mut()).zip(surface_rest.iter_mut());
                for (((to, median), surfaces), (certain, label)) in rest.zip(certain.into_iter().zip(labels_by_cell)) {
                    (*to, *median, *surfaces) = (certain, label, [label; 2]);
                }
            }
        });
    }

    /// Lays a plane through each cell and its neighbours on the same surface.
    #[inline(never)]
    fn lay_planes(&mut self, rows: [&CellRow<WORDS>; 3], median: &[u8; WORDS], cells: usize) {
        let count = cells.div_ceil(2);
        let row = &rows[1].value[..cells];
        let values = rows.map(|row| &row.value.as_chunks::<2>().0[..count]);
        let slopes = &rows[1].slope.as_chunks::<2>().0[..count];
        let labels = &rows[1].label.as_chunks::<2>().0[..count];
        let medians = &median.as_chunks::<2>().0[..count];
        let (pixels, downs) =
            (&mut self.pixels.as_chunks_mut::<2>().0[..count], &mut self.slope.as_chunks_mut::<2>().0[..count]);
        for i in 0..count {
            let (mut here, mut across) = (word(values[1][i]), word(slopes[i].map(i16::cast_unsigned)));
            if u16::from_le_bytes(medians[i]) != u16::from_le_bytes(labels[i]) {
                for half in 0..2 {
                    if medians[i][half] != labels[i][half] {
                        let (value, slope) = outvoted(row, 2 * i + half, medians[i][half]);
                        let keep = 0xffff_0000 >> (16 * half);
                        here = here & keep | (value.cast_unsigned() & 0xffff) << (16 * half);
                        across = across & keep | (slope.cast_unsigned() & 0xffff) << (16 * half);
                    }
                }
            }
            let (here, down) = blend_pair(here, word(values[0][i]), word(values[2][i]));
            // A quarter of the slope lies between two columns.
            let middle =
                add_halves(here >> 2 & 0x3fff_3fff, splat_half((OFFSET - HALF.cast_signed() / 4 + 2).cast_unsigned()))
                    & WHOLE;
            let thrice = add_halves(add_halves(across, across), across);
            let low = |word: u32| i32::from(word as u16 as i16);
            let high = |word: u32| word.cast_signed() >> 16;
            // Each rounded to 1/16 px on its own: so a packet tells a cell by three small numbers.
            let rounded = |slope: i32, bits: u32| ((slope + (1 << (bits - 1))) >> bits) << 2;
            for half in 0..2 {
                let (near, far, middle) = if half == 0 {
                    (rounded(low(across), 7), rounded(low(thrice), 7), middle & 0xffff | middle << 16)
                } else {
                    (rounded(high(across), 7), rounded(high(thrice), 7), middle >> 16 | middle & 0xffff_0000)
                };
                pixels[i][half] = [sub_halves(middle, pair(far, near)), add_halves(middle, pair(near, far))];
            }
            downs[i] = [rounded(low(down), 6) as i16, rounded(high(down), 6) as i16];
        }
    }

    /// At a jump along the row the half of a cell beside it takes the neighbour's surface, if that fits twice as well.
    #[inline(never)]
    fn choose_surfaces(
        &mut self,
        config: &Config,
        sources: &Sources<'_, WORDS>,
        median: &[u8],
        surfaces: &mut Surfaces<WORDS>,
    ) {
        let mut before = u32::from(median.first().copied().unwrap_or(0)) << 24;
        let (fours, rest) = median.as_chunks::<4>();
        let rest =
            (!rest.is_empty()).then(|| core::array::from_fn(|i| rest.get(i).or(rest.last()).copied().unwrap_or(0)));
        for (four, &labels) in fours.iter().chain(&rest).enumerate() {
            let here = u32::from_le_bytes(labels);
            // Set in the lanes of the cells that a jump is before.
            let jumps = select_ge(difference(here, here << 8 | before >> 24), splat(2), ONES, 0);
            before = here;
            if jumps != 0 {
                for lane in (0..4).filter(|lane| jumps >> (8 * lane) & 1 == 1) {
                    self.choose_at(config, sources, median, 4 * four + lane, surfaces);
                }
            }
        }
    }

    /// The same at the jump before a cell.
    #[inline(never)]
    fn choose_at(
        &mut self,
        config: &Config,
        sources: &Sources<'_, WORDS>,
        median: &[u8],
        c: usize,
        surfaces: &mut Surfaces<WORDS>,
    ) {
        let last = 4 * (median.len() + 1);
        if let Some(&[before, here]) = c.checked_sub(1).and_then(|c| median.get(c..)).and_then(|m| m.first_chunk::<2>())
        {
            let labels = [before, here];
            // Windows of four columns around the two halves beside the jump.
            for (half, cell) in [(1, c - 1), (0, c)] {
                let column = 4 * cell + 2 * half + 3;
                let fit = |label: u8| {
                    let at =
                        usize::try_from(column as i32 - i32::from(label) - i32::from(config.min_disparity)).ok()?;
                    (at <= last)
                        .then(|| window_sad(sources.left.map(|r| &r[..]), column, sources.right.map(|r| &r[..]), at))
                };
                let (own, other) = (labels[1 - half], labels[half]);
                if let (Some(own), Some(others)) = (fit(own), fit(other))
                    && 2 * others < own
                {
                    let neighbour = if half == 1 { c } else { c - 1 };
                    // Of a label that the median put in the place of another only the whole disparity is known.
                    let row = sources.rows[1];
                    let value = if row.label[neighbour] == other {
                        i32::from(row.value[neighbour])
                    } else {
                        (i32::from(other) << 8) + HALF.cast_signed()
                    };
                    let value = (value >> 2) + OFFSET - HALF.cast_signed() / 4;
                    self.pixels[cell][half] = pair(value, value);
                    surfaces[cell][half] = other;
                }
            }
        }
    }

    /// Pixels whose column of the right view, and both beside it, are seen by something nearer are hidden there: they take the
    /// surface behind, as a guess.
    #[inline(never)]
    fn hide(&mut self, config: &Config, surfaces: &[[u8; 2]]) {
        // For each column of the right view the greatest label that claims it; nobody claims what lies outside.
        let mut claims = [0; WORDS];
        let width = usize::from(config.width);
        let claims = &mut claims[..surfaces.len() + 2];
        if let [first, .., inner, last] = claims {
            (*first, *last) = (u32::MAX, u32::MAX);
            if !width.is_multiple_of(4) {
                *inner = u32::MAX << (8 * (width % 4));
            }
        }
        let origin = 4 - i32::from(config.min_disparity);
        let mut column = origin + 4 * surfaces.len() as i32;
        // Seen past a nearer thing to the right of it: that is mostly a strip that the right view does not see, and that looks
        // like what only the right view sees at the thing's other side.
        let mut leftmost = i32::MAX - OUT_OF_ORDER;
        for (&[a, b], confidence) in surfaces.iter().zip(&mut self.confidence).rev() {
            column -= 4;
            let at = |label: u8| (column - i32::from(label)).cast_unsigned() as usize;
            let here = column - i32::from(b);
            if here > leftmost + OUT_OF_ORDER {
                *confidence = min(u32::from_le_bytes(*confidence), splat(MOST_DOUBTFUL)).to_le_bytes();
            }
            leftmost = leftmost.min(here);
            if a == b {
                claim(claims, at(a), splat(u32::from(a)));
            } else {
                claim(claims, at(a), splat(u32::from(a)) & 0x0000_ffff);
                claim(claims, at(b), splat(u32::from(b)) & 0xffff_0000);
            }
        }
        let mut first_hidden = None;
        let mut seen_before = None;
        let mut column = origin;
        for (c, &[a, b]) in surfaces.iter().enumerate() {
            let at = |label: u8| (column - i32::from(label)).cast_unsigned() as usize;
            let mask = if a == b {
                hidden(claims, at(a), a)
            } else {
                hidden(claims, at(a), a) & 0x0000_ffff | hidden(claims, at(b), b) & 0xffff_0000
            };
            column += 4;
            if mask == 0 {
                // Seen: it may be what lies behind the hidden ones before it.
                if let Some(first) = first_hidden.take() {
                    self.fill(first..c, seen_before, Some(self.pixels[c][0] & 0xffff));
                    // The window reaches into what is hidden.
                    let confidence = min(u32::from_le_bytes(self.confidence[c]), splat(MOST_DOUBTFUL));
                    self.confidence[c] = confidence.to_le_bytes();
                }
                seen_before = Some(c);
            } else {
                let confidence = u32::from_le_bytes(self.confidence[c]) & !mask | splat(GUESS) & mask;
                self.confidence[c] = confidence.to_le_bytes();
                first_hidden = first_hidden.or(Some(c));
            }
        }
        if let Some(first) = first_hidden {
            self.fill(first..surfaces.len(), seen_before, None);
        }
    }

    /// Where there is nothing to see an answer is a guess, unless the nearest cells to the left and to the right that show
    /// something agree with it.
    #[inline(never)]
    fn doubt_blank(&mut self, cells: usize, median: &[u8; WORDS], worth: &Worth<WORDS>) {
        const NEAR: u8 = 2;
        let (blank, median) = (&worth.blank[..cells], &median[..cells]);
        let mut before: Option<u8> = None;
        let mut c = 0;
        while c < cells {
            if blank[c] == 0 {
                before = Some(median[c]);
                c += 1;
                continue;
            }
            let end = (c..cells).find(|&i| blank[i] == 0).unwrap_or(cells);
            let after = median.get(end).copied();
            for i in c..end {
                let agrees = |other: Option<u8>| other.is_some_and(|other| other.abs_diff(median[i]) <= NEAR);
                if !(agrees(before) && agrees(after)) {
                    self.confidence[i] = self.confidence[i].map(|confidence| confidence.min(GUESS as u8));
                }
            }
            c = end;
        }
    }

    /// Gives the hidden pixels of the cells the farther of the surfaces beside them.
    #[inline(never)]
    fn fill(&mut self, cells: core::ops::Range<usize>, seen_before: Option<usize>, after: Option<u32>) {
        let before = seen_before.map(|c| self.pixels[c][1] >> 16);
        let Some(value) = before.into_iter().chain(after).min() else { return };
        for c in cells {
            for (i, &confidence) in self.confidence[c].iter().enumerate() {
                if u32::from(confidence) == GUESS {
                    let pair = &mut self.pixels[c][i / 2];
                    *pair = if i % 2 == 0 { *pair & 0xffff_0000 | value } else { *pair & 0xffff | value << 16 };
                }
            }
        }
    }

    /// Writes the disparities of the upper or the lower row.
    #[inline(never)]
    pub(crate) fn write(&self, is_lower: bool, config: &Config, out: &mut [[Disparity; 4]; WORDS]) {
        let cells = usize::from(config.width).div_ceil(4);
        // The offset goes and the least disparity comes; 1/2 of 1/16 px rounds.
        let base = pair_of(2 * (16 * i32::from(config.min_disparity) - OFFSET / 4));
        let (half, least) = (pair_of(2), pair_of(OFFSET));
        let rows = self.pixels[..cells].iter().zip(&self.slope[..cells]).zip(&mut out[..cells]);
        for ((pixels, &slope), out) in rows {
            let slope = pair_of(i32::from(if is_lower { slope } else { -slope }));
            // Nothing is farther than the least disparity searched. Halved twice: a quarter, and half of twice the base.
            let [a, b] = pixels.map(|pair| {
                let moved = add_halves(pair, slope);
                let within = select_ge_halves(moved, least, moved, least);
                signed_halved_sum_halves(signed_halved_sum_halves(within, half), base)
            });
            *out = [a, a >> 16, b, b >> 16].map(|bits| Disparity::from_bits(bits as u16 as i16));
        }
    }
}

/// Claims four columns of the right view, from a byte on.
#[inline(always)]
fn claim(claims: &mut [u32], byte: usize, labels: u32) {
    update(claims, byte, |claimed| max(claimed, labels));
}

/// Those of four columns of the right view, from a byte on, that are claimed by something nearer than a label, with both
/// beside them.
#[inline(always)]
fn hidden(claims: &[u32], byte: usize, label: u8) -> u32 {
    let nearer = add(splat(u32::from(label)), splat(2));
    // Mostly nothing nearer is there.
    match select_ge(load(claims, byte), nearer, u32::MAX, 0) {
        0 => 0,
        _ => select_ge(least_of_three(claims, byte), nearer, u32::MAX, 0),
    }
}

/// The value of a cell that takes the label of its neighbours, and its slope along the row.
#[inline(never)]
fn outvoted(row: &[u16], cell: usize, label: u8) -> (i32, i32) {
    let here = (i32::from(label) << 8) + HALF.cast_signed();
    let beside = |value: Option<&u16>| {
        let value = value.map(|&value| i32::from(value));
        (value.unwrap_or(0), value.is_some_and(|value| is_same_surface(value, here)))
    };
    blend(here, [beside(cell.checked_sub(1).and_then(|before| row.get(before))), beside(row.get(cell + 1))])
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
