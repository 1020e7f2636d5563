//! One row of the rectified stereo pair.

/// The same row of both rectified views: matching points lie in one scanline,
/// at `x_right = x_left - disparity`.
#[derive(Debug, Clone, Copy)]
pub struct ScanlinePair<'a> {
    /// 8-bit luma of the left view, left to right.
    pub left: &'a [u8],
    /// 8-bit luma of the right view, left to right, as many pixels as `left`.
    pub right: &'a [u8],
}
