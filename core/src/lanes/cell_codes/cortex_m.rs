//! Cells by a loop whose figures all stay in registers.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

use super::{
    DisparityCodes, FIRST_OF_TWO, JUMP, Listed, MIXED, MOST, MOST_BYTES, MOST_BYTES_OF_PAIR, ODD, Part, STEP, STEPS,
    STEPS_DOWN, WIDE,
};
use crate::Disparity;
use crate::lanes::demand;

/// Writes the confidences of pairs of cells after a column of `before`: a byte for each pair, then what follows of cells; how many bytes,
/// if both rows have the same. Rows are equally long, and there is room for [`MOST_BYTES_OF_PAIR`] for each.
#[inline(never)]
pub(crate) fn put_confidences([upper, lower]: [&[[u8; 8]]; 2], before: u8, room: &mut [u8]) -> Option<usize> {
    let count = upper.len();
    demand(count == lower.len() && MOST_BYTES_OF_PAIR * count <= room.len());
    if count == 0 {
        return Some(0);
    }
    let begin = upper.as_ptr();
    let out = room.as_mut_ptr();
    // SAFETY: reads as many pairs of cells as both rows have, writes a byte for each, and at most four for each cell behind
    // them: for as many there is room.
    unsafe {
        let mut end = begin.add(count);
        let out_end: *mut u8;
        asm!(
            "2:",
            // No two words at once: rows need not begin at one.
            "ldr {a}, [{u}], #4",
            "ldr {b}, [{l}], #4",
            "cmp {a}, {b}",
            "bne 9f",
            "ldr {c}, [{u}], #4",
            "ldr {b}, [{l}], #4",
            "cmp {c}, {b}",
            "bne 9f",
            "cmp.w {a}, {a}, ror #8",
            "bne 5f",
            "uxtb {d}, {a}",
            "sub {d}, {d}, {before}",
            "ror {d}, {d}, #{step_bits}",
            "cmp {d}, #{steps}",
            "bhs 6f",
            "3:",
            "cmp.w {c}, {c}, ror #8",
            "bne 7f",
            "uxtb {b}, {c}",
            "sub {b}, {b}, {a}, lsr #24",
            "add {b}, {b}, #{least}",
            "ror {b}, {b}, #{step_bits}",
            "cmp {b}, #{steps}",
            "bhs 8f",
            "4:",
            "orr {d}, {d}, {b}, lsl #4",
            "strb {d}, [{out}], #1",
            "lsr {before}, {c}, #24",
            "sub {before}, {before}, #{least}",
            "cmp {u}, {end}",
            "bne 2b",
            "b 22f",
            // What follows of the left cell, ...
            "5:",
            "mov {d}, #{mixed}",
            "str {a}, [{follows}], #4",
            "b 3b",
            "6:",
            "mov {d}, #{jump}",
            "strb {a}, [{follows}], #1",
            "b 3b",
            // ... and of the right one.
            "7:",
            "mov {b}, #{mixed}",
            "str {c}, [{follows}], #4",
            "b 4b",
            "8:",
            "mov {b}, #{jump}",
            "strb {c}, [{follows}], #1",
            "b 4b",
            // The rows differ.
            "9:",
            "mov {end}, #0",
            "22:",
            steps = const STEPS,
            step_bits = const STEP.ilog2(),
            least = const STEP * STEPS_DOWN,
            jump = const JUMP,
            mixed = const MIXED,
            u = inout(reg) begin => _,
            l = inout(reg) lower.as_ptr() => _,
            end = inout(reg) end,
            out = inout(reg) out => _,
            follows = inout(reg) out.add(count) => out_end,
            before = inout(reg) u32::from(before).wrapping_sub(STEP * STEPS_DOWN) => _,
            a = out(reg) _, b = out(reg) _, c = out(reg) _, d = out(reg) _,
            options(nostack),
        );
        (!end.is_null()).then(|| out_end.offset_from(out).cast_unsigned())
    }
}

