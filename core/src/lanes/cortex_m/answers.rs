//! Pixels of answers in pieces of assembly.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

use crate::lanes::answer_rows::{PixelPair, PlanePairs, down_bits};
use crate::lanes::splat_half;

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
