//! Arithmetic on four bytes at once, in one word of 32 bits.
//!
//! Lane 0 is the least significant byte. Each operation exists three times: in portable code, as one or two
//! instructions of the DSP extension of Cortex-M4, M7 and M33 (ARM DDI 0403, chapter A7), and as some of SSE2. `build.rs`
//! selects by the target; they are held against each other over random and extreme input, on the host and in the emulator.

#[cfg(haarline_dsp)]
mod cortex_m;
#[cfg(any(not(any(haarline_dsp, haarline_sse2)), test))]
#[cfg_attr(any(haarline_dsp, haarline_sse2), allow(dead_code, reason = "what the others are held against"))]
mod portable;
#[cfg(haarline_sse2)]
pub(crate) mod x86_64;

#[cfg(haarline_dsp)]
pub(crate) use cortex_m::*;
#[cfg(not(any(haarline_dsp, haarline_sse2)))]
pub(crate) use portable::*;
#[cfg(haarline_sse2)]
pub(crate) use x86_64::*;

pub(crate) mod answer_rows;
#[cfg(feature = "packet")]
pub(crate) mod cell_codes;
pub(crate) mod columns;
pub(crate) mod evidence_rows;
pub(crate) mod lens_runs;
pub(crate) mod partners;
pub(crate) mod rows;
pub(crate) mod sevens;
pub(crate) mod smoothing;
pub(crate) mod trials;
pub(crate) mod windows;

/// What is read and written from here on without another check must lie within its rows: else the program ends. In one place for
/// all, since each of its own takes flash.
#[inline(always)]
pub(crate) fn demand(is_within: bool) {
    if !is_within {
        end_outside();
    }
}

#[cold]
#[inline(never)]
fn end_outside() -> ! {
    // No message: it would take what formats one.
    unreachable!()
}

/// `a` if so, else `b`. A branch that nobody can foresee is taken the wrong way half of the times, which costs more than to find
/// both; Cortex-M does not guess.
#[inline(always)]
pub(crate) fn choose<T>(is_a: bool, a: T, b: T) -> T {
    #[cfg(haarline_dsp)]
    return if is_a { a } else { b };
    #[cfg(not(haarline_dsp))]
    core::hint::select_unpredictable(is_a, a, b)
}

/// The same, of which the compiler for Cortex-M knows nothing: a loop over it is not written out, which takes flash.
#[inline(always)]
pub(crate) fn unseen<T>(value: T) -> T {
    if cfg!(haarline_dsp) { core::hint::black_box(value) } else { value }
}

/// What is made of each number: [`core::array::from_fn`], of which a compiler for x86-64 makes a call for each.
#[inline(always)]
pub(crate) fn array<T: Copy + Default, const LEN: usize>(mut of: impl FnMut(usize) -> T) -> [T; LEN] {
    if cfg!(haarline_dsp) {
        return core::array::from_fn(of);
    }
    let mut all = [T::default(); LEN];
    for (i, one) in all.iter_mut().enumerate() {
        *one = of(i);
    }
    all
}

/// One in each lane.
pub(crate) const ONES: u32 = 0x0101_0101;

/// The same byte in each lane.
#[inline(always)]
pub(crate) const fn splat(byte: u32) -> u32 {
    byte.wrapping_mul(ONES)
}

/// Lane `lane` of a word.
#[inline(always)]
pub(crate) const fn lane(word: u32, lane: u32) -> u32 {
    word >> (8 * lane) & 0xff
}

/// The least of the four lanes, in each of them.
#[cfg(not(haarline_sse2))]
#[inline(always)]
pub(crate) fn least(word: u32) -> u32 {
    let pair = min(word, word.rotate_right(16));
    min(pair, pair.rotate_right(8))
}

/// The greatest of the four lanes, in each of them.
#[cfg(not(haarline_sse2))]
#[inline(always)]
pub(crate) fn greatest(word: u32) -> u32 {
    let pair = max(word, word.rotate_right(16));
    max(pair, pair.rotate_right(8))
}

/// `|a - b|` of unsigned lanes.
#[inline(always)]
pub(crate) fn difference(a: u32, b: u32) -> u32 {
    sub(a, b) | sub(b, a)
}

/// By how many bits the first lane that is 0 lies above lane 0; one must be.
#[cfg_attr(haarline_sse2, allow(dead_code, reason = "quads have their own"))]
#[inline(always)]
pub(crate) fn zero_lane_bits(word: u32) -> u32 {
    select_ge(0, word, ONES, 0).trailing_zeros() & 24
}

/// `|a - b|` of unsigned halves.
#[inline(always)]
pub(crate) fn difference_of_halves(a: u32, b: u32) -> u32 {
    sub_saturating_halves(a, b) | sub_saturating_halves(b, a)
}

/// The same 16 bits in each half.
#[inline(always)]
pub(crate) const fn splat_half(half: u32) -> u32 {
    half * 0x0001_0001
}

#[cfg(test)]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "lanes are cut out"
)]
mod tests {
    use super::*;

