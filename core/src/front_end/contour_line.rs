//! The contours of one line of a view, from responses of four columns a word (the paper's K of eq. 1).
#![allow(clippy::cast_possible_truncation, reason = "columns are below 1280, strengths below 256")]

use crate::front_end::camera_view::Row;
use crate::front_end::haar::{self, SlidingResponse};
use crate::lanes::rows::FLIP;
use crate::lanes::{ONES, add, difference, max, select_ge, signed_halved_sum, splat, sub};

/// Columns of a margin.
const MARGIN: usize = 4;

/// A contour point: its column in the upper half; in the lower one its strength, the mean step in grey levels, and
/// [`FALLING`](Self::FALLING) more if it goes from bright to dark.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Edge(u32);

impl Edge {
    const FALLING: u32 = 256;

    const fn new(column: u32, strength: u32, is_falling: bool) -> Self {
        Self(column << 16 | if is_falling { Self::FALLING } else { 0 } | strength)
    }

    /// The first column behind it.
    pub(crate) const fn column(self) -> usize {
        (self.0 >> 16) as usize
    }

    /// Whether it lies before a column, which is 0 or more.
    pub(crate) const fn is_before(self, column: i32) -> bool {
        self.0 < (column.cast_unsigned() << 16)
    }

    /// Polarity and strength.
    pub(crate) const fn kind(self) -> u32 {
        self.0 & 0xffff
    }

    /// The kinds that may be the same edge in the other view: the same polarity, and a strength within a ratio of 3 to 2.
    pub(crate) const fn resembling(self) -> core::ops::RangeInclusive<u32> {
        let (strength, polarity) = (self.0 & 0xff, self.0 & Self::FALLING);
        let most = strength + strength / 2;
        polarity | (2 * strength).div_ceil(3)..=polarity | if most > 255 { 255 } else { most }
    }
}

/// Responses of four columns: one of `rise` and `fall` is 0 in each lane, the other the mean step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Response {
    rise: u32,
    fall: u32,
    /// What the step must reach to be a contour.
    gate: u32,
}

impl Response {
    /// From what lies before and after, unsigned lanes.
    #[inline(always)]
    fn between(before: u32, after: u32, gate: u32) -> Self {
        Self { rise: sub(after, before), fall: sub(before, after), gate }
    }

    #[inline(always)]
    const fn strength(self) -> u32 {
        self.rise | self.fall
    }
}

/// The contours of one line, at most one in two columns, left to right.
#[derive(Debug, Clone)]
pub(crate) struct ContourLine<const WORDS: usize> {
    points: [[Edge; 2]; WORDS],
    len: usize,
}

impl<const WORDS: usize> ContourLine<WORDS> {
    pub(crate) const fn new() -> Self {
        Self { points: [[Edge(0); 2]; WORDS], len: 0 }
    }

    pub(crate) fn as_slice(&self) -> &[Edge] {
        self.points.as_flattened().get(..self.len).unwrap_or(&[])
    }

    /// Finds the columns where the step reaches its gate and is stronger than at the column before and no weaker than at the
    /// one after.
    ///
    /// - `response`: of the word with that number, asked in turn from 1 on.
    #[inline(always)]
    fn find(&mut self, width: usize, mut response: impl FnMut(usize) -> Response) {
        self.len = 0;
        let words = width.div_ceil(4);
        let (mut before, mut here) = (0, response(1));
        for i in 1..=words {
            let next = if i < words { response(i + 1) } else { Response::default() };
            let (strength, after) = (here.strength(), next.strength());
            let least = max(max(here.gate, add(strength << 8 | before >> 24, ONES)), strength >> 8 | after << 24);
            let mut peaks = select_ge(strength, least, ONES, 0);
            while peaks != 0 {
                let bits = peaks.trailing_zeros();
                peaks &= peaks - 1;
                let column = 4 * (i - 1) + bits as usize / 8;
                if column < width {
                    self.push(column, strength >> bits & 0xff, here.fall >> bits & 0xff != 0);
                }
            }
            (before, here) = (strength, next);
        }
    }

    fn push(&mut self, column: usize, strength: u32, is_falling: bool) {
        if let Some(point) = self.points.as_flattened_mut().get_mut(self.len) {
            *point = Edge::new(column as u32, strength, is_falling);
            self.len += 1;
        }
    }

    /// Finds the upright contours of four rows, by their mean.
    pub(crate) fn find_upright(&mut self, rows: [&Row<WORDS>; 4], half_support: u8, threshold: u8, width: usize) {
        let gate = splat(threshold.max(1).into());
        if half_support != 2 {
            let responses = slide(rows, half_support, width);
            return self.find(width, |i| Response { gate, ..responses[i.min(WORDS - 1)] });
        }
        let words = width.div_ceil(4) + 2;
        let rows = rows.map(|row| &row[..words]);
        let mean = |i: usize| mean_of_four(rows.map(|row| row[i]));
        // Means of each column and the next.
        let pairs = |word: u32, next: u32| signed_halved_sum(word, word >> 8 | next << 24) ^ FLIP;
        let mut word = mean(1);
        let mut before = pairs(mean(0), word);
        self.find(width, |i| {
            let next = mean(i + 1);
            let after = pairs(word, next);
            let response = Response::between(before >> 16 | after << 16, after, gate);
            (word, before) = (next, after);
            response
        });
    }

