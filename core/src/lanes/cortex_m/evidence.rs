//! Sums that tests of evidence take, in pieces of assembly.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

use crate::lanes::evidence_rows::{CellSums, CellWindows};

/// Sums of a cell: its own words, the next ones, where those after them come, and the place in the row.
macro_rules! self_sums {
    ($here:literal, $here_b:literal, $next:literal, $next_b:literal, $far:literal, $far_b:literal, $place:literal) => {
        concat!(
            "ldr {t}, [{like}], #4\n ldr ",
            $far,
            ", [{like}, #{row} - 4]\n",
            "usad8 {t}, ",
            $here,
            ", {t}\n usada8 {t}, ",
            $here_b,
            ", ",
            $far,
            ", {t}\n",
            "usat {t}, #8, {t}\n strb {t}, [{out}, #2 * {words} + ",
            $place,
            "]\n",
            "ldr ",
            $far,
            ", [{a}, #8 + 4 * ",
            $place,
            "]\n ldr ",
            $far_b,
            ", [{a}, #{row} + 8 + 4 * ",
            $place,
            "]\n",
            "usad8 {t}, ",
            $here,
            ", ",
            $next,
            "\n usada8 {t}, ",
            $here_b,
            ", ",
            $next_b,
            ", {t}\n",
            "usat {t}, #8, {t}\n strb {t}, [{out}, #",
            $place,
            "]\n",
            "usad8 {t}, ",
            $here,
            ", ",
            $far,
            "\n usada8 {t}, ",
            $here_b,
            ", ",
            $far_b,
            ", {t}\n",
            "usat {t}, #8, {t}\n strb {t}, [{out}, #{words} + ",
            $place,
            "]\n",
            "usad8 {t}, ",
            $here,
            ", {zero}\n usada8 {t}, ",
            $here_b,
            ", {zero}, {t}\n",
            "usat {t}, #8, {t}\n strb {t}, [{out}, #3 * {words} + ",
            $place,
            "]\n",
        )
    };
}

/// The first `3 * threes` cells' `near`, `far`, `like` and `strength`.
///
/// # Safety
/// Each of the cells must have two words after its own, and its window at the distance within the row.
#[inline(always)]
pub(crate) unsafe fn self_sums_by_threes<const WORDS: usize>(
    left: &[[u32; WORDS]; 2],
    distance: usize,
    zero: u32,
    sums: &mut CellSums<WORDS>,
    threes: usize,
) {
    if threes == 0 {
        return;
    }
    // SAFETY: the rows lie one behind the other, and so do the sums; all within, as the caller promises.
    unsafe {
        let a = left.as_ptr().cast::<u32>().add(1);
        let out = (&raw mut *sums).cast::<u8>();
        asm!(
            "ldr {h}, [{a}]", "ldr {i}, [{a}, #{row}]", "ldr {n}, [{a}, #4]", "ldr {o}, [{a}, #{row} + 4]",
            "2:",
            self_sums!("{h}", "{i}", "{n}", "{o}", "{f}", "{g}", "0"),
            self_sums!("{n}", "{o}", "{f}", "{g}", "{h}", "{i}", "1"),
            self_sums!("{f}", "{g}", "{h}", "{i}", "{n}", "{o}", "2"),
            "add {a}, {a}, #12",
            "add {out}, {out}, #3",
            "cmp {out}, {end}",
            "bne 2b",
            a = inout(reg) a => _, like = inout(reg) a.cast::<u8>().add(distance) => _, out = inout(reg) out => _,
            end = in(reg) out.add(3 * threes), zero = in(reg) zero,
            h = out(reg) _, i = out(reg) _, n = out(reg) _, o = out(reg) _, f = out(reg) _, g = out(reg) _, t = out(reg) _,
            row = const { 4 * WORDS }, words = const { WORDS },
            options(nostack),
        );
    }
}

/// The sum at the answer of a cell.
macro_rules! fit_sum {
    ($place:literal) => {
        concat!(
            "ldrb {t}, [{labels}, #",
            $place,
            "]\n sub {t}, {origin}, {t}\n",
            "cmp {t}, {last}\n it hi\n movhi {t}, {last}\n",
            "ldr {u}, [{right}, {t}]\n ldr {v}, [{below}, {t}]\n",
            "ldr {t}, [{left}, #{row} + 4 * ",
            $place,
            "]\n usad8 {v}, {t}, {v}\n",
            "ldr {t}, [{left}, #4 * ",
            $place,
            "]\n usada8 {v}, {t}, {u}, {v}\n",
            "usat {v}, #8, {v}\n strb {v}, [{out}, #",
            $place,
            "]\n",
            "add {origin}, {origin}, #4\n",
        )
    };
}

/// What the first `2 * pairs` cells differ by at their labels.
///
/// # Safety
/// There must be so many labels, the rows' words, and four bytes from [`CellWindows::last_byte`] on.
#[inline(always)]
pub(crate) unsafe fn fit_sums_by_pairs<const WORDS: usize>(
    windows: &CellWindows<'_, WORDS>,
    fit: &mut [u8; WORDS],
    pairs: usize,
) {
    if pairs == 0 {
        return;
    }
    // SAFETY: the rows lie one behind the other; all within, as the caller promises.
    unsafe {
        let labels = windows.labels.as_ptr();
        let right = windows.right.as_ptr().cast::<u8>();
        asm!(
            "2:",
            fit_sum!("0"),
            fit_sum!("1"),
            "add {left}, {left}, #8",
            "add {out}, {out}, #2",
            "add {labels}, {labels}, #2",
            "cmp {labels}, {end}",
            "bne 2b",
            labels = inout(reg) labels => _, end = in(reg) labels.add(2 * pairs), origin = inout(reg) windows.origin => _,
            last = in(reg) windows.last_byte(), right = in(reg) right, below = in(reg) right.add(4 * WORDS),
            left = inout(reg) windows.left.as_ptr().cast::<u32>().add(1) => _, out = inout(reg) fit.as_mut_ptr() => _,
            t = out(reg) _, u = out(reg) _, v = out(reg) _, row = const { 4 * WORDS },
            options(nostack),
        );
    }
}
