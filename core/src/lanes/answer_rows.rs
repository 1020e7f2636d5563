//! Rows of answers, two cells a word: planes through cells, and the pixels that they make.
#![cfg_attr(haarline_dsp, expect(unsafe_code, reason = "pieces of assembly, after one check a row"))]
#![cfg_attr(
    not(haarline_dsp),
    allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "halves of words are cut out")
)]

use crate::Disparity;
#[cfg(not(haarline_dsp))]
use crate::lanes::smoothing::{blend_pair, halves, word};
#[cfg(not(haarline_dsp))]
use crate::lanes::{add_halves, signed_max_halves, splat_half, sub_halves};

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

/// The power of 2 by which the slope down, from one value to the next, is divided for half a row of pixels.
///
/// - `height`: rows of a cell, 2 or 4. A value is 16 times as fine as a disparity.
pub(crate) const fn down_bits(height: u32) -> u32 {
    5 + height / 2
}

/// Lays planes through as many pairs of cells, so many rows high, as all have: pixels, and what the next half row down has more.
#[inline(always)]
pub(crate) fn lay_planes<const HEIGHT: u32>(planes: &PlanePairs<'_>, pixels: &mut [PixelPair], downs: &mut [[i16; 2]]) {
    #[cfg(haarline_dsp)]
    {
        let [above, here, below] = planes.values.map(<[_]>::len);
        let pairs = above.min(here).min(below).min(planes.slopes.len()).min(pixels.len()).min(downs.len());
        if pairs > 0 {
            // SAFETY: all have so many.
            unsafe { super::lay_plane_pairs::<HEIGHT>(planes, pixels.as_mut_ptr(), downs.as_mut_ptr(), pairs) };
        }
    }
    #[cfg(not(haarline_dsp))]
    {
        #[cfg(haarline_sse2)]
        let done = super::x86_64::answers::lay_planes_by_fours::<HEIGHT>(planes, pixels, downs);
        #[cfg(not(haarline_sse2))]
        let done = 0;
        lay_pairs::<HEIGHT>(planes, pixels, downs, done);
    }
}

/// Lays planes through the pairs of cells from `first` on.
#[cfg(not(haarline_dsp))]
#[inline(always)]
fn lay_pairs<const HEIGHT: u32>(
    planes: &PlanePairs<'_>,
    pixels: &mut [PixelPair],
    downs: &mut [[i16; 2]],
    first: usize,
) {
    for (i, (pixels, down)) in pixels.iter_mut().zip(downs).enumerate().skip(first) {
        (*pixels, *down) = lay_pair::<HEIGHT>(planes, i);
    }
}

/// The plane through a pair of cells: its pixels, and what the next half row down has more.
#[cfg(not(haarline_dsp))]
#[inline(always)]
fn lay_pair<const HEIGHT: u32>(planes: &PlanePairs<'_>, i: usize) -> (PixelPair, [i16; 2]) {
    let [above, here, below] = planes.values.map(|row| word(row[i]));
    let across = word(planes.slopes[i].map(i16::cast_unsigned));
    let (here, down) = blend_pair(planes.same, here, above, below);
    // A quarter of the slope lies between two columns. Each is rounded on its own: so a packet tells a cell by three
    // small numbers.
    let middle = add_halves(here >> 3 & 0x1fff_1fff, splat_half(1)) >> 1 & 0x1fff_1fff;
    let [less, more] = planes.bases.map(|base| add_halves(middle, base));
    let near = divided(across, 7);
    let far = divided(add_halves(add_halves(across, across), across), 7);
    let [a, b, c, d] = [sub_halves(less, far), sub_halves(less, near), add_halves(more, near), add_halves(more, far)];
    let pixels = [[a & 0xffff | b << 16, c & 0xffff | d << 16], [a >> 16 | b & 0xffff_0000, c >> 16 | d & 0xffff_0000]];
    (pixels, halves(sub_halves(divided(down, down_bits(HEIGHT)), planes.raised)).map(u16::cast_signed))
}

/// What [`divided`] adds.
pub(crate) const fn raised(bits: u32) -> u32 {
    0x8000 >> bits
}

/// Two signed numbers divided by 2 to the power of `bits`, rounded, and [`raised`], so that neither is negative.
#[cfg(not(haarline_dsp))]
#[inline(always)]
fn divided(numbers: u32, bits: u32) -> u32 {
    add_halves(numbers, splat_half(0x8000 + (1 << (bits - 1)))) >> bits & splat_half(0xffff >> bits)
}

/// What begins at a word, so that it is written and read by whole words.
#[derive(Debug, Clone)]
#[repr(align(4))]
pub(crate) struct WordAligned<T>(pub(crate) T);

