//! The 3 x 3 cells around each cell of a row, four cells a word.
//!
//! A row has a byte a cell, and room for whole words. Beyond its ends the outermost cells are there again.

use crate::lanes::{halved_sum, lane, splat};

/// Words of four cells.
pub(crate) const fn words_of(cells: usize) -> usize {
    cells.div_ceil(4)
}

/// Repeats the last of `cells` cells up to the end of its word.
#[inline(always)]
pub(crate) fn fill_up<const WORDS: usize>(row: &mut [u8; WORDS], cells: usize) {
    if !cells.is_multiple_of(4)
        && let Some(&last) = row[..cells].last()
    {
        row.iter_mut().skip(cells).take(3).for_each(|cell| *cell = last);
    }
}

/// The first `words` words of a row.
#[inline(always)]
pub(crate) fn words<const WORDS: usize>(row: &[u8; WORDS], words: usize) -> &[[u8; 4]] {
    &row.as_chunks::<4>().0[..words]
}

/// The first `words` words of a row.
#[inline(always)]
pub(crate) fn words_mut<const WORDS: usize>(row: &mut [u8; WORDS], words: usize) -> &mut [[u8; 4]] {
    &mut row.as_chunks_mut::<4>().0[..words]
}

/// Goes along the words of columns: of the `i`-th its left neighbours, itself and its right neighbours, lane by lane.
#[inline(always)]
pub(crate) fn along<const N: usize>(
    words: usize,
    at: impl Fn(usize) -> [u32; N],
    mut take: impl FnMut(usize, [[u32; 3]; N]),
) {
    if words == 0 {
        return;
    }
    let mut here = at(0);
    let mut before = here.map(|word| splat(lane(word, 0)));
    for i in 0..words {
        let next = if i + 1 < words { at(i + 1) } else { here.map(|word| splat(lane(word, 3))) };
        take(i, core::array::from_fn(|k| [here[k] << 8 | before[k] >> 24, here[k], here[k] >> 8 | next[k] << 24]));
        (before, here) = (here, next);
    }
}

/// Means over the 3 x 3 cells around each of the middle row, `[1 2 1] / 4` down and along.
#[inline(never)]
pub(crate) fn means_around(rows: [&[[u8; 4]]; 3], means: &mut [[u8; 4]]) {
    let [above, here, below] = rows;
    let count = means.len();
    if count == 0 || above.len() != count || here.len() != count || below.len() != count {
        return;
    }
    let down = |i: usize| mean([above, here, below].map(|row| u32::from_le_bytes(row[i])));
    let mut middle = down(0);
    let mut before = splat(lane(middle, 0));
    for i in 1..count {
        let next = down(i);
        means[i - 1] = mean([middle << 8 | before >> 24, middle, middle >> 8 | next << 24]).to_le_bytes();
        (before, middle) = (middle, next);
    }
    let next = splat(lane(middle, 3));
    means[count - 1] = mean([middle << 8 | before >> 24, middle, middle >> 8 | next << 24]).to_le_bytes();
}

/// The mean of neighbours, `[1 2 1] / 4`.
#[inline(always)]
pub(crate) fn mean([a, b, c]: [u32; 3]) -> u32 {
    halved_sum(halved_sum(a, c), b)
}
