//! Codes of cells of 4 x 2 px as bits: many cells in one piece, up to one that has no code.
#![cfg_attr(haarline_dsp, expect(unsafe_code, reason = "a loop whose figures all stay in registers"))]

use crate::Disparity;

/// Some bits: how many in the lowest byte, and above it the bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Code(u32);

impl Code {
    /// The lowest `count` bits of `bits`, at most 16; the others are 0.
    #[inline(always)]
    pub(crate) const fn new(bits: u32, count: u32) -> Self {
        Self(bits << 8 | count)
    }

    /// Whether it is that one.
    pub(crate) const fn is(self, other: Self) -> bool {
        self.0 == other.0
    }

    #[inline(always)]
    pub(crate) const fn bits(self) -> u32 {
        self.0 >> 8
    }

    #[inline(always)]
    pub(crate) const fn count(self) -> u32 {
        self.0 & 0xff
    }
}

/// Bits on their way into words, the first in the lowest place.
pub(crate) struct Bits<'a> {
    words: &'a mut [[u8; 4]],
    used: usize,
    /// What is no whole word yet, fewer than 32 bits, and how many.
    pending: u32,
    count: u32,
}

impl<'a> Bits<'a> {
    pub(crate) const fn new(words: &'a mut [[u8; 4]]) -> Self {
        Self { words, used: 0, pending: 0, count: 0 }
    }

    /// Adds a code; `None` if there is no more room.
    #[inline(always)]
    pub(crate) fn put(&mut self, code: Code) -> Option<()> {
        let before = self.count;
        self.pending |= code.bits() << before;
        self.count += code.count();
        if self.count >= 32 {
            *self.words.get_mut(self.used)? = self.pending.to_le_bytes();
            self.used += 1;
            self.count -= 32;
            self.pending = code.bits() >> (32 - before);
        }
        Some(())
    }

    /// Writes what is left; how many bytes all are. `None` if there is no more room.
    pub(crate) fn finish(self) -> Option<usize> {
        if self.count > 0 {
            *self.words.get_mut(self.used)? = self.pending.to_le_bytes();
        }
        Some(4 * self.used + self.count.div_ceil(8) as usize)
    }

    /// Words that there still is room for.
    fn room(&self) -> usize {
        self.words.len() - self.used
    }
}

/// A code as tables have it: with what to add to their address for the next cell's codes.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(haarline_dsp, expect(dead_code, reason = "read by assembly"))]
pub(crate) struct Entry(u32);

impl Entry {
    /// No code. Counts more bits than all codes of a cell together.
    pub(crate) const NONE: Self = Self(Self::NO_COUNT);
    const NO_COUNT: u32 = 64;
    const NEXT: u32 = 23;

    /// A code of less than 16 bits, and for the next cell the table that begins so many bytes later, less than 512.
    pub(crate) const fn new(code: Code, next: usize) -> Self {
        assert!(code.count() < 16 && next < 1 << (32 - Self::NEXT));
        #[allow(clippy::cast_possible_truncation, reason = "as is asserted")]
        Self(code.0 | (next as u32) << Self::NEXT)
    }

    #[cfg(not(haarline_dsp))]
    const fn code(self) -> Code {
        Code(self.0 & ((1 << Self::NEXT) - 1))
    }

    #[cfg(not(haarline_dsp))]
    const fn is_none(self) -> bool {
        self.code().count() == Self::NO_COUNT
    }

    #[cfg(not(haarline_dsp))]
    const fn next(self) -> usize {
        (self.0 >> Self::NEXT) as usize
    }
}

/// Codes of a confidence that is the same in a whole cell, by an eighth of what it is more than the one before, from -16 on:
/// after a change, and after none.
pub(crate) struct ConfidenceCodes(pub(crate) [[Entry; 32]; 2]);

/// Bytes of a table of 32 codes.
const TABLE: usize = 128;

impl ConfidenceCodes {
    /// What to add to the address after a change or none.
    pub(crate) const fn next(is_steady: bool) -> usize {
        TABLE * is_steady as usize
    }
}

/// The confidence of the column before, and what it was after.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Confidences {
    pub(crate) before: u8,
    pub(crate) is_steady: bool,
}

