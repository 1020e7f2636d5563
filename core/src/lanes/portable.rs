//! The operations on any target: carries are kept within a lane by masking each lane's top bit.

const TOP: u32 = 0x8080_8080;
const REST: u32 = !TOP;

/// 0xff in each lane whose top bit is set, else 0.
#[inline(always)]
const fn spread(top: u32) -> u32 {
    ((top & TOP) >> 7).wrapping_mul(0xff)
}

/// Sum of the lanes modulo 256, and in the top bits the carries out of them.
#[inline(always)]
const fn sum(a: u32, b: u32) -> (u32, u32) {
    let sum = ((a & REST) + (b & REST)) ^ ((a ^ b) & TOP);
    (sum, (a & b) | ((a | b) & !sum))
}

/// Difference of the lanes modulo 256, and in the top bits where `a < b`.
#[inline(always)]
const fn less(a: u32, b: u32) -> (u32, u32) {
    let difference = ((a | TOP) - (b & REST)) ^ ((a ^ !b) & TOP);
    (difference, (!a & b) | ((!a | b) & difference))
}

/// Saturating sum of unsigned lanes (UQADD8).
#[inline(always)]
pub(crate) const fn add(a: u32, b: u32) -> u32 {
    let (sum, carry) = sum(a, b);
    sum | spread(carry)
}

/// Saturating difference of unsigned lanes (UQSUB8).
#[inline(always)]
pub(crate) const fn sub(a: u32, b: u32) -> u32 {
    let (difference, borrow) = less(a, b);
    difference & !spread(borrow)
}

/// In each lane `x` where `a >= b`, else `y` (USUB8, SEL).
#[inline(always)]
pub(crate) const fn select_ge(a: u32, b: u32, x: u32, y: u32) -> u32 {
    let below = spread(less(a, b).1);
    x & !below | y & below
}

/// The lesser of unsigned lanes.
#[inline(always)]
pub(crate) const fn min(a: u32, b: u32) -> u32 {
    select_ge(a, b, b, a)
}

/// The greater of unsigned lanes.
#[inline(always)]
pub(crate) const fn max(a: u32, b: u32) -> u32 {
    select_ge(a, b, a, b)
}

/// The lesser and the greater of unsigned lanes.
#[inline(always)]
pub(crate) const fn min_max(a: u32, b: u32) -> (u32, u32) {
    (min(a, b), max(a, b))
}

/// Difference of the lanes modulo 256 (USUB8).
#[inline(always)]
pub(crate) const fn wrapping_sub(a: u32, b: u32) -> u32 {
    less(a, b).0
}

/// Half of the sum of unsigned lanes, rounded down (UHADD8).
#[inline(always)]
pub(crate) const fn halved_sum(a: u32, b: u32) -> u32 {
    (a & b) + (((a ^ b) >> 1) & REST)
}

/// Saturating sum of signed lanes (QADD8).
#[inline(always)]
pub(crate) const fn signed_add(a: u32, b: u32) -> u32 {
    let (sum, _) = sum(a, b);
    // Overflow where both have a sign that the sum has not.
    let over = spread((a ^ sum) & (b ^ sum));
    let limit = (spread(a) ^ REST) & over;
    sum & !over | limit
}

/// Saturating difference of signed lanes (QSUB8).
#[inline(always)]
pub(crate) const fn signed_sub(a: u32, b: u32) -> u32 {
    let (difference, _) = less(a, b);
    let over = spread((a ^ b) & (a ^ difference));
    let limit = (spread(a) ^ REST) & over;
    difference & !over | limit
}

/// Sum of the four absolute differences of unsigned lanes (USAD8).
#[inline(always)]
pub(crate) const fn sad(a: u32, b: u32) -> u32 {
    let d = sub(a, b) | sub(b, a);
    let pairs = (d & 0x00ff_00ff) + (d >> 8 & 0x00ff_00ff);
    (pairs + (pairs >> 16)) & 0xffff
}

