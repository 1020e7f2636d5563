//! Rows of words in pieces of assembly, so that nothing is put aside in between.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

use super::answer_rows::{PixelPair, PlanePairs, down_bits};
use super::evidence_rows::{CellSums, CellWindows};
use super::splat_half;
use super::trials::Trial;

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

/// The widest rows that [`tile_sad_words`] takes: LDRD reaches 1020 bytes far.
pub(crate) const MOST_TILE_SAD_WORDS: usize = 1020 / 12;

/// `WORDS` words in bytes, 0 beyond [`MOST_TILE_SAD_WORDS`].
const fn tile_sad_offset(words: usize) -> usize {
    if words > MOST_TILE_SAD_WORDS { 0 } else { 4 * words }
}

/// Sums of absolute differences of two words by four rows, that lie `WORDS` words apart: left and right of the upper two
/// rows, then of the lower two. In one piece, so that nothing is put aside in between.
///
/// # Safety
/// Both must be readable for two words in each of the four rows; there may be [`MOST_TILE_SAD_WORDS`] words at most.
#[inline(always)]
pub(crate) unsafe fn tile_sad_words<const WORDS: usize>(left: *const u32, right: *const u8) -> [u32; 4] {
    let (a, b, c, d);
    // SAFETY: reads what the caller promises.
    unsafe {
        asm!(
            "ldrd {x}, {y}, [{l}]", "ldr {v}, [{r}]", "ldr {w}, [{r}, #4]",
            "usad8 {a}, {x}, {v}", "usad8 {b}, {y}, {w}",
            "ldrd {x}, {y}, [{l}, #{one}]", "ldr {v}, [{r}, #{one}]", "ldr {w}, [{r}, #{one} + 4]",
            "usada8 {a}, {x}, {v}, {a}", "usada8 {b}, {y}, {w}, {b}",
            "ldrd {x}, {y}, [{l}, #{two}]", "ldr {v}, [{r}, #{two}]", "ldr {w}, [{r}, #{two} + 4]",
            "usad8 {c}, {x}, {v}", "usad8 {d}, {y}, {w}",
            "ldrd {x}, {y}, [{l}, #{three}]", "ldr {v}, [{r}, #{three}]", "ldr {w}, [{r}, #{three} + 4]",
            "usada8 {c}, {x}, {v}, {c}", "usada8 {d}, {y}, {w}, {d}",
            l = in(reg) left, r = in(reg) right, a = out(reg) a, b = out(reg) b, c = out(reg) c, d = out(reg) d,
            x = out(reg) _, y = out(reg) _, v = out(reg) _, w = out(reg) _,
            one = const { tile_sad_offset(WORDS) }, two = const { 2 * tile_sad_offset(WORDS) },
            three = const { 3 * tile_sad_offset(WORDS) },
            options(pure, readonly, nostack, preserves_flags)
        );
    }
    [a, b, c, d]
}