/// Codes of disparities. The first entry of a table is that of the least number.
#[repr(C)]
pub(crate) struct DisparityCodes {
    /// The first pixel less the one before it, from -32 on.
    pub(crate) value: [Entry; 64],
    /// What the lower row has more than the upper one, from -16 on: after less than none, none, and more.
    pub(crate) down: [[Entry; 32]; 3],
    /// By what the last column has more than the first, from -32 on.
    pub(crate) shape: [Shape; 64],
    /// Says that the bits of a value follow.
    pub(crate) escape: Code,
}

/// The code of a shape, and what the third and second column must have more than the first: lower and upper half.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct Shape {
    pub(crate) inner: u32,
    pub(crate) code: Entry,
}

impl DisparityCodes {
    /// From the value of 0 to the three tables' *down* of 0.
    const DOWN: usize = TABLE + TABLE / 2;
    /// From the value of 0 to the shape of 0.
    #[cfg(haarline_dsp)]
    const SHAPE: usize = TABLE + 3 * TABLE + 32 * size_of::<Shape>();
    /// From the value of 0 to the escape.
    #[cfg(haarline_dsp)]
    const ESCAPE: usize = Self::SHAPE + 32 * size_of::<Shape>();
    /// Bits of a value after the escape; the least number stands for a wider one.
    #[cfg(not(haarline_dsp))]
    const BITS: u32 = 12;

    /// What to add to the address of the value of 0 for the codes of *down* after less than none (0), none (1), more (2).
    pub(crate) const fn next(down: usize) -> usize {
        Self::DOWN + TABLE * down
    }
}

/// The pixel before a cell, and which codes of *down* hold for it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Disparities {
    pub(crate) before: i32,
    pub(crate) down: usize,
}

/// The columns of a cell, two in a word.
#[inline(always)]
pub(crate) fn words_of(row: [Disparity; 4]) -> [u32; 2] {
    let [a, b, c, d] = row.map(|disparity| u32::from(disparity.into_bits().cast_unsigned()));
    [a | b << 16, c | d << 16]
}

#[cfg(not(haarline_dsp))]
pub(crate) use portable::{put_confidences, put_disparities};

#[cfg(not(haarline_dsp))]
mod portable {
    use super::{Bits, Code, ConfidenceCodes, Confidences, Disparities, DisparityCodes, Entry, TABLE, words_of};
    use crate::Disparity;
    use crate::lanes::{splat, splat_half, sub_halves};

    /// Writes the confidences of cells up to one that has no code: how many cells. Both rows must have the same.
    pub(crate) fn put_confidences(
        [upper, lower]: [&[[u8; 4]]; 2],
        codes: &ConfidenceCodes,
        state: &mut Confidences,
        bits: &mut Bits<'_>,
    ) -> usize {
        let most = bits.room();
        let mut done = 0;
        for (&upper, &lower) in upper.iter().zip(lower).take(most) {
            let word = u32::from_le_bytes(upper);
            let change = i32::from(upper[0]) - i32::from(state.before);
            let index = usize::try_from((change >> 3) + 16).unwrap_or(0).min(31);
            let entry = codes.0[usize::from(state.is_steady)][index];
            let is_told = upper == lower && word == splat(word & 0xff) && change & 7 == 0;
            if !is_told || put(bits, [entry]).is_none() {
                break;
            }
            *state = Confidences { before: upper[3], is_steady: entry.next() == TABLE };
            done += 1;
        }
        done
    }

