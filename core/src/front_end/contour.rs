//! Contours: the extrema of the Haar response along a line, the only source of candidates.

use crate::count;
use crate::front_end::haar::{self, SlidingResponse};
use crate::matching::extremum::parabola;

/// A contour point: an extremum of the sliding Haar response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Contour {
    /// Column of the extremum, 1/16 px; the edge lies half a pixel before it.
    pub column: i16,
    /// Haar response there: positive from dark to bright. Its magnitude is the strength.
    pub response: i16,
}

impl Contour {
    /// Whether two contours may be the same edge seen twice: the same polarity, and strengths
    /// within a ratio of 3 to 2.
    #[must_use]
    pub const fn resembles(self, other: Self) -> bool {
        if (self.response > 0) != (other.response > 0) {
            return false;
        }
        let (a, b) = (self.response.unsigned_abs() as u32, other.response.unsigned_abs() as u32);
        2 * a <= 3 * b && 2 * b <= 3 * a
    }
}

/// The contours of one line, at most one in two columns, left to right.
#[derive(Debug, Clone)]
pub(crate) struct ContourLine<const BLOCKS: usize> {
    points: [[Contour; 2]; BLOCKS],
    len: usize,
}

impl<const BLOCKS: usize> ContourLine<BLOCKS> {
    pub(crate) const fn new() -> Self {
        Self { points: [[Contour { column: 0, response: 0 }; 2]; BLOCKS], len: 0 }
    }

    pub(crate) fn as_slice(&self) -> &[Contour] {
        self.points.as_flattened().get(..self.len).unwrap_or(&[])
    }

    /// Finds the contours of `line`, whose values must be below 2^13 and at most `16 * BLOCKS`:
    /// columns where the response of `half_support` reaches `threshold` and is stronger than at the
    /// column before and no weaker than at the one after. `first_column` is the image's column of the
    /// line's first value.
    pub(crate) fn find(&mut self, line: &[u16], first_column: i32, half_support: u8, threshold: i32) {
        self.len = 0;
        let mut responses = SlidingResponse::new(line, usize::from(half_support));
        let (Some(mut before), Some(mut here)) = (responses.next(), responses.next()) else { return };
        // The first response belongs to the line's value number `half_support`; this is the second.
        let mut column = 16 * (first_column + i32::from(half_support) + 1);
        // A running sum in two halves, its magnitude, the threshold and two neighbours.
        count::additions(2 * line.len());
        count::subtractions(4 * line.len());
        count::comparisons(4 * line.len());
        for after in responses {
            let (a, b, c) = (before.abs(), here.abs(), after.abs());
            if b >= threshold && b > a && b >= c {
                let sign = here.signum();
                let at = column + parabola(-before * sign, -b, -after * sign);
                self.push(at, here);
            }
            (before, here) = (here, after);
            column += 16;
        }
    }

    /// Finds the contours of `line`, whose values must be below 2^10, by the decimated transform: the
    /// detail that is left with the approximation set to zero (the paper's eq. 1), wherever it is stronger
    /// than in the pair before, no weaker than in the pair after and reaches `threshold`.
    ///
    /// `half_support` must be a power of two: it is the number of values of which each of a pair is the
    /// mean. The wavelets do not overlap, so the contours are as coarse as their support.
    pub(crate) fn find_decimated(&mut self, line: &[u16], half_support: u8, threshold: i32) {
        self.len = 0;
        let mut values = [[0i16; 4]; BLOCKS];
        let mut details = [[0i16; 4]; BLOCKS];
        let (values, details) = (values.as_flattened_mut(), details.as_flattened_mut());
        for (to, &from) in values.iter_mut().zip(line) {
            *to = i16::try_from(from).unwrap_or(i16::MAX);
        }
        let (mut len, mut scale) = (line.len().min(values.len()), 1);
        loop {
            let mut means = [[0i16; 4]; BLOCKS];
            let level = values.get(..len).unwrap_or(&[]);
            haar::forward(level, means.as_flattened_mut(), details);
            count::additions(len / 2);
            count::subtractions(len / 2);
            if scale >= half_support {
                break;
            }
            values.copy_from_slice(means.as_flattened());
            (len, scale) = (len.div_ceil(2), scale.saturating_mul(2));
        }
        let details = details.get(..len / 2).unwrap_or(&[]);
        let scale = i32::from(half_support);
        let mut column = 16 * scale; // of the first pair's middle
        for k in 0..details.len() {
            let at = |k: Option<usize>| k.and_then(|k| details.get(k)).map_or(0, |&d| i32::from(d));
            let [before, here, after] = [k.checked_sub(1), Some(k), Some(k + 1)].map(|k| at(k) * scale);
            let (a, b, c) = (before.abs(), here.abs(), after.abs());
            if b >= threshold && b > a && b >= c {
                self.push(column, here);
            }
            column += 32 * scale;
        }
        count::subtractions(details.len());
        count::comparisons(4 * details.len());
    }

