//! Cells by a loop whose figures all stay in registers.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

use super::{Bits, ConfidenceCodes, Confidences, Disparities, DisparityCodes, TABLE};
use crate::Disparity;
use crate::lanes::splat;

/// Stores the word that is full, where the stack says; what is left of the bits `$bits` that filled it is pending.
macro_rules! flush {
    ($bits:literal, $to:literal) => {
        concat!(
            "ldr ",
            $to,
            ", [sp]\n str {pending}, [",
            $to,
            "], #4\n str ",
            $to,
            ", [sp]\n",
            "rsb ",
            $to,
            ", {count}, #32\n lsr {pending}, ",
            $bits,
            ", ",
            $to,
        )
    };
}

/// Writes the confidences of cells up to one that has no code: how many cells. Both rows must have the same.
#[inline(never)]
pub(crate) fn put_confidences(
    [upper, lower]: [&[[u8; 4]]; 2],
    codes: &ConfidenceCodes,
    state: &mut Confidences,
    bits: &mut Bits<'_>,
) -> usize {
    let most = upper.len().min(lower.len()).min(bits.room());
    if most == 0 {
        return 0;
    }
    let mut before = i32::from(state.before) - 128;
    let base = codes.0.as_ptr().cast::<u8>();
    let mut table = base.wrapping_add(ConfidenceCodes::next(state.is_steady));
    let begin = upper.as_ptr();
    let mut at = begin;
    // SAFETY: reads as many cells as both rows have, and of a table of 32 codes one that the index is limited to; each
    // cell adds less than 32 bits, so that at most as many words are written as there are cells, for which there is room.
    unsafe {
        let out = bits.words.as_mut_ptr().add(bits.used);
        let next: *mut [u8; 4];
        asm!(
            "push {{r7}}",
            "push {{{e}}}",
            "mov r7, {a}",
            "2:",
            "ldr {a}, [{u}], #4",
            "ldr {b}, [{l}], #4",
            "cmp {a}, {b}",
            "bne 5f",
            "cmp {a}, r7",
            "beq 7f",
            "cmp.w {a}, {a}, ror #8",
            "bne 5f",
            "mov r7, {a}",
            "uxtb {a}, {a}",
            "sub {b}, {a}, {before}",
            "ror {b}, {b}, #3",
            "usat {b}, #5, {b}",
            "ldr {b}, [{table}, {b}, lsl #2]",
            "ubfx {c}, {b}, #8, #15",
            "uxtab {e}, {count}, {b}",
            "cmp {e}, #32",
            "bhs 4f",
            "lsl {c}, {c}, {count}",
            "orr {pending}, {pending}, {c}",
            "mov {count}, {e}",
            "3:",
            "sub {before}, {a}, #128",
            "add {table}, {base}, {b}, lsr #23",
            "cmp {u}, {end}",
            "bne 2b",
            "b 6f",
            "4:",
            "cmp {e}, #64",
            "bhs 5f",
            "lsl {a}, {c}, {count}",
            "orr {pending}, {pending}, {a}",
            flush!("{c}", "{a}"),
            "sub {count}, {e}, #32",
            "uxtb {a}, r7",
            "b 3b",
            // The same as before in the whole cell: a bit of 0.
            "7:",
            "add {table}, {base}, #{steady}",
            "add {count}, {count}, #1",
            "cmp {count}, #32",
            "beq 8f",
            "cmp {u}, {end}",
            "bne 2b",
            "b 6f",
            "8:",
            "ldr {a}, [sp]",
            "str {pending}, [{a}], #4",
            "str {a}, [sp]",
            "mov {pending}, #0",
            "mov {count}, #0",
            "cmp {u}, {end}",
            "bne 2b",
            "b 6f",
            "5:",
            "sub {u}, {u}, #4",
            "6:",
            "pop {{{e}}}",
            "pop {{r7}}",
            u = inout(reg) at,
            l = inout(reg) lower.as_ptr() => _,
            end = in(reg) begin.add(most),
            pending = inout(reg) bits.pending,
            count = inout(reg) bits.count,
            before = inout(reg) before,
            table = inout(reg) table,
            base = in(reg) base,
            steady = const TABLE,
            // A row's first cell has none before it, but then 0 is what it would be.
            a = inout(reg) splat(state.before.into()) => _,
            b = out(reg) _, c = out(reg) _,
            e = inout(reg) out => next,
        );
        bits.used += next.offset_from(out).cast_unsigned();
        state.before = u8::try_from(before + 128).unwrap_or(0);
        state.is_steady = table != base;
        at.offset_from(begin).cast_unsigned()
    }
}

