//! Whole rows at a time: kernels that look at every byte of a row, four at once, at any offset.
//!
//! A row is a slice of words of four columns each, the lowest byte leftmost. Every kernel checks its lengths once and
//! then reads without a check for each word.
#![cfg_attr(haarline_sse2, allow(dead_code, reason = "what goes word by word is held against the quads in tests"))]
#![allow(clippy::needless_range_loop, reason = "words of several rows at one number")]
#![expect(unsafe_code, reason = "words at byte offsets that are no multiple of four, without a check for each")]

use super::{add, demand, sad_add, signed_add, signed_halved_sum, signed_sub, splat, sub, wrapping_add};
#[cfg(any(haarline_dsp, haarline_sse2))]
use super::{gradient_across_fours, gradient_down_fours};

#[cfg(haarline_sse2)]
pub(crate) use super::x86_64::rows::haar_peaks_of_pairs;

/// Flips unsigned bytes, 0 to 255, to signed ones, -128 to 127, and back.
pub(crate) const FLIP: u32 = 0x8080_8080;

/// The word that begins `byte` bytes into a row.
///
/// # Safety
/// `byte + 4` must not exceed the row's length in bytes.
#[inline(always)]
pub(super) unsafe fn word(row: &[u32], byte: usize) -> u32 {
    debug_assert!(byte + 4 <= 4 * row.len());
    // SAFETY: within the row, as the caller promises.
    let word = unsafe { row.as_ptr().cast::<u8>().add(byte).cast::<u32>().read_unaligned() };
    u32::from_le(word)
}

/// How gradients become features: limited to `-wide..=wide`, and added to the same limited to `-narrow..=narrow`, so that
/// the cost is steep for small differences and flat for large ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Clips {
    wide: Clip,
    narrow: Option<Clip>,
}

/// Limits lanes, 128 for 0, to `128 - limit..=128 + limit` and moves them to `255 - 2 limit..=255`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Clip {
    lower: u32,
    raise: u32,
}

impl Clip {
    const fn new(limit: u32) -> Self {
        Self { lower: splat(128 - limit), raise: splat(255 - 2 * limit) }
    }

    #[inline(always)]
    fn of(self, gradient: u32) -> u32 {
        // Saturating at 0 and then at 255 cuts both ends.
        add(sub(gradient, self.lower), self.raise)
    }
}

impl Clips {
    /// What is subtracted and added to limit.
    #[cfg(any(haarline_dsp, haarline_sse2))]
    fn limits(self) -> [Option<[u32; 2]>; 2] {
        [Some(self.wide), self.narrow].map(|clip| clip.map(|clip| [clip.lower, clip.raise]))
    }

    /// Limits whose sum is at most 127; `narrow` of 0 is none.
    pub(crate) const fn new(wide: u32, narrow: u32) -> Self {
        Self { wide: Clip::new(wide), narrow: if narrow == 0 { None } else { Some(Clip::new(narrow)) } }
    }

    /// The byte of a feature whose gradient is zero.
    pub(crate) fn zero(self) -> u32 {
        self.of(0) & 0xff
    }

    /// What becomes of the gradients, signed lanes.
    #[inline(always)]
    pub(crate) fn of(self, gradient: u32) -> u32 {
        let gradient = gradient ^ FLIP;
        match self.narrow {
            // The offsets of 255 - 2 limit add up modulo 256.
            Some(narrow) => wrapping_add(self.wide.of(gradient), narrow.of(gradient)),
            None => self.wide.of(gradient),
        }
    }
}

/// What `gradient`, of signed lanes, makes of each word from `first` on but the last, limited.
#[inline(always)]
fn clip_row(clips: Clips, out: &mut [u32], first: usize, gradient: impl Fn(usize) -> u32) {
    let last = out.len().saturating_sub(1);
    for i in first..last {
        out[i] = clips.of(gradient(i));
    }
}

