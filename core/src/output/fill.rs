//! Optional: answers for holes, from what lies beside them.

use crate::Disparity;

/// Fills the holes of a disparity row: each unknown pixel takes the smaller, so farther, of the next
/// known disparities left and right of it, since what one camera cannot see is mostly background; at
/// the borders the only one there is. Filled pixels have confidence 1, the least.
///
/// These are guesses, not measurements: use them for pictures, not to tell that the way is free. A row
/// without any known pixel stays unknown.
///
/// - `disparity`, `confidence`: one row, as many of both.
///
/// # Examples
/// ```
/// use haarline::{Disparity, fill_holes};
/// let [far, near, hole] = [Disparity::from_px(3), Disparity::from_px(20), Disparity::UNKNOWN];
/// let (mut disparity, mut confidence) = ([far, hole, hole, near, hole], [200, 0, 0, 90, 0]);
/// fill_holes(&mut disparity, &mut confidence);
/// assert_eq!(disparity, [far, far, far, near, near]);
/// assert_eq!(confidence, [200, 1, 1, 90, 1]);
/// ```
pub fn fill_holes(disparity: &mut [Disparity], confidence: &mut [u8]) {
    let mut left = None;
    let mut x = 0;
    while x < disparity.len() {
        let hole = disparity.iter().skip(x).take_while(|d| !d.is_known()).count();
        let right = disparity.get(x + hole).copied();
        let filling = match (left, right) {
            (Some(a), Some(b)) => Some(farther(a, b)),
            (one, other) => one.or(other),
        };
        if let (Some(filling), Some(pixels), Some(confidence)) =
            (filling, disparity.get_mut(x..x + hole), confidence.get_mut(x..x + hole))
        {
            pixels.fill(filling);
            confidence.fill(1);
        }
        left = right.or(left);
        x += hole + 1;
    }
}

fn farther(a: Disparity, b: Disparity) -> Disparity {
    if a.into_bits() <= b.into_bits() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_without_any_answer_stays_unknown() {
        let (mut disparity, mut confidence) = ([Disparity::UNKNOWN; 4], [0; 4]);
        fill_holes(&mut disparity, &mut confidence);
        assert_eq!((disparity, confidence), ([Disparity::UNKNOWN; 4], [0; 4]));
    }

    #[test]
    fn known_pixels_stay_and_a_hole_at_the_border_takes_its_only_neighbour() {
        let px = Disparity::from_px;
        let hole = Disparity::UNKNOWN;
        let (mut disparity, mut confidence) = ([hole, hole, px(9), hole, px(-2), px(5)], [0, 0, 7, 0, 8, 9]);
        fill_holes(&mut disparity, &mut confidence);
        assert_eq!(disparity, [px(9), px(9), px(9), px(-2), px(-2), px(5)]);
        assert_eq!(confidence, [1, 1, 7, 1, 8, 9]);
    }
}
