//! Pixels of two sensors with seven lines each, a word of 16 bits for a pixel of both.
#![cfg_attr(haarline_dsp, expect(unsafe_code, reason = "a piece of assembly, after one check a row"))]

/// Parts as many eights of pixels as all three hold: of each word of 16 bits, little-endian, the lowest seven bits are the
/// highest of a pixel for `first`, the next seven those of one for `second`. How many pixels were parted: none where there is
/// no quicker way than the portable one.
#[inline(always)]
pub(crate) fn part_eights(raw: &[u8], first: &mut [u8], second: &mut [u8]) -> usize {
    #[cfg(haarline_dsp)]
    {
        let eights = (raw.len() / 16).min(first.len() / 8).min(second.len() / 8);
        let (raw, first, second): (*const u32, *mut u32, *mut u32) =
            (raw.as_ptr().cast(), first.as_mut_ptr().cast(), second.as_mut_ptr().cast());
        if eights == 0 || !(raw.is_aligned() && first.is_aligned() && second.is_aligned()) {
            return 0;
        }
        // SAFETY: aligned, and all have so many.
        unsafe { super::part_sevens(raw, first, second, eights) };
        8 * eights
    }
    #[cfg(not(haarline_dsp))]
    {
        let _ = (raw, first, second);
        0
    }
}
