//! Four words at once in a register of SSE2, which every x86-64 has: sixteen lanes, or eight halves.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::x86_64::{
    __m128i, _mm_add_epi8, _mm_add_epi16, _mm_adds_epi8, _mm_adds_epu8, _mm_and_si128, _mm_andnot_si128, _mm_avg_epu8,
    _mm_avg_epu16, _mm_cmpeq_epi8, _mm_cmpeq_epi16, _mm_cvtsi32_si128, _mm_cvtsi128_si32, _mm_max_epu8, _mm_min_epi16,
    _mm_min_epu8, _mm_or_si128, _mm_sad_epu8, _mm_set1_epi32, _mm_sub_epi8, _mm_sub_epi16, _mm_subs_epi8,
    _mm_subs_epu8, _mm_subs_epu16, _mm_xor_si128,
};

/// Four words, the lowest first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quad(__m128i);

macro_rules! operations {
    ($($(#[$doc:meta])* $name:ident = $instruction:ident;)*) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub(crate) fn $name(self, other: Self) -> Self {
            // SAFETY: the target has SSE2.
            Self(unsafe { $instruction(self.0, other.0) })
        }
    )*};
}

impl Quad {
    operations! {
        /// Saturating sum of unsigned lanes.
        add = _mm_adds_epu8;
        /// Saturating difference of unsigned lanes.
        sub = _mm_subs_epu8;
        /// Sum of the lanes modulo 256.
        wrapping_add = _mm_add_epi8;
        /// Difference of the lanes modulo 256.
        wrapping_sub = _mm_sub_epi8;
        /// Saturating sum of signed lanes.
        signed_add = _mm_adds_epi8;
        /// Saturating difference of signed lanes.
        signed_sub = _mm_subs_epi8;
        /// The lesser of unsigned lanes.
        min = _mm_min_epu8;
        /// The greater of unsigned lanes.
        max = _mm_max_epu8;
        /// Half of the sum of unsigned lanes, rounded up.
        halved_sum_up = _mm_avg_epu8;
        /// All bits of the lanes that are equal.
        equal = _mm_cmpeq_epi8;
        /// Sums of the absolute differences of the lower and the upper two words, in the words 0 and 2.
        sad = _mm_sad_epu8;
        /// Sum of the halves modulo 2^16.
        add_halves = _mm_add_epi16;
        /// Difference of the halves modulo 2^16.
        sub_halves = _mm_sub_epi16;
        /// Saturating difference of unsigned halves.
        sub_saturating_halves = _mm_subs_epu16;
        /// The lesser of signed halves.
        signed_min_halves = _mm_min_epi16;
        /// Half of the sum of unsigned halves, rounded up.
        halved_sum_up_halves = _mm_avg_epu16;
        /// All bits of the halves that are equal.
        equal_halves = _mm_cmpeq_epi16;
        /// Bits that both have.
        and = _mm_and_si128;
        /// Bits that only `other` has.
        not_and = _mm_andnot_si128;
        /// Bits that one has.
        or = _mm_or_si128;
        /// Bits that one of both has.
        xor = _mm_xor_si128;
    }

    /// A word, and nothing that is looked at.
    #[inline(always)]
    pub(crate) fn of_word(word: u32) -> Self {
        // SAFETY: the target has SSE2.
        Self(unsafe { _mm_cvtsi32_si128(word.cast_signed()) })
    }

    /// The lowest word.
    #[inline(always)]
    pub(crate) fn word(self) -> u32 {
        // SAFETY: the target has SSE2.
        unsafe { _mm_cvtsi128_si32(self.0).cast_unsigned() }
    }

    /// The same word four times.
    #[inline(always)]
    pub(crate) fn splat(word: u32) -> Self {
        // SAFETY: the target has SSE2.
        Self(unsafe { _mm_set1_epi32(word.cast_signed()) })
    }

    /// What is set is `self`'s, the rest `other`'s; `mask` says where.
    #[inline(always)]
    pub(crate) fn where_or(self, mask: Self, other: Self) -> Self {
        mask.and(self).or(mask.not_and(other))
    }

    /// All bits of the unsigned lanes that are not less.
    #[inline(always)]
    pub(crate) fn not_less(self, other: Self) -> Self {
        self.max(other).equal(self)
    }

    /// Half of the sum of unsigned lanes, rounded down.
    #[inline(always)]
    pub(crate) fn halved_sum(self, other: Self) -> Self {
        // Of what is missing to 255 up is down.
        let ones = Self::splat(u32::MAX);
        self.xor(ones).halved_sum_up(other.xor(ones)).xor(ones)
    }

    /// Half of the sum of signed lanes, rounded down.
    #[inline(always)]
    pub(crate) fn signed_halved_sum(self, other: Self) -> Self {
        let rest = Self::splat(0x7f7f_7f7f);
        self.xor(rest).halved_sum_up(other.xor(rest)).xor(rest)
    }

    /// Half of the sum of unsigned halves, rounded down.
    #[inline(always)]
    pub(crate) fn halved_sum_halves(self, other: Self) -> Self {
        let ones = Self::splat(u32::MAX);
        self.xor(ones).halved_sum_up_halves(other.xor(ones)).xor(ones)
    }

    /// Half of the difference of unsigned halves, rounded down, modulo 2^16.
    #[inline(always)]
    pub(crate) fn halved_difference_halves(self, other: Self) -> Self {
        // (a + !b + 1) / 2 is 2^15 more.
        self.halved_sum_up_halves(other.xor(Self::splat(u32::MAX))).xor(Self::splat(0x8000_8000))
    }

    /// Half of the sum of signed halves, rounded down.
    #[inline(always)]
    pub(crate) fn signed_halved_sum_halves(self, other: Self) -> Self {
        let rest = Self::splat(0x7fff_7fff);
        self.xor(rest).halved_sum_up_halves(other.xor(rest)).xor(rest)
    }

    /// All bits of the unsigned halves that are not less.
    #[inline(always)]
    pub(crate) fn not_less_halves(self, other: Self) -> Self {
        other.sub_saturating_halves(self).equal_halves(Self::splat(0))
    }
}
