//! Sums of absolute differences of tiles and windows in pieces of assembly, so that nothing is put aside in between.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

use crate::lanes::trials::Trial;

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

/// [`tile_sads_around`](super::windows::tile_sads_around).
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