/// The same, added to `sum` (USADA8).
#[inline(always)]
pub(crate) const fn sad_add(a: u32, b: u32, sum: u32) -> u32 {
    sum + sad(a, b)
}

/// Half of the sum of signed lanes, rounded down (SHADD8).
#[inline(always)]
pub(crate) const fn signed_halved_sum(a: u32, b: u32) -> u32 {
    halved_sum(a ^ TOP, b ^ TOP) ^ TOP
}

/// The quotient, rounded towards 0; the divisor is not 0 (SDIV).
#[inline(always)]
pub(crate) const fn quotient(a: i32, b: i32) -> i32 {
    a / b
}

/// A number limited to 0 to 255 (USAT).
#[inline(always)]
pub(crate) fn limited_to_byte(number: i32) -> u32 {
    number.clamp(0, 255).cast_unsigned()
}

/// Each of two 16-bit halves, below 2^15, at most 255 (USAT16).
#[inline(always)]
pub(crate) const fn saturated_halves(word: u32) -> u32 {
    // 0x80 in a half that is greater, which 0xff then replaces.
    let over =
        ((word >> 8 | word >> 9 | word >> 10 | word >> 11 | word >> 12 | word >> 13 | word >> 14) & 0x0001_0001) * 0xff;
    (word | over) & 0x00ff_00ff
}

/// Sum of the two 16-bit halves modulo 2^16 (UADD16).
#[inline(always)]
pub(crate) const fn add_halves(a: u32, b: u32) -> u32 {
    ((a & 0x7fff_7fff) + (b & 0x7fff_7fff)) ^ ((a ^ b) & 0x8000_8000)
}

/// Difference of the two 16-bit halves modulo 2^16 (USUB16).
#[inline(always)]
pub(crate) const fn sub_halves(a: u32, b: u32) -> u32 {
    ((a | 0x8000_8000) - (b & 0x7fff_7fff)) ^ ((a ^ !b) & 0x8000_8000)
}

/// What a function makes of each pair of halves.
#[inline(always)]
fn by_halves(a: u32, b: u32, f: impl Fn(u32, u32) -> u32) -> u32 {
    f(a & 0xffff, b & 0xffff) & 0xffff | f(a >> 16, b >> 16) << 16
}

/// Saturating difference of unsigned halves (UQSUB16).
#[inline(always)]
pub(crate) fn sub_saturating_halves(a: u32, b: u32) -> u32 {
    by_halves(a, b, u32::saturating_sub)
}

/// Half of the sum of unsigned halves, rounded down (UHADD16).
#[inline(always)]
pub(crate) fn halved_sum_halves(a: u32, b: u32) -> u32 {
    by_halves(a, b, |a, b| (a + b) >> 1)
}

/// Half of the difference of unsigned halves, rounded down, modulo 2^16 (UHSUB16).
#[inline(always)]
pub(crate) fn halved_difference_halves(a: u32, b: u32) -> u32 {
    by_halves(a, b, |a, b| a.wrapping_sub(b) >> 1)
}

/// The greater of signed halves (SSUB16, SEL).
#[inline(always)]
pub(crate) fn signed_max_halves(a: u32, b: u32) -> u32 {
    select_ge_halves(a ^ 0x8000_8000, b ^ 0x8000_8000, a, b)
}

/// In each unsigned half `x` where `a >= b`, else `y` (USUB16, SEL).
#[inline(always)]
pub(crate) fn select_ge_halves(a: u32, b: u32, x: u32, y: u32) -> u32 {
    let low = if a & 0xffff >= b & 0xffff { x } else { y };
    let high = if a >> 16 >= b >> 16 { x } else { y };
    low & 0xffff | high & 0xffff_0000
}

/// Sum of the lanes modulo 256 (UADD8).
#[inline(always)]
pub(crate) const fn wrapping_add(a: u32, b: u32) -> u32 {
    sum(a, b).0
}

/// The word: only Cortex-M has to be told to hold it in a register.
#[inline(always)]
pub(crate) const fn held(word: u32) -> u32 {
    word
}
