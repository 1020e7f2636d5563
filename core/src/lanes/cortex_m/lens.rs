//! Rows of lens tables, and rows copied, in pieces of assembly: 32 instructions for four pixels, 34 where their rows do not follow
//! each other in memory, and 40 more for a segment of eight times four.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

use crate::lanes::lens_runs::{MOST_APART, Rows, SEGMENT, Segment};

/// A run between the rows whose first pixels, at the run's place, r7 and r8 point to, in 29 instructions. `$above`, `$below`: where
/// the pixels of these rows and those one further right are.
macro_rules! run {
    ($below:literal, $below_right:literal) => {
        concat!(
            "ubfx r9, r2, #12, #4
             rsb r10, r9, #16
             ldr r11, [r7, #1]
             ldr r12, ",
            $below_right,
            "
             uxtb16 r11, r11, ror #8
             uxtb16 r12, r12, ror #8
             mul r11, r11, r10
             mla r11, r12, r9, r11
             ldr r8, ",
            $below,
            "
             ldr r7, [r7]
             uxtb16 r12, r7
             uxtb16 r7, r7, ror #8
             mul r12, r12, r10
             mul r7, r7, r10
             uxtb16 r10, r8
             uxtb16 r8, r8, ror #8
             mla r12, r10, r9, r12
             mla r7, r8, r9, r7
             ubfx r9, r0, #12, #4
             rsb r10, r9, #16
             mla r12, r12, r10, r6
             mla r12, r7, r9, r12
             mla r7, r7, r10, r6
             mla r7, r11, r9, r7
             rev16 r12, r12
             sel r12, r7, r12
             str r12, [r5], #4
             add r0, r0, r1
             add r2, r2, r3
            "
        )
    };
}

/// A run between two rows that follow each other in memory: 32.
macro_rules! adjoining {
    () => {
        concat!(
            "asr r7, r2, #16
             ldr r7, [r4, r7, lsl #2]
             add r7, r7, r0, asr #16
            ",
            run!("[r7, #{width}]", "[r7, #{width} + 1]")
        )
    };
}

/// A run between any two rows: 34.
macro_rules! apart {
    () => {
        concat!(
            "asr r7, r2, #16
             add r7, r4, r7, lsl #2
             ldrd r7, r8, [r7]
             add r7, r7, r0, asr #16
             add r8, r8, r0, asr #16
            ",
            run!("[r8]", "[r8, #1]")
        )
    };
}

/// The steps to what follows a pair of runs.
macro_rules! bend {
    () => {
        "ldrd r7, r8, [lr, #32]\n add r1, r1, r7\n add r3, r3, r8\n"
    };
}

#[inline(always)]
pub(in crate::lanes) fn make_rows<const WIDTH: usize>(
    segments: &mut [Segment],
    rows: &[[u8; WIDTH]],
    numbers: Rows,
    out: &mut [[u8; SEGMENT]],
) -> usize {
    const { assert!(WIDTH < 4095, "it is an instruction's offset") }
    let count = segments.len().min(out.len());
    let Some(segments) = segments.get_mut(..count) else { return 0 };
    if segments.is_empty() || rows.is_empty() {
        return 0;
    }
    let places = numbers.map(|row| row << 16);
    // Of the rows once more, as many as segments that begin before the turn reach behind it.
    let again = rows.len().min(MOST_APART as usize + 2);
    let (from, reached) = (out.as_ptr().addr(), out.as_mut_ptr());
    let reached_at: usize;
    // SAFETY: segments from the first one to the last are read and written, as many of `out` are written. A segment that lies
    // within the columns, which `aim` has found, reads five bytes from each run's place on; the others are not made. Its runs lie
    // between rows from the first to the last, `MOST_APART` at most, and the one below these. The stack has a table of the rows, and
    // of so many more of them that it holds all of these, from the first place on or, if it is behind the turn, from there on. Rows
    // that follow each other there do so in memory unless the table turns between them. r6 and r7, which no operand may be, are
    // put back, and so is the stack: at most 134 words beside those.
    unsafe {
        asm!(
            "push {{r6, r7}}",
            "mov r6, sp",
            // The table from its end on: the rows once more, then the rows.
            "add r7, r4, r12",
            "3:",
            "str r7, [sp, #-4]!",
            "sub r7, r7, #{width}",
            "cmp r7, r4",
            "bhs 3b",
            "add r7, r4, r8",
            "3:",
            "str r7, [sp, #-4]!",
            "sub r7, r7, #{width}",
            "cmp r7, r4",
            "bhs 3b",
            "mov r4, sp",
            "push {{r1, r6}}",
            "ldm r3, {{r9, r10, r11, r12}}",
            "push {{r9, r10, r11, r12}}",
            // Bytes 1 and 3 of what is selected are those of the first operand.
            "mov r6, #0xff00ff00",
            "mov r7, #0x00ff00ff",
            "usub8 r6, r6, r7",
            "mov r6, #0x00800080",
            "2:",
            "ldm lr, {{r0, r1, r2, r3}}",
            "ldrd r7, r8, [lr, #40]",
            "ldm sp, {{r9, r10, r11, r12}}",
            "add r7, r7, r2",
            "add r8, r8, r2",
            "cmp r7, r9",
            "blt.w 9f",
            "cmp r8, r10",
            "bge.w 9f",
            // All behind the turn, or all before it, the row below included.
            "add r8, r8, #0x10001",
            "cmp r7, r12",
            "ite ge",
            "movge r11, r12",
            "cmplt r12, r8",
            "ldrd r7, r8, [lr, #16]",
            "add r7, r7, r0",
            "add r8, r8, r1",
            "strd r7, r8, [lr]",
            "ldrd r7, r8, [lr, #24]",
            "add r7, r7, r2",
            "add r8, r8, r3",
            "strd r7, r8, [lr, #8]",
            "sub r2, r2, r11",
            "blt.w 4f",
            concat!(adjoining!(), adjoining!(), bend!(), adjoining!(), adjoining!(), bend!()),
            concat!(adjoining!(), adjoining!(), bend!(), adjoining!(), adjoining!()),
            "5:",
            "ldr r7, [lr, #36]",
            "ldr r8, [lr, #48]",
            "add r7, r7, r8",
            "str r7, [lr, #36]",
            "ldr r7, [sp, #16]",
            "add lr, lr, #52",
            "cmp lr, r7",
            "bne.w 2b",
            "b.w 9f",
            "4:",
            concat!(apart!(), apart!(), bend!(), apart!(), apart!(), bend!()),
            concat!(apart!(), apart!(), bend!(), apart!(), apart!()),
            "b.w 5b",
            "9:",
            "ldr r6, [sp, #20]",
            "mov sp, r6",
            "pop {{r6, r7}}",
            width = const WIDTH,
            out("r0") _,
            inout("r1") segments.as_ptr_range().end => _,
            out("r2") _,
            inout("r3") places.as_ptr() => _,
            inout("r4") rows.as_ptr() => _,
            inout("r5") reached => reached_at,
            // Where the last row of the table's parts begins.
            inout("r8") (rows.len() - 1) * WIDTH => _,
            out("r9") _,
            out("r10") _,
            out("r11") _,
            inout("r12") (again - 1) * WIDTH => _,
            inout("lr") segments.as_mut_ptr() => _,
        );
    }
    (reached_at - from) / SEGMENT
}

/// Copies 32 columns at a time where both lie on a word's border, else 16, in words all the same; what is left of both. `memcpy` goes
/// byte by byte there.
#[inline(always)]
pub(in crate::lanes) fn copy_words<'a, 'b>(row: &'a [u8], to: &'b mut [u8]) -> (&'a [u8], &'b mut [u8]) {
    let are_aligned = (row.as_ptr().addr() | to.as_ptr().addr()).is_multiple_of(4);
    let step = if are_aligned { 32 } else { 16 };
    let whole = row.len().min(to.len()) / step * step;
    let ((words, row), (room, to)) = (row.split_at(whole), to.split_at_mut(whole));
    let (from, end) = (words.as_ptr(), words.as_ptr_range().end);
    if whole > 0 && are_aligned {
        // SAFETY: as many bytes, a multiple of 32 and not none, are read and written as both slices have, whose addresses four divides.
        unsafe {
            asm!(
                "2:",
                "ldm r0!, {{r2, r3, r4, r5, r8, r9, r10, r11}}",
                "cmp r0, r12",
                "stm r1!, {{r2, r3, r4, r5, r8, r9, r10, r11}}",
                "bne 2b",
                inout("r0") from => _,
                inout("r1") room.as_mut_ptr() => _,
                in("r12") end,
                out("r2") _,
                out("r3") _,
                out("r4") _,
                out("r5") _,
                out("r8") _,
                out("r9") _,
                out("r10") _,
                out("r11") _,
                options(nostack),
            );
        }
    } else if whole > 0 {
        // SAFETY: as many bytes, a multiple of 16 and not none, are read and written as both slices have.
        unsafe {
            asm!(
                "2:",
                "ldr {a}, [{from}], #4",
                "ldr {b}, [{from}], #4",
                "ldr {c}, [{from}], #4",
                "ldr {d}, [{from}], #4",
                "str {a}, [{to}], #4",
                "str {b}, [{to}], #4",
                "str {c}, [{to}], #4",
                "str {d}, [{to}], #4",
                "cmp {from}, {end}",
                "bne 2b",
                from = inout(reg) from => _,
                to = inout(reg) room.as_mut_ptr() => _,
                end = in(reg) end,
                a = out(reg) _,
                b = out(reg) _,
                c = out(reg) _,
                d = out(reg) _,
                options(nostack),
            );
        }
    }
    (row, to)
}
