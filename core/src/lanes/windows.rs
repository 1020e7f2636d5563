//! Windows of a row or of several, at any byte, and what they differ by.
#![expect(unsafe_code, reason = "words at byte offsets that are no multiple of four, without a check for each")]

use core::ops::Range;

use super::rows::word;
#[cfg(haarline_sse2)]
use super::x86_64::tile::tile_sads;
use super::{demand, sad, sad_add};

/// Sums of absolute differences of the four cells of a tile, 4 x 2 px each: left and right of the upper two rows, then of the
/// lower two.
///
/// - `left`: first word of the tile; `right`: first byte of what it is compared with.
#[inline(always)]
pub(crate) fn tile_sad<const BLOCKS: usize>(
    left_rows: &[[u32; BLOCKS]; 4],
    left: usize,
    right_rows: &[[u32; BLOCKS]; 4],
    right: usize,
) -> [u32; 4] {
    demand(left + 2 <= BLOCKS && right + 8 <= 4 * BLOCKS);
    #[cfg(haarline_dsp)]
    if BLOCKS <= super::MOST_TILE_SAD_WORDS {
        let (first, other) = (left_rows.as_flattened().as_ptr(), right_rows.as_flattened().as_ptr());
        // SAFETY: checked above; the four rows lie one behind the other.
        return unsafe { super::tile_sad_words::<BLOCKS>(first.add(left), other.cast::<u8>().add(right)) };
    }
    #[cfg(haarline_sse2)]
    {
        // SAFETY: checked above.
        let [[upper, lower]] = unsafe { tile_sads(left_rows, left, right_rows, right) };
        [upper & 0xffff, upper >> 16, lower & 0xffff, lower >> 16]
    }
    #[cfg(not(haarline_sse2))]
    tile_sad_by_words(left_rows, left, right_rows, right)
}

/// [`tile_sad`] by words.
#[cfg(not(haarline_sse2))]
#[inline(always)]
fn tile_sad_by_words<const BLOCKS: usize>(
    left_rows: &[[u32; BLOCKS]; 4],
    left: usize,
    right_rows: &[[u32; BLOCKS]; 4],
    right: usize,
) -> [u32; 4] {
    demand(left + 2 <= BLOCKS && right + 8 <= 4 * BLOCKS);
    let mut sums = [0; 4];
    for (y, (a, b)) in left_rows.iter().zip(right_rows).enumerate() {
        // SAFETY: checked above.
        let (first, second) = unsafe { (word(b, right), word(b, right + 4)) };
        let cells = 2 * (y / 2);
        sums[cells] = sad_add(a[left], first, sums[cells]);
        sums[cells + 1] = sad_add(a[left + 1], second, sums[cells + 1]);
    }
    sums
}

/// [`tile_sad`] at three windows, each a byte further right; the two cells of either row of cells in a word.
///
/// - `left`: first word of the tile; `right`: first byte of the first window.
#[inline(always)]
pub(crate) fn tile_sads_around<const BLOCKS: usize>(
    left_rows: &[[u32; BLOCKS]; 4],
    left: usize,
    right_rows: &[[u32; BLOCKS]; 4],
    right: usize,
) -> [[u32; 2]; 3] {
    demand(left + 2 <= BLOCKS && right + 10 <= 4 * BLOCKS);
    #[cfg(haarline_dsp)]
    if BLOCKS <= super::MOST_TILE_SAD_WORDS {
        let (first, other) = (left_rows.as_flattened().as_ptr(), right_rows.as_flattened().as_ptr());
        // SAFETY: checked above; the four rows lie one behind the other.
        return unsafe { super::tile_sads_around_words::<BLOCKS>(first.add(left), other.cast::<u8>().add(right)) };
    }
    // SAFETY: checked above.
    #[cfg(haarline_sse2)]
    return unsafe { tile_sads(left_rows, left, right_rows, right) };
    #[cfg(not(haarline_sse2))]
    [0, 1, 2].map(|step| {
        let [a, b, c, d] = tile_sad(left_rows, left, right_rows, right + step);
        [a | b << 16, c | d << 16]
    })
}

/// Sum of absolute differences of windows of 4 x 2 columns, that begin at any byte. All rows must be equally long.
#[inline(always)]
pub(crate) fn window_sad(left_rows: [&[u32]; 2], left: usize, right_rows: [&[u32]; 2], right: usize) -> u32 {
    let mut sum = 0;
    for (a, b) in left_rows.into_iter().zip(right_rows) {
        demand(left + 4 <= 4 * a.len() && right + 4 <= 4 * b.len());
        // SAFETY: checked above.
        sum = unsafe { sad_add(word(a, left), word(b, right), sum) };
    }
    sum
}

