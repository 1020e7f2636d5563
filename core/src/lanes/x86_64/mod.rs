//! The operations as instructions of SSE2: a word lies in the lowest lanes of a [`Quad`], and the compiler leaves it there
//! from one operation to the next.
#![cfg_attr(haarline_sse2, allow(dead_code, reason = "what goes word by word is held against the quads in tests"))]

pub(crate) mod answers;
pub(crate) mod evidence;
pub(crate) mod quad;
pub(crate) mod rows;
pub(crate) mod smoothing;
pub(crate) mod tile;

use quad::Quad;
pub(super) use rows::{gradient_across_fours, gradient_down_fours};

macro_rules! operations {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub(crate) fn $name(a: u32, b: u32) -> u32 {
            Quad::of_word(a).$name(Quad::of_word(b)).word()
        }
    )*};
}

operations! {
    /// Saturating sum of unsigned lanes.
    add;
    /// Saturating difference of unsigned lanes.
    sub;
    /// Half of the sum of unsigned lanes, rounded down.
    halved_sum;
    /// Saturating sum of signed lanes.
    signed_add;
    /// Saturating difference of signed lanes.
    signed_sub;
    /// Half of the sum of signed lanes, rounded down.
    signed_halved_sum;
    /// Sum of the four absolute differences of unsigned lanes.
    sad;
    /// The lesser of unsigned lanes.
    min;
    /// The greater of unsigned lanes.
    max;
    /// Sum of the lanes modulo 256.
    wrapping_add;
    /// Difference of the lanes modulo 256.
    wrapping_sub;
    /// Saturating difference of unsigned halves.
    sub_saturating_halves;
    /// Half of the sum of unsigned halves, rounded down.
    halved_sum_halves;
    /// Half of the difference of unsigned halves, rounded down, modulo 2^16.
    halved_difference_halves;
    /// The greater of signed halves.
    signed_max_halves;
    /// Sum of the two 16-bit halves modulo 2^16.
    add_halves;
    /// Difference of the two 16-bit halves modulo 2^16.
    sub_halves;
}

/// Sum of the four absolute differences of unsigned lanes, added to `sum`.
#[inline(always)]
pub(crate) fn sad_add(a: u32, b: u32, sum: u32) -> u32 {
    sum + sad(a, b)
}

/// `x` where `mask` is set, else `y`.
#[inline(always)]
fn either(mask: Quad, x: u32, y: u32) -> u32 {
    Quad::of_word(x).where_or(mask, Quad::of_word(y)).word()
}

/// In each lane `x` where `a >= b`, else `y`.
#[inline(always)]
pub(crate) fn select_ge(a: u32, b: u32, x: u32, y: u32) -> u32 {
    either(Quad::of_word(a).not_less(Quad::of_word(b)), x, y)
}

/// In each unsigned half `x` where `a >= b`, else `y`.
#[inline(always)]
pub(crate) fn select_ge_halves(a: u32, b: u32, x: u32, y: u32) -> u32 {
    either(Quad::of_word(a).not_less_halves(Quad::of_word(b)), x, y)
}

/// The lesser and the greater of unsigned lanes.
#[inline(always)]
pub(crate) fn min_max(a: u32, b: u32) -> (u32, u32) {
    (min(a, b), max(a, b))
}

/// The quotient, rounded towards 0; the divisor is not 0.
#[inline(always)]
pub(crate) const fn quotient(a: i32, b: i32) -> i32 {
    a / b
}

/// A number limited to 0 to 255.
#[inline(always)]
pub(crate) fn limited_to_byte(number: i32) -> u32 {
    number.clamp(0, 255).cast_unsigned()
}

/// Each of two 16-bit halves, below 2^15, at most 255.
#[inline(always)]
pub(crate) fn saturated_halves(word: u32) -> u32 {
    Quad::of_word(word).signed_min_halves(Quad::splat(0x00ff_00ff)).word()
}

/// The least of the four lanes, in each of them.
#[inline(always)]
pub(crate) fn least(word: u32) -> u32 {
    Quad::of_word(word).least_spread().word()
}

/// The greatest of the four lanes, in each of them.
#[inline(always)]
pub(crate) fn greatest(word: u32) -> u32 {
    Quad::of_word(word).greatest_spread().word()
}

/// The word: only Cortex-M has to be told to hold it in a register.
#[inline(always)]
pub(crate) const fn held(word: u32) -> u32 {
    word
}
