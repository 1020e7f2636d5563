//! The disparities of cells, in 1/16 px.
//!
//! Three numbers tell most cells:
//!
//! 1. *shape*: half of what the last column has more than the first. The columns are 0, `shape - near`, `shape + near`, `2 shape` above
//!    the first, `near` being a third of `shape`, rounded;
//! 2. *rise*: half of what a row has more than the one above it;
//! 3. *step*: the upper left pixel less the pixel before it; before the row is 0.
//!
//! | first byte | follow | numbers, the first one counting fastest |
//! |---|---|---|
//! | 1 to 225 | | shape -2 to 2, step -4 to 4, rise -1 to 3 |
//! | 226 to 253 | a byte: the lower eight bits of their number | shape -8 to 8, rise -6 to 6, step -16 to 15 |
//! | 254 | a byte, and two of the step | shape -8 to 8, rise -6 to 6 |
//! | 255 | | none: a jump, or a part of the cell is hidden |
//!
//! After the codes of all cells comes what follows of those with 255. A byte tells in its lowest three bits whether the second, third
//! and fourth column differ from the column before. Then follow the step, what the lower row has more, and by how much each such
//! column differs: a byte each but for the step, if bit 4 is set, and the columns, if bit 3 is. If the byte is 128, the four upper pixels and
//! the four lower ones less these follow, two bytes each. Two bytes are little-endian, and numbers are modulo 2^16.

use super::super::writer::{Writer, take};
use super::PAIR;
use crate::Disparity;
use crate::lanes::cell_codes::{DisparityCodes, FIRST_OF_TWO, Listed, MOST_BYTES, Part, WIDE, put_disparities};

/// Numbers of a range, the least first.
#[derive(Clone, Copy)]
struct Range {
    least: i32,
    count: u32,
}

impl Range {
    const fn new(least: i32, most: i32) -> Self {
        Self { least, count: (most - least).cast_unsigned() + 1 }
    }

    /// What a number of the range adds to a code that begins with `first`, if the ranges before have so many numbers together.
    const fn part(self, number: i32, before: u32, first: u32) -> Option<u32> {
        let index = number.wrapping_sub(self.least).cast_unsigned();
        if index < self.count { Some(first + before * index) } else { None }
    }

    /// The number, and what is left of an index of several.
    const fn split(self, index: u32) -> (i32, u32) {
        ((index % self.count).cast_signed() + self.least, index / self.count)
    }
}

/// Of one byte: shape, step, rise.
const ONE: [Range; 3] = [Range::new(-2, 2), Range::new(-4, 4), Range::new(-1, 3)];
const FIRST_OF_ONE: u32 = 1;
const LAST_OF_TWO: u32 = WIDE - 1;
/// Of two: shape, rise, step.
const TWO: [Range; 3] = [Range::new(-8, 8), Range::new(-6, 6), Range::new(-16, 15)];
const _: () = {
    assert!(FIRST_OF_ONE + ONE[0].count * ONE[1].count * ONE[2].count == FIRST_OF_TWO);
    assert!(FIRST_OF_TWO + (TWO[0].count * TWO[1].count * TWO[2].count).div_ceil(1 << 8) == WIDE);
    assert!(TWO[0].count * TWO[1].count <= 1 << 8);
};
/// Of a cell without a code: what has two bytes, ...
const WIDE_COLUMNS: u8 = 1 << 3;
const WIDE_STEP: u8 = 1 << 4;
/// ... and that all does.
const ALL: u8 = 1 << 7;

static CODES: DisparityCodes = codes();

