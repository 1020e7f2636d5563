//! A column of the agreement in one piece of assembly, so that nothing is put aside in between.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]
#![allow(clippy::cast_possible_truncation, reason = "limited before")]

use core::arch::asm;

use super::columns::{Column, Decided, Steps};

/// The least lane of a register is subtracted from all.
macro_rules! normalise {
    ($sums:literal, $a:literal, $b:literal, $c:literal) => {
        concat!(
            "ror ", $a, ", ", $sums, ", #16\n usub8 ", $b, ", ", $sums, ", ", $a, "\n sel ", $b, ", ", $a, ", ", $sums, "\n",
            "ror ", $a, ", ", $b, ", #8\n usub8 ", $c, ", ", $b, ", ", $a, "\n sel ", $b, ", ", $a, ", ", $b, "\n",
            "uqsub8 ", $sums, ", ", $sums, ", ", $b, "\n",
        )
    };
}

/// What path sums tell a cell with the same labels, in the register `$out`.
macro_rules! message {
    ($sums:literal, $out:literal, $a:literal, $b:literal) => {
        concat!(
            "lsl ", $out, ", ", $sums, ", #8\n uqadd8 ", $out, ", ", $out, ", {down}\n",
            "lsr ", $a, ", ", $sums, ", #8\n uqadd8 ", $a, ", ", $a, ", {up}\n",
            "usub8 ", $b, ", ", $a, ", ", $out, "\n sel ", $out, ", ", $out, ", ", $a, "\n",
            "usub8 ", $b, ", ", $out, ", ", $sums, "\n sel ", $out, ", ", $sums, ", ", $out, "\n",
            "usub8 ", $b, ", ", $out, ", {jump}\n sel ", $out, ", {jump}, ", $out, "\n",
        )
    };
}

/// By how many bits the first lane that is 0 lies above lane 0, in the register `$out`.
macro_rules! zero_lane {
    ($sums:literal, $out:literal, $a:literal) => {
        concat!(
            "mov ", $out, ", #0\n usub8 ", $a, ", ", $out, ", ", $sums, "\n mov ", $a, ", #0x01010101\n",
            "sel ", $out, ", ", $a, ", ", $out, "\n rbit ", $out, ", ", $out, "\n clz ", $out, ", ", $out, "\n",
            "and ", $out, ", ", $out, ", #24\n",
        )
    };
}

/// Decides the upper cell of a column, whose labels stand in it: its paths along the row, from the top, and from the lower
/// cell; the lower one for the time being.
#[inline(always)]
pub(crate) fn decide_column(column: &mut Column, steps: Steps, jump: u32) -> Decided {
    let (value, label, merit, lower_label): (u32, u32, u32, u32);
    // SAFETY: reads and writes the column.
    unsafe {
        asm!(
            // The path from the top, in b.
            "ldrd {a}, {g}, [{p}]",
            "ldr {b}, [{p}, #20]",
            "uqadd8 {b}, {b}, {a}",
            normalise!("{b}", "{t}", "{u}", "{w}"),
            // What the lower cell tells.
            "ldr {x}, [{p}, #12]",
            message!("{x}", "{t}", "{u}", "{w}"),
            // All paths, in x.
            "ldr {x}, [{p}, #8]",
            "uqadd8 {x}, {x}, {b}",
            "uqadd8 {x}, {x}, {t}",
            normalise!("{x}", "{t}", "{u}", "{w}"),
            // The label in u, its lane in w.
            zero_lane!("{x}", "{w}", "{t}"),
            "ldr {y}, [{p}, #16]",
            "lsr {u}, {y}, {w}",
            "uxtb {u}, {u}",
            "orr {t}, {up}, {down}",
            "lsr {t}, {t}, {w}",
            "uxtb {t}, {t}",
            "cmp {t}, #255",
            "bne 2f",
            // At an end of the labels: no fraction, in w; the margin in x and the cost in a.
            "lsr {a}, {a}, {w}",
            "uxtb {a}, {a}",
            "mov {t}, #0x01010101",
            "mul {t}, {u}, {t}",
            "uqsub8 {w}, {y}, {t}",
            "uqsub8 {t}, {t}, {y}",
            "orr {t}, {t}, {w}",
            "mov {y}, #0x02020202",
            "usub8 {t}, {t}, {y}",
            "mov {y}, #0x40404040",
            "sel {x}, {x}, {y}",
            "ror {t}, {x}, #16",
            "usub8 {w}, {x}, {t}",
            "sel {x}, {t}, {x}",
            "ror {t}, {x}, #8",
            "usub8 {w}, {x}, {t}",
            "sel {x}, {t}, {x}",
            "uxtb {x}, {x}",
            "mov {w}, #0",
            "b 3f",
            // Between two labels: these are turned into the lanes before, here and after.
            "2:",
            "add {w}, {w}, #24",
            "ror {x}, {x}, {w}",
            "ror {a}, {a}, {w}",
            "uqadd8 {t}, {x}, {a}",
            "lsr {x}, {x}, #24",
            "ubfx {a}, {a}, #8, #8",
            "uxtb {w}, {t}",
            "ubfx {y}, {t}, #16, #8",
            "ubfx {t}, {t}, #8, #8",
            "cmp {x}, #64",
            "it hi",
            "movhi {x}, #64",
            "cmp {w}, {y}",
            "ite hi",
            "subhi {t}, {w}, {t}",
            "subls {t}, {y}, {t}",
            "sub {w}, {w}, {y}",
            "cmp {t}, #1",
            "ite lt",
            "movlt {w}, #0",
            "lslge {w}, {w}, #7",
            "it ge",
            "sdivge {w}, {w}, {t}",
            "ssat {w}, #8, {w}",
            "3:",
            "sub {x}, {x}, {a}, lsl #1",
            "add {x}, {x}, #128",
            "usat {x}, #8, {x}",
            "add {w}, {w}, {u}, lsl #8",
            "add {w}, {w}, #128",
            // The lower cell: its path from the top, in b, and all paths that it has so far, in t.
            message!("{b}", "{t}", "{a}", "{y}"),
            "uqadd8 {b}, {g}, {t}",
            "str {g}, [{p}, #28]",
            normalise!("{b}", "{t}", "{a}", "{y}"),
            "ldr {t}, [{p}, #12]",
            "uqadd8 {t}, {t}, {b}",
            normalise!("{t}", "{a}", "{y}", "{g}"),
            "strd {b}, {t}, [{p}, #20]",
            zero_lane!("{t}", "{y}", "{a}"),
            "ldr {a}, [{p}, #16]",
            "lsr {y}, {a}, {y}",
            p = in(reg) &raw mut *column, up = in(reg) steps.up, down = in(reg) steps.down, jump = in(reg) jump,
            a = out(reg) _, b = out(reg) _, g = out(reg) _, t = out(reg) _,
            u = out(reg) label, w = out(reg) value, x = out(reg) merit, y = out(reg) lower_label,
            options(nostack),
        );
    }
    Decided { value: value as u16, label: label as u8, merit: merit as u8, lower_label: lower_label as u8 }
}