/// Runs a kernel over as many fours of words as a row has between its margins; the first word that is left.
#[cfg(any(haarline_dsp, haarline_sse2))]
#[inline(always)]
fn by_fours(words: usize, kernel: impl FnOnce(usize)) -> usize {
    let fours = words.saturating_sub(2) / 4;
    if fours > 0 {
        kernel(fours);
    }
    4 * fours + 1
}

/// Features of the gradient along the row: `[1 1]` down x `[-1 0 1]` across (pair sum and pair difference).
///
/// Fills all words of `out` but the first and the last. All rows must be equally long.
#[inline(never)]
pub(crate) fn gradient_across(rows: [&[u32]; 2], clips: Clips, out: &mut [u32]) {
    let [a, b] = rows;
    demand(a.len() == out.len() && b.len() == out.len());
    // SAFETY: the rows have `4 * fours + 2` words and more.
    #[cfg(any(haarline_dsp, haarline_sse2))]
    let first = by_fours(out.len(), |fours| unsafe { gradient_across_fours(rows, clips.limits(), out, fours) });
    #[cfg(not(any(haarline_dsp, haarline_sse2)))]
    let first = 1;
    clip_row(clips, out, first, |i| {
        // SAFETY: the words begin one byte before and one after word `i`, which is neither the first nor the last.
        let across = |row| unsafe { signed_sub(word(row, 4 * i + 1), word(row, 4 * i - 1)) };
        signed_add(across(a), across(b))
    });
}

/// Features of the gradient down: `[-1 0 1]` down x `[1 1]` across, of the rows above and below.
///
/// Fills all words of `out` but the first and the last. All rows must be equally long.
#[inline(never)]
pub(crate) fn gradient_down(rows: [&[u32]; 2], clips: Clips, out: &mut [u32]) {
    let [above, below] = rows;
    demand(above.len() == out.len() && below.len() == out.len());
    // SAFETY: the rows have `4 * fours + 2` words and more.
    #[cfg(any(haarline_dsp, haarline_sse2))]
    let first = by_fours(out.len(), |fours| unsafe { gradient_down_fours(rows, clips.limits(), out, fours) });
    #[cfg(not(any(haarline_dsp, haarline_sse2)))]
    let first = 1;
    clip_row(clips, out, first, |i| {
        // SAFETY: word `i` is neither the first nor the last.
        let down = |byte| unsafe { signed_sub(word(below, byte), word(above, byte)) };
        signed_add(down(4 * i), down(4 * i + 1))
    });
}

/// Fills the words of a row after its first with pixels, doubled so often, saturating, and made signed.
pub(crate) fn fill(row: &mut [u32], pixels: &[u8], doublings: u32) {
    let Some(row) = row.get_mut(1..) else { return };
    demand(pixels.len() <= 4 * row.len());
    #[cfg(haarline_sse2)]
    let done = super::x86_64::rows::fill_fours(row, pixels, doublings);
    #[cfg(not(any(haarline_dsp, haarline_sse2)))]
    let done = 0;
    #[cfg(haarline_dsp)]
    let done = if doublings < 2 && pixels.as_ptr().cast::<u32>().is_aligned() && pixels.len() >= 32 {
        let eights = pixels.len() / 32;
        // SAFETY: aligned; the pixels have 32 * eights bytes, and the row as many.
        unsafe { super::flip_eights(pixels.as_ptr().cast(), row.as_mut_ptr(), eights, doublings == 1) };
        8 * eights
    } else {
        0
    };
    let doubled = |word| (0..doublings).fold(word, |word, _| add(word, word)) ^ FLIP;
    let (words, rest) = pixels[4 * done..].as_chunks::<4>();
    let row = &mut row[done..];
    for (to, &word) in row.iter_mut().zip(words) {
        *to = doubled(u32::from_le_bytes(word));
    }
    if let Some(to) = row.get_mut(words.len())
        && !rest.is_empty()
    {
        let mut last = [0; 4];
        last[..rest.len()].copy_from_slice(rest);
        *to = doubled(u32::from_le_bytes(last));
    }
}