#[expect(clippy::cast_sign_loss, reason = "from the least number on")]
const fn codes() -> DisparityCodes {
    let mut codes = DisparityCodes { shape: [Part::NONE; 32], rise: [Part::NONE; 32], step: [Part::FOLLOWS; 64] };
    let (shapes, rises, steps) = (TWO[0], TWO[1], TWO[2]);
    let mut i = 0;
    while i < shapes.count {
        let shape = shapes.least + i.cast_signed();
        let [_, second, third, _] = columns(shape);
        codes.shape[(third as i32 + 16) as usize] =
            Part::of_shape(ONE[0].part(shape, 1, FIRST_OF_ONE), i, second as i32);
        i += 1;
    }
    let mut i = 0;
    while i < rises.count {
        let rise = rises.least + i.cast_signed();
        let one = ONE[2].part(rise, ONE[0].count * ONE[1].count, 0);
        codes.rise[(2 * rise + 16) as usize] = Part::new(one, shapes.count * i);
        i += 1;
    }
    let mut i = 0;
    while i < steps.count {
        let step = steps.least + i.cast_signed();
        let one = ONE[1].part(step, ONE[0].count, 0);
        codes.step[(step + 32) as usize] = Part::new(one, shapes.count * rises.count * i);
        i += 1;
    }
    codes
}

/// The columns of a cell of a shape, less the first.
#[expect(clippy::cast_possible_truncation, reason = "shapes are few")]
const fn columns(shape: i32) -> [i16; 4] {
    let near = (2 * shape + 3).div_euclid(6);
    [0, (shape - near) as i16, (shape + near) as i16, (2 * shape) as i16]
}

/// Writes those of two rows; `None` if there is no more room, or something in a cell without a code is unknown.
pub(super) fn write(rows: [&[Disparity]; 2], before: i16, listed: &mut Listed, writer: &mut Writer<'_>) -> Option<()> {
    let rows = rows.map(|row| row.as_chunks::<4>().0);
    let count = put_disparities(rows, &CODES, before, writer.room(MOST_BYTES * rows[0].len())?, listed);
    writer.add(count);
    for cell in listed.iter() {
        let before = cell.checked_sub(1).map_or(Some(before), |left| Some(rows[0].get(left)?[3].into_bits()))?;
        write_cell(before, rows[0].get(cell)?, rows[1].get(cell)?, writer)?;
    }
    Some(())
}

/// A cell without a code.
#[inline(never)]
fn write_cell(before: i16, upper: &[Disparity; 4], lower: &[Disparity; 4], writer: &mut Writer<'_>) -> Option<()> {
    let upper = upper.map(Disparity::into_bits);
    let down: [i16; 4] = core::array::from_fn(|i| lower[i].into_bits().wrapping_sub(upper[i]));
    if upper.contains(&Disparity::UNKNOWN.into_bits()) {
        return None;
    }
    if down != [down[0]; 4] || is_wide(down[0]) {
        if lower.contains(&Disparity::UNKNOWN) {
            return None;
        }
        writer.push([ALL])?;
        for number in upper.into_iter().chain(down) {
            write_number(number, true, writer)?;
        }
        return Some(());
    }
    let [a, b, c, d] = upper;
    let (step, steps) = (a.wrapping_sub(before), [b.wrapping_sub(a), c.wrapping_sub(b), d.wrapping_sub(c)]);
    let (mut told, mut wide_columns) = (if is_wide(step) { WIDE_STEP } else { 0 }, false);
    for (bit, step) in (0..).zip(steps) {
        told |= u8::from(step != 0) << bit;
        wide_columns |= is_wide(step);
    }
    writer.push([told | if wide_columns { WIDE_COLUMNS } else { 0 }])?;
    write_number(step, is_wide(step), writer)?;
    write_number(down[0], false, writer)?;
    for step in steps {
        if step != 0 {
            write_number(step, wide_columns, writer)?;
        }
    }
    Some(())
}

/// Whether a number needs two bytes.
#[inline(always)]
fn is_wide(number: i16) -> bool {
    i8::try_from(number).is_err()
}

#[inline(always)]
fn write_number(number: i16, is_wide: bool, writer: &mut Writer<'_>) -> Option<()> {
    let [low, high] = number.to_le_bytes();
    if is_wide { writer.push([low, high]) } else { writer.push([low]) }
}

