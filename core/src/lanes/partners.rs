//! The two cheapest partners of a contour.
#![cfg_attr(haarline_dsp, expect(unsafe_code, reason = "a loop whose figures all stay in registers"))]
#![allow(clippy::cast_possible_truncation, reason = "rows are below 4096 bytes")]

use crate::lanes::windows::Window;

/// A contour.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct Contour {
    /// Column in the upper half, strength in the lower one.
    pub(crate) place: u32,
    /// Of a left contour its partner. Of a right one the least cost, and whose it is: 24 and 8 bits.
    pub(crate) partner: u32,
}

impl Contour {
    pub(crate) const fn column(self) -> usize {
        (self.place >> 16) as usize
    }

    pub(crate) const fn strength(self) -> u32 {
        self.place & 0xffff
    }
}

/// What is asked of the partners of a contour.
#[repr(C)]
pub(crate) struct Wanted {
    window: Window,
    /// The least strength, and how far strengths go beyond it.
    weakest: u32,
    span: u32,
    /// Of the contour.
    number: u32,
    /// The first place that is none.
    end: u32,
}

impl Wanted {
    /// - `number`: of the left contour; `end`: the first place that is no partner's.
    #[inline(always)]
    pub(crate) fn of<const WORDS: usize>(contour: Contour, left: &[[u32; WORDS]; 2], number: u32, end: u32) -> Self {
        // Strengths within a ratio of 2.
        let strength = contour.strength();
        let weakest = strength.div_ceil(2);
        let span = 2 * strength - weakest;
        // A window lies within the row.
        let beyond = (4 * WORDS as u32).saturating_sub(7) << 16;
        Self { window: Window::of(left, contour.column()), weakest, span, number, end: end.min(beyond) }
    }
}

/// The two cheapest partners, cost and place in one number, `u32::MAX` where there is none; the candidates, left to right, learn
/// of it. `start` is the number of the first one.
#[inline(always)]
pub(crate) fn cheapest<const WORDS: usize>(
    wanted: &Wanted,
    start: u32,
    right: &[[u32; WORDS]; 2],
    candidates: &mut [Contour],
) -> [u32; 2] {
    let (mut best, mut second) = (u32::MAX, u32::MAX);
    #[cfg(haarline_dsp)]
    if !candidates.is_empty() {
        let candidates = candidates.as_mut_ptr_range();
        // SAFETY: reads and writes the candidates, and reads the two rows, one behind the other, eight bytes from a place on
        // that `Wanted::of` sees to it lies within them.
        unsafe {
            core::arch::asm!(
                "2:",
                "ldr {p}, [{c}], #8",
                "ldr {x}, [{wanted}, #28]",
                "cmp {p}, {x}",
                "bhs 4f",
                "ldrd {x}, {y}, [{wanted}, #16]",
                "uxth {s}, {p}",
                "sub {s}, {s}, {x}",
                "cmp {s}, {y}",
                "bhi 3f",
                "add {p}, {rows}, {p}, lsr #16",
                "ldrd {x}, {y}, [{wanted}]",
                "ldr {s}, [{p}]",
                "ldr {z}, [{p}, #4]",
                "usad8 {s}, {x}, {s}",
                "usada8 {s}, {y}, {z}, {s}",
                "ldrd {x}, {y}, [{wanted}, #8]",
                "ldr {z}, [{p}, #{row}]",
                "usada8 {s}, {x}, {z}, {s}",
                "ldr {z}, [{p}, #{row} + 4]",
                "usada8 {s}, {y}, {z}, {s}",
                "lsl {s}, {s}, #8",
                "ldr {x}, [{wanted}, #24]",
                "ldr {y}, [{c}, #-4]",
                "orr {x}, {x}, {s}",
                "cmp {x}, {y}",
                "it lo",
                "strlo {x}, [{c}, #-4]",
                "orr {s}, {s}, {place}",
                "cmp {s}, {second}",
                "bhs 3f",
                "mov {second}, {s}",
                "cmp {s}, {best}",
                "itt lo",
                "movlo {second}, {best}",
                "movlo {best}, {s}",
                "3:",
                "add {place}, {place}, #1",
                "cmp {c}, {end}",
                "bne 2b",
                "4:",
                wanted = in(reg) wanted,
                c = inout(reg) candidates.start => _,
                end = in(reg) candidates.end,
                rows = in(reg) right.as_ptr(),
                place = inout(reg) start => _,
                best = inout(reg) best,
                second = inout(reg) second,
                p = out(reg) _, s = out(reg) _, x = out(reg) _, y = out(reg) _, z = out(reg) _,
                row = const { 4 * WORDS },
                options(nostack),
            );
        }
    }
    #[cfg(not(haarline_dsp))]
    for (place, candidate) in (start..).zip(candidates) {
        if candidate.place >= wanted.end {
            break;
        }
        // Nobody can foresee which strengths are wanted: a cost that none exceeds takes no branch.
        let is_wanted = candidate.strength().wrapping_sub(wanted.weakest) <= wanted.span;
        let unwanted = if is_wanted { 0 } else { u32::MAX };
        let cost = wanted.window.sad(right, candidate.column()) << 8 | unwanted;
        candidate.partner = lesser(candidate.partner, cost | wanted.number);
        let key = cost | place;
        second = second.min(best.max(key));
        best = best.min(key);
    }
    [best, second]
}

/// The lesser of two numbers, by arithmetic: of `min` the compiler makes a branch, which is wrong half of the times.
#[cfg(not(haarline_dsp))]
#[inline(always)]
#[expect(clippy::cast_sign_loss, reason = "one of the two")]
fn lesser(a: u32, b: u32) -> u32 {
    let less = i64::from(b) - i64::from(a);
    (i64::from(a) + (less & less >> 63)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheapest_are_those_of_all() {
        let mut seed = 1_u32;
        let mut next = || crate::random::next(&mut seed) >> 4;
        for number in 0..150 {
            let [left, right] = [0; 2].map(|_: u32| [0; 2].map(|_: u32| [0; 30].map(|_: u32| next() & 0x0707_0707)));
            let contour = |column: u32, strength: u32| Contour { place: column << 16 | strength, partner: u32::MAX };
            let mut candidates: [Contour; 12] =
                core::array::from_fn(|i| contour(8 * i as u32 + next() % 8, next() % 24));
            for candidate in &mut candidates[..6] {
                candidate.partner = next() >> 4;
            }
            let (before, own, end) = (candidates, contour(next() % 100, 1 + next() % 20), (next() % 110) << 16);
            let (wanted, start) = (Wanted::of(own, &left, number, end), next() % 100);
            let found = cheapest(&wanted, start, &right, &mut candidates);
            let mut keys = [u32::MAX; 12];
            for (i, (old, new)) in before.iter().zip(&candidates).enumerate() {
                let (strength, weakest) = (old.strength(), own.strength().div_ceil(2));
                let mut partner = old.partner;
                if old.place < end && weakest <= strength && strength <= 2 * own.strength() {
                    let cost = Window::of(&left, own.column()).sad(&right, old.column()) << 8;
                    keys[i] = cost | (start + i as u32);
                    partner = partner.min(cost | number);
                }
                assert_eq!((new.place, new.partner), (old.place, partner));
            }
            keys.sort_unstable();
            assert_eq!(found, keys[..2]);
        }
    }
}