/// Two cells, one beside the other, at three windows of the right view: the second cell's sums, moved up, and the first one's.
macro_rules! two_cells_thrice {
    ($a:literal, $b:literal, $c:literal, $y:literal, $next:literal) => {
        concat!(
            "ldr {x}, [{l}, #",
            $y,
            " + 4]\n",
            "ldr {t}, [{r}, #",
            $y,
            " + 4]\n usad8 ",
            $a,
            ", {x}, {t}\n",
            "ldr {t}, [{r}, #",
            $y,
            " + 5]\n usad8 ",
            $b,
            ", {x}, {t}\n",
            "ldr {t}, [{r}, #",
            $y,
            " + 6]\n usad8 ",
            $c,
            ", {x}, {t}\n",
            "ldr {x}, [{l}, #",
            $next,
            " + 4]\n",
            "ldr {t}, [{r}, #",
            $next,
            " + 4]\n usada8 ",
            $a,
            ", {x}, {t}, ",
            $a,
            "\n",
            "ldr {t}, [{r}, #",
            $next,
            " + 5]\n usada8 ",
            $b,
            ", {x}, {t}, ",
            $b,
            "\n",
            "ldr {t}, [{r}, #",
            $next,
            " + 6]\n usada8 ",
            $c,
            ", {x}, {t}, ",
            $c,
            "\n",
            "lsl ",
            $a,
            ", ",
            $a,
            ", #16\n lsl ",
            $b,
            ", ",
            $b,
            ", #16\n lsl ",
            $c,
            ", ",
            $c,
            ", #16\n",
            "ldr {x}, [{l}, #",
            $y,
            "]\n",
            "ldr {t}, [{r}, #",
            $y,
            "]\n usada8 ",
            $a,
            ", {x}, {t}, ",
            $a,
            "\n",
            "ldr {t}, [{r}, #",
            $y,
            " + 1]\n usada8 ",
            $b,
            ", {x}, {t}, ",
            $b,
            "\n",
            "ldr {t}, [{r}, #",
            $y,
            " + 2]\n usada8 ",
            $c,
            ", {x}, {t}, ",
            $c,
            "\n",
            "ldr {x}, [{l}, #",
            $next,
            "]\n",
            "ldr {t}, [{r}, #",
            $next,
            "]\n usada8 ",
            $a,
            ", {x}, {t}, ",
            $a,
            "\n",
            "ldr {t}, [{r}, #",
            $next,
            " + 1]\n usada8 ",
            $b,
            ", {x}, {t}, ",
            $b,
            "\n",
            "ldr {t}, [{r}, #",
            $next,
            " + 2]\n usada8 ",
            $c,
            ", {x}, {t}, ",
            $c,
        )
    };
}

/// [`tile_sads_around`](super::rows::tile_sads_around).
///
/// # Safety
/// The left view must be readable for two words, the right one for ten bytes in each of the four rows, `WORDS` words apart;
/// there may be [`MOST_TILE_SAD_WORDS`] words at most.
#[inline(always)]
pub(crate) unsafe fn tile_sads_around_words<const WORDS: usize>(left: *const u32, right: *const u8) -> [[u32; 2]; 3] {
    let (a, b, c, d, e, f);
    // SAFETY: reads what the caller promises.
    unsafe {
        asm!(
            two_cells_thrice!("{a}", "{b}", "{c}", "0", "{one}"),
            two_cells_thrice!("{d}", "{e}", "{f}", "{two}", "{three}"),
            l = in(reg) left, r = in(reg) right, a = out(reg) a, b = out(reg) b, c = out(reg) c,
            d = out(reg) d, e = out(reg) e, f = out(reg) f, x = out(reg) _, t = out(reg) _,
            one = const { tile_sad_offset(WORDS) }, two = const { 2 * tile_sad_offset(WORDS) },
            three = const { 3 * tile_sad_offset(WORDS) },
            options(pure, readonly, nostack, preserves_flags)
        );
    }
    [[a, d], [b, e], [c, f]]
}

