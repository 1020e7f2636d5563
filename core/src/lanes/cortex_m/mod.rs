//! The operations as instructions of the DSP extension, and kernels in pieces of assembly.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

mod answers;
mod column;
mod evidence;
mod lens;
mod rows;
mod sads;
mod sevens;

pub(super) use answers::*;
pub(crate) use column::{decide_column, decide_pending};
pub(super) use evidence::*;
pub(super) use lens::{copy_words, make_rows};
pub(super) use rows::*;
pub(super) use sads::*;
pub(super) use sevens::*;

macro_rules! operations {
    ($($(#[$doc:meta])* $name:ident = $instruction:literal;)*) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub(crate) fn $name(a: u32, b: u32) -> u32 {
            let result;
            // SAFETY: works on registers only.
            unsafe { asm!(concat!($instruction, " {}, {}, {}"), lateout(reg) result, in(reg) a, in(reg) b, options(pure, nomem, nostack, preserves_flags)) };
            result
        }
    )*};
}

operations! {
    /// Saturating sum of unsigned lanes.
    add = "uqadd8";
    /// Saturating difference of unsigned lanes.
    sub = "uqsub8";
    /// Half of the sum of unsigned lanes, rounded down.
    halved_sum = "uhadd8";
    /// Saturating sum of signed lanes.
    signed_add = "qadd8";
    /// Saturating difference of signed lanes.
    signed_sub = "qsub8";
    /// Half of the sum of signed lanes, rounded down.
    signed_halved_sum = "shadd8";
    /// Sum of the four absolute differences of unsigned lanes.
    sad = "usad8";
    /// Saturating difference of unsigned halves.
    sub_saturating_halves = "uqsub16";
    /// Half of the sum of unsigned halves, rounded down.
    halved_sum_halves = "uhadd16";
    /// Half of the difference of unsigned halves, rounded down, modulo 2^16.
    halved_difference_halves = "uhsub16";
}

/// Sum of the four absolute differences of unsigned lanes, added to `sum`.
#[inline(always)]
pub(crate) fn sad_add(a: u32, b: u32, sum: u32) -> u32 {
    let result;
    // SAFETY: works on registers only.
    unsafe {
        asm!("usada8 {}, {}, {}, {}", lateout(reg) result, in(reg) a, in(reg) b, in(reg) sum, options(pure, nomem, nostack, preserves_flags))
    };
    result
}

/// Difference of the lanes modulo 256.
#[inline(always)]
pub(crate) fn wrapping_sub(a: u32, b: u32) -> u32 {
    let result;
    // SAFETY: works on registers only; the GE flags belong to the flags that an asm block may change.
    unsafe { asm!("usub8 {}, {}, {}", lateout(reg) result, in(reg) a, in(reg) b, options(pure, nomem, nostack)) };
    result
}

/// In each lane `x` where `a >= b`, else `y`.
#[inline(always)]
pub(crate) fn select_ge(a: u32, b: u32, x: u32, y: u32) -> u32 {
    let result;
    // SAFETY: works on registers only.
    unsafe {
        asm!("usub8 {r}, {a}, {b}", "sel {r}, {x}, {y}", r = out(reg) result, a = in(reg) a, b = in(reg) b, x = in(reg) x, y = in(reg) y,
            options(pure, nomem, nostack));
    }
    result
}

/// In each unsigned half `x` where `a >= b`, else `y`.
#[inline(always)]
pub(crate) fn select_ge_halves(a: u32, b: u32, x: u32, y: u32) -> u32 {
    let result;
    // SAFETY: works on registers only.
    unsafe {
        asm!("usub16 {r}, {a}, {b}", "sel {r}, {x}, {y}", r = out(reg) result, a = in(reg) a, b = in(reg) b, x = in(reg) x, y = in(reg) y,
            options(pure, nomem, nostack));
    }
    result
}

/// The lesser of unsigned lanes.
#[inline(always)]
pub(crate) fn min(a: u32, b: u32) -> u32 {
    select_ge(a, b, b, a)
}

/// The greater of unsigned lanes.
#[inline(always)]
pub(crate) fn max(a: u32, b: u32) -> u32 {
    select_ge(a, b, a, b)
}

/// The lesser and the greater of unsigned lanes.
#[inline(always)]
pub(crate) fn min_max(a: u32, b: u32) -> (u32, u32) {
    let (least, most);
    // SAFETY: works on registers only.
    unsafe {
        asm!("usub8 {l}, {a}, {b}", "sel {l}, {b}, {a}", "sel {m}, {a}, {b}", l = out(reg) least, m = lateout(reg) most,
            a = in(reg) a, b = in(reg) b, options(pure, nomem, nostack));
    }
    (least, most)
}

/// Sum of the two 16-bit halves modulo 2^16.
#[inline(always)]
pub(crate) fn add_halves(a: u32, b: u32) -> u32 {
    let result;
    // SAFETY: works on registers only.
    unsafe { asm!("uadd16 {}, {}, {}", lateout(reg) result, in(reg) a, in(reg) b, options(pure, nomem, nostack)) };
    result
}

/// The quotient, rounded towards 0; the divisor is not 0.
#[inline(always)]
pub(crate) fn quotient(a: i32, b: i32) -> i32 {
    let result;
    // The compiler would divide what it proves to fit 16 bits as such, and extend each operand.
    // SAFETY: works on registers only.
    unsafe {
        asm!("sdiv {}, {}, {}", lateout(reg) result, in(reg) a, in(reg) b, options(pure, nomem, nostack, preserves_flags))
    };
    result
}

/// A number limited to 0 to 255.
#[inline(always)]
pub(crate) fn limited_to_byte(number: i32) -> u32 {
    let result;
    // SAFETY: works on registers only.
    unsafe { asm!("usat {}, #8, {}", lateout(reg) result, in(reg) number, options(pure, nomem, nostack)) };
    result
}

/// Each of two 16-bit halves, below 2^15, at most 255.
#[inline(always)]
pub(crate) fn saturated_halves(word: u32) -> u32 {
    let result;
    // SAFETY: works on registers only.
    unsafe { asm!("usat16 {}, #8, {}", lateout(reg) result, in(reg) word, options(pure, nomem, nostack)) };
    result
}

/// Difference of the two 16-bit halves modulo 2^16.
#[inline(always)]
pub(crate) fn sub_halves(a: u32, b: u32) -> u32 {
    let result;
    // SAFETY: works on registers only.
    unsafe { asm!("usub16 {}, {}, {}", lateout(reg) result, in(reg) a, in(reg) b, options(pure, nomem, nostack)) };
    result
}

/// Sum of the lanes modulo 256.
#[inline(always)]
pub(crate) fn wrapping_add(a: u32, b: u32) -> u32 {
    let result;
    // SAFETY: works on registers only.
    unsafe { asm!("uadd8 {}, {}, {}", lateout(reg) result, in(reg) a, in(reg) b, options(pure, nomem, nostack)) };
    result
}

/// A word that is held in a register: constants of a loop are else made anew in each turn.
#[inline(always)]
pub(crate) fn held(word: u32) -> u32 {
    let mut word = word;
    // SAFETY: does nothing.
    unsafe { asm!("/* {} */", inout(reg) word, options(pure, nomem, nostack, preserves_flags)) };
    word
}