    /// Writes the disparities of cells, two columns in a word, up to one that has no code: how many cells.
    pub(crate) fn put_disparities(
        [upper, lower]: [&[[Disparity; 4]]; 2],
        codes: &DisparityCodes,
        state: &mut Disparities,
        bits: &mut Bits<'_>,
    ) -> usize {
        let most = bits.room() / 2;
        let mut done = 0;
        for (upper, lower) in upper.iter().zip(lower).take(most) {
            let ([left, right], lower) = (words_of(*upper), words_of(*lower));
            let down = [sub_halves(lower[0], left), sub_halves(lower[1], right)];
            if down[0] != down[1] || down[0] != down[0].rotate_left(16) {
                break;
            }
            let [first, last] = [(left << 16).cast_signed() >> 16, right.cast_signed() >> 16];
            let shape = codes.shape[saturated(last - first, 32)];
            if sub_halves(left & 0xffff_0000 | right & 0xffff, splat_half(left & 0xffff)) != shape.inner {
                break;
            }
            let step = first - state.before;
            let value = codes.value[saturated(step, 32)];
            let down = codes.down[state.down][saturated(down[0].cast_signed() >> 16, 16)];
            let least = -1 << (DisparityCodes::BITS - 1);
            if value.is_none() && !shape.code.is_none() && !down.is_none() && (least + 1..-least).contains(&step) {
                let step = Code::new(step.cast_unsigned() & ((1 << DisparityCodes::BITS) - 1), DisparityCodes::BITS);
                let all = [shape.code.code(), codes.escape, step, down.code()];
                if all.into_iter().try_for_each(|code| bits.put(code)).is_none() {
                    break;
                }
            } else if put(bits, [shape.code, value, down]).is_none() {
                break;
            }
            *state = Disparities { before: last, down: (down.next() - DisparityCodes::DOWN) / TABLE };
            done += 1;
        }
        done
    }

    /// Where a number stands in a table from `-half` to `half - 1`; those beyond stand at its ends.
    fn saturated(number: i32, half: i32) -> usize {
        usize::try_from(number.clamp(-half, half - 1) + half).unwrap_or(0)
    }

    /// All of these codes, or none.
    fn put<const N: usize>(bits: &mut Bits<'_>, entries: [Entry; N]) -> Option<()> {
        if entries.iter().any(|entry| entry.is_none()) {
            return None;
        }
        entries.iter().try_for_each(|entry| bits.put(entry.code()))
    }
}

#[cfg(haarline_dsp)]
pub(crate) use cortex_m::{put_confidences, put_disparities};

#[cfg(haarline_dsp)]
mod cortex_m {
    use core::arch::asm;

    use super::{Bits, ConfidenceCodes, Confidences, Disparities, DisparityCodes, TABLE};
    use crate::Disparity;
    use crate::lanes::splat;

    /// Writes the confidences of cells up to one that has no code: how many cells. Both rows must have the same.
    #[inline(never)]
    pub(crate) fn put_confidences(
        [upper, lower]: [&[[u8; 4]]; 2],
        codes: &ConfidenceCodes,
        state: &mut Confidences,
        bits: &mut Bits<'_>,
    ) -> usize {
        let most = upper.len().min(lower.len()).min(bits.room());
        if most == 0 {
            return 0;
        }
        let mut before = i32::from(state.before) - 128;
        let base = codes.0.as_ptr().cast::<u8>();
        let mut table = base.wrapping_add(ConfidenceCodes::next(state.is_steady));
        let begin = upper.as_ptr();
        let mut at = begin;
        // SAFETY: reads as many cells as both rows have, and of a table of 32 codes one that the index is limited to; each
        // cell adds less than 32 bits, so that at most as many words are written as there are cells, for which there is room.
        unsafe {
            let out = bits.words.as_mut_ptr().add(bits.used);
            let next: *mut [u8; 4];
            asm!(
                "push {{r7}}",
                "push {{{e}}}",
                "mov r7, {a}",
                "2:",
                "ldr {a}, [{u}], #4",
                "ldr {b}, [{l}], #4",
                "cmp {a}, {b}",
                "bne 5f",
                "cmp {a}, r7",
                "beq 7f",
                "cmp.w {a}, {a}, ror #8",
                "bne 5f",
                "mov r7, {a}",
                "uxtb {a}, {a}",
                "sub {b}, {a}, {before}",
                "ror {b}, {b}, #3",
                "usat {b}, #5, {b}",
                "ldr {b}, [{table}, {b}, lsl #2]",
                "ubfx {c}, {b}, #8, #15",
                "uxtab {e}, {count}, {b}",
                "cmp {e}, #32",
                "bhs 4f",
                "lsl {c}, {c}, {count}",
                "orr {pending}, {pending}, {c}",
                "mov {count}, {e}",
                "3:",
                "sub {before}, {a}, #128",
                "add {table}, {base}, {b}, lsr #23",
                "cmp {u}, {end}",
                "bne 2b",
                "b 6f",
                "4:",
                "cmp {e}, #64",
                "bhs 5f",
                "lsl {a}, {c}, {count}",
                "orr {pending}, {pending}, {a}",
                "ldr {a}, [sp]",
                "str {pending}, [{a}], #4",
                "str {a}, [sp]",
                "rsb {a}, {count}, #32",
                "lsr {pending}, {c}, {a}",
                "sub {count}, {e}, #32",
                "uxtb {a}, r7",
                "b 3b",
                // The same as before in the whole cell: a bit of 0.
                "7:",
                "add {table}, {base}, #{steady}",
                "add {count}, {count}, #1",
                "cmp {count}, #32",
                "beq 8f",
                "cmp {u}, {end}",
                "bne 2b",
                "b 6f",
                "8:",
                "ldr {a}, [sp]",
                "str {pending}, [{a}], #4",
                "str {a}, [sp]",
                "mov {pending}, #0",
                "mov {count}, #0",
                "cmp {u}, {end}",
                "bne 2b",
                "b 6f",
                "5:",
                "sub {u}, {u}, #4",
                "6:",
                "pop {{{e}}}",
                "pop {{r7}}",
                u = inout(reg) at,
                l = inout(reg) lower.as_ptr() => _,
                end = in(reg) begin.add(most),
                pending = inout(reg) bits.pending,
                count = inout(reg) bits.count,
                before = inout(reg) before,
                table = inout(reg) table,
                base = in(reg) base,
                steady = const TABLE,
                // A row's first cell has none before it, but then 0 is what it would be.
                a = inout(reg) splat(state.before.into()) => _,
                b = out(reg) _, c = out(reg) _,
                e = inout(reg) out => next,
            );
            bits.used += next.offset_from(out).cast_unsigned();
            state.before = u8::try_from(before + 128).unwrap_or(0);
            state.is_steady = table != base;
            at.offset_from(begin).cast_unsigned()
        }
    }