/// Writes a row of pixels, moved down by so many times the slopes of their cells, -3, -1, 1 or 3, none less than `least`, of as
/// many pairs as all have.
#[inline(always)]
pub(crate) fn write_moved<const TIMES: i32>(
    pixels: &[PixelPair],
    slopes: &[[i16; 2]],
    least: u32,
    out: &mut [[[Disparity; 4]; 2]],
) {
    #[cfg(haarline_dsp)]
    {
        let pairs = pixels.len().min(slopes.len()).min(out.len());
        let out: *mut u32 = out.as_mut_ptr().cast();
        crate::lanes::demand(out.is_aligned());
        if pairs > 0 {
            // SAFETY: all have so many; the disparities are 16 bits each, of any value, and aligned.
            unsafe { super::write_moved_pairs::<TIMES>(pixels.as_ptr(), slopes.as_ptr(), least, out, pairs) };
        }
    }
    #[cfg(not(haarline_dsp))]
    {
        #[cfg(haarline_sse2)]
        let done = super::x86_64::answers::write_moved_by_fours::<TIMES>(pixels, slopes, least, out);
        #[cfg(not(haarline_sse2))]
        let done = 0;
        write_pairs::<TIMES>(pixels, slopes, least, out, done);
    }
}

/// Writes the pairs from `first` on.
#[cfg(not(haarline_dsp))]
#[inline(always)]
fn write_pairs<const TIMES: i32>(
    pixels: &[PixelPair],
    slopes: &[[i16; 2]],
    least: u32,
    out: &mut [[[Disparity; 4]; 2]],
    first: usize,
) {
    for ((pixels, slopes), out) in pixels.iter().zip(slopes).zip(out).skip(first) {
        for ((pixels, &slope), out) in pixels.iter().zip(slopes).zip(out) {
            let down = splat_half((TIMES * i32::from(slope)).cast_unsigned() & 0xffff);
            let [a, b] = pixels.map(|pair| signed_max_halves(add_halves(pair, down), least));
            *out = [a, a >> 16, b, b >> 16].map(|bits| Disparity::from_bits(bits as u16 as i16));
        }
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

#[cfg(all(test, haarline_sse2))]
mod tests {
    use super::*;

    const PAIRS: usize = 19;

    /// Numbers of all kinds.
    fn numbers(seed: &mut u32) -> [[u16; 2]; PAIRS] {
        [[0; 2]; PAIRS].map(|pair| {
            pair.map(|_: u16| {
                let number = (crate::random::next(seed) >> 8) as u16;
                // Many near each other, so that they are one surface.
                if *seed >> 31 == 0 { 0x3000 + number % 500 } else { number }
            })
        })
    }

    fn slopes(seed: &mut u32) -> [[i16; 2]; PAIRS] {
        numbers(seed).map(|pair| pair.map(|number| number.cast_signed() >> 4))
    }

    fn check_planes<const HEIGHT: u32>(seed: &mut u32, pairs: usize) {
        let [above, here, below] = [0; 3].map(|_: u32| numbers(seed));
        let slopes = slopes(seed);
        let planes = PlanePairs {
            values: [&above[..pairs], &here[..pairs], &below[..pairs]],
            slopes: &slopes[..pairs],
            same: splat_half(383),
            bases: [0x0123_0123, 0xfe76_fe76],
            raised: splat_half(raised(down_bits(HEIGHT))),
        };
        let mut found = ([[[7; 2]; 2]; PAIRS], [[7; 2]; PAIRS]);
        let mut wanted = found;
        lay_planes::<HEIGHT>(&planes, &mut found.0[..pairs], &mut found.1[..pairs]);
        lay_pairs::<HEIGHT>(&planes, &mut wanted.0[..pairs], &mut wanted.1[..pairs], 0);
        assert_eq!(found, wanted);
    }

    fn check_written<const TIMES: i32>(seed: &mut u32, pairs: usize) {
        let pixels = [0; PAIRS].map(|_: u32| [0; 2].map(|_: u32| [0; 2].map(|_: u32| word(numbers(seed)[0]))));
        let slopes = slopes(seed);
        let least = splat_half(0xff00);
        let mut found = [[[Disparity::UNKNOWN; 4]; 2]; PAIRS];
        let mut wanted = found;
        write_moved::<TIMES>(&pixels[..pairs], &slopes[..pairs], least, &mut found[..pairs]);
        write_pairs::<TIMES>(&pixels[..pairs], &slopes[..pairs], least, &mut wanted[..pairs], 0);
        assert!(found.as_flattened().iter().flatten().eq(wanted.as_flattened().iter().flatten()));
    }

    #[test]
    fn pairs_side_by_side_are_as_one_by_one() {
        let mut seed = 1;
        for pairs in (0..=PAIRS).cycle().take(20 * PAIRS) {
            check_planes::<2>(&mut seed, pairs);
            check_planes::<4>(&mut seed, pairs);
            check_written::<-3>(&mut seed, pairs);
            check_written::<-1>(&mut seed, pairs);
            check_written::<1>(&mut seed, pairs);
            check_written::<3>(&mut seed, pairs);
        }
    }
}