    /// Finds the lying contours between two rows: columns where the response down is an extremum down the column, from two
    /// rows above to two rows below, and along the row.
    ///
    /// - `row`: the row so far below the first of the lower side.
    pub(crate) fn find_lying<'a>(
        &mut self,
        row: impl Fn(i64) -> &'a Row<WORDS>,
        half_support: u8,
        threshold: u8,
        width: usize,
    ) {
        let threshold = splat(threshold.max(1).into());
        let words = width.div_ceil(4) + 2;
        if half_support == 2 {
            let rows = [-4, -3, -2, -1, 0, 1, 2, 3].map(|y| &row(y)[..words]);
            let pair = |y: usize, i: usize| signed_halved_sum(rows[y][i], rows[y + 1][i]) ^ FLIP;
            return self.find(width, |i| {
                let [a, b, c, d] = [pair(0, i), pair(2, i), pair(4, i), pair(6, i)];
                gated(Response::between(b, c, threshold), difference(a, b), difference(c, d))
            });
        }
        let [above, here, below] = [-2, 0, 2].map(|y| fall_through(|at| row(y + at), half_support, words));
        self.find(width, |i| gated(Response { gate: threshold, ..here[i] }, above[i].strength(), below[i].strength()));
    }

    /// Finds the upright contours of four rows by the decimated transform: the detail that is left with the approximation
    /// set to zero (the paper's eq. 1), wherever it is stronger than in the pair before, no weaker than in the pair after and
    /// reaches `threshold`.
    ///
    /// `half_support` must be a power of two: it is the number of values of which each of a pair is the mean. The wavelets
    /// do not overlap, so the contours are as coarse as their support.
    pub(crate) fn find_decimated(&mut self, rows: [&Row<WORDS>; 4], half_support: u8, threshold: u8, width: usize) {
        self.len = 0;
        let mut values = [[0i16; 4]; WORDS];
        let mut details = [[0i16; 4]; WORDS];
        for (i, values) in values.iter_mut().enumerate().skip(1) {
            *values = mean_of_four(rows.map(|row| row[i])).to_le_bytes().map(|value| i16::from(value.cast_signed()));
        }
        let (values, details) = (&mut values.as_flattened_mut()[MARGIN..], details.as_flattened_mut());
        let (mut len, mut scale) = (width, 1);
        loop {
            let mut means = [[0i16; 4]; WORDS];
            haar::forward(&values[..len], means.as_flattened_mut(), details);
            if scale >= usize::from(half_support) {
                break;
            }
            len = len.div_ceil(2);
            values[..len].copy_from_slice(&means.as_flattened()[..len]);
            scale *= 2;
        }
        let details = &details[..len / 2];
        let strength = |k: usize| details.get(k).map_or(0, |detail| detail.unsigned_abs());
        for (k, &detail) in details.iter().enumerate() {
            let here = detail.unsigned_abs();
            let before = k.checked_sub(1).map_or(0, strength);
            if here >= u16::from(threshold.max(1)) && here > before && here >= strength(k + 1) {
                self.push((2 * k + 1) * scale, u32::from(here.min(255)), detail < 0);
            }
        }
    }
}

/// A response that must be stronger than the one above and no weaker than the one below.
#[inline(always)]
fn gated(response: Response, above: u32, below: u32) -> Response {
    Response { gate: max(max(response.gate, add(above, ONES)), below), ..response }
}

/// The mean of four words, signed lanes.
#[inline(always)]
fn mean_of_four([a, b, c, d]: [u32; 4]) -> u32 {
    signed_halved_sum(signed_halved_sum(b, c), signed_halved_sum(a, d))
}

/// Steps as a word of responses.
fn steps(steps: [i32; 4]) -> Response {
    let bytes = |sign: i32| u32::from_le_bytes(steps.map(|step| u8::try_from((sign * step).max(0)).unwrap_or(u8::MAX)));
    Response { rise: bytes(1), fall: bytes(-1), gate: 0 }
}

/// Upright responses of any half-support, of the mean of four rows. Columns beside the image complete the support at its
/// border columns, as many as there are.
fn slide<const WORDS: usize>(rows: [&Row<WORDS>; 4], half_support: u8, width: usize) -> [Response; WORDS] {
    let mut line = [[0u8; 4]; WORDS];
    for (i, line) in line.iter_mut().enumerate() {
        *line = (mean_of_four(rows.map(|row| row[i])) ^ FLIP).to_le_bytes();
    }
    let s = usize::from(half_support);
    let beside = s.min(MARGIN);
    let line = &line.as_flattened()[MARGIN - beside..MARGIN + width + beside - 1];
    let mut found = [[0i32; 4]; WORDS];
    let responses = SlidingResponse::new(line, s);
    for (to, response) in found.as_flattened_mut()[MARGIN - beside + s..].iter_mut().zip(responses) {
        *to = response / i32::from(half_support);
    }
    found.map(steps)
}

/// Lying responses of any half-support between two rows; `row` gives those from the first of the lower side on.
fn fall_through<'a, const WORDS: usize>(
    row: impl Fn(i64) -> &'a Row<WORDS>,
    half_support: u8,
    words: usize,
) -> [Response; WORDS] {
    let mut sums = [[0i32; 4]; WORDS];
    for distance in 0..i64::from(half_support) {
        let (below, above) = (row(distance), row(-1 - distance));
        for ((sums, &below), &above) in sums.iter_mut().zip(below).zip(above).take(words) {
            for ((sum, below), above) in
                sums.iter_mut().zip((below ^ FLIP).to_le_bytes()).zip((above ^ FLIP).to_le_bytes())
            {
                *sum += i32::from(below) - i32::from(above);
            }
        }
    }
    sums.map(|sums| steps(sums.map(|sum| sum / i32::from(half_support))))
}
