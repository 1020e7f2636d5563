//! Codes of cells of 4 columns, whole bytes: as many cells in one piece as a [`Listed`] can tell of.

/// Cells in one piece.
pub(crate) const MOST: usize = 128;

/// Cells whose disparities have no code, by their number.
#[derive(Clone, Copy)]
pub(crate) struct Listed {
    cells: [u8; MOST],
    count: usize,
}

impl Listed {
    pub(crate) const NONE: Self = Self { cells: [0; MOST], count: 0 };

    /// In their order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = usize> {
        self.cells.iter().take(self.count).map(|&cell| cell.into())
    }
}

/// What a step of confidence is.
pub(crate) const STEP: u32 = 8;
/// Steps downwards that have a code.
pub(crate) const STEPS_DOWN: u32 = 7;
/// How many have.
pub(crate) const STEPS: u32 = 14;
/// Another confidence than these, in the whole cell: it follows.
pub(crate) const JUMP: u32 = 14;
/// Not the same confidence in the whole cell: all four follow.
pub(crate) const MIXED: u32 = 15;
/// The most bytes of the confidences of two cells.
pub(crate) const MOST_BYTES_OF_PAIR: usize = 9;

/// The first byte of the codes of two bytes.
pub(crate) const FIRST_OF_TWO: u32 = 226;
/// Before what a shape and a rise add to the codes of two bytes, and a step of two bytes.
pub(crate) const WIDE: u32 = 254;
/// No code.
pub(crate) const ODD: u32 = 255;

/// What a number of a cell adds to its codes: to that of one byte in the lowest ten bits, to that of two in the upper half.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Part(u32);

impl Part {
    /// A number has no code of one byte. So it is above 255 whatever the others add, and they all stay below 1024.
    const NOT_ONE: u32 = 0x100;
    /// Where a shape has what the second column is above the first.
    const SECOND: u32 = 10;
    const TWO: u32 = 16;
    /// From here on a code of two bytes is none: it is of a step that follows, ...
    const STEP_FOLLOWS: u32 = 0x2000;
    /// ... or all is none.
    const NO_CODE: u32 = 0x4000;

    /// A number that has no code.
    pub(crate) const NONE: Self = Self(Self::NOT_ONE | Self::NO_CODE << Self::TWO);
    /// A step that has none.
    pub(crate) const FOLLOWS: Self = Self(Self::NOT_ONE | Self::STEP_FOLLOWS << Self::TWO);

    /// What it adds to a code of one byte, if it has one, and of two.
    pub(crate) const fn new(one: Option<u32>, two: u32) -> Self {
        let one = if let Some(one) = one { one } else { Self::NOT_ONE };
        assert!(one <= Self::NOT_ONE && two < Self::STEP_FOLLOWS);
        Self(one | two << Self::TWO)
    }

    /// The same of a shape, whose second column is so much above the first.
    pub(crate) const fn of_shape(one: Option<u32>, two: u32, second: i32) -> Self {
        assert!(second >= -16 && second < 16);
        Self(Self::new(one, two).0 | (second.cast_unsigned() & 0x1f) << Self::SECOND)
    }

    #[cfg(any(not(haarline_dsp), test))]
    const fn second(self) -> i32 {
        (self.0 << (32 - 5 - Self::SECOND)).cast_signed() >> (32 - 5)
    }
}

/// What numbers add to codes.
#[repr(C)]
pub(crate) struct DisparityCodes {
    /// By what the third column has more than the first, from -16 on.
    pub(crate) shape: [Part; 32],
    /// By what the lower row has more than the upper one, from -16 on.
    pub(crate) rise: [Part; 32],
    /// By what the first pixel has more than the one before it, from -32 on.
    pub(crate) step: [Part; 64],
}

/// The most bytes of a cell's disparities.
pub(crate) const MOST_BYTES: usize = 4;

#[cfg(haarline_dsp)]
mod cortex_m;
#[cfg(any(not(haarline_dsp), test))]
#[cfg_attr(haarline_dsp, allow(dead_code, reason = "what the other is held against"))]
mod portable;

#[cfg(haarline_dsp)]
pub(crate) use cortex_m::{put_confidences, put_disparities};
#[cfg(not(haarline_dsp))]
pub(crate) use portable::{put_confidences, put_disparities};

