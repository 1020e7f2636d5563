//! The median of 3 x 3 disparities.

use haarline::Disparity;

use crate::simd::{max_halves, median_halves, min_halves};

/// The medians around each pixel of the middle row. The row's ends stand for what is beyond them.
///
/// The rows have the length of `out`, 2 px at least.
pub(super) fn median(rows: [&[i16]; 3], out: &mut [Disparity]) {
    let width = out.len();
    let last = rows.map(|row| row[width - 1]);
    let [above, row, below] = rows.map(|row| row.as_chunks::<2>().0);
    let mut columns = above.iter().zip(row).zip(below).map(|((&above, &row), &below)| Columns::of([above, row, below]));
    let Some(mut here) = columns.next() else { return };
    // One column to the left of `here`, and then one to the right.
    let mut left = here.shifted_into(Columns::of(rows.map(|row| [row[0]; 2])));
    let mut places = out.chunks_mut(2);
    for (next, place) in columns.chain([Columns::of(last.map(|last| [last; 2]))]).zip(&mut places) {
        let right = next.shifted_into(here);
        place.copy_from_slice(&halves(left.median(&here, &right)).map(Disparity::from_bits));
        (left, here) = (right, next);
    }
    // Of an odd width, the last column is a pair by itself.
    if let Some([place]) = places.next() {
        let [median, _] = halves(left.median(&here, &here));
        *place = Disparity::from_bits(median);
    }
}

/// The three values of two columns, a column in each half.
#[derive(Clone, Copy)]
struct Columns {
    least: u32,
    middle: u32,
    most: u32,
}

impl Columns {
    /// Sorts them.
    #[inline(always)]
    fn of(rows: [[i16; 2]; 3]) -> Self {
        let [a, b, c] = rows.map(word);
        let (less, more) = (min_halves(a, b), max_halves(a, b));
        let (middle, most) = (min_halves(more, c), max_halves(more, c));
        Self { least: min_halves(less, middle), middle: max_halves(less, middle), most }
    }

    /// The second column of the pair before, and the first of this one.
    #[inline(always)]
    fn shifted_into(&self, before: Self) -> Self {
        let join = |before: u32, this: u32| before >> 16 | this << 16;
        Self {
            least: join(before.least, self.least),
            middle: join(before.middle, self.middle),
            most: join(before.most, self.most),
        }
    }

    /// Of the nine values around each column: the middle one of the greatest least, the middle middle and the least
    /// greatest.
    #[inline(always)]
    fn median(&self, here: &Self, right: &Self) -> u32 {
        let least = max_halves(max_halves(self.least, here.least), right.least);
        let most = min_halves(min_halves(self.most, here.most), right.most);
        median_halves(least, median_halves(self.middle, here.middle, right.middle), most)
    }
}

#[inline(always)]
fn word([low, high]: [i16; 2]) -> u32 {
    u32::from(low.cast_unsigned()) | u32::from(high.cast_unsigned()) << 16
}

#[inline(always)]
fn halves(word: u32) -> [i16; 2] {
    let [a, b, c, d] = word.to_le_bytes();
    [i16::from_le_bytes([a, b]), i16::from_le_bytes([c, d])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn pairs_have_the_median_of_nine(
            values in prop::array::uniform3(prop::array::uniform16(prop_oneof![any::<i16>(), -2..=2_i16])),
            width in 2..=16_usize,
        ) {
            let mut out = [Disparity::UNKNOWN; 16];
            median(values.each_ref().map(|row| &row[..width]), &mut out[..width]);
            for (x, out) in out[..width].iter().enumerate() {
                let columns = [x.saturating_sub(1), x, (x + 1).min(width - 1)];
                let mut nine = values.map(|row| columns.map(|x| row[x]));
                let nine = nine.as_flattened_mut();
                nine.sort_unstable();
                prop_assert_eq!(out.into_bits(), nine[4], "column {} of {}", x, width);
            }
        }
    }
}