/// `|[1 -2 1] x [1 -2 1]|` of the three columns from `byte` on of three rows of signed bytes; a fourth must follow.
#[inline(always)]
pub(crate) fn second_difference<const WORDS: usize>(rows: [&[u32; WORDS]; 3], byte: usize) -> u32 {
    demand(byte + 4 <= 4 * WORDS);
    // SAFETY: checked above.
    second_difference_of(rows.map(|row| unsafe { word(row, byte) } ^ FLIP))
}

/// The same of rows of pixels, columns `first` to `first + 2` of the four that there must be.
#[inline(always)]
pub(crate) fn second_difference_in(rows: [&[u8]; 3], first: usize) -> u32 {
    demand(rows.iter().all(|row| first + 4 <= row.len()));
    // SAFETY: checked above.
    second_difference_of(
        rows.map(|row| u32::from_le_bytes(unsafe { row.as_ptr().add(first).cast::<[u8; 4]>().read() })),
    )
}

/// The same of the first three columns of four in a word of each row.
#[inline(always)]
fn second_difference_of([a, b, c]: [u32; 3]) -> u32 {
    let even = |word, sum| sad_add(word & 0x00ff_00ff, 0, sum);
    let odd = |word: u32| word >> 8 & 0xff;
    let corners = even(a, even(c, 4 * odd(b)));
    let edges = even(b, odd(a) + odd(c));
    corners.abs_diff(2 * edges)
}

/// Haar responses of half-support 2 along a row of tiles: mean of two columns by two rows, less that of the two columns
/// before; 0 where it falls (where it rises if `falling`). Two words a tile.
///
/// - `words`: of a row, margins included; `first`: the tile to begin with.
#[inline(always)]
pub(crate) fn haar_responses<const WORDS: usize>(
    rows: [&[u32; WORDS]; 2],
    words: usize,
    falling: bool,
    first: usize,
    mut take: impl FnMut([u32; 2]),
) {
    let mean = |[a, b]: [u32; 2]| signed_halved_sum(a, b);
    let flip = response_flip(falling);
    let margin = mean(rows.map(|row| row[2 * first]));
    let mut column = mean(rows.map(|row| row[2 * first + 1]));
    let mut before = pair_means(margin, column, flip);
    let mut word = |next: u32| {
        let after = pair_means(column, next, flip);
        let two_before = before >> 16 | after << 16;
        (column, before) = (next, after);
        sub(after, two_before)
    };
    // The words after the first one of a tile and after the second.
    let tiles = (words - 2) / 2;
    let pairs = rows.map(|row| &row[2..words].as_chunks::<2>().0[..tiles]);
    for tile in first..tiles {
        let left = word(mean(pairs.map(|pairs| pairs[tile][0])));
        let right = word(mean(pairs.map(|pairs| pairs[tile][1])));
        take([left, right]);
    }
    if !words.is_multiple_of(2) {
        // Beyond the margin it goes on like it.
        let margin = mean(rows.map(|row| row[words - 1]));
        let first = word(margin);
        take([first, word(margin)]);
    }
}

/// What makes signed bytes unsigned, and turns falling ones to rising if so.
#[inline(always)]
pub(crate) const fn response_flip(falling: bool) -> u32 {
    if falling { !FLIP } else { FLIP }
}

/// Means of each column and the next, of columns that are signed, flipped.
#[inline(always)]
fn pair_means(word: u32, next: u32, flip: u32) -> u32 {
    signed_halved_sum(word, word >> 8 | next << 24) ^ flip
}

/// The word at any byte of a row; all bits set where it lies outside.
#[inline(always)]
pub(crate) fn load(row: &[u32], byte: usize) -> u32 {
    if byte > (4 * row.len()).saturating_sub(4) || row.is_empty() {
        return u32::MAX;
    }
    // SAFETY: checked above.
    unsafe { word(row, byte) }
}

/// Changes the word at any byte of a row; nothing where it lies outside.
#[inline(always)]
pub(crate) fn update(row: &mut [u32], byte: usize, change: impl FnOnce(u32) -> u32) {
    if byte <= (4 * row.len()).saturating_sub(4) && !row.is_empty() {
        // SAFETY: checked above.
        unsafe {
            let value = change(word(row, byte));
            row.as_mut_ptr().cast::<u8>().add(byte).cast::<u32>().write_unaligned(value.to_le());
        }
    }
}

