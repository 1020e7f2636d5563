//! Disparity in fixed point, and the rows of it that a method delivers.

use crate::lanes::answer_rows::copy;

/// Disparity `x_left - x_right` in 1/16 px, the format of OpenCV's StereoBM, or unknown.
///
/// Larger is nearer. 0 is a point at infinity for parallel cameras, negative values lie behind
/// infinity (they occur with toed-in or uncalibrated cameras). *Unknown* is a value of its own and
/// never compares equal to any of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Disparity(i16);

impl Disparity {
    /// Fractional bits: one step is 1/16 px.
    pub const FRAC_BITS: u32 = 4;

    /// No measurement. Not zero: zero is far away.
    pub const UNKNOWN: Self = Self(i16::MIN);

    /// From raw 1/16 px steps; `i16::MIN` is [`Disparity::UNKNOWN`].
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: i16) -> Self {
        Self(bits)
    }

    /// The raw value: 1/16 px steps, `i16::MIN` for unknown.
    #[inline]
    #[must_use]
    pub const fn into_bits(self) -> i16 {
        self.0
    }

    /// From whole pixels.
    ///
    /// # Panics
    /// If `px` is not within `-2047..=2047`.
    #[inline]
    #[must_use]
    pub const fn from_px(px: i16) -> Self {
        assert!(-2048 < px && px < 2048, "a disparity has 11 bits before the point");
        Self(px << Self::FRAC_BITS)
    }

    /// Whether there is a measurement.
    #[inline]
    #[must_use]
    pub const fn is_known(self) -> bool {
        self.0 != i16::MIN
    }

    /// The measurement in raw 1/16 px steps, if there is one.
    #[inline]
    #[must_use]
    pub const fn known(self) -> Option<i16> {
        if self.is_known() { Some(self.0) } else { None }
    }
}

/// One row of the disparity map of the left view.
#[derive(Debug, Clone, Copy)]
pub struct DisparityRow<'a> {
    /// Row of the image, from 0 at the top.
    pub y: u32,
    /// Disparity of each pixel of the left view, as many as the scanline has.
    pub disparity: &'a [Disparity],
    /// Confidence of each pixel: 0 where the disparity is unknown, 1 to 15 for a guess (hidden in the right view, or
    /// nothing to see), 16 to 63 doubtful, 64 and more *sure*.
    ///
    /// In [`Full`](crate::Full), [`Lite`](crate::Lite) and [`WaveletBlock`](crate::WaveletBlock) an answer is sure if it stands out from the others by its margin less
    /// its cost, over 3 x 3 cells, and if the left row does not look like itself there: 4 and 8 px beside, at the
    /// next like contour, and for the second best partner of the nearest contour. What is not sure is ranked by its margin
    /// alone. It ranks answers; it is no probability. In the other methods it is a margin, 1 to 255.
    pub confidence: &'a [u8],
}

impl DisparityRow<'_> {
    /// Copies the row, as far as there is room, in fewer instructions than by `memcpy` where both ends lie at words.
    pub fn copy_to(&self, disparity: &mut [Disparity], confidence: &mut [u8]) {
        copy(self.disparity, disparity);
        copy(self.confidence, confidence);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_away_is_known_and_not_the_same_as_unknown() {
        assert_eq!(Disparity::from_px(0).known(), Some(0));
        assert_ne!(Disparity::from_px(0), Disparity::UNKNOWN);
        assert_eq!(Disparity::UNKNOWN.known(), None);
        assert!(!Disparity::UNKNOWN.is_known());
    }

    #[test]
    fn every_whole_pixel_in_range_is_known_and_sixteen_steps() {
        for px in -2047..=2047 {
            assert_eq!(Disparity::from_px(px).known(), Some(16 * px), "{px}");
        }
    }
}