    /// Writes the disparities of cells, two columns in a word, up to one that has no code: how many cells.
    #[inline(never)]
    pub(crate) fn put_disparities(
        [upper, lower]: [&[[Disparity; 4]]; 2],
        codes: &DisparityCodes,
        state: &mut Disparities,
        bits: &mut Bits<'_>,
    ) -> usize {
        let most = upper.len().min(lower.len()).min(bits.room() / 2);
        if most == 0 {
            return 0;
        }
        let base = codes.value.as_ptr().wrapping_add(32).cast::<u8>();
        let mut table = base.wrapping_add(DisparityCodes::next(state.down));
        let begin = upper.as_ptr();
        let mut at = begin;
        // SAFETY: reads as many cells as both rows have, and of each table one that the index is limited to; each
        // cell adds less than 64 bits, so that at most two words are written for each, for which there is room.
        unsafe {
            let out = bits.words.as_mut_ptr().add(bits.used);
            let next: *mut [u8; 4];
            asm!(
                "push {{r7}}",
                "push {{{e}}}",
                "push {{{f}}}",
                "2:",
                // No two words at once: rows need not begin at one.
                "ldr {a}, [{u}], #4",
                "ldr r7, [{u}], #4",
                "ldr {c}, [{l}], #4",
                "ldr {d}, [{l}], #4",
                "usub16 {c}, {c}, {a}",
                "usub16 {d}, {d}, r7",
                "cmp {c}, {d}",
                "bne 5f",
                "cmp.w {c}, {c}, ror #16",
                "bne 5f",
                "ssat {c}, #5, {c}, asr #16",
                "asr {d}, r7, #16",
                "sxth {e}, {a}",
                // The shape that the columns between the first and the last must have.
                "sub {f}, {d}, {e}",
                "ssat {f}, #6, {f}",
                "add {f}, {base}, {f}, lsl #3",
                "pkhbt r7, r7, {a}",
                "pkhbt {a}, {a}, {a}, lsl #16",
                "usub16 r7, r7, {a}",
                "ldrd {a}, {f}, [{f}, #{shape}]",
                "cmp r7, {a}",
                "bne 5f",
                "sub {e}, {e}, {before}",
                "ssat {e}, #6, {e}",
                "ldr {e}, [{base}, {e}, lsl #2]",
                "ldr {c}, [{table}, {c}, lsl #2]",
                // Shape, value, down; the number of bits is the lowest byte, which is all that a shift takes of a register.
                "ubfx {a}, {c}, #8, #15",
                "lsl {a}, {a}, {e}",
                "orr {a}, {a}, {e}, lsr #8",
                "lsl {a}, {a}, {f}",
                "orr {a}, {a}, {f}, lsr #8",
                "uxtab r7, {count}, {c}",
                "uxtab r7, r7, {e}",
                "uxtab r7, r7, {f}",
                "9:",
                "cmp r7, #32",
                "bhs 4f",
                "lsl {a}, {a}, {count}",
                "orr {pending}, {pending}, {a}",
                "mov {count}, r7",
                "3:",
                "mov {before}, {d}",
                "add {table}, {base}, {c}, lsr #23",
                "ldr {e}, [sp, #4]",
                "cmp {u}, {e}",
                "bne 2b",
                "b 6f",
                "4:",
                "cmp r7, #64",
                "bhs 7f",
                "lsl {f}, {a}, {count}",
                "orr {pending}, {pending}, {f}",
                "ldr {f}, [sp]",
                "str {pending}, [{f}], #4",
                "str {f}, [sp]",
                "rsb {f}, {count}, #32",
                "lsr {pending}, {a}, {f}",
                "sub {count}, r7, #32",
                "b 3b",
                // One has no code. If it is the value, its bits are told.
                "7:",
                "orr {a}, {f}, {c}",
                "tst {a}, #64",
                "bne 5f",
                "ldrsh {e}, [{u}, #-8]",
                "sub {e}, {e}, {before}",
                "ssat {a}, #12, {e}",
                "cmp {a}, {e}",
                "bne 5f",
                "cmn {e}, #2048",
                "beq 5f",
                "ldr r7, [{base}, #{escape}]",
                "ubfx {a}, {a}, #0, #12",
                "lsl {a}, {a}, r7",
                "orr {a}, {a}, r7, lsr #8",
                "lsl {a}, {a}, {f}",
                "orr {a}, {a}, {f}, lsr #8",
                "uxtab r7, {count}, r7",
                "uxtab r7, r7, {f}",
                "add r7, r7, #12",
                "lsl {e}, {a}, {count}",
                "orr {pending}, {pending}, {e}",
                "cmp r7, #32",
                "blo 8f",
                "ldr {f}, [sp]",
                "str {pending}, [{f}], #4",
                "str {f}, [sp]",
                "rsb {f}, {count}, #32",
                "lsr {pending}, {a}, {f}",
                "sub r7, r7, #32",
                "8:",
                "mov {count}, r7",
                "ubfx {a}, {c}, #8, #15",
                "uxtab r7, {count}, {c}",
                "b 9b",
                "5:",
                "sub {u}, {u}, #8",
                "6:",
                "pop {{{f}}}",
                "add sp, sp, #4",
                "pop {{r7}}",
                shape = const DisparityCodes::SHAPE,
                escape = const DisparityCodes::ESCAPE,
                u = inout(reg) at,
                l = inout(reg) lower.as_ptr() => _,
                pending = inout(reg) bits.pending,
                count = inout(reg) bits.count,
                before = inout(reg) state.before,
                table = inout(reg) table,
                base = in(reg) base,
                a = out(reg) _, c = out(reg) _, d = out(reg) _,
                e = inout(reg) begin.add(most) => _,
                f = inout(reg) out => next,
            );
            bits.used += next.offset_from(out).cast_unsigned();
            state.down = (table as usize - base as usize - DisparityCodes::DOWN) / TABLE;
            at.offset_from(begin).cast_unsigned()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_lie_where_the_loops_look_for_them() {
        assert_eq!(core::mem::offset_of!(DisparityCodes, down), 2 * TABLE);
        assert_eq!(2 * TABLE + TABLE / 2 - TABLE, DisparityCodes::DOWN);
        assert_eq!(core::mem::offset_of!(DisparityCodes, shape), 5 * TABLE);
        assert_eq!(size_of::<[Entry; 32]>(), TABLE);
    }

    #[test]
    fn what_finds_no_room_is_not_written() {
        let mut words = [[0; 4]; 2];
        let mut bits = Bits::new(&mut words);
        let fits = (0..).take_while(|_| bits.put(Code::new(0x7ff, 11)).is_some()).count();
        assert_eq!(fits, 95 / 11);
        assert_eq!(words, [[0xff; 4]; 2]);
    }
}