/// Works out the sums of trials, of which the labels are known, at the windows of eight columns so many bytes before `origin`.
///
/// # Safety
/// There must be a trial; both views must be readable for two words in each of the four rows, `WORDS` words apart, the right
/// one for each label; there may be [`MOST_TILE_SAD_WORDS`] words at most.
#[inline(always)]
pub(crate) unsafe fn try_labels<const WORDS: usize>(left: *const u32, origin: *const u8, trials: &mut [Trial]) {
    let trials = trials.as_mut_ptr_range();
    // SAFETY: reads what the caller promises, and writes the trials.
    unsafe {
        asm!(
            "2:",
            "ldr {r}, [{trial}]",
            "uxtb {r}, {r}",
            "sub {r}, {origin}, {r}",
            "ldrd {x}, {y}, [{l}]", "ldr {v}, [{r}]", "ldr {w}, [{r}, #4]",
            "usad8 {a}, {x}, {v}", "usad8 {b}, {y}, {w}",
            "ldrd {x}, {y}, [{l}, #{one}]", "ldr {v}, [{r}, #{one}]", "ldr {w}, [{r}, #{one} + 4]",
            "usada8 {a}, {x}, {v}, {a}", "usada8 {b}, {y}, {w}, {b}",
            "orr {a}, {a}, {b}, lsl #16",
            "ldrd {x}, {y}, [{l}, #{two}]", "ldr {v}, [{r}, #{two}]", "ldr {w}, [{r}, #{two} + 4]",
            "usad8 {b}, {x}, {v}", "usad8 {c}, {y}, {w}",
            "ldrd {x}, {y}, [{l}, #{three}]", "ldr {v}, [{r}, #{three}]", "ldr {w}, [{r}, #{three} + 4]",
            "usada8 {b}, {x}, {v}, {b}", "usada8 {c}, {y}, {w}, {c}",
            "orr {b}, {b}, {c}, lsl #16",
            "ldr {r}, [{trial}]",
            "strd {a}, {b}, [{trial}, #4]",
            // The sum of all four cells, in front of place and label.
            "add {a}, {a}, {b}",
            "uxth {b}, {a}",
            "add {a}, {b}, {a}, lsr #16",
            "add {r}, {r}, {a}, lsl #12",
            "str {r}, [{trial}], #16",
            "cmp {trial}, {end}",
            "bne 2b",
            trial = inout(reg) trials.start => _, end = in(reg) trials.end, l = in(reg) left, origin = in(reg) origin,
            a = out(reg) _, b = out(reg) _, c = out(reg) _, r = out(reg) _,
            x = out(reg) _, y = out(reg) _, v = out(reg) _, w = out(reg) _,
            one = const { tile_sad_offset(WORDS) }, two = const { 2 * tile_sad_offset(WORDS) },
            three = const { 3 * tile_sad_offset(WORDS) },
            options(nostack)
        );
    }
}

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
            "usat {t}, #8, {t}\n strb {t}, [{out}, #4 * {words} + ",
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

/// The first `2 * pairs` cells' `fit`.
///
/// # Safety
/// There must be so many labels, the rows' words, and four bytes from [`CellWindows::last_byte`] on.
#[inline(always)]
pub(crate) unsafe fn fit_sums_by_pairs<const WORDS: usize>(
    windows: &CellWindows<'_, WORDS>,
    sums: &mut CellSums<WORDS>,
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
            left = inout(reg) windows.left.as_ptr().cast::<u32>().add(1) => _, out = inout(reg) sums.fit.as_mut_ptr() => _,
            t = out(reg) _, u = out(reg) _, v = out(reg) _, row = const { 4 * WORDS },
            options(nostack),
        );
    }
}

