//! A column of the agreement in one piece of assembly, so that nothing is put aside in between.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]
#![allow(clippy::cast_possible_truncation, reason = "limited before")]

use core::arch::asm;

use crate::lanes::columns::{Column, Decided, Steps};

/// The least lane of a register is subtracted from all.
macro_rules! normalise {
    ($sums:literal, $a:literal, $b:literal, $c:literal) => {
        concat!(
            "ror ",
            $a,
            ", ",
            $sums,
            ", #16\n usub8 ",
            $b,
            ", ",
            $sums,
            ", ",
            $a,
            "\n sel ",
            $b,
            ", ",
            $a,
            ", ",
            $sums,
            "\n",
            "ror ",
            $a,
            ", ",
            $b,
            ", #8\n usub8 ",
            $c,
            ", ",
            $b,
            ", ",
            $a,
            "\n sel ",
            $b,
            ", ",
            $a,
            ", ",
            $b,
            "\n",
            "uqsub8 ",
            $sums,
            ", ",
            $sums,
            ", ",
            $b,
            "\n",
        )
    };
}

/// What path sums tell a cell with the same labels, in the register `$out`.
macro_rules! message {
    ($sums:literal, $out:literal, $a:literal, $b:literal) => {
        concat!(
            "lsl ",
            $out,
            ", ",
            $sums,
            ", #8\n uqadd8 ",
            $out,
            ", ",
            $out,
            ", {down}\n",
            "lsr ",
            $a,
            ", ",
            $sums,
            ", #8\n uqadd8 ",
            $a,
            ", ",
            $a,
            ", {up}\n",
            "usub8 ",
            $b,
            ", ",
            $a,
            ", ",
            $out,
            "\n sel ",
            $out,
            ", ",
            $out,
            ", ",
            $a,
            "\n",
            "usub8 ",
            $b,
            ", ",
            $out,
            ", ",
            $sums,
            "\n sel ",
            $out,
            ", ",
            $sums,
            ", ",
            $out,
            "\n",
            "usub8 ",
            $b,
            ", ",
            $out,
            ", {jump}\n sel ",
            $out,
            ", {jump}, ",
            $out,
            "\n",
        )
    };
}

/// By how many bits the first lane that is 0 lies above lane 0, in the register `$out`.
macro_rules! zero_lane {
    ($sums:literal, $out:literal, $a:literal) => {
        concat!(
            "mov ",
            $out,
            ", #0\n usub8 ",
            $a,
            ", ",
            $out,
            ", ",
            $sums,
            "\n mov ",
            $a,
            ", #0x01010101\n",
            "sel ",
            $out,
            ", ",
            $a,
            ", ",
            $out,
            "\n rbit ",
            $out,
            ", ",
            $out,
            "\n clz ",
            $out,
            ", ",
            $out,
            "\n",
            "and ",
            $out,
            ", ",
            $out,
            ", #24\n",
        )
    };
}

/// Of the sums in x and the costs in a, the least of the sums 0: the label in u, the value in w, and the merit in x.
///
/// - `$labels` puts the labels in y; `$beside` puts in t what is less than 255 in the lanes with neighbours, moved by w bits.
macro_rules! winner {
    ($labels:literal, $beside:literal) => {
        concat!(
            // The label in u, its lane in w.
            zero_lane!("{x}", "{w}", "{t}"),
            $labels,
            "\n",
            "lsr {u}, {y}, {w}\n",
            "uxtb {u}, {u}\n",
            $beside,
            "\n",
            "uxtb {t}, {t}\n",
            "cmp {t}, #255\n",
            "bne 2f\n",
            // At an end of the labels: no fraction, in w; the margin in x and the cost in a.
            "lsr {a}, {a}, {w}\n",
            "uxtb {a}, {a}\n",
            "mov {t}, #0x01010101\n",
            "mul {t}, {u}, {t}\n",
            "uqsub8 {w}, {y}, {t}\n",
            "uqsub8 {t}, {t}, {y}\n",
            "orr {t}, {t}, {w}\n",
            "mov {y}, #0x02020202\n",
            "usub8 {t}, {t}, {y}\n",
            "mov {y}, #0x40404040\n",
            "sel {x}, {x}, {y}\n",
            "ror {t}, {x}, #16\n",
            "usub8 {w}, {x}, {t}\n",
            "sel {x}, {t}, {x}\n",
            "ror {t}, {x}, #8\n",
            "usub8 {w}, {x}, {t}\n",
            "sel {x}, {t}, {x}\n",
            "uxtb {x}, {x}\n",
            "mov {w}, #0\n",
            "b 3f\n",
            // Between two labels: these are turned into the lanes before, here and after.
            "2:\n",
            "add {w}, {w}, #24\n",
            "ror {x}, {x}, {w}\n",
            "ror {a}, {a}, {w}\n",
            "uqadd8 {t}, {x}, {a}\n",
            "lsr {x}, {x}, #24\n",
            "ubfx {a}, {a}, #8, #8\n",
            "uxtb {w}, {t}\n",
            "ubfx {y}, {t}, #16, #8\n",
            "ubfx {t}, {t}, #8, #8\n",
            "cmp {x}, #64\n",
            "it hi\n",
            "movhi {x}, #64\n",
            "cmp {w}, {y}\n",
            "ite hi\n",
            "subhi {t}, {w}, {t}\n",
            "subls {t}, {y}, {t}\n",
            "sub {w}, {w}, {y}\n",
            "cmp {t}, #1\n",
            "ite lt\n",
            "movlt {w}, #0\n",
            "lslge {w}, {w}, #7\n",
            "it ge\n",
            "sdivge {w}, {w}, {t}\n",
            "ssat {w}, #8, {w}\n",
            "3:\n",
            "sub {x}, {x}, {a}, lsl #1\n",
            "add {x}, {x}, #128\n",
            "usat {x}, #8, {x}\n",
            "add {w}, {w}, {u}, lsl #8\n",
            "add {w}, {w}, #128\n",
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
            winner!("ldr {y}, [{p}, #16]", "orr {t}, {up}, {down}\n lsr {t}, {t}, {w}"),
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

/// Decides the lower cell above a column, now that `message` tells what lies below it: value, label and merit.
///
/// - `labels`: of its tile; `beside`: less than 255 in the lanes whose neighbours are the labels one less and one more.
#[inline(always)]
pub(crate) fn decide_pending(column: &Column, labels: u32, beside: u32, message: u32) -> (u16, u8, u8) {
    let (value, label, merit): (u32, u32, u32);
    // SAFETY: works on registers only.
    unsafe {
        asm!(
            "uqadd8 {x}, {x}, {m}",
            normalise!("{x}", "{t}", "{u}", "{w}"),
            winner!("mov {y}, {labels}", "lsr {t}, {beside}, {w}"),
            labels = in(reg) labels, beside = in(reg) beside, m = in(reg) message,
            a = inout(reg) column.costs_above => _, t = out(reg) _, y = out(reg) _,
            u = out(reg) label, w = out(reg) value, x = inout(reg) column.pending => merit,
            options(pure, nomem, nostack),
        );
    }
    (value as u16, label as u8, merit as u8)
}