/// Writes the disparities of cells, two columns in a word, up to one that has no code: how many cells.
#[inline(never)]
pub(crate) fn put_disparities(
    [upper, lower]: [&[[Disparity; 4]]; 2],
    codes: &DisparityCodes,
    state: &mut Disparities,
    bits: &mut Bits<'_>,
) -> usize {
    let most = upper.len().min(lower.len()).min(bits.room() / 2);
    if most == 0 {
        return 0;
    }
    let base = codes.value.as_ptr().wrapping_add(32).cast::<u8>();
    let mut table = base.wrapping_add(DisparityCodes::next(state.down));
    let begin = upper.as_ptr();
    let mut at = begin;
    // SAFETY: reads as many cells as both rows have, and of each table one that the index is limited to; each
    // cell adds less than 64 bits, so that at most two words are written for each, for which there is room.
    unsafe {
        let out = bits.words.as_mut_ptr().add(bits.used);
        let next: *mut [u8; 4];
        asm!(
            "push {{r7}}",
            "push {{{e}}}",
            "push {{{f}}}",
            "2:",
            // No two words at once: rows need not begin at one.
            "ldr {a}, [{u}], #4",
            "ldr r7, [{u}], #4",
            "ldr {c}, [{l}], #4",
            "ldr {d}, [{l}], #4",
            "usub16 {c}, {c}, {a}",
            "usub16 {d}, {d}, r7",
            "cmp {c}, {d}",
            "bne 5f",
            "cmp.w {c}, {c}, ror #16",
            "bne 5f",
            "ssat {c}, #5, {c}, asr #16",
            "asr {d}, r7, #16",
            "sxth {e}, {a}",
            // The shape that the columns between the first and the last must have.
            "sub {f}, {d}, {e}",
            "ssat {f}, #6, {f}",
            "add {f}, {base}, {f}, lsl #3",
            "pkhbt r7, r7, {a}",
            "pkhbt {a}, {a}, {a}, lsl #16",
            "usub16 r7, r7, {a}",
            "ldrd {a}, {f}, [{f}, #{shape}]",
            "cmp r7, {a}",
            "bne 5f",
            "sub {e}, {e}, {before}",
            "ssat {e}, #6, {e}",
            "ldr {e}, [{base}, {e}, lsl #2]",
            "ldr {c}, [{table}, {c}, lsl #2]",
            // Shape, value, down; the number of bits is the lowest byte, which is all that a shift takes of a register.
            "ubfx {a}, {c}, #8, #15",
            "lsl {a}, {a}, {e}",
            "orr {a}, {a}, {e}, lsr #8",
            "lsl {a}, {a}, {f}",
            "orr {a}, {a}, {f}, lsr #8",
            "uxtab r7, {count}, {c}",
            "uxtab r7, r7, {e}",
            "uxtab r7, r7, {f}",
            "9:",
            "cmp r7, #32",
            "bhs 4f",
            "lsl {a}, {a}, {count}",
            "orr {pending}, {pending}, {a}",
            "mov {count}, r7",
            "3:",
            "mov {before}, {d}",
            "add {table}, {base}, {c}, lsr #23",
            "ldr {e}, [sp, #4]",
            "cmp {u}, {e}",
            "bne 2b",
            "b 6f",
            "4:",
            "cmp r7, #64",
            "bhs 7f",
            "lsl {f}, {a}, {count}",
            "orr {pending}, {pending}, {f}",
            flush!("{a}", "{f}"),
            "sub {count}, r7, #32",
            "b 3b",
            // One has no code. If it is the value, its bits are told.
            "7:",
            "orr {a}, {f}, {c}",
            "tst {a}, #64",
            "bne 5f",
            "ldrsh {e}, [{u}, #-8]",
            "sub {e}, {e}, {before}",
            "ssat {a}, #12, {e}",
            "cmp {a}, {e}",
            "bne 5f",
            "cmn {e}, #2048",
            "beq 5f",
            "ldr r7, [{base}, #{escape}]",
            "ubfx {a}, {a}, #0, #12",
            "lsl {a}, {a}, r7",
            "orr {a}, {a}, r7, lsr #8",
            "lsl {a}, {a}, {f}",
            "orr {a}, {a}, {f}, lsr #8",
            "uxtab r7, {count}, r7",
            "uxtab r7, r7, {f}",
            "add r7, r7, #12",
            "lsl {e}, {a}, {count}",
            "orr {pending}, {pending}, {e}",
            "cmp r7, #32",
            "blo 8f",
            flush!("{a}", "{f}"),
            "sub r7, r7, #32",
            "8:",
            "mov {count}, r7",
            "ubfx {a}, {c}, #8, #15",
            "uxtab r7, {count}, {c}",
            "b 9b",
            "5:",
            "sub {u}, {u}, #8",
            "6:",
            "pop {{{f}}}",
            "add sp, sp, #4",
            "pop {{r7}}",
            shape = const DisparityCodes::SHAPE,
            escape = const DisparityCodes::ESCAPE,
            u = inout(reg) at,
            l = inout(reg) lower.as_ptr() => _,
            pending = inout(reg) bits.pending,
            count = inout(reg) bits.count,
            before = inout(reg) state.before,
            table = inout(reg) table,
            base = in(reg) base,
            a = out(reg) _, c = out(reg) _, d = out(reg) _,
            e = inout(reg) begin.add(most) => _,
            f = inout(reg) out => next,
        );
        bits.used += next.offset_from(out).cast_unsigned();
        state.down = (table as usize - base as usize - DisparityCodes::DOWN) / TABLE;
        at.offset_from(begin).cast_unsigned()
    }
}