/// Writes the disparities of cells after a pixel of `before`; how many bytes. Rows are equally long, at most [`MOST`], and there is room
/// for [`MOST_BYTES`] for each cell.
#[inline(never)]
pub(crate) fn put_disparities(
    [upper, lower]: [&[[Disparity; 4]]; 2],
    codes: &DisparityCodes,
    before: i16,
    room: &mut [u8],
    listed: &mut Listed,
) -> usize {
    let count = upper.len();
    demand(count == lower.len() && MOST_BYTES * count <= room.len() && count <= MOST);
    listed.count = 0;
    if count == 0 {
        return 0;
    }
    let begin = upper.as_ptr();
    let (out, list) = (room.as_mut_ptr(), listed.cells.as_mut_ptr());
    // SAFETY: reads as many cells as both rows have, and of each table one that the index is limited to; writes at most
    // MOST_BYTES for each, for which there is room, and a number for at most each cell, which are no more than the list has.
    unsafe {
        let (out_end, listed_end): (*mut u8, *mut u8);
        asm!(
            "push {{r7}}",
            // The end, the beginning and the list.
            "push {{{c}}}",
            "push {{{d}}}",
            "push {{{x}}}",
            "2:",
            // No two words at once: rows need not begin at one.
            "ldr {a}, [{u}], #4",
            "ldr {b}, [{u}], #4",
            "ldr {c}, [{l}], #4",
            "ldr {d}, [{l}], #4",
            "usub16 {c}, {c}, {a}",
            "usub16 {d}, {d}, {b}",
            "cmp {c}, {d}",
            "bne 5f",
            "cmp.w {c}, {c}, ror #16",
            "bne 5f",
            // The third and the fourth column are as much above the first and the second, ...
            "usub16 {d}, {b}, {a}",
            "cmp.w {d}, {d}, ror #16",
            "bne 5f",
            "ssat {d}, #5, {d}, asr #16",
            "ldr {x}, [{shapes}, {d}, lsl #2]",
            // ... and the second as much above the first as it then must be.
            "sxth r7, {a}",
            "rsb {a}, r7, {a}, asr #16",
            "sbfx {d}, {x}, #{second}, #5",
            "cmp {a}, {d}",
            "bne 5f",
            "ssat {c}, #5, {c}, asr #16",
            "ldr {c}, [{rises}, {c}, lsl #2]",
            "sub r7, r7, {before}",
            "ssat {a}, #6, r7",
            "ldr {a}, [{steps}, {a}, lsl #2]",
            "add {x}, {x}, {c}",
            "add {x}, {x}, {a}",
            "asr {before}, {b}, #16",
            "tst {x}, #{not_one}",
            "bne 4f",
            "strb {x}, [{out}], #1",
            "3:",
            "ldr {a}, [sp, #8]",
            "cmp {u}, {a}",
            "bne 2b",
            "b 6f",
            "4:",
            "lsr {d}, {x}, #{two}",
            "cmp {d}, #{no_code}",
            "bhs 5f",
            "cmp {d}, #{step_follows}",
            "bhs 7f",
            "add {d}, {d}, #{first_of_two}",
            "rev16 {d}, {d}",
            "strh {d}, [{out}], #2",
            "b 3b",
            "7:",
            "mov {a}, #{wide}",
            "strb {a}, [{out}], #1",
            "strb {d}, [{out}], #1",
            "strh r7, [{out}], #2",
            "b 3b",
            "5:",
            "mov {a}, #{odd}",
            "strb {a}, [{out}], #1",
            "asr {before}, {b}, #16",
            "ldr {d}, [sp, #4]",
            "sub {a}, {u}, {d}",
            "lsr {a}, {a}, #3",
            "sub {a}, {a}, #1",
            "ldr {d}, [sp]",
            "strb {a}, [{d}], #1",
            "str {d}, [sp]",
            "b 3b",
            "6:",
            "pop {{{x}}}",
            "add sp, sp, #8",
            "pop {{r7}}",
            second = const Part::SECOND,
            not_one = const Part::NOT_ONE | Part::NOT_ONE << 1,
            two = const Part::TWO,
            no_code = const Part::NO_CODE,
            step_follows = const Part::STEP_FOLLOWS,
            first_of_two = const FIRST_OF_TWO << 8,
            wide = const WIDE,
            odd = const ODD,
            u = inout(reg) begin => _,
            l = inout(reg) lower.as_ptr() => _,
            out = inout(reg) out => out_end,
            before = inout(reg) i32::from(before) => _,
            shapes = in(reg) codes.shape.as_ptr().add(codes.shape.len() / 2),
            rises = in(reg) codes.rise.as_ptr().add(codes.rise.len() / 2),
            steps = in(reg) codes.step.as_ptr().add(codes.step.len() / 2),
            a = out(reg) _, b = out(reg) _,
            c = inout(reg) begin.add(count) => _,
            d = inout(reg) begin => _,
            x = inout(reg) list => listed_end,
        );
        listed.count = listed_end.offset_from(list).cast_unsigned();
        out_end.offset_from(out).cast_unsigned()
    }
}
