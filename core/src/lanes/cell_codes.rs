//! Codes of cells of 4 columns as bits: many cells in one piece, up to one that has no code.

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

#[cfg(haarline_dsp)]
mod cortex_m;
#[cfg(not(haarline_dsp))]
mod portable;

#[cfg(haarline_dsp)]
pub(crate) use cortex_m::{put_confidences, put_disparities};
#[cfg(not(haarline_dsp))]
pub(crate) use portable::{put_confidences, put_disparities};

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