    /// Finds the lying contours that cross a row: columns where the response along the column, one row
    /// above, at the row and one below, has its extremum at the row and along the row, too.
    ///
    /// - `responses`: of the rows, without margins, within +-4080; the middle one must reach `threshold`.
    pub(crate) fn find_lying(&mut self, responses: [&[i16]; 3], threshold: i32) {
        self.len = 0;
        let [above, row, below] = responses;
        let columns = above.iter().zip(row).zip(below);
        let columns = columns.map(|((&a, &b), &c)| [a, b, c].map(i32::from));
        let nothing = [[0; 3]; 1];
        let (mut before, mut here) = (0, [0; 3]);
        // One column late, since the one after must be known.
        for (column, next) in (-16..).step_by(16).zip(columns.chain(nothing)) {
            let [above, response, below] = here;
            let [strength, after] = [response, next[1]].map(i32::abs);
            let is_peak_down = strength >= threshold && strength > above.abs() && strength >= below.abs();
            if is_peak_down && strength > before && strength >= after {
                self.push(column + parabola(-before, -strength, -after), response);
            }
            (before, here) = (strength, next);
        }
        count::subtractions(3 * row.len());
        count::comparisons(8 * row.len());
    }

    fn push(&mut self, column: i32, response: i32) {
        let (Ok(column), Ok(response)) = (i16::try_from(column), i16::try_from(response)) else { return };
        if let Some(point) = self.points.as_flattened_mut().get_mut(self.len) {
            *point = Contour { column, response };
            self.len += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    fn contours(line: &[u16]) -> Vec<(i16, i16)> {
        let mut found = ContourLine::<16>::new();
        found.find(line, 0, 2, 8);
        found.as_slice().iter().map(|c| (c.column, c.response)).collect()
    }

    #[test]
    fn a_step_is_one_contour_at_its_first_changed_column() {
        let up: Vec<u16> = (0..32).map(|x| if x < 12 { 0 } else { 50 }).collect();
        assert_eq!(contours(&up), [(16 * 12, 100)]);
        let down: Vec<u16> = up.iter().map(|v| 50 - v).collect();
        assert_eq!(contours(&down), [(16 * 12, -100)]);
    }

    #[test]
    fn a_constant_line_and_a_faint_step_have_none() {
        assert_eq!(contours(&[77; 32]), []);
        let faint: Vec<u16> = (0..32).map(|x| if x < 12 { 10 } else { 13 }).collect();
        assert_eq!(contours(&faint), []);
    }

    #[test]
    fn the_decimated_transform_finds_a_step_within_its_pair() {
        for (half_support, step, column) in [(1, 13, 13), (2, 14, 14), (4, 12, 12), (8, 8, 8)] {
            let line: Vec<u16> = (0..32).map(|x| if x < step { 40 } else { 90 }).collect();
            let mut found = ContourLine::<8>::new();
            found.find_decimated(&line, half_support, 8);
            let wanted = Contour { column: 16 * column, response: 50 * i16::from(half_support) };
            assert_eq!(found.as_slice(), [wanted], "half-support {half_support}");
        }
    }

    #[test]
    fn a_lying_contour_is_where_the_response_peaks_down_and_across() {
        let mut found = ContourLine::<8>::new();
        let row = [0, 10, 40, 10, 0, -30, -60, -30, 0, 9];
        let weak = row.map(|v| v / 2);
        found.find_lying([&weak, &row, &weak], 10);
        let points: Vec<(i16, i16)> = found.as_slice().iter().map(|c| (c.column, c.response)).collect();
        assert_eq!(points, [(2 * 16, 40), (6 * 16, -60)]);
        found.find_lying([&row, &row, &weak], 10);
        assert!(found.as_slice().is_empty(), "as strong one row above");
    }

    #[test]
    fn no_line_has_more_contours_than_half_its_columns() {
        for seed in 0..50u32 {
            let mut state = seed;
            let line: Vec<u16> = (0..64)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    u16::from((state >> 24) as u8) * 4
                })
                .collect();
            let found = contours(&line);
            assert!(found.len() <= 32 && found.windows(2).all(|w| w[0].0 < w[1].0), "{found:?}");
        }
    }
}
