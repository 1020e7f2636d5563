//! Rows of answers, two cells a word: planes through cells, and the pixels that they make.
#![cfg_attr(haarline_dsp, expect(unsafe_code, reason = "pieces of assembly, after one check a row"))]

use crate::Disparity;

/// Disparities of two cells in the middle of their rows, the columns 0, 1 and 2, 3 of each, two in a word.
pub(crate) type PixelPair = [[u32; 2]; 2];

/// What planes are laid through: two cells a word.
pub(crate) struct PlanePairs<'a> {
    /// Values of the cells above, of the cells themselves, and of those below.
    pub(crate) values: [&'a [[u16; 2]]; 3],
    /// Slopes of the cells along the row, far from the ends of 16 bits.
    pub(crate) slopes: &'a [[i16; 2]],
    /// Most that values differ by on one surface, in both halves.
    pub(crate) same: u32,
    /// What is added to the middle of a cell for its left and its right columns, in both halves.
    pub(crate) bases: [u32; 2],
    /// What slopes down are raised by, in both halves.
    pub(crate) raised: u32,
}

/// Lays planes through as many pairs as all have: pixels, and what the lower row has more. How many were laid.
#[inline(always)]
pub(crate) fn lay_planes(planes: &PlanePairs<'_>, pixels: &mut [PixelPair], downs: &mut [[i16; 2]]) -> usize {
    #[cfg(haarline_dsp)]
    {
        let [above, here, below] = planes.values.map(<[_]>::len);
        let pairs = above.min(here).min(below).min(planes.slopes.len()).min(pixels.len()).min(downs.len());
        if pairs > 0 {
            // SAFETY: all have so many.
            unsafe { super::lay_plane_pairs(planes, pixels.as_mut_ptr(), downs.as_mut_ptr(), pairs) };
        }
        pairs
    }
    #[cfg(not(haarline_dsp))]
    {
        let _ = (planes, pixels, downs);
        0
    }
}

/// What begins at a word, so that it is written and read by whole words.
#[derive(Debug, Clone)]
#[repr(align(4))]
pub(crate) struct WordAligned<T>(pub(crate) T);

/// Writes a row of pixels, moved down or up by the slopes of their cells, none less than `least`, of as many pairs as all
/// have. How many were written: none where there is no quicker way than one by one.
#[inline(always)]
pub(crate) fn write_moved<const DOWN: bool>(
    pixels: &[PixelPair],
    slopes: &[[i16; 2]],
    least: u32,
    out: &mut [[[Disparity; 4]; 2]],
) -> usize {
    #[cfg(haarline_dsp)]
    {
        let pairs = pixels.len().min(slopes.len()).min(out.len());
        let out: *mut u32 = out.as_mut_ptr().cast();
        if pairs == 0 || !out.is_aligned() {
            return 0;
        }
        // SAFETY: all have so many; the disparities are 16 bits each, of any value, and aligned.
        unsafe { super::write_moved_pairs::<DOWN>(pixels.as_ptr(), slopes.as_ptr(), least, out, pairs) };
        pairs
    }
    #[cfg(not(haarline_dsp))]
    {
        let _ = (pixels, slopes, least, out);
        0
    }
}

/// Copies as many as both have.
#[inline(always)]
pub(crate) fn copy<T: Copy>(from: &[T], to: &mut [T]) {
    let len = from.len().min(to.len());
    #[cfg(haarline_dsp)]
    let done = {
        let (from, to): (*const u32, *mut u32) = (from.as_ptr().cast(), to.as_mut_ptr().cast());
        let eights = len * size_of::<T>() / 32;
        if eights > 0 && from.is_aligned() && to.is_aligned() && 32 % size_of::<T>() == 0 {
            // SAFETY: aligned, and both have so many bytes, of whole values.
            unsafe { super::copy_eights(from, to, eights) };
            eights * 32 / size_of::<T>()
        } else {
            0
        }
    };
    #[cfg(not(haarline_dsp))]
    let done = 0;
    to[done..len].copy_from_slice(&from[done..len]);
}
