//! Contours: the extrema of the Haar response along a line, the only source of candidates.

use crate::extremum::parabola;
use crate::haar::SlidingResponse;

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
