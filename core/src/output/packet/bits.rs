//! Numbers as bits: prefix codes, and a reader of them. The first bit is the lowest of a byte.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "a few dozen codes"
)]

use crate::lanes::cell_codes::Code;

/// Bits of the longest code.
const LONGEST: usize = 12;

/// Codes of the numbers `-MOST..=MOST`, and last of an escape.
#[derive(Debug, Clone, Copy)]
pub(super) struct Codes<const N: usize>([Code; N]);

impl<const N: usize> Codes<N> {
    /// The greatest number that has a code.
    const MOST: i32 = (N as i32 - 2) / 2;

    /// The prefix code of those lengths: shorter ones first, and of equal ones the lesser number.
    pub(super) const fn of(lengths: [u8; N]) -> Self {
        let mut codes = [Code::new(0, 0); N];
        let (mut next, mut length) = (0_u32, 1);
        while length <= LONGEST {
            next <<= 1;
            let mut i = 0;
            while i < N {
                if lengths[i] as usize == length {
                    // The highest bit comes first.
                    codes[i] = Code::new(next.reverse_bits() >> (32 - length), length as u32);
                    next += 1;
                }
                i += 1;
            }
            length += 1;
        }
        // Every sequence of bits is one of codes.
        assert!(next == 1 << LONGEST);
        Self(codes)
    }

    /// Where a number's code is; beyond the last number's, no code.
    #[inline(always)]
    pub(super) const fn index(number: i32) -> usize {
        number.wrapping_add(Self::MOST).cast_unsigned() as usize
    }

    /// The code of a number that has one.
    #[inline(always)]
    pub(super) fn get(&self, number: i32) -> Option<Code> {
        self.0.get(..N - 1)?.get(Self::index(number)).copied()
    }

    /// The code at an index.
    pub(super) const fn at(&self, index: usize) -> Code {
        self.0[index]
    }

    /// The code that says that the number has none.
    #[inline(always)]
    pub(super) const fn escape(&self) -> Code {
        self.0[N - 1]
    }
}

/// Bits as they are read.
pub(super) struct BitReader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> BitReader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The next bits, 16 at most; beyond the end they are 0.
    fn peek(&self) -> u32 {
        let byte = |i: usize| u32::from(self.bytes.get(self.at / 8 + i).copied().unwrap_or(0));
        (byte(0) | byte(1) << 8 | byte(2) << 16) >> (self.at % 8)
    }

    /// Takes so many bits, 16 at most.
    pub(super) fn take(&mut self, count: u32) -> Option<u32> {
        let bits = self.peek() & ((1 << count) - 1);
        self.at += count as usize;
        (self.at <= 8 * self.bytes.len()).then_some(bits)
    }

    /// Takes a code: the number that it stands for, `None` for the escape.
    pub(super) fn number<const N: usize>(&mut self, codes: &Codes<N>) -> Option<Option<i32>> {
        let bits = self.peek();
        let is_here = |code: &Code| bits & ((1 << code.count()) - 1) == code.bits();
        let index = codes.0.iter().position(is_here)?;
        self.take(codes.0.get(index)?.count())?;
        Some((index + 1 < N).then(|| index as i32 - Codes::<N>::MOST))
    }

    /// Whether all was read: what fills the last byte up is 0.
    pub(super) fn is_done(&self) -> bool {
        self.at.div_ceil(8) == self.bytes.len() && self.peek() == 0
    }
}
