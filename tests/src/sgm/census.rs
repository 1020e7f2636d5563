//! The census transform: which neighbours are darker than a pixel.

use crate::simd::census_words;

/// Rows above and below that a census looks at, and columns beside.
pub(super) const REACH: u32 = 2;
/// The same as an index.
const BESIDE: usize = REACH as usize;
/// Rows that it takes.
pub(super) const ROWS: usize = 2 * BESIDE + 1;

/// Signs of the eight pixels of a diamond around each pixel of the middle row: a bit is set where the
/// neighbour is darker. At the ends of the row its first and last pixel stand for those beyond.
///
/// The rows have the length of `out`, 8 px at least.
pub(super) fn census(rows: [&[u8]; ROWS], out: &mut [u8]) {
    let width = out.len();
    let inner = width - 2 * BESIDE;
    let (whole, rest) = (inner / 4 * 4, inner % 4);
    census_words(rows, &mut out[BESIDE..][..whole]);
    if rest > 0 {
        // The last word overlaps the one before.
        let last = inner - 4;
        census_words(rows.map(|row| &row[last..]), &mut out[last + BESIDE..][..4]);
    }
    for x in [0, 1, width - 2, width - 1] {
        out[x] = signs(rows, x);
    }
}

/// The signs of one pixel, wherever it is.
fn signs(rows: [&[u8]; ROWS], x: usize) -> u8 {
    let last = rows[BESIDE].len() - 1;
    let left = |by: usize| x.saturating_sub(by);
    let right = |by: usize| (x + by).min(last);
    let neighbours = [
        rows[0][x],
        rows[1][left(1)],
        rows[1][right(1)],
        rows[2][left(2)],
        rows[2][right(2)],
        rows[3][left(1)],
        rows[3][right(1)],
        rows[4][x],
    ];
    neighbours.into_iter().fold(0, |bits, other| bits << 1 | u8::from(other < rows[BESIDE][x]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn words_have_the_signs_of_each_pixel(
            pixels in prop::array::uniform5(prop::array::uniform32(prop_oneof![any::<u8>(), 100..103_u8])),
            width in 8..=32_usize,
        ) {
            let rows = pixels.each_ref().map(|row| &row[..width]);
            let mut out = [0; 32];
            census(rows, &mut out[..width]);
            for (x, &out) in out[..width].iter().enumerate() {
                prop_assert_eq!(out, signs(rows, x), "column {} of {}", x, width);
            }
        }
    }

    #[test]
    fn each_neighbour_has_its_bit() {
        let places = [(2, 0), (1, 1), (3, 1), (0, 2), (4, 2), (1, 3), (3, 3), (2, 4)];
        for (bit, (x, y)) in places.into_iter().enumerate() {
            let mut pixels = [[9; 8]; 5];
            pixels[y][x + 1] = 8;
            let mut out = [0; 8];
            census(pixels.each_ref().map(|row| &row[..]), &mut out);
            assert_eq!(out[3], 0x80 >> bit);
        }
    }
}