/// Where in a row the window of four lanes begins that differs most from `zero`, the first one of equals, of those that
/// begin at some bytes; before them where none differs.
#[inline(always)]
pub(crate) fn strongest_window(row: &[u32], zero: u32, bytes: Range<usize>) -> usize {
    demand(bytes.end < 4 * row.len() - 2);
    let (mut strongest, mut at) = (0, bytes.start - 1);
    for byte in bytes {
        // SAFETY: checked above.
        let strength = sad(unsafe { word(row, byte) }, zero);
        if strength > strongest {
            (strongest, at) = (strength, byte);
        }
    }
    at
}

/// A window of 8 columns of two rows, that begins at any byte.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Window([u32; 4]);

impl Window {
    /// The window at a byte of two rows.
    #[inline(always)]
    pub(crate) fn of<const WORDS: usize>(rows: &[[u32; WORDS]; 2], byte: usize) -> Self {
        demand(byte + 8 <= 4 * WORDS);
        let [a, b] = rows;
        // SAFETY: checked above.
        unsafe { Self([word(a, byte), word(a, byte + 4), word(b, byte), word(b, byte + 4)]) }
    }

    /// Sum of absolute differences to the window at a byte of two rows.
    #[inline(always)]
    pub(crate) fn sad<const WORDS: usize>(&self, rows: &[[u32; WORDS]; 2], byte: usize) -> u32 {
        demand(byte + 8 <= 4 * WORDS);
        // SAFETY: checked above; the rows lie one behind the other.
        #[cfg(haarline_dsp)]
        return unsafe { super::window_sad_words::<WORDS>(&self.0, rows.as_ptr().cast::<u8>().add(byte)) };
        #[cfg(haarline_sse2)]
        return super::x86_64::rows::sad_of_four(self.0, Self::of(rows, byte).0);
        #[cfg(not(any(haarline_dsp, haarline_sse2)))]
        self.sad_by_words(Self::of(rows, byte))
    }

    /// [`Self::sad`] by words.
    #[cfg(not(any(haarline_dsp, haarline_sse2)))]
    #[inline(always)]
    fn sad_by_words(self, other: Self) -> u32 {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        sad_add(d, h, sad_add(c, g, sad_add(b, f, sad(a, e))))
    }
}

#[cfg(test)]
mod tests {
    use super::super::rows::tests::{WORDS, byte, rows};
    use super::*;

    #[test]
    fn sums_of_differences_are_those_of_bytes() {
        for [a, b, c, d, e] in rows() {
            let (left, right) = ([a, b, c, d], [e, a, b, c]);
            for (at, byte_at) in (0..=WORDS - 2).flat_map(|at| (0..=4 * WORDS - 8).map(move |byte| (at, byte))) {
                let cell = |x: usize, y: usize| -> u32 {
                    let pixels = (y..y + 2).flat_map(|y| (x..x + 4).map(move |x| (x, y)));
                    let difference =
                        |(x, y): (usize, usize)| byte(&left[y], 4 * at + x).abs_diff(byte(&right[y], byte_at + x));
                    pixels.map(|at| u32::from(difference(at))).sum()
                };
                let expected = [cell(0, 0), cell(4, 0), cell(0, 2), cell(4, 2)];
                assert_eq!(tile_sad(&left, at, &right, byte_at), expected);
                if byte_at + 10 <= 4 * WORDS {
                    let around = tile_sads_around(&left, at, &right, byte_at);
                    for (step, cells) in around.into_iter().enumerate() {
                        let [a, b, c, d] = tile_sad(&left, at, &right, byte_at + step);
                        assert_eq!(cells, [a | b << 16, c | d << 16]);
                    }
                }
                let sum = Window::of(&[a, b], 4 * at).sad(&[e, a], byte_at);
                assert_eq!(sum, expected[0] + expected[1]);
            }
        }
    }

    /// Responses by portable operations.

    #[test]
    fn the_strongest_window_is_the_first_of_those_that_differ_most() {
        for [row, ..] in rows() {
            let zero = 0x2f;
            let strength = |at: usize| (at..at + 4).map(|at| u32::from(byte(&row, at).abs_diff(zero))).sum::<u32>();
            for (first, end) in [(1, 4 * WORDS - 3), (5, 17), (9, 10)] {
                let expected = (first..end).rev().max_by_key(|&at| strength(at));
                assert_eq!(Some(strongest_window(&row, 0x2f2f_2f2f, first..end)), expected);
            }
        }
        assert_eq!(strongest_window(&[0x0f0f_0f0f; 8], 0x0f0f_0f0f, 7..12), 6, "nothing differs");
    }
}
