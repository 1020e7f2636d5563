//! Rows of words: gradients, pixels that come in, copies; in pieces of assembly, so that nothing is put aside in between.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

/// Instructions that limit the gradient in `t` twice, add up and leave the sum in `t`, or that limit it once.
macro_rules! limited {
    (twice) => {
        "eor {t}, {t}, #0x80808080\n uqsub8 {u}, {t}, {l0}\n uqadd8 {u}, {u}, {r0}\n uqsub8 {t}, {t}, {l1}\n uqadd8 {t}, {t}, {r1}\n uadd8 {t}, {t}, {u}\n"
    };
    (once) => {
        "eor {t}, {t}, #0x80808080\n uqsub8 {t}, {t}, {l0}\n uqadd8 {t}, {t}, {r0}\n"
    };
}

/// A word of the gradient along the row: its bytes before and after in either row, and where it goes.
macro_rules! across {
    ($times:ident, $after:literal, $before:literal, $out:literal) => {
        concat!(
            "ldr {t}, [{a}, #",
            $after,
            "]\n ldr {u}, [{a}",
            $before,
            "\n qsub8 {t}, {t}, {u}\n",
            "ldr {u}, [{b}, #",
            $after,
            "]\n ldr {v}, [{b}",
            $before,
            "\n qsub8 {u}, {u}, {v}\n",
            "qadd8 {t}, {t}, {u}\n",
            limited!($times),
            "str {t}, [{out}",
            $out,
            "\n",
        )
    };
}

/// A word of the gradient down: where the next words are, the register of this difference and that of the next, and where
/// it goes.
macro_rules! down {
    ($times:ident, $next:literal, $this:literal, $other:literal, $out:literal) => {
        concat!(
            "ldr {t}, [{below}, ",
            $next,
            "\n ldr {u}, [{above}, ",
            $next,
            "\n qsub8 ",
            $other,
            ", {t}, {u}\n",
            "lsr {t}, ",
            $this,
            ", #8\n orr {t}, {t}, ",
            $other,
            ", lsl #24\n qadd8 {t}, ",
            $this,
            ", {t}\n",
            limited!($times),
            "str {t}, [{out}",
            $out,
            "\n",
        )
    };
}

macro_rules! across_row {
    ($times:ident, $a:ident, $b:ident, $out:ident, $end:ident, $($limits:tt)*) => {
        asm!(
            "2:",
            across!($times, 14, ", #12]", ", #12]"),
            across!($times, 10, ", #8]", ", #8]"),
            across!($times, 6, ", #4]", ", #4]"),
            across!($times, 2, "], #16", "], #16"),
            "cmp {out}, {end}",
            "bne 2b",
            a = inout(reg) $a => _, b = inout(reg) $b => _, out = inout(reg) $out => _, end = in(reg) $end,
            t = out(reg) _, u = out(reg) _, v = out(reg) _, $($limits)*,
            options(nostack),
        )
    };
}

macro_rules! down_row {
    ($times:ident, $above:ident, $below:ident, $out:ident, $end:ident, $($limits:tt)*) => {
        asm!(
            "ldr {d}, [{below}]",
            "ldr {u}, [{above}]",
            "qsub8 {d}, {d}, {u}",
            "2:",
            down!($times, "#4]", "{d}", "{e}", "], #4"),
            down!($times, "#8]", "{e}", "{d}", "], #4"),
            down!($times, "#12]", "{d}", "{e}", "], #4"),
            down!($times, "#16]!", "{e}", "{d}", "], #4"),
            "cmp {out}, {end}",
            "bne 2b",
            above = inout(reg) $above => _, below = inout(reg) $below => _, out = inout(reg) $out => _, end = in(reg) $end,
            d = out(reg) _, e = out(reg) _, t = out(reg) _, u = out(reg) _, $($limits)*,
            options(nostack),
        )
    };
}

/// [`gradient_across`](super::rows::gradient_across) of the words `1..=4 * fours`. `limits` are pairs of what is subtracted and added.
///
/// # Safety
/// The rows must have at least `4 * fours + 2` words, and `fours` must not be 0.
#[inline(always)]
pub(crate) unsafe fn gradient_across_fours(
    rows: [&[u32]; 2],
    limits: [Option<[u32; 2]>; 2],
    out: &mut [u32],
    fours: usize,
) {
    let [a, b] = rows;
    // SAFETY: reads from one byte before word 1 to one after word 4 * fours, writes the words 1..=4 * fours; all inside.
    unsafe {
        let (a, b) = (a.as_ptr().cast::<u8>().add(3), b.as_ptr().cast::<u8>().add(3));
        let out = out.as_mut_ptr().add(1);
        let end = out.add(4 * fours);
        match limits {
            [Some([l0, r0]), Some([l1, r1])] => {
                across_row!(twice, a, b, out, end, l0 = in(reg) l0, r0 = in(reg) r0, l1 = in(reg) l1, r1 = in(reg) r1);
            }
            [Some([l0, r0]), None] => across_row!(once, a, b, out, end, l0 = in(reg) l0, r0 = in(reg) r0),
            [None, _] => {}
        }
    }
}