    /// Words with all kinds of lanes and halves, extreme ones too.
    fn words() -> impl Iterator<Item = u32> + Clone {
        let extremes =
            [0, 1, 0x7f, 0x80, 0xff, 0x7fff, 0x8000, 0xffff, 0x017f_8000, 0x80ff_7f01, 0xff00_ff00, u32::MAX];
        let random = (1..40u32).map(|i| {
            let word = i.wrapping_mul(0x9e37_79b1);
            (word ^ word >> 15).wrapping_mul(0x85eb_ca6b)
        });
        extremes.into_iter().chain(random)
    }

    fn by_halves(a: u32, b: u32, f: impl Fn(u16, u16) -> u16) -> u32 {
        let [low, high] = [0, 16].map(|shift| u32::from(f((a >> shift) as u16, (b >> shift) as u16)));
        low | high << 16
    }

    fn by_lanes(a: u32, b: u32, f: impl Fn(u8, u8) -> u8) -> u32 {
        let (a, b) = (a.to_le_bytes(), b.to_le_bytes());
        u32::from_le_bytes([0, 1, 2, 3].map(|i| f(a[i], b[i])))
    }

    #[test]
    fn halves_are_worked_on_by_themselves() {
        for (a, b) in words().flat_map(|a| words().map(move |b| (a, b))) {
            assert_eq!(sub_saturating_halves(a, b), by_halves(a, b, u16::saturating_sub));
            assert_eq!(difference_of_halves(a, b), by_halves(a, b, u16::abs_diff));
            assert_eq!(halved_sum_halves(a, b), by_halves(a, b, u16::midpoint));
            let halved_difference = |a: u16, b: u16| ((i32::from(a) - i32::from(b)) >> 1) as u16;
            assert_eq!(halved_difference_halves(a, b), by_halves(a, b, halved_difference));
            #[cfg(not(haarline_dsp))]
            assert_eq!(signed_max_halves(a, b), by_halves(a, b, |a, b| (a as i16).max(b as i16) as u16));
            let (x, y) = (0x1234_5678, 0x9abc_def0);
            let selected = by_halves(a, b, |a, b| if a >= b { 0xffff } else { 0 });
            assert_eq!(select_ge_halves(a, b, x, y), x & selected | y & !selected);
            let limited = a & 0x7fff_7fff;
            assert_eq!(saturated_halves(limited), by_halves(limited, 0, |a, _| a.min(255)));
        }
    }

    #[test]
    fn lanes_are_ordered() {
        for (a, b) in words().flat_map(|a| words().map(move |b| (a, b))) {
            assert_eq!(min_max(a, b), (by_lanes(a, b, u8::min), by_lanes(a, b, u8::max)));
            assert_eq!(difference(a, b), by_lanes(a, b, u8::abs_diff));
            let bytes = a.to_le_bytes().map(u32::from);
            assert_eq!(Some(least(a)), bytes.into_iter().min().map(splat));
            assert_eq!(Some(greatest(a)), bytes.into_iter().max().map(splat));
        }
    }

    #[test]
    fn numbers_are_divided_and_limited() {
        for (a, b) in [(7, 2), (-7, 2), (-32640, 255), (0, 9)] {
            assert_eq!(quotient(a, b), a / b);
        }
        assert_eq!([-1000, -1, 0, 200, 255, 256].map(limited_to_byte), [0, 0, 0, 200, 255, 255]);
    }

    #[test]
    #[cfg(any(haarline_dsp, haarline_sse2))]
    fn instructions_equal_portable_code() {
        macro_rules! check {
            ($a:ident, $b:ident: $($name:ident)*) => {$(
                assert_eq!($name($a, $b), portable::$name($a, $b), "{} of {:#x} and {:#x}", stringify!($name), $a, $b);
            )*};
        }
        for (a, b) in words().flat_map(|a| words().map(move |b| (a, b))) {
            check!(a, b: add sub halved_sum signed_add signed_sub signed_halved_sum wrapping_add wrapping_sub sad min max min_max);
            check!(a, b: add_halves sub_halves sub_saturating_halves halved_sum_halves halved_difference_halves);
            #[cfg(not(haarline_dsp))]
            check!(a, b: signed_max_halves);
            let (x, y) = (a.rotate_left(5) ^ 0x1234_5678, b.wrapping_mul(0x9e37_79b1));
            assert_eq!(select_ge(a, b, x, y), portable::select_ge(a, b, x, y));
            assert_eq!(select_ge_halves(a, b, x, y), portable::select_ge_halves(a, b, x, y));
            assert_eq!(sad_add(a, b, x >> 8), portable::sad_add(a, b, x >> 8));
            assert_eq!(saturated_halves(a & 0x7fff_7fff), portable::saturated_halves(a & 0x7fff_7fff));
            assert_eq!(limited_to_byte(a.cast_signed()), portable::limited_to_byte(a.cast_signed()));
            if b != 0 && a != 1 << 31 {
                assert_eq!(
                    quotient(a.cast_signed(), b.cast_signed()),
                    portable::quotient(a.cast_signed(), b.cast_signed())
                );
            }
        }
    }
}
