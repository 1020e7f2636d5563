//! Four bytes or two halves in a word, worked on at once.
//!
//! Where the target has the DSP extension of Arm's M profile (`cfg(dsp)`, see `build.rs`) these are its instructions, in
//! the modules named `dsp`, which have all of this package's unsafe code; elsewhere the modules named `portable` give
//! the same, bit for bit.

#[cfg(dsp)]
mod dsp;
pub mod paths;
#[cfg(not(dsp))]
mod portable;
pub mod sad;

#[cfg(dsp)]
use dsp as chosen;
#[cfg(not(dsp))]
use portable as chosen;

pub use chosen::{at_least, at_most_halves, census_words, max_halves, min_halves, min_unsigned_halves, sobel_words};
#[cfg(not(dsp))]
pub use portable::{max, saturating_sub};

/// What enters a window, and what leaves it on the other side.
#[derive(Debug, Clone, Copy)]
pub struct Step<T> {
    /// Enters.
    pub entering: T,
    /// Leaves.
    pub leaving: T,
}

/// The same byte four times.
#[inline(always)]
pub fn splat(byte: u8) -> u32 {
    u32::from(byte) * 0x0101_0101
}

/// How many bits are set in each byte.
#[inline(always)]
pub fn count_ones(word: u32) -> u32 {
    let pairs = word - ((word >> 1) & 0x5555_5555);
    let nibbles = pairs - 3 * ((pairs >> 2) & 0x3333_3333);
    (nibbles + (nibbles >> 4)) & 0x0f0f_0f0f
}

/// The greatest of the four bytes, in all of them.
#[cfg(not(dsp))]
#[inline(always)]
pub fn greatest(word: u32) -> u32 {
    let pairs = max(word, word.rotate_right(16));
    max(pairs, pairs.rotate_right(8))
}

/// The middle one of three halves, twice.
#[inline(always)]
pub fn median_halves(a: u32, b: u32, c: u32) -> u32 {
    max_halves(min_halves(a, b), min_halves(max_halves(a, b), c))
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use proptest::prelude::*;

    /// Words of any bytes, and of the least and greatest signed and unsigned ones.
    fn words() -> impl Strategy<Value = u32> {
        let byte = || prop_oneof![any::<u8>(), prop::sample::select(std::vec![0, 1, 127, 128, 254, 255])];
        prop_oneof![any::<u32>(), [byte(), byte(), byte(), byte()].prop_map(u32::from_le_bytes)]
    }

    fn each(a: u32, b: u32, op: impl Fn(u8, u8) -> u8) -> u32 {
        let (a, b) = (a.to_le_bytes(), b.to_le_bytes());
        u32::from_le_bytes(std::array::from_fn(|at| op(a[at], b[at])))
    }

    fn halves(word: u32) -> [i16; 2] {
        let [a, b, c, d] = word.to_le_bytes();
        [[a, b], [c, d]].map(i16::from_le_bytes)
    }

    proptest! {
        #[test]
        fn each_byte_is_worked_on_by_itself(a in words(), b in words(), few in words()) {
            prop_assert_eq!(max(a, b), each(a, b, u8::max));
            prop_assert_eq!(saturating_sub(a, b), each(a, b, u8::saturating_sub));
            prop_assert_eq!(at_least(a, b), each(a, b, |a, b| if a >= b { 255 } else { 0 }));
            prop_assert_eq!(count_ones(a), each(a, 0, |a, _| u8::try_from(a.count_ones()).unwrap()));
            prop_assert_eq!(greatest(a), splat(a.to_le_bytes().into_iter().max().unwrap()));
            let bits = few & 0x7f7f_7f7f;
            prop_assert_eq!(portable::shift_in_less(bits, a, b), each(bits, each(a, b, |a, b| u8::from(a < b)), |bits, is_less| bits << 1 | is_less));
        }

        #[test]
        fn each_half_is_worked_on_by_itself(a in words(), b in words(), c in words()) {
            for half in 0..2 {
                let (a, b, c) = (halves(a)[half], halves(b)[half], halves(c)[half]);
                let word = |half: i16| u32::from(half.cast_unsigned()) * 0x1_0001;
                prop_assert_eq!(halves(max_halves(word(a), word(b))), [a.max(b); 2]);
                prop_assert_eq!(halves(min_halves(word(a), word(b))), [a.min(b); 2]);
                let mut three = [a, b, c];
                three.sort_unstable();
                prop_assert_eq!(halves(median_halves(word(a), word(b), word(c))), [three[1]; 2]);
            }
            let unsigned = |word: u32| halves(word).map(i16::cast_unsigned);
            for half in 0..2 {
                let (a, b, c) = (unsigned(a)[half], unsigned(b)[half], [unsigned(min_unsigned_halves(a, b))[half], unsigned(at_most_halves(a, b))[half]]);
                prop_assert_eq!(c, [a.min(b), if a <= b { u16::MAX } else { 0 }]);
            }
            prop_assert_eq!(halves(max_halves(a, b))[0], halves(a)[0].max(halves(b)[0]));
            prop_assert_eq!(halves(min_halves(a, b))[1], halves(a)[1].min(halves(b)[1]));
        }
    }
}