/// [`gradient_down`](super::rows::gradient_down) of the words `1..=4 * fours`. `limits` are pairs of what is subtracted and added.
///
/// # Safety
/// The rows must have at least `4 * fours + 2` words, and `fours` must not be 0.
#[inline(always)]
pub(crate) unsafe fn gradient_down_fours(
    rows: [&[u32]; 2],
    limits: [Option<[u32; 2]>; 2],
    out: &mut [u32],
    fours: usize,
) {
    let [above, below] = rows;
    // SAFETY: reads the words 1..=4 * fours + 1, writes the words 1..=4 * fours; all inside.
    unsafe {
        let (above, below) = (above.as_ptr().add(1), below.as_ptr().add(1));
        let out = out.as_mut_ptr().add(1);
        let end = out.add(4 * fours);
        match limits {
            [Some([l0, r0]), Some([l1, r1])] => {
                down_row!(twice, above, below, out, end, l0 = in(reg) l0, r0 = in(reg) r0, l1 = in(reg) l1, r1 = in(reg) r1);
            }
            [Some([l0, r0]), None] => down_row!(once, above, below, out, end, l0 = in(reg) l0, r0 = in(reg) r0),
            [None, _] => {}
        }
    }
}

/// Instructions that flip a register's bytes, doubled before if asked.
macro_rules! flipped {
    (doubled, $register:literal) => {
        concat!("uqadd8 ", $register, ", ", $register, ", ", $register, "\n", flipped!(plain, $register))
    };
    (plain, $register:literal) => {
        concat!("eor ", $register, ", ", $register, ", #0x80808080\n")
    };
}

macro_rules! flip_row {
    ($how:ident, $from:ident, $to:ident, $eights:ident) => {
        asm!(
            "2:",
            "ldm {from}!, {{r0, r1, r2, r3, r4, r5, r8, r9}}",
            flipped!($how, "r0"),
            flipped!($how, "r1"),
            flipped!($how, "r2"),
            flipped!($how, "r3"),
            flipped!($how, "r4"),
            flipped!($how, "r5"),
            flipped!($how, "r8"),
            flipped!($how, "r9"),
            "stm {to}!, {{r0, r1, r2, r3, r4, r5, r8, r9}}",
            "cmp {from}, {end}",
            "bne 2b",
            from = inout(reg) $from => _, to = inout(reg) $to => _, end = in(reg) $from.add(8 * $eights),
            out("r0") _, out("r1") _, out("r2") _, out("r3") _, out("r4") _, out("r5") _, out("r8") _, out("r9") _,
            options(nostack),
        )
    };
}

/// Copies `8 * eights` words, their bytes doubled once, saturating, if asked, and flipped.
///
/// # Safety
/// `from` must be aligned and both must have so many words; `eights` must not be 0.
#[inline(always)]
pub(crate) unsafe fn flip_eights(from: *const u32, to: *mut u32, eights: usize, are_doubled: bool) {
    // SAFETY: as the caller promises.
    unsafe {
        if are_doubled {
            flip_row!(doubled, from, to, eights);
        } else {
            flip_row!(plain, from, to, eights);
        }
    }
}

/// Copies `8 * eights` words.
///
/// # Safety
/// Both must be aligned and have so many words; `eights` must not be 0.
#[inline(always)]
pub(crate) unsafe fn copy_eights(from: *const u32, to: *mut u32, eights: usize) {
    // SAFETY: as the caller promises.
    unsafe {
        asm!(
            "2:",
            "ldm {from}!, {{r0, r1, r2, r3, r4, r5, r8, r9}}",
            "stm {to}!, {{r0, r1, r2, r3, r4, r5, r8, r9}}",
            "cmp {from}, {end}",
            "bne 2b",
            from = inout(reg) from => _, to = inout(reg) to => _, end = in(reg) from.add(8 * eights),
            out("r0") _, out("r1") _, out("r2") _, out("r3") _, out("r4") _, out("r5") _, out("r8") _, out("r9") _,
            options(nostack),
        );
    }
}
