//! The steps as whole loops of instructions, sixteen labels a round.
//!
//! A label's neighbours are read by words that begin one byte further down and up: the words of zeros before and behind the
//! labels are neighbours that never count. Where a path is written over the one before, the lower neighbours of the
//! next word are read first.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;
use core::mem::offset_of;

use super::{Column, Merits, P1, UNROLLED};

/// For each of `candidates`, four in a word, how many bits are those of `pixel`, the same byte four times.
#[inline(always)]
pub fn agree(pixel: u32, candidates: &[u8], agreement: &mut [u32]) {
    let words = agreement.len();
    assert!(words > 0 && words.is_multiple_of(UNROLLED) && candidates.len() >= 4 * words);
    // SAFETY: it reads `4 * words` bytes of `candidates` and writes `words` words of `agreement`, which are that long.
    unsafe {
        asm!(
            "2:",
            "ldr r1, [{candidates}, #4]",
            "ldr r2, [{candidates}, #8]",
            "ldr r3, [{candidates}, #12]",
            "ldr r0, [{candidates}], #16",
            "eor r0, r0, {other}",
            "eor r1, r1, {other}",
            "eor r2, r2, {other}",
            "eor r3, r3, {other}",
            "and {t}, {m5}, r0, lsr #1",
            "subs {words}, {words}, #4",
            "sub r0, r0, {t}",
            "and {t}, {m5}, r1, lsr #1",
            "sub r1, r1, {t}",
            "and {t}, {m5}, r2, lsr #1",
            "sub r2, r2, {t}",
            "and {t}, {m5}, r3, lsr #1",
            "sub r3, r3, {t}",
            // Pairs of bits `4 a + b` become `a + b`.
            "and {t}, {m3}, r0, lsr #2",
            "mls r0, {t}, {three}, r0",
            "and {t}, {m3}, r1, lsr #2",
            "mls r1, {t}, {three}, r1",
            "and {t}, {m3}, r2, lsr #2",
            "mls r2, {t}, {three}, r2",
            "and {t}, {m3}, r3, lsr #2",
            "mls r3, {t}, {three}, r3",
            "add r0, r0, r0, lsr #4",
            "add r1, r1, r1, lsr #4",
            "add r2, r2, r2, lsr #4",
            "add r3, r3, r3, lsr #4",
            "and r0, r0, #0x0f0f0f0f",
            "and r1, r1, #0x0f0f0f0f",
            "and r2, r2, #0x0f0f0f0f",
            "and r3, r3, #0x0f0f0f0f",
            "stm {agreement}!, {{r0, r1, r2, r3}}",
            "bne 2b",
            candidates = inout(reg) candidates.as_ptr() => _,
            agreement = inout(reg) agreement.as_mut_ptr() => _,
            words = inout(reg) words => _,
            other = in(reg) !pixel,
            m5 = in(reg) 0x5555_5555_u32,
            m3 = in(reg) 0x3333_3333_u32,
            three = in(reg) 3_u32,
            t = out(reg) _,
            out("r0") _,
            out("r1") _,
            out("r2") _,
            out("r3") _,
            options(nostack)
        );
    }
}

/// The greatest of staying, changing by one label and jumping: `h` has the label's own merits before and after, `u` the
/// lower neighbours', which are lost, `d` the upper ones'; `t` is free.
macro_rules! best {
    ($h:literal, $u:literal, $d:literal, $t:literal) => {
        concat!(
            "usub8 {",
            $t,
            "}, {",
            $u,
            "}, {",
            $d,
            "}\n",
            "sel {",
            $u,
            "}, {",
            $u,
            "}, {",
            $d,
            "}\n",
            "uqsub8 {",
            $h,
            "}, {",
            $h,
            "}, {stay}\n",
            "uqsub8 {",
            $u,
            "}, {",
            $u,
            "}, {change}\n",
            "usub8 {",
            $t,
            "}, {",
            $h,
            "}, {",
            $u,
            "}\n",
            "sel {",
            $h,
            "}, {",
            $h,
            "}, {",
            $u,
            "}\n",
        )
    };
}

/// Keeps the greatest bytes in `most`; `t` is free.
macro_rules! keep_most {
    ($most:literal, $x:literal, $t:literal) => {
        concat!("usub8 {", $t, "}, {", $x, "}, {", $most, "}\n", "sel {", $most, "}, {", $x, "}, {", $most, "}\n",)
    };
}

