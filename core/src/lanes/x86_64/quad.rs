//! Four words at once in a register of SSE2, which every x86-64 has: sixteen lanes, or eight halves.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

#[allow(clippy::wildcard_imports, reason = "a few dozen instructions, all with the same prefix")]
use core::arch::x86_64::*;

use crate::Disparity;

/// Sixteen bytes without gaps, each of which may be any.
///
/// # Safety
/// It is as it says.
pub(crate) unsafe trait Sixteen: Copy {}

// SAFETY: sixteen numbers of 8 bits, eight of 16, or four of 32.
unsafe impl Sixteen for [u8; 16] {}
// SAFETY: as before.
unsafe impl Sixteen for [[u16; 2]; 4] {}
// SAFETY: as before.
unsafe impl Sixteen for [[i16; 2]; 4] {}
// SAFETY: as before.
unsafe impl Sixteen for [[u32; 2]; 2] {}
// SAFETY: as before; a disparity is its bits.
unsafe impl Sixteen for [[Disparity; 4]; 2] {}

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
        /// Sum of the words as numbers.
        add_words = _mm_add_epi32;
        /// Difference of the words as numbers.
        sub_words = _mm_sub_epi32;
        /// All bits of the words that are greater as signed numbers.
        greater_words = _mm_cmpgt_epi32;
        /// The greater of signed halves.
        signed_max_halves = _mm_max_epi16;
        /// Bits that both have.
        and = _mm_and_si128;
        /// Bits that only `other` has.
        not_and = _mm_andnot_si128;
        /// Bits that one has.
        or = _mm_or_si128;
        /// Bits that one of both has.
        xor = _mm_xor_si128;
        /// The lower two words of both, in turn.
        in_turn = _mm_unpacklo_epi32;
        /// The upper two words of both, in turn.
        upper_in_turn = _mm_unpackhi_epi32;
        /// The lower four halves of both, in turn.
        halves_in_turn = _mm_unpacklo_epi16;
        /// The upper four halves of both, in turn.
        upper_halves_in_turn = _mm_unpackhi_epi16;
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

    /// All bits of the unsigned halves that are not less.
    #[inline(always)]
    pub(crate) fn not_less_halves(self, other: Self) -> Self {
        other.sub_saturating_halves(self).equal_halves(Self::splat(0))
    }

    /// Four words.
    #[inline(always)]
    pub(crate) fn of([a, b, c, d]: [u32; 4]) -> Self {
        let [a, b, c, d] = [a, b, c, d].map(u32::cast_signed);
        // SAFETY: the target has SSE2.
        Self(unsafe { _mm_set_epi32(d, c, b, a) })
    }

    /// Two words, and 0.
    #[inline(always)]
    pub(crate) fn of_two([a, b]: [u32; 2]) -> Self {
        Self::of([a, b, 0, 0])
    }

    /// Sixteen bytes from one of a slice of words on.
    ///
    /// # Safety
    /// All must lie within the slice.
    #[inline(always)]
    pub(crate) unsafe fn load(row: &[u32], byte: usize) -> Self {
        debug_assert!(byte + 16 <= 4 * row.len());
        // SAFETY: as the caller promises.
        Self(unsafe { _mm_loadu_si128(row.as_ptr().cast::<u8>().add(byte).cast()) })
    }

    /// The same of eight bytes, and 0.
    ///
    /// # Safety
    /// All must lie within the slice.
    #[inline(always)]
    pub(crate) unsafe fn load_two(row: &[u32], byte: usize) -> Self {
        debug_assert!(byte + 8 <= 4 * row.len());
        // SAFETY: as the caller promises.
        Self(unsafe { _mm_loadl_epi64(row.as_ptr().cast::<u8>().add(byte).cast()) })
    }

    /// The same of four bytes, and 0.
    ///
    /// # Safety
    /// All must lie within the slice.
    #[inline(always)]
    pub(crate) unsafe fn load_word(row: &[u32], byte: usize) -> Self {
        debug_assert!(byte + 4 <= 4 * row.len());
        // SAFETY: as the caller promises.
        Self::of_word(unsafe { row.as_ptr().cast::<u8>().add(byte).cast::<u32>().read_unaligned() })
    }

    /// The words.
    #[inline(always)]
    pub(crate) fn words(self) -> [u32; 4] {
        let mut words = [0; 4];
        // SAFETY: four words are there.
        unsafe { _mm_storeu_si128(words.as_mut_ptr().cast(), self.0) };
        words
    }

    /// The lower two words.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the halves are meant")]
    pub(crate) fn two_words(self) -> [u32; 2] {
        // SAFETY: the target has SSE2.
        let both = unsafe { _mm_cvtsi128_si64(self.0) }.cast_unsigned();
        [both as u32, (both >> 32) as u32]
    }

    /// What sixteen bytes hold.
    #[inline(always)]
    pub(crate) fn read<T: Sixteen>(from: &T) -> Self {
        // SAFETY: sixteen bytes are there.
        Self(unsafe { _mm_loadu_si128(core::ptr::from_ref(from).cast()) })
    }

    /// Puts it into sixteen bytes.
    #[inline(always)]
    pub(crate) fn write<T: Sixteen>(self, to: &mut T) {
        // SAFETY: sixteen bytes are there, and may be any.
        unsafe { _mm_storeu_si128(core::ptr::from_mut(to).cast(), self.0) };
    }

    /// Each half shifted towards its lower lane.
    #[inline(always)]
    pub(crate) fn halves_down<const BITS: i32>(self) -> Self {
        // SAFETY: the target has SSE2.
        Self(unsafe { _mm_srli_epi16::<BITS>(self.0) })
    }

    /// The last bytes of `before`, so many, and what follows; `REST` is 16 less `BYTES`.
    #[inline(always)]
    pub(crate) fn after<const BYTES: i32, const REST: i32>(self, before: Self) -> Self {
        const { assert!(BYTES + REST == 16) }
        // SAFETY: the target has SSE2.
        unsafe { Self(_mm_slli_si128::<BYTES>(self.0)).or(Self(_mm_srli_si128::<REST>(before.0))) }
    }

    /// Four sums as halves: those in the words 0 and 2, and those of `others`.
    #[inline(always)]
    fn packed_sums(self, others: Self) -> Self {
        // The first time an empty half stays between any two.
        // SAFETY: the target has SSE2.
        unsafe {
            let apart = _mm_packs_epi32(self.0, others.0);
            Self(_mm_packs_epi32(apart, apart))
        }
    }

    /// Four sums as halves: those in the words 0 and 2, and those of `others`.
    #[inline(always)]
    pub(crate) fn sums_as_halves(self, others: Self) -> [u32; 2] {
        self.packed_sums(others).two_words()
    }

    /// The same as bytes, at most 255.
    #[inline(always)]
    pub(crate) fn sums_as_bytes(self, others: Self) -> u32 {
        let halves = self.packed_sums(others);
        // SAFETY: the target has SSE2.
        Self(unsafe { _mm_packus_epi16(halves.0, halves.0) }).word()
    }

    /// Each word shifted towards its higher lanes.
    #[inline(always)]
    pub(crate) fn up<const BITS: i32>(self) -> Self {
        // SAFETY: the target has SSE2.
        Self(unsafe { _mm_slli_epi32::<BITS>(self.0) })
    }

    /// Each word shifted towards its lower lanes.
    #[inline(always)]
    pub(crate) fn down<const BITS: i32>(self) -> Self {
        // SAFETY: the target has SSE2.
        Self(unsafe { _mm_srli_epi32::<BITS>(self.0) })
    }

    /// Each word rotated towards its lower lanes; `REST` is 32 less `BITS`.
    #[inline(always)]
    pub(crate) fn rotated<const BITS: i32, const REST: i32>(self) -> Self {
        const { assert!(BITS + REST == 32) }
        self.down::<BITS>().or(self.up::<REST>())
    }

    /// The lower two words of both.
    #[inline(always)]
    pub(crate) fn lower(self, other: Self) -> Self {
        // SAFETY: the target has SSE2.
        Self(unsafe { _mm_unpacklo_epi64(self.0, other.0) })
    }

    /// The upper two words of both.
    #[inline(always)]
    pub(crate) fn upper(self, other: Self) -> Self {
        // SAFETY: the target has SSE2.
        Self(unsafe { _mm_unpackhi_epi64(self.0, other.0) })
    }

    /// The lowest lane of each word in all of its lanes; the others must be 0.
    #[inline(always)]
    pub(crate) fn lowest_spread(self) -> Self {
        let twice = self.or(self.up::<8>());
        twice.or(twice.up::<16>())
    }

    /// The sum of each word's lanes, at most 255 + 255 + 255 + 255, as its number.
    #[inline(always)]
    pub(crate) fn sum_of_lanes(self) -> Self {
        let even = Self::splat(0x00ff_00ff);
        let pairs = self.and(even).add_halves(self.down::<8>().and(even));
        // SAFETY: the target has SSE2.
        Self(unsafe { _mm_madd_epi16(pairs.0, _mm_set1_epi16(1)) })
    }

    /// In each word's lowest lane its least one; the others are of no use.
    #[inline(always)]
    pub(crate) fn least(self) -> Self {
        let pair = self.min(self.down::<16>());
        pair.min(pair.down::<8>())
    }

    /// The same in all lanes.
    #[inline(always)]
    pub(crate) fn least_spread(self) -> Self {
        let pair = self.min(self.rotated::<16, 16>());
        pair.min(pair.rotated::<8, 24>())
    }

    /// In all lanes of each word its greatest one.
    #[inline(always)]
    pub(crate) fn greatest_spread(self) -> Self {
        let pair = self.max(self.rotated::<16, 16>());
        pair.max(pair.rotated::<8, 24>())
    }

    /// In all lanes of the lower and the upper two words their greatest one.
    #[inline(always)]
    pub(crate) fn greatest_of_two_words(self) -> Self {
        // SAFETY: the target has SSE2.
        let swapped = Self(unsafe { _mm_shuffle_epi32::<0b10_11_00_01>(self.0) });
        self.max(swapped).greatest_spread()
    }

    /// `|self - other|` of unsigned lanes.
    #[inline(always)]
    pub(crate) fn difference(self, other: Self) -> Self {
        self.sub(other).or(other.sub(self))
    }

    /// `|self - other|` of unsigned halves.
    #[inline(always)]
    pub(crate) fn difference_of_halves(self, other: Self) -> Self {
        self.sub_saturating_halves(other).or(other.sub_saturating_halves(self))
    }

    /// A bit for each lane: its top one.
    #[inline(always)]
    pub(crate) fn top_bits(self) -> u32 {
        // SAFETY: the target has SSE2.
        unsafe { _mm_movemask_epi8(self.0) }.cast_unsigned()
    }

    /// Of each word as a number: `128 * self / divisor`, rounded towards 0 and limited to -128 to 127; anything if
    /// the divisor is 0. Both are less than 512.
    #[inline(always)]
    pub(crate) fn limited_fraction(self, divisor: Self) -> Self {
        // The quotients are at least 1/512 from a whole number that they are not: rounding does not reach it.
        // SAFETY: the target has SSE2.
        unsafe {
            let number = _mm_mul_ps(_mm_cvtepi32_ps(self.0), _mm_set1_ps(128.0));
            let quotient = _mm_div_ps(number, _mm_cvtepi32_ps(divisor.0));
            let limited = _mm_min_ps(_mm_max_ps(quotient, _mm_set1_ps(-128.0)), _mm_set1_ps(127.0));
            Self(_mm_cvttps_epi32(limited))
        }
    }
}
