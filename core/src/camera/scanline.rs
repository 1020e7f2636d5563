//! One row of the rectified stereo pair.

use crate::RowError;

/// The same row of both rectified views: matching points lie in one scanline,
/// at `x_right = x_left - disparity`.
#[derive(Debug, Clone, Copy)]
pub struct ScanlinePair<'a> {
    /// 8-bit luma of the left view, left to right.
    pub left: &'a [u8],
    /// 8-bit luma of the right view, left to right, as many pixels as `left`.
    pub right: &'a [u8],
}

impl ScanlinePair<'_> {
    /// Checks that both views have `width` pixels.
    ///
    /// # Errors
    /// If one has not.
    pub const fn check(&self, width: u16) -> Result<(), RowError> {
        let expected = width as usize;
        let found = if self.left.len() == expected { self.right.len() } else { self.left.len() };
        if found == expected { Ok(()) } else { Err(RowError::Width { expected: width, found }) }
    }
}