/// The greatest byte of `x` in all its bytes; `t` and `s` are free.
macro_rules! spread {
    ($x:literal, $t:literal, $s:literal) => {
        concat!(
            "ror {", $t, "}, {", $x, "}, #16\n", "usub8 {", $s, "}, {", $x, "}, {", $t, "}\n", "sel {", $x, "}, {", $x,
            "}, {", $t, "}\n", "ror {", $t, "}, {", $x, "}, #8\n", "usub8 {", $s, "}, {", $x, "}, {", $t, "}\n",
            "sel {", $x, "}, {", $x, "}, {", $t, "}\n",
        )
    };
}

/// Two words of the path from the right; `at` is their place behind `before` and `column`, which are at the right's merits.
macro_rules! right_pair {
    ($at:literal) => {
        concat!(
            "ldrd {h0}, {h1}, [{before}, #",
            $at,
            "]\n",
            "ldr {u}, [{before}, #",
            $at,
            "-1]\n",
            "ldr {d}, [{before}, #",
            $at,
            "+1]\n",
            best!("h0", "u", "d", "a0"),
            "ldr {u}, [{before}, #",
            $at,
            "+3]\n",
            "ldr {d}, [{before}, #",
            $at,
            "+5]\n",
            best!("h1", "u", "d", "a0"),
            "ldrd {a0}, {a1}, [{column}, #",
            $at,
            "+{agreement}]\n",
            "add {h0}, {h0}, {a0}\n",
            "add {h1}, {h1}, {a1}\n",
            keep_most!("most", "h0", "u"),
            keep_most!("most", "h1", "u"),
            "strd {h0}, {h1}, [{column}, #",
            $at,
            "]\n",
        )
    };
}

/// The path from the right: from `before` to the next column. `floor` is that of `before`. Gives the greatest merit.
#[inline(always)]
pub fn step_from_right<const WORDS: usize>(
    before: &mut Column<WORDS>,
    column: &mut Column<WORDS>,
    words: usize,
    floor: u32,
) -> u32 {
    assert!(words > 0 && words.is_multiple_of(UNROLLED) && words <= WORDS);
    let right = offset_of!(Column<WORDS>, right);
    let (before, column) = (&raw const *before, &raw mut *column);
    let mut most = 0;
    // SAFETY: of each column it reads or writes the first `words` words of arrays of `WORDS`, and reads the words of
    // zeros on either side of `right`.
    unsafe {
        asm!(
            "add {change}, {stay}, {p1}",
            "2:",
            right_pair!("0"),
            right_pair!("8"),
            "add {before}, {before}, #16",
            "add {column}, {column}, #16",
            "subs {words}, {words}, #4",
            "bne 2b",
            spread!("most", "u", "d"),
            before = inout(reg) before.byte_add(right) => _,
            column = inout(reg) column.byte_add(right) => _,
            words = inout(reg) words => _,
            stay = in(reg) floor,
            change = out(reg) _,
            most = inout(reg) most,
            h0 = out(reg) _,
            h1 = out(reg) _,
            u = out(reg) _,
            d = out(reg) _,
            a0 = out(reg) _,
            a1 = out(reg) _,
            p1 = const P1 as u32 * 0x0101_0101,
            agreement = const offset_of!(Column<WORDS>, agreement) - offset_of!(Column<WORDS>, right),
            options(nostack)
        );
    }
    most
}

/// Two words of the path from the left, over the ones before. `u` has the lower neighbours of the first word, and then
/// those of the word behind the second.
macro_rules! left_pair {
    ($at:literal) => {
        concat!(
            "ldrd {h0}, {h1}, [{path}, #",
            $at,
            "]\n",
            "ldr {d}, [{path}, #",
            $at,
            "+1]\n",
            best!("h0", "u", "d", "a0"),
            "ldr {u}, [{path}, #",
            $at,
            "+3]\n",
            "ldr {d}, [{path}, #",
            $at,
            "+5]\n",
            best!("h1", "u", "d", "a0"),
            "ldrd {a0}, {a1}, [{column}, #",
            $at,
            "+{agreement}]\n",
            "add {h0}, {h0}, {a0}\n",
            "add {h1}, {h1}, {a1}\n",
            keep_most!("most", "h0", "d"),
            keep_most!("most", "h1", "d"),
            "ldrd {a0}, {a1}, [{column}, #",
            $at,
            "]\n",
            "ldr {u}, [{path}, #",
            $at,
            "+7]\n",
            "add {a0}, {a0}, {h0}\n",
            "add {a1}, {a1}, {h1}\n",
            "strd {h0}, {h1}, [{path}, #",
            $at,
            "]\n",
            "strd {a0}, {a1}, [{column}, #",
            $at,
            "]\n",
        )
    };
}

