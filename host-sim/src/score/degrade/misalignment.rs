//! A right camera that stands otherwise than the left one: what a rig's screws do.

use serde::Serialize;

use crate::Frame;

/// How the right view is displaced. All of it at once is one resampling, bilinear, of pixels that replicate the
/// border's beyond it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Misalignment {
    /// What the left view shows in a row, the right one shows so many rows lower.
    pub row_offset: f64,
    /// The right view's content is turned clockwise about its centre, degrees.
    pub roll: f64,
    /// The right view's content is so many times as high, about its centre.
    pub row_scale: f64,
}

impl Misalignment {
    /// A camera in its place.
    pub const NONE: Self = Self { row_offset: 0.0, roll: 0.0, row_scale: 1.0 };

    /// What the camera sees, grey levels; the rows of `frame` as they are if it is in its place.
    #[must_use]
    pub fn resample(&self, frame: &Frame) -> Vec<f64> {
        if *self == Self::NONE {
            return frame.luma.iter().map(|&pixel| f64::from(pixel)).collect();
        }
        let (sin, cos) = self.roll.to_radians().sin_cos();
        let centre = [frame.width, frame.height].map(|size| (size as f64 - 1.0) / 2.0);
        let pixels = (0..frame.height).flat_map(|y| (0..frame.width).map(move |x| [x as f64, y as f64]));
        let seen = pixels.map(|[x, y]| {
            // Back from where it is seen to where it was: offset, scale, turn.
            let (right, down) = (x - centre[0], (y - self.row_offset - centre[1]) / self.row_scale);
            interpolate(frame, [centre[0] + cos * right + sin * down, centre[1] - sin * right + cos * down])
        });
        seen.collect()
    }
}

/// The frame at `[x, y]`, px from the centre of its first pixel.
fn interpolate(frame: &Frame, [x, y]: [f64; 2]) -> f64 {
    let place = |at: f64, size: usize| {
        let at = at.clamp(0.0, size as f64 - 1.0);
        let first = at.floor() as usize;
        (first, (first + 1).min(size - 1), at - at.floor())
    };
    let ((left, right, across), (above, below, down)) = (place(x, frame.width), place(y, frame.height));
    let in_row = |y: usize| {
        let row = frame.row(y);
        let [left, right] = [row[left], row[right]].map(f64::from);
        left + across * (right - left)
    };
    let [above, below] = [above, below].map(in_row);
    above + down * (below - above)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grey levels that tell their place: one a row, or one a column.
    fn frame(of: fn(usize, usize) -> u8) -> Frame {
        Frame::from_luma(41, 21, (0..41 * 21).map(|index| of(index % 41, index / 41)).collect())
    }

    fn seen(misalignment: Misalignment, of: fn(usize, usize) -> u8, [x, y]: [usize; 2]) -> f64 {
        misalignment.resample(&frame(of))[y * 41 + x]
    }

    #[test]
    fn a_row_offset_shows_rows_lower_and_replicates_the_border() {
        let rows = |_: usize, y: usize| 10 * y as u8;
        let at = |row_offset, y| seen(Misalignment { row_offset, ..Misalignment::NONE }, rows, [5, y]);
        assert_eq!([at(3.0, 10), at(3.0, 2), at(-2.5, 10), at(-2.5, 19)], [70.0, 0.0, 125.0, 200.0]);
    }

    #[test]
    fn a_roll_turns_clockwise() {
        let roll = Misalignment { roll: 90.0, ..Misalignment::NONE };
        // What was 5 px right of the centre is seen 5 px below it.
        let at = seen(roll, |x, _| x as u8, [20, 15]);
        assert!((at - 25.0).abs() < 1e-9, "{at}");
        let small = Misalignment { roll: 1.0, ..Misalignment::NONE };
        let at = seen(small, |_, y| 10 * y as u8, [40, 10]);
        assert!((at - (100.0 - 200.0 * 1_f64.to_radians().sin())).abs() < 1e-9, "{at}");
    }

    #[test]
    fn a_row_scale_moves_rows_away_from_the_centre() {
        let scale = Misalignment { row_scale: 1.25, ..Misalignment::NONE };
        let at = |y| seen(scale, |_, y| 10 * y as u8, [9, y]);
        assert_eq!([at(10), at(20), at(5)], [100.0, 180.0, 60.0]);
    }
}