/// Sum of absolute differences of four words and of two words in each of two rows, `WORDS` words apart.
///
/// # Safety
/// The two words of either row must be readable.
#[inline(always)]
pub(crate) unsafe fn window_sad_words<const WORDS: usize>(window: &[u32; 4], rows: *const u8) -> u32 {
    let sum;
    // SAFETY: reads what the caller promises.
    unsafe {
        asm!(
            "ldrd {x}, {y}, [{w}]", "ldr {s}, [{r}]", "ldr {z}, [{r}, #4]",
            "usad8 {s}, {x}, {s}", "usada8 {s}, {y}, {z}, {s}",
            "ldrd {x}, {y}, [{w}, #8]", "ldr {z}, [{r}, #{row}]", "usada8 {s}, {x}, {z}, {s}",
            "ldr {z}, [{r}, #{row} + 4]", "usada8 {s}, {y}, {z}, {s}",
            w = in(reg) window, r = in(reg) rows, s = out(reg) sum, x = out(reg) _, y = out(reg) _, z = out(reg) _,
            row = const { 4 * WORDS },
            options(pure, readonly, nostack, preserves_flags)
        );
    }
    sum
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

/// Two cells' pixels in a row, moved by their slopes up or down.
macro_rules! moved_row {
    ($move:literal, $times:literal, $pixels:ident, $slopes:ident, $out:ident, $end:ident, $least:ident) => {
        asm!(
            "2:",
            "ldr {s}, [{slopes}], #4",
            "ldrd {a}, {b}, [{pixels}], #8",
            "ldrd {c}, {d}, [{pixels}], #8",
            $times,
            "pkhbt {t}, {s}, {s}, lsl #16",
            "pkhtb {s}, {s}, {s}, asr #16",
            concat!($move, " {a}, {a}, {t}"),
            concat!($move, " {b}, {b}, {t}"),
            concat!($move, " {c}, {c}, {s}"),
            concat!($move, " {d}, {d}, {s}"),
            "ssub16 {t}, {a}, {least}",
            "sel {a}, {a}, {least}",
            "ssub16 {t}, {b}, {least}",
            "sel {b}, {b}, {least}",
            "ssub16 {t}, {c}, {least}",
            "sel {c}, {c}, {least}",
            "ssub16 {t}, {d}, {least}",
            "sel {d}, {d}, {least}",
            "strd {a}, {b}, [{out}], #8",
            "strd {c}, {d}, [{out}], #8",
            "cmp {pixels}, {end}",
            "bne 2b",
            slopes = inout(reg) $slopes => _, pixels = inout(reg) $pixels => _, out = inout(reg) $out => _,
            end = in(reg) $end, least = in(reg) $least,
            a = out(reg) _, b = out(reg) _, c = out(reg) _, d = out(reg) _, s = out(reg) _, t = out(reg) _,
            options(nostack),
        )
    };
}

/// [`write_moved`](super::answer_rows::write_moved) of `pairs` pairs of cells.
///
/// # Safety
/// All must have so many, `pixels` and `out` must be aligned to words, and `pairs` must not be 0.
#[inline(always)]
pub(crate) unsafe fn write_moved_pairs<const TIMES: i32>(
    pixels: *const PixelPair,
    slopes: *const [i16; 2],
    least: u32,
    out: *mut u32,
    pairs: usize,
) {
    // SAFETY: as the caller promises.
    unsafe {
        let end = pixels.add(pairs);
        match TIMES {
            3 => moved_row!("uadd16", "uadd16 {t}, {s}, {s}\n uadd16 {s}, {s}, {t}", pixels, slopes, out, end, least),
            1 => moved_row!("uadd16", "", pixels, slopes, out, end, least),
            -1 => moved_row!("usub16", "", pixels, slopes, out, end, least),
            _ => moved_row!("usub16", "uadd16 {t}, {s}, {s}\n uadd16 {s}, {s}, {t}", pixels, slopes, out, end, least),
        }
    }
}

/// [`lay_planes`](super::answer_rows::lay_planes) of `pairs` pairs of cells.
///
/// # Safety
/// All must have so many, and `pairs` must not be 0.
#[inline(always)]
pub(crate) unsafe fn lay_plane_pairs<const HEIGHT: u32>(
    planes: &PlanePairs<'_>,
    pixels: *mut PixelPair,
    downs: *mut [i16; 2],
    pairs: usize,
) {
    let [above, here, below] = planes.values.map(<[_]>::as_ptr);
    let slopes = planes.slopes.as_ptr();
    let [less, more] = planes.bases;
    // SAFETY: reads and writes what the caller promises; the constants lie on the stack while it runs.
    unsafe {
        asm!(
            // The place of the slopes after that of the next values, the end, constants.
            "sub {slopes}, {slopes}, {here}",
            "sub {slopes}, {slopes}, #4",
            "push {{{slopes}}}",
            "push {{{end}}}",
            "push {{{raised}}}",
            "push {{{more}}}",
            "push {{{less}}}",
            "push {{{same}}}",
            "2:",
            "ldr {h}, [{here}], #4",
            "ldr {end}, [{above}], #4",
            "ldr {slopes}, [{below}], #4",
            // How far the values above and below are from that of the cell.
            "uqsub16 {less}, {end}, {h}",
            "uqsub16 {more}, {h}, {end}",
            "orr {less}, {less}, {more}",
            "uqsub16 {more}, {slopes}, {h}",
            "uqsub16 {raised}, {h}, {slopes}",
            "orr {more}, {more}, {raised}",
            "ldr {same}, [sp]",
            "usub16 {raised}, {same}, {less}",
            "sel {end}, {end}, {h}",
            "usub16 {raised}, {same}, {more}",
            "sel {slopes}, {slopes}, {h}",
            "usub16 {raised}, {less}, {more}",
            "sel {less}, {less}, {more}",
            "uhadd16 {more}, {end}, {slopes}",
            "uhadd16 {more}, {more}, {h}",
            "uhsub16 {raised}, {slopes}, {end}",
            "usub16 {slopes}, {slopes}, {end}",
            "usub16 {end}, {same}, {less}",
            "sel {h}, {more}, {h}",
            "sel {slopes}, {raised}, {slopes}",
            // The slope down. Slopes are far from the ends of 16 bits.
            "ldr {same}, [sp, #12]",
            "eor {slopes}, {slopes}, #0x80008000",
            "add {slopes}, {slopes}, #{half}",
            "lsr {slopes}, {slopes}, #{bits}",
            "bic {slopes}, {slopes}, #{over}",
            "usub16 {slopes}, {slopes}, {same}",
            "str {slopes}, [{downs}], #4",
            // Half a column and one and a half beside the middle.
            "ldr {same}, [sp, #20]",
            "ldr {end}, [{here}, {same}]",
            "uadd16 {less}, {end}, {end}",
            "uadd16 {less}, {less}, {end}",
            "eor {end}, {end}, #0x80008000",
            "add {end}, {end}, #0x00400040",
            "lsr {end}, {end}, #7",
            "bic {end}, {end}, #0xfe00fe00",
            "eor {less}, {less}, #0x80008000",
            "add {less}, {less}, #0x00400040",
            "lsr {less}, {less}, #7",
            "bic {less}, {less}, #0xfe00fe00",
            "ldrd {same}, {raised}, [sp, #4]",
            "lsr {h}, {h}, #3",
            "bic {h}, {h}, #0xe000e000",
            "add {h}, {h}, #0x00010001",
            "lsr {h}, {h}, #1",
            "bic {h}, {h}, #0xe000e000",
            "uadd16 {same}, {h}, {same}",
            "uadd16 {raised}, {h}, {raised}",
            "usub16 {slopes}, {same}, {less}",
            "usub16 {same}, {same}, {end}",
            "uadd16 {h}, {raised}, {end}",
            "uadd16 {raised}, {raised}, {less}",
            "pkhbt {end}, {slopes}, {same}, lsl #16",
            "pkhbt {less}, {h}, {raised}, lsl #16",
            "strd {end}, {less}, [{pixels}], #8",
            "pkhtb {end}, {same}, {slopes}, asr #16",
            "pkhtb {less}, {raised}, {h}, asr #16",
            "strd {end}, {less}, [{pixels}], #8",
            "ldr {same}, [sp, #16]",
            "cmp {here}, {same}",
            "bne 2b",
            "add sp, sp, #24",
            above = inout(reg) above => _, here = inout(reg) here => _, below = inout(reg) below => _,
            pixels = inout(reg) pixels => _, downs = inout(reg) downs => _,
            slopes = inout(reg) slopes => _, end = inout(reg) here.add(pairs) => _, less = inout(reg) less => _,
            more = inout(reg) more => _, same = inout(reg) planes.same => _, raised = inout(reg) planes.raised => _,
            h = out(reg) _,
            bits = const { down_bits(HEIGHT) }, half = const { splat_half(1 << (down_bits(HEIGHT) - 1)) },
            over = const { splat_half(!(0xffff >> down_bits(HEIGHT)) & 0xffff) },
        );
    }
}
