//! The loops as instructions, sixteen labels a round; where labels are left over, in plain code.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

use super::{GROUP, Labels, portable};
use crate::simd::{Step, splat};

/// Four labels: the differences of what enters and of what leaves, and one less the other, signed, to the sums.
macro_rules! descend_four {
    () => {
        concat!(
            "ldr {e}, [{entering}], #4\n",
            "ldr {l}, [{leaving}], #4\n",
            "uqsub8 {t}, {e}, {left_entering}\n",
            "uqsub8 {e}, {left_entering}, {e}\n",
            "orr {e}, {e}, {t}\n",
            "uqsub8 {t}, {l}, {left_leaving}\n",
            "uqsub8 {l}, {left_leaving}, {l}\n",
            "orr {l}, {l}, {t}\n",
            "ssub8 {e}, {e}, {l}\n",
            "ldrd {l}, {t}, [{sums}]\n",
            "sxtab16 {l}, {l}, {e}\n",
            "sxtab16 {t}, {t}, {e}, ror #8\n",
            "strd {l}, {t}, [{sums}], #8\n",
        )
    };
}

/// Moves a column's sums of the first labels down by a row, each by what its own response of the right view makes of `left`.
#[inline(always)]
pub fn descend<const LABELS: usize>(sums: &mut Labels<LABELS>, left: Step<u8>, right: Step<&[u8]>) {
    let labels = right.entering.len();
    if labels == 0 || !labels.is_multiple_of(GROUP) {
        return portable::descend(sums, left, right);
    }
    assert!(labels <= LABELS && labels == right.leaving.len());
    // SAFETY: it reads `labels` bytes of either slice, and reads and writes the first `labels` sums.
    unsafe {
        asm!(
            "2:",
            descend_four!(),
            descend_four!(),
            descend_four!(),
            descend_four!(),
            "subs {labels}, {labels}, #16",
            "bne 2b",
            sums = inout(reg) sums.0.as_mut_ptr() => _,
            entering = inout(reg) right.entering.as_ptr() => _,
            leaving = inout(reg) right.leaving.as_ptr() => _,
            labels = inout(reg) labels => _,
            left_entering = in(reg) splat(left.entering),
            left_leaving = in(reg) splat(left.leaving),
            e = out(reg) _,
            l = out(reg) _,
            t = out(reg) _,
            options(nostack)
        );
    }
}

/// Four labels on, and the least ones. No sum leaves its 16 bits, so nothing is carried from one to the other.
macro_rules! slide_four {
    () => {
        concat!(
            "ldrd {w0}, {w1}, [{window}]\n",
            "ldrd {e0}, {e1}, [{entering}], #8\n",
            "ldrd {l0}, {l1}, [{leaving}], #8\n",
            "add {w0}, {w0}, {e0}\n",
            "add {w1}, {w1}, {e1}\n",
            "sub {w0}, {w0}, {l0}\n",
            "sub {w1}, {w1}, {l1}\n",
            "usub16 {e0}, {w0}, {least}\n",
            "sel {least}, {least}, {w0}\n",
            "usub16 {e0}, {w1}, {least}\n",
            "sel {least}, {least}, {w1}\n",
            "strd {w0}, {w1}, [{window}], #8\n",
        )
    };
}

/// Slides the sums of `labels` of a window on: what enters is added, what leaves is subtracted. In `leasts` are those of
/// each group: of its even places in the lower half, of its odd ones in the upper.
#[inline(always)]
pub fn slide<const LABELS: usize>(
    window: &mut Labels<LABELS>,
    columns: Step<&Labels<LABELS>>,
    labels: usize,
    leasts: &mut [u32],
) {
    if labels == 0 || !labels.is_multiple_of(GROUP) {
        return portable::slide(window, columns, labels, leasts);
    }
    assert!(labels <= LABELS && labels / GROUP <= leasts.len());
    // SAFETY: it reads the first `labels` sums of both columns, reads and writes those of the window, and writes a word for
    // each sixteen of them to `leasts`.
    unsafe {
        asm!(
            "2:",
            "mov {least}, #-1",
            slide_four!(),
            slide_four!(),
            slide_four!(),
            slide_four!(),
            "str {least}, [{leasts}], #4",
            "subs {labels}, {labels}, #16",
            "bne 2b",
            window = inout(reg) window.0.as_mut_ptr() => _,
            entering = inout(reg) columns.entering.0.as_ptr() => _,
            leaving = inout(reg) columns.leaving.0.as_ptr() => _,
            leasts = inout(reg) leasts.as_mut_ptr() => _,
            labels = inout(reg) labels => _,
            least = out(reg) _,
            w0 = out(reg) _,
            w1 = out(reg) _,
            e0 = out(reg) _,
            e1 = out(reg) _,
            l0 = out(reg) _,
            l1 = out(reg) _,
            options(nostack)
        );
    }
}

/// Leaves with the hits among four labels, each in its byte.
macro_rules! hits_of_four {
    () => {
        concat!(
            "ldrd {a}, {b}, [{sums}], #8\n",
            "usub16 {t}, {least}, {a}\n",
            "sel {a}, {even}, {none}\n",
            "usub16 {t}, {least}, {b}\n",
            "sel {b}, {odd}, {none}\n",
            "orrs {a}, {a}, {b}\n",
        )
    };
}

/// The label of a whole group whose sum is `least`, in both halves, from the group's first on; of several the first.
/// One has it.
#[inline(always)]
pub fn first_of_group<const LABELS: usize>(sums: &Labels<LABELS>, group: usize, least: u32) -> usize {
    let sums = &sums.0[GROUP * group..][..GROUP];
    let (hits, behind): (u32, *const u16);
    // SAFETY: it reads sixteen sums at most.
    unsafe {
        asm!(
            hits_of_four!(),
            "bne 2f",
            hits_of_four!(),
            "bne 2f",
            hits_of_four!(),
            "bne 2f",
            hits_of_four!(),
            "2:",
            sums = inout(reg) sums.as_ptr() => behind,
            least = in(reg) least,
            even = in(reg) 0x00ff_00ff_u32,
            odd = in(reg) 0xff00_ff00_u32,
            none = in(reg) 0_u32,
            a = out(reg) hits,
            b = out(reg) _,
            t = out(reg) _,
            options(nostack, readonly)
        );
    }
    (behind.addr() - sums.as_ptr().addr()) / 2 - 4 + hits.trailing_zeros() as usize / 8
}

/// Keeps the lesser halves of four labels.
macro_rules! least_of_four {
    () => {
        concat!(
            "ldrd {a}, {b}, [{sums}], #8\n",
            "usub16 {t}, {a}, {least}\n",
            "sel {least}, {least}, {a}\n",
            "usub16 {t}, {b}, {least}\n",
            "sel {least}, {least}, {b}\n",
        )
    };
}

/// The least sums of a whole group's even and odd places.
#[inline(always)]
pub fn least_of_group<const LABELS: usize>(sums: &Labels<LABELS>, group: usize) -> u32 {
    let sums = &sums.0[GROUP * group..][..GROUP];
    let mut least = u32::MAX;
    // SAFETY: it reads sixteen sums.
    unsafe {
        asm!(
            least_of_four!(),
            least_of_four!(),
            least_of_four!(),
            least_of_four!(),
            sums = inout(reg) sums.as_ptr() => _,
            least = inout(reg) least,
            a = out(reg) _,
            b = out(reg) _,
            t = out(reg) _,
            options(nostack, readonly)
        );
    }
    least
}