/// The path from the left: from the pixel before to that of `column`, and adds its merits to those of the path from the right.
#[inline(always)]
pub fn step_from_left<const WORDS: usize>(
    left: &mut Merits<WORDS>,
    column: &mut Column<WORDS>,
    words: usize,
    floor: u32,
) -> u32 {
    assert!(words > 0 && words.is_multiple_of(UNROLLED) && words <= WORDS);
    let (left, column) = (&raw mut *left, &raw mut *column);
    let mut most = 0;
    // SAFETY: it reads and writes the first `words` words of arrays of `WORDS`, and reads the words of zeros on either
    // side of `labels`.
    unsafe {
        asm!(
            "add {change}, {stay}, {p1}",
            "ldr {u}, [{path}, #-1]",
            "2:",
            left_pair!("0"),
            left_pair!("8"),
            "add {path}, {path}, #16",
            "add {column}, {column}, #16",
            "subs {words}, {words}, #4",
            "bne 2b",
            spread!("most", "u", "d"),
            path = inout(reg) left.byte_add(offset_of!(Merits<WORDS>, labels)) => _,
            column = inout(reg) column.byte_add(offset_of!(Column<WORDS>, right)) => _,
            words = inout(reg) words => _,
            stay = in(reg) floor,
            change = out(reg) _,
            most = inout(reg) most,
            h0 = out(reg) _,
            h1 = out(reg) _,
            u = out(reg) _,
            d = out(reg) _,
            a0 = out(reg) _,
            a1 = out(reg) _,
            p1 = const P1 as u32 * 0x0101_0101,
            agreement = const offset_of!(Column<WORDS>, agreement) - offset_of!(Column<WORDS>, right),
            options(nostack)
        );
    }
    most
}

/// Two words of the path from above, over the ones before, and the sums of all paths. `u` as from the left.
macro_rules! above_pair {
    ($at:literal) => {
        concat!(
            "ldrd {h0}, {h1}, [{column}, #",
            $at,
            "]\n",
            "ldr {d}, [{column}, #",
            $at,
            "+1]\n",
            best!("h0", "u", "d", "a0"),
            "ldr {u}, [{column}, #",
            $at,
            "+3]\n",
            "ldr {d}, [{column}, #",
            $at,
            "+5]\n",
            best!("h1", "u", "d", "a0"),
            "ldrd {a0}, {a1}, [{column}, #",
            $at,
            "+{agreement}]\n",
            "add {h0}, {h0}, {a0}\n",
            "add {h1}, {h1}, {a1}\n",
            keep_most!("most", "h0", "d"),
            keep_most!("most", "h1", "d"),
            "ldrd {a0}, {a1}, [{column}, #",
            $at,
            "+{right}]\n",
            "ldr {u}, [{column}, #",
            $at,
            "+7]\n",
            "add {a0}, {a0}, {h0}\n",
            "add {a1}, {a1}, {h1}\n",
            "strd {h0}, {h1}, [{column}, #",
            $at,
            "]\n",
            keep_most!("best", "a0", "d"),
            keep_most!("best", "a1", "d"),
            "strd {a0}, {a1}, [{column}, #",
            $at,
            "+{agreement}]\n",
        )
    };
}

/// The path from above, and the sums of all three. Gives the greatest merit and the greatest sum.
#[inline(always)]
pub fn step_from_above<const WORDS: usize>(column: &mut Column<WORDS>, words: usize, floor: u32) -> (u32, u32) {
    assert!(words > 0 && words.is_multiple_of(UNROLLED) && words <= WORDS);
    let column = &raw mut *column;
    let (mut most, mut best) = (0, 0);
    // SAFETY: it reads and writes the first `words` words of arrays of `WORDS`, and reads the words of zeros on either
    // side of `above`.
    unsafe {
        asm!(
            "add {change}, {stay}, {p1}",
            "ldr {u}, [{column}, #-1]",
            "2:",
            above_pair!("0"),
            above_pair!("8"),
            "add {column}, {column}, #16",
            "subs {words}, {words}, #4",
            "bne 2b",
            spread!("most", "u", "d"),
            spread!("best", "u", "d"),
            column = inout(reg) column.byte_add(offset_of!(Column<WORDS>, above)) => _,
            words = inout(reg) words => _,
            stay = in(reg) floor,
            change = out(reg) _,
            most = inout(reg) most,
            best = inout(reg) best,
            h0 = out(reg) _,
            h1 = out(reg) _,
            u = out(reg) _,
            d = out(reg) _,
            a0 = out(reg) _,
            a1 = out(reg) _,
            p1 = const P1 as u32 * 0x0101_0101,
            right = const offset_of!(Column<WORDS>, right) - offset_of!(Column<WORDS>, above),
            agreement = const offset_of!(Column<WORDS>, agreement) - offset_of!(Column<WORDS>, above),
            options(nostack)
        );
    }
    (most, best)
}
