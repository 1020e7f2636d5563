//! Row kernels, sixteen bytes at once.
#![expect(unsafe_code, reason = "sixteen bytes at byte offsets, without a check for each")]

use super::quad::Quad;
use crate::lanes::rows::{FLIP, Mean, response_flip};

/// Writes four words.
#[inline(always)]
fn put(out: &mut [u32], word: usize, quad: Quad) {
    if let Some(to) = out.get_mut(word..).and_then(<[u32]>::first_chunk_mut) {
        *to = quad.words();
    }
}

/// Limits in all lanes: what is subtracted and added.
type Limits = [Option<[Quad; 2]>; 2];

fn all_lanes(limits: [Option<[u32; 2]>; 2]) -> Limits {
    limits.map(|limit| limit.map(|limit| limit.map(Quad::splat)))
}

#[inline(always)]
fn limited(gradient: Quad, limits: Limits) -> Quad {
    let gradient = gradient.xor(Quad::splat(FLIP));
    let limit = |[lower, raise]: [Quad; 2]| gradient.sub(lower).add(raise);
    let [wide, narrow] = limits.map(|limits| limits.map(limit));
    let wide = wide.unwrap_or(gradient);
    narrow.map_or(wide, |narrow| wide.wrapping_add(narrow))
}

/// [`gradient_across`](super::rows::gradient_across) of the words `1..=4 * fours`. `limits` are pairs of what is subtracted and added.
///
/// # Safety
/// The rows must have at least `4 * fours + 2` words.
#[inline(always)]
pub(crate) unsafe fn gradient_across_fours(
    [a, b]: [&[u32]; 2],
    limits: [Option<[u32; 2]>; 2],
    out: &mut [u32],
    fours: usize,
) {
    let limits = all_lanes(limits);
    for first in (1..4 * fours).step_by(4) {
        // SAFETY: from one byte before the words to one after them.
        let across = |row| unsafe { Quad::load(row, 4 * first + 1).signed_sub(Quad::load(row, 4 * first - 1)) };
        put(out, first, limited(across(a).signed_add(across(b)), limits));
    }
}

/// [`gradient_down`](super::rows::gradient_down) of the words `1..=4 * fours`. `limits` are pairs of what is subtracted and added.
///
/// # Safety
/// The rows must have at least `4 * fours + 2` words.
#[inline(always)]
pub(crate) unsafe fn gradient_down_fours(
    [above, below]: [&[u32]; 2],
    limits: [Option<[u32; 2]>; 2],
    out: &mut [u32],
    fours: usize,
) {
    let limits = all_lanes(limits);
    for first in (1..4 * fours).step_by(4) {
        // SAFETY: to one byte after the words.
        let down = |byte| unsafe { Quad::load(below, byte).signed_sub(Quad::load(above, byte)) };
        put(out, first, limited(down(4 * first).signed_add(down(4 * first + 1)), limits));
    }
}

/// [`fill`](super::rows::fill) of as many fours of words as there are pixels; the first word that is left.
#[inline(always)]
pub(crate) fn fill_fours(row: &mut [u32], pixels: &[u8], doublings: u32) -> usize {
    let mut done = 0;
    for (to, pixels) in row.as_chunks_mut::<4>().0.iter_mut().zip(pixels.as_chunks::<16>().0) {
        let doubled = (0..doublings).fold(Quad::read(pixels), |pixels, _| pixels.add(pixels));
        *to = doubled.xor(Quad::splat(FLIP)).words();
        done += 4;
    }
    done
}

/// Sum of absolute differences of four words.
#[inline(always)]
pub(crate) fn sad_of_four(a: [u32; 4], b: [u32; 4]) -> u32 {
    let [first, _, second, _] = Quad::of(a).sad(Quad::of(b)).words();
    first + second
}

/// The mean of neighbours, `[1 2 1] / 4`.
#[inline(always)]
fn mean_121(a: Quad, b: Quad, c: Quad) -> Quad {
    a.signed_halved_sum(c).signed_halved_sum(b)
}

/// The mean of neighbours, `[1 2 2 2 1] / 8`.
#[inline(always)]
fn mean_12221(a: Quad, b: Quad, c: Quad, d: Quad, e: Quad) -> Quad {
    mean_121(a, c, e).signed_halved_sum(b.signed_halved_sum(d))
}

/// [`mean_down`](super::rows::mean_down) of as many fours of words as there are; the first word that is left. All rows must
/// be equally long.
#[inline(always)]
pub(crate) fn mean_down_fours(rows: [&[u32]; 5], mean: Mean, out: &mut [u32]) -> usize {
    let words = out.len() / 4 * 4;
    for i in (0..words).step_by(4) {
        let [a, b, c, d, e] = rows.map(|row| match row.get(i..).and_then(<[u32]>::first_chunk) {
            Some(&words) => Quad::of(words),
            None => Quad::splat(0),
        });
        put(out, i, if mean == Mean::Three { mean_121(b, c, d) } else { mean_12221(a, b, c, d, e) });
    }
    words
}

/// [`mean_across`](super::rows::mean_across) of the words `1..=4 * fours`.
///
/// # Safety
/// The row must have at least `4 * fours + 2` words.
#[inline(always)]
pub(crate) unsafe fn mean_across_fours(row: &[u32], mean: Mean, out: &mut [u32], fours: usize) {
    for first in (1..4 * fours).step_by(4) {
        // SAFETY: at most four bytes before the words to four after them.
        let at = |byte: usize| unsafe { Quad::load(row, byte) };
        let five = |byte: usize| mean_12221(at(byte - 2), at(byte - 1), at(byte), at(byte + 1), at(byte + 2));
        let byte = 4 * first;
        put(
            out,
            first,
            match mean {
                Mean::Three => mean_121(at(byte - 1), at(byte), at(byte + 1)),
                Mean::Five => five(byte),
                Mean::Nine => five(byte - 2).signed_halved_sum(five(byte + 2)),
            },
        );
    }
}

/// The strongest of [`haar_responses`](super::rows::haar_responses) of as many pairs of tiles as there are: its column, the
/// first of equals, and its strength. The first tile that is left.
#[inline(always)]
pub(crate) fn haar_peaks_of_pairs<const WORDS: usize>(
    rows: [&[u32; WORDS]; 2],
    words: usize,
    falling: bool,
    mut take: impl FnMut(u32, u32),
) -> usize {
    // The margins are read, too.
    let pairs = words.min(WORDS).saturating_sub(2) / 4;
    let flip = Quad::splat(response_flip(falling));
    let mut column = 0;
    for pair in 0..pairs {
        let mean = |byte: usize| {
            // SAFETY: from two bytes before the words 1..=4 * pairs to one after them.
            let [a, b] = rows.map(|row| unsafe { Quad::load(row, byte) });
            a.signed_halved_sum(b)
        };
        let pair_means = |byte: usize| mean(byte).signed_halved_sum(mean(byte + 1)).xor(flip);
        let byte = 4 + 16 * pair;
        let (before, after) = (pair_means(byte - 2), pair_means(byte));
        let responses = after.sub(before);
        let most = responses.greatest_of_two_words();
        let mut places = responses.equal(most).top_bits();
        let [first, _, second, _] = most.words();
        for strength in [first, second] {
            take(column + places.trailing_zeros() % 8, strength & 0xff);
            (column, places) = (column + 8, places >> 8);
        }
    }
    2 * pairs
}