// Elsewhere the kernels are the portable ones.
#[cfg(all(test, haarline_dsp))]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;
    use crate::Disparity;
    use proptest::prelude::*;

    /// Codes of anything: of a shape -2, 0 and 2, of a rise up to 3 either side of 0, of a step up to 5.
    fn codes() -> DisparityCodes {
        let mut codes = DisparityCodes { shape: [Part::NONE; 32], rise: [Part::NONE; 32], step: [Part::FOLLOWS; 64] };
        for (i, second) in (0..).zip([-1, 0, 1]) {
            codes.shape[usize::try_from(16 + 3 * second).unwrap()] = Part::of_shape((i > 0).then_some(i), i, second);
        }
        for i in 0..7 {
            codes.rise[13 + i as usize] = Part::new((i < 4).then_some(3 * i), 3 * i);
        }
        for i in 0..11 {
            codes.step[27 + i as usize] = Part::new((i < 9).then_some(1 + 12 * i), 21 * i);
        }
        codes
    }

    proptest! {
        #[test]
        fn confidences_are_the_portable_ones(
            cells in prop::collection::vec((0u8..32, 0u8..20, any::<[u8; 4]>()), 0..=MOST),
            before: u8,
            odd in 0usize..4000,
        ) {
            // Mostly whole steps in whole cells.
            let cells: Vec<[u8; 4]> = cells
                .iter()
                .map(|&(sure, kind, any)| match kind {
                    0 => any,
                    1 => [any[0]; 4],
                    2 => [8 * sure, 8 * sure, 8, 8],
                    _ => [8 * (sure % 8); 4],
                })
                .collect();
            let rows = cells.as_flattened().as_chunks::<8>().0;
            let mut lower = rows.to_vec();
            if let Some(byte) = lower.as_flattened_mut().get_mut(odd) {
                *byte ^= 1;
            }
            let mut rooms = [[0xAA; MOST_BYTES_OF_PAIR * MOST / 2]; 2];
            let [ours, portable] = &mut rooms;
            let count = put_confidences([rows, &lower], before, ours);
            prop_assert_eq!(count, portable::put_confidences([rows, &lower], before, portable));
            prop_assert_eq!(count.is_none(), rows != lower);
            if let Some(count) = count {
                prop_assert_eq!(&ours[..count], &portable[..count]);
            }
        }

        #[test]
        fn disparities_are_the_portable_ones(
            cells in prop::collection::vec((-8i16..9, -2i16..3, -5i16..6, 0u8..12, any::<[i16; 8]>()), 0..=MOST),
            before: i16,
        ) {
            let (mut rows, mut last) = ([const { Vec::new() }; 2], before);
            for &(step, shape, rise, kind, any) in &cells {
                let first = last.wrapping_add(step);
                let mut upper = [0, shape, 2 * shape + shape.signum(), 4 * shape].map(|column| first.wrapping_add(column));
                let mut lower = upper.map(|column: i16| column.wrapping_add(rise));
                match kind {
                    0 => (upper, lower) = (*any.first_chunk().unwrap(), *any.last_chunk().unwrap()),
                    1 => lower[usize::try_from(any[0].rem_euclid(4)).unwrap()] ^= 1,
                    2 => upper = [any[0]; 4],
                    _ => {}
                }
                last = upper[3];
                for (row, cell) in rows.iter_mut().zip([upper, lower]) {
                    row.push(cell.map(Disparity::from_bits));
                }
            }
            let (codes, mut rooms) = (codes(), [[0xAA; MOST_BYTES * MOST]; 2]);
            let [ours, portable] = &mut rooms;
            let [mut listed, mut portable_listed] = [Listed::NONE; 2];
            let rows = rows.each_ref().map(Vec::as_slice);
            let count = put_disparities(rows, &codes, before, ours, &mut listed);
            prop_assert_eq!(count, portable::put_disparities(rows, &codes, before, portable, &mut portable_listed));
            prop_assert_eq!(&ours[..count], &portable[..count]);
            prop_assert!(listed.iter().eq(portable_listed.iter()));
        }
    }
}
