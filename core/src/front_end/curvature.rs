//! Points of maximum curvature: where a contour that goes on from row to row bends most.
//!
//! The paper names them beside contours as features to be matched (S2b). A contour is linked to the nearest
//! one of its polarity in the row above and in the row below; the bend is the second difference of its column
//! over the three rows, the pair difference of pair differences.

use crate::front_end::contour::Contour;
use crate::front_end::haar::difference_121;

/// Columns between rows by which a contour may move and still be the same one, 1/16 px.
const MOST_MOVE: i32 = 3 * 16;

/// A contour point that bends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CurvaturePoint {
    /// Index of the contour in its row.
    pub index: usize,
    /// Second difference of its column over three rows, 1/16 px: positive where it bulges to the left.
    pub bend: i32,
}

/// The contours of `row` that bend by `least` / 16 px or more, given those of the rows above and below, each
/// from left to right.
///
/// The rows may be any distance apart, the same above and below. A contour without a neighbour of its
/// polarity within 3 px in either row is none.
///
/// # Examples
/// ```
/// use haarline::contour::Contour;
/// use haarline::curvature::curvature;
/// let at = |column: i16| [Contour { column: 16 * column, response: 90 }];
/// let bends = |above, row, below| curvature(&at(above), &at(row), &at(below), 16).map(|p| p.bend).next();
/// assert_eq!(bends(10, 11, 12), None); // a slanted line is straight
/// assert_eq!(bends(12, 10, 12), Some(4 * 16));
/// ```
pub fn curvature<'a>(
    above: &'a [Contour],
    row: &'a [Contour],
    below: &'a [Contour],
    least: i32,
) -> impl Iterator<Item = CurvaturePoint> + 'a {
    let (mut first_above, mut first_below) = (0, 0);
    row.iter().enumerate().filter_map(move |(index, contour)| {
        let a = follow(contour, above, &mut first_above)?;
        let c = follow(contour, below, &mut first_below)?;
        let bend = difference_121(a, i32::from(contour.column), c);
        (bend.abs() >= least).then_some(CurvaturePoint { index, bend })
    })
}

/// Column of the nearest contour in `line` that goes on from `contour`; `first` is where to look from.
fn follow(contour: &Contour, line: &[Contour], first: &mut usize) -> Option<i32> {
    let column = i32::from(contour.column);
    // Contours come from left to right, so nobody looks further left than this again.
    while line.get(*first).is_some_and(|other| i32::from(other.column) < column - MOST_MOVE) {
        *first += 1;
    }
    let near = line.get(*first..)?.iter().take_while(|other| i32::from(other.column) <= column + MOST_MOVE);
    let same = near.inspect(|_| {});
    let same = same.filter(|other| (other.response > 0) == (contour.response > 0));
    same.map(|other| i32::from(other.column)).min_by_key(|other| other.abs_diff(column))
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    fn line(columns: &[i16]) -> Vec<Contour> {
        columns.iter().map(|&c| Contour { column: c, response: if c % 2 == 0 { 50 } else { -50 } }).collect()
    }

    fn points(above: &[i16], row: &[i16], below: &[i16]) -> Vec<(usize, i32)> {
        curvature(&line(above), &line(row), &line(below), 8).map(|point| (point.index, point.bend)).collect()
    }

    #[test]
    fn only_the_contour_that_bends_is_a_point() {
        assert_eq!(points(&[100, 200, 300], &[110, 190, 300], &[120, 200, 300]), [(1, 20)]);
        assert_eq!(points(&[200], &[210], &[200]), [(0, -20)]);
    }

    #[test]
    fn a_contour_that_ends_or_changes_polarity_is_none() {
        assert_eq!(points(&[100], &[110], &[]), []);
        assert_eq!(points(&[100], &[110], &[101]), []);
        assert_eq!(points(&[100], &[160], &[100]), [], "60 / 16 px away");
        assert_eq!(points(&[], &[], &[]), []);
    }

    #[test]
    fn the_nearest_of_several_goes_on() {
        assert_eq!(points(&[70, 96, 130], &[100], &[80, 104, 140]), []);
        assert_eq!(points(&[70, 130], &[100], &[104]), [(0, -26)]);
    }
}