/// The columns of a cell, and what a row has more than the one above.
#[derive(Clone, Copy)]
struct Cell {
    upper: [i16; 4],
    down: [i16; 4],
}

/// Reads the `nth` row, from 0 at the top; `None` if the bytes are none.
pub(super) fn read(bytes: &mut &[u8], nth: u8, before: &mut i16, disparity: &mut [Disparity]) -> Option<()> {
    // The last pair of cells is filled up.
    let count = 2 * disparity.len().div_ceil(PAIR);
    let mut codes = *bytes;
    for _ in 0..count {
        read_code(bytes)?;
    }
    let mut cells = disparity.chunks_mut(4);
    for _ in 0..count {
        let cell = match read_code(&mut codes)? {
            Some([shape, rise, step]) => cell_of(before.wrapping_add(step), shape.into(), 2 * rise),
            None => read_cell(*before, bytes)?,
        };
        *before = cell.upper[3];
        for ((to, from), down) in cells.next().into_iter().flatten().zip(cell.upper).zip(cell.down) {
            *to = Disparity::from_bits(from.wrapping_add(down.wrapping_mul(nth.into())));
        }
    }
    Some(())
}

fn cell_of(first: i16, shape: i32, rise: i16) -> Cell {
    Cell { upper: columns(shape).map(|column| first.wrapping_add(column)), down: [rise; 4] }
}

/// Shape, rise and step; nothing of a cell without a code.
#[expect(clippy::option_option, reason = "no code, and no bytes")]
fn read_code(bytes: &mut &[u8]) -> Option<Option<[i16; 3]>> {
    let [first] = take(bytes)?.map(u32::from);
    Some(match first {
        0 => return None,
        FIRST_OF_ONE..FIRST_OF_TWO => {
            let [shape, step, rise] = numbers(ONE, first - FIRST_OF_ONE)?;
            Some([shape, rise, step])
        }
        FIRST_OF_TWO..=LAST_OF_TWO => {
            let [low] = take(bytes)?.map(u32::from);
            Some(numbers(TWO, (first - FIRST_OF_TWO) << 8 | low)?)
        }
        WIDE => {
            let ([index], step) = (take(bytes)?.map(u32::from), i16::from_le_bytes(take(bytes)?));
            let [shape, rise, _] = numbers(TWO, index).filter(|_| index < TWO[0].count * TWO[1].count)?;
            Some([shape, rise, step])
        }
        _ => None,
    })
}

/// The three numbers with an index.
fn numbers([a, b, c]: [Range; 3], index: u32) -> Option<[i16; 3]> {
    let (first, rest) = a.split(index);
    let (second, rest) = b.split(rest);
    let (third, rest) = c.split(rest);
    #[expect(clippy::cast_possible_truncation, reason = "small numbers")]
    (rest == 0).then_some([first as i16, second as i16, third as i16])
}

/// What follows of a cell without a code.
fn read_cell(before: i16, bytes: &mut &[u8]) -> Option<Cell> {
    let [told] = take(bytes)?;
    let mut number = |is_wide| {
        if is_wide { take(bytes).map(i16::from_le_bytes) } else { take(bytes).map(|one| i8::from_le_bytes(one).into()) }
    };
    if told == ALL {
        let mut cell = Cell { upper: [0; 4], down: [0; 4] };
        for to in cell.upper.iter_mut().chain(&mut cell.down) {
            *to = number(true)?;
        }
        return Some(cell);
    }
    let mut column = before.wrapping_add(number(told & WIDE_STEP != 0)?);
    let rise = number(false)?;
    let mut upper = [column; 4];
    for (bit, to) in (0..).zip(&mut upper[1..]) {
        if told >> bit & 1 == 1 {
            column = column.wrapping_add(number(told & WIDE_COLUMNS != 0)?);
        }
        *to = column;
    }
    Some(Cell { upper, down: [rise; 4] })
}