/// The mean of neighbours, `[1 2 1] / 4` of three words.
#[inline(always)]
fn mean_121(a: u32, b: u32, c: u32) -> u32 {
    signed_halved_sum(signed_halved_sum(a, c), b)
}

/// The mean of neighbours, `[1 2 2 2 1] / 8` of five words.
#[inline(always)]
fn mean_12221(a: u32, b: u32, c: u32, d: u32, e: u32) -> u32 {
    signed_halved_sum(mean_121(a, c, e), signed_halved_sum(b, d))
}

/// How wide a mean along the row is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mean {
    /// `[1 2 1]`
    Three,
    /// `[1 2 2 2 1]`
    Five,
    /// `[1 2 2 2 2 2 2 2 1]`
    Nine,
}

/// Means of three rows (`[1 2 1]`, the inner three) or of five (`[1 2 2 2 1]`), all words.
#[inline(never)]
pub(crate) fn mean_down(rows: [&[u32]; 5], mean: Mean, out: &mut [u32]) {
    let [a, b, c, d, e] = rows;
    demand([a, b, c, d, e].iter().all(|row| row.len() == out.len()));
    #[cfg(haarline_sse2)]
    let first = super::x86_64::rows::mean_down_fours(rows, mean, out);
    #[cfg(not(haarline_sse2))]
    let first = 0;
    for i in first..out.len() {
        out[i] = match mean {
            Mean::Three => mean_121(b[i], c[i], d[i]),
            _ => mean_12221(a[i], b[i], c[i], d[i], e[i]),
        };
    }
}

/// Means along a row, all words but the first and the last.
#[inline(never)]
pub(crate) fn mean_across(row: &[u32], mean: Mean, out: &mut [u32]) {
    demand(row.len() == out.len());
    let last = out.len().saturating_sub(1);
    // SAFETY: the row has `4 * fours + 2` words and more.
    #[cfg(haarline_sse2)]
    let first = by_fours(out.len(), |fours| unsafe { super::x86_64::rows::mean_across_fours(row, mean, out, fours) });
    #[cfg(not(haarline_sse2))]
    let first = 1;
    match mean {
        Mean::Three => {
            for i in first..last {
                // SAFETY: one byte beyond word `i` on either side.
                out[i] = unsafe { mean_121(word(row, 4 * i - 1), row[i], word(row, 4 * i + 1)) };
            }
        }
        Mean::Five => {
            for i in first..last {
                // SAFETY: two bytes beyond word `i` on either side.
                out[i] = unsafe { five(row, 4 * i) };
            }
        }
        Mean::Nine => {
            for i in first..last {
                // SAFETY: four bytes beyond word `i` on either side.
                out[i] = unsafe { signed_halved_sum(five(row, 4 * i - 2), five(row, 4 * i + 2)) };
            }
        }
    }
}

/// `[1 2 2 2 1] / 8` along the row, of the word that begins at `byte`.
///
/// # Safety
/// The row must have two bytes before and six after `byte`.
#[inline(always)]
unsafe fn five(row: &[u32], byte: usize) -> u32 {
    // SAFETY: as the caller promises.
    unsafe {
        mean_12221(word(row, byte - 2), word(row, byte - 1), word(row, byte), word(row, byte + 1), word(row, byte + 2))
    }
}

/// In each lane the least of three bytes of a row, those at `byte - 1`, `byte` and `byte + 1` and on; 255 where one lies outside.
#[inline(always)]
pub(crate) fn least_of_three(row: &[u32], byte: usize) -> u32 {
    if byte.wrapping_sub(1) >= (4 * row.len()).saturating_sub(5) {
        return u32::MAX;
    }
    // SAFETY: 1 <= byte and byte + 5 <= 4 * len.
    unsafe { super::min(super::min(word(row, byte - 1), word(row, byte)), word(row, byte + 1)) }
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, reason = "lanes are cut out of words by number")]
pub(super) mod tests;
