//! Pixels of two sensors of seven lines each, parted in a piece of assembly.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

/// Parts `8 * eights` pixels of two sensors with seven lines each, as [`part_eights`](super::sevens::part_eights) tells.
///
/// # Safety
/// All must be aligned, `raw` have `4 * eights` words and the others `2 * eights`; `eights` must not be 0.
#[inline(always)]
pub(crate) unsafe fn part_sevens(raw: *const u32, first: *mut u32, second: *mut u32, eights: usize) {
    // SAFETY: as the caller promises.
    unsafe {
        asm!(
            "2:",
            "ldm {raw}!, {{r0, r1, r2, r3}}",
            // Of four words of 16 bits the second and the fourth, and the first and the third; then their pixels in turn.
            "pkhtb {t}, r1, r0, asr #16",
            "pkhbt r0, r0, r1, lsl #16",
            "and {u}, {low}, r0, lsl #1",
            "and r1, {high}, {t}, lsl #9",
            "orr {u}, {u}, r1",
            "and r0, {low}, r0, lsr #6",
            "and r1, {high}, {t}, lsl #2",
            "orr r0, r0, r1",
            "pkhtb {t}, r3, r2, asr #16",
            "pkhbt r2, r2, r3, lsl #16",
            "and r1, {low}, r2, lsl #1",
            "and r3, {high}, {t}, lsl #9",
            "orr r1, r1, r3",
            "strd {u}, r1, [{first}], #8",
            "and r2, {low}, r2, lsr #6",
            "and r3, {high}, {t}, lsl #2",
            "orr r2, r2, r3",
            "strd r0, r2, [{second}], #8",
            "cmp {raw}, {end}",
            "bne 2b",
            raw = inout(reg) raw => _, first = inout(reg) first => _, second = inout(reg) second => _,
            end = in(reg) raw.add(4 * eights), low = in(reg) 0x00fe_00fe_u32, high = in(reg) 0xfe00_fe00_u32,
            t = out(reg) _, u = out(reg) _, out("r0") _, out("r1") _, out("r2") _, out("r3") _,
            options(nostack),
        );
    }
}
