//! Two rows of a method that answers in cells of 4 x 2 px, as what was decided of each cell.
//!
//! First come the confidences of all cells, then of each cell three numbers, all by prefix codes ([`Codes`]):
//!
//! 1. *shape*: what lies between the middle of the cell and its outer columns, 1/16 px. With `far` so much the columns are
//!    0, `far - near`, `far + near`, `2 far` above the first, `near` being a third of `far`, rounded. The escape says that the
//!    columns do not lie so: at a jump, or where a part of the cell is hidden; then three more *values* follow, the steps to
//!    the second, third and fourth column.
//! 2. *value*: the upper left pixel less the pixel before it, 1/16 px; before the row is 0. After the escape 12 bits follow;
//!    if these are 0x800, 16 more.
//! 3. *down*: half of what the lower row has more than the upper one. There are three codes: for cells after one with less
//!    than none, with none and with more. After the escape 16 bits follow for each column, the lower row less the upper one.
//!
//! A *confidence* is told as an eighth of what it is more than that of the column before. There are two codes, for cells
//! after one with a change and with none. After the escape 4 bits follow. If they are 8, all four confidences do, a byte each; else
//!    the lower three are set for the second, third and fourth column if they have not the first one's. A bit is set if the
//!    first one's is another than the column's before, which follows then; if a column has another than the first, a bit is
//!    set if it is no [`GUESS`], and then it follows.
//!
//! Both rows have the same confidences. A row alone is its own lower row. The last cell is filled up by the last pixel.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "disparities have 16 bits, and what is cut out of a word is meant"
)]

use super::bits::{BitReader, BitWriter, Code, Codes, Pending, Words};
use crate::answer::cell_row::word;
use crate::lanes::{splat, splat_half, sub_halves};
use crate::{Disparity, DisparityRow};

/// Numbers that have a code, either side of 0, and the escape.
const fn codes(most: usize) -> usize {
    2 * most + 2
}

const VALUE: Codes<{ codes(20) }> = Codes::of([
    10, 10, 10, 10, 10, 10, 10, 10, 9, 9, 8, 8, 8, 7, 6, 6, 5, 4, 4, 3, 2, 3, 4, 4, 5, 6, 6, 7, 8, 8, 8, 9, 9, 10, 10,
    10, 10, 10, 10, 10, 10, 4,
]);
const SHAPE: Codes<{ codes(10) }> = Codes::of([10, 10, 9, 8, 7, 6, 5, 4, 4, 3, 2, 3, 3, 4, 5, 6, 7, 8, 9, 10, 10, 4]);
/// After less than none, none, and more.
const DOWN: [Codes<{ codes(6) }>; 3] = [
    Codes::of([11, 9, 6, 5, 3, 1, 2, 5, 5, 7, 8, 11, 11, 11]),
    Codes::of([10, 10, 7, 6, 5, 3, 1, 2, 5, 6, 6, 8, 10, 10]),
    Codes::of([11, 10, 8, 7, 5, 5, 2, 2, 2, 3, 5, 6, 9, 11]),
];
/// After a change, and after none.
const CONFIDENCE: [Codes<{ codes(12) }>; 2] = [
    Codes::of([11, 11, 10, 8, 7, 6, 6, 6, 6, 6, 5, 4, 1, 3, 4, 5, 6, 6, 6, 7, 8, 8, 10, 11, 11, 5]),
    Codes::of([10, 10, 10, 9, 8, 8, 7, 6, 6, 6, 5, 3, 1, 3, 5, 6, 6, 7, 6, 6, 7, 8, 8, 9, 10, 5]),
];
/// What hidden pixels mostly have.
const GUESS: u8 = 8;
/// A confidence that is the one before, in either code.
const NO_CHANGE: Code = Code::new(0, 1);
const _: () = assert!(CONFIDENCE[0].at(12).is(NO_CHANGE) && CONFIDENCE[1].at(12).is(NO_CHANGE));
/// Says that all confidences of a cell follow.
const ALL: u32 = 8;
/// A pixel that is not known.
const UNKNOWN: i32 = Disparity::UNKNOWN.into_bits() as i32;
/// Steps of confidence that have a code.
const STEP: i32 = 8;
/// Says that a value needs 16 bits.
const WIDE: i32 = -0x800;

static TABLES: Tables = Tables::new();

/// What a row is written with.
struct Tables {
    value: Codes<{ codes(20) }>,
    shape: [Shape; codes(10) - 1],
    no_shape: Code,
    down: [Downs; 3],
    confidence: [Codes<{ codes(12) }>; 2],
}

/// Codes of *down*, and the escape.
struct Downs([Code; codes(6) - 1], Code);

impl Downs {
    const fn of(codes: &Codes<{ self::codes(6) }>) -> Self {
        let mut all = [codes.escape(); self::codes(6) - 1];
        let mut i = 0;
        while i < all.len() {
            all[i] = codes.at(i);
            i += 1;
        }
        Self(all, codes.escape())
    }
}

/// The four columns of a cell above the first, two in a word, and the code that says so.
#[derive(Clone, Copy)]
struct Shape {
    columns: [u32; 2],
    code: Code,
}

impl Tables {
    const fn new() -> Self {
        let mut shape = [Shape { columns: [0; 2], code: SHAPE.escape() }; codes(10) - 1];
        let mut i = 0;
        while i < shape.len() {
            let [_, b, c, d] = columns(i as i32 - 10);
            shape[i] = Shape { columns: [word([0, b as u16]), word([c as u16, d as u16])], code: SHAPE.at(i) };
            i += 1;
        }
        Self {
            value: VALUE,
            shape,
            no_shape: SHAPE.escape(),
            down: [Downs::of(&DOWN[0]), Downs::of(&DOWN[1]), Downs::of(&DOWN[2])],
            confidence: CONFIDENCE,
        }
    }
}

/// The columns of a cell of a shape, less the first.
const fn columns(far: i32) -> [i32; 4] {
    let near = (2 * far + 3).div_euclid(6);
    [0, far - near, far + near, 2 * far]
}

/// Writes two rows, of the same width; how many bytes they are. `None` if there is not so much room, if they differ in
/// confidence, or if something in them is unknown: then they are none of a method that answers in cells.
pub(super) fn write(upper: DisparityRow<'_>, lower: DisparityRow<'_>, room: &mut [u8]) -> Option<usize> {
    let words = room.as_chunks::<4>().0.len();
    let writer = write_sure(upper.confidence, lower.confidence, BitWriter::new(room))?;
    let (unused, last) = write_disparities(upper.disparity, lower.disparity, writer)?.finish()?;
    Some(4 * (words - unused) - (4 - last) % 4)
}

// In the loops the bits stay in registers: a writer is made of them only where it is handed on.

/// The confidences of both rows, if they are the same.
#[inline(never)]
fn write_sure<'a>(upper: &[u8], lower: &[u8], writer: BitWriter<'a>) -> Option<BitWriter<'a>> {
    let BitWriter { mut words, mut pending } = writer;
    let (mut before, mut codes) = (0_u32, &TABLES.confidence[0]);
    let [(upper, upper_rest), (lower, lower_rest)] = [upper, lower].map(|row| row.as_chunks::<4>());
    for (&upper, &lower) in upper.iter().zip(lower) {
        if u32::from_le_bytes(upper) != u32::from_le_bytes(lower) {
            return None;
        }
        let word = u32::from_le_bytes(upper);
        // Mostly all columns are equal, and the change to the cell before has a code.
        let change = (word & 0xff).cast_signed() - (before & 0xff).cast_signed();
        if word == splat(word & 0xff)
            && let Some(code) = codes.get(change >> 3)
            && change & (STEP - 1) == 0
        {
            pending.put(&mut words, code)?;
        } else {
            BitWriter { words, pending } = write_confidences(upper, before, codes, words, pending)?;
        }
        (before, codes) = (splat(word >> 24), &TABLES.confidence[usize::from(change == 0 && word == before)]);
    }
    let mut writer = BitWriter { words, pending };
    if let Some((upper, lower)) = filled_up(upper_rest).zip(filled_up(lower_rest)) {
        if upper != lower {
            return None;
        }
        writer = write_confidences(upper, before, codes, writer.words, writer.pending)?;
    }
    Some(writer)
}

/// The disparities of both rows.
#[inline(never)]
fn write_disparities<'a>(upper: &[Disparity], lower: &[Disparity], writer: BitWriter<'a>) -> Option<BitWriter<'a>> {
    let BitWriter { mut words, mut pending } = writer;
    let (mut before, mut downs) = (0, &TABLES.down[1]);
    let [(upper, upper_rest), (lower, lower_rest)] = [upper, lower].map(|row| row.as_chunks::<4>());
    for (upper, lower) in upper.iter().zip(lower) {
        let cell = Cell::of(words_of(*upper), words_of(*lower));
        if let Some([shape, value, down]) = cell.codes(before, downs) {
            pending.put_three(&mut words, shape, value, down)?;
        } else {
            BitWriter { words, pending } = write_odd(cell, before, downs, words, pending)?;
        }
        (before, downs) = (cell.last(), cell.next_downs());
    }
    if let Some((upper, lower)) = filled_up(upper_rest).zip(filled_up(lower_rest)) {
        return write_odd(Cell::of(words_of(upper), words_of(lower)), before, downs, words, pending);
    }
    Some(BitWriter { words, pending })
}

/// The columns of a cell, two in a word.
#[inline(always)]
fn words_of(row: [Disparity; 4]) -> [u32; 2] {
    let [a, b, c, d] = row.map(|disparity| disparity.into_bits().cast_unsigned());
    [word([a, b]), word([c, d])]
}

/// The two rows of a cell, and what the lower one has more.
#[derive(Clone, Copy)]
struct Cell {
    upper: [u32; 2],
    lower: [u32; 2],
    down: [u32; 2],
}

impl Cell {
    #[inline(always)]
    fn of(upper: [u32; 2], lower: [u32; 2]) -> Self {
        Self { upper, lower, down: [sub_halves(lower[0], upper[0]), sub_halves(lower[1], upper[1])] }
    }

    #[inline(always)]
    fn first(&self) -> i32 {
        i32::from(self.upper[0] as u16 as i16)
    }

    #[inline(always)]
    fn last(&self) -> i32 {
        self.upper[1].cast_signed() >> 16
    }

    /// Its shape, if that has a code.
    #[inline(always)]
    fn shape(&self) -> Option<Code> {
        let base = splat_half(self.upper[0] & 0xffff);
        let shape = TABLES.shape.get(half(self.last() - self.first(), 10))?;
        (shape.columns == [sub_halves(self.upper[0], base), sub_halves(self.upper[1], base)]).then_some(shape.code)
    }

    /// What all columns of the lower row have more, if it is the same.
    #[inline(always)]
    fn rise(&self) -> Option<i32> {
        let [a, b] = self.down;
        (a == b && a == a.rotate_left(16)).then_some(i32::from(a as u16 as i16))
    }

    /// Codes of its shape, its value after the column `before`, and its *down*, if all have one.
    #[inline(always)]
    fn codes(&self, before: i32, downs: &Downs) -> Option<[Code; 3]> {
        let down = *downs.0.get(half(self.rise()?, 6))?;
        Some([self.shape()?, TABLES.value.get(self.first() - before)?, down])
    }

    /// The codes for the next cell's *down*: after less than none, none, or more.
    #[inline(always)]
    fn next_downs(&self) -> &'static Downs {
        &TABLES.down[self.rise().map_or(1, down_index)]
    }
}

/// The index of half of a number from `-2 * most` to `2 * most`; odd numbers come out beyond all that have a code.
#[inline(always)]
const fn half(number: i32, most: u32) -> usize {
    number.cast_unsigned().wrapping_add(2 * most).rotate_right(1) as usize
}

/// Which of the codes comes after a *down*: that after less than none, none, or more.
#[inline(always)]
const fn down_index(rise: i32) -> usize {
    (rise.signum() + 1) as usize
}

/// A cell of which not everything has a code.
#[inline(never)]
fn write_odd<'a>(cell: Cell, before: i32, downs: &Downs, words: Words<'a>, pending: Pending) -> Option<BitWriter<'a>> {
    let mut writer = BitWriter { words, pending };
    if has_unknown(cell.upper) || has_unknown(cell.lower) {
        return None;
    }
    let step = cell.first() - before;
    if let Some(shape) = cell.shape() {
        writer.put(shape)?;
        write_value(step, &mut writer)?;
    } else {
        writer.put(TABLES.no_shape)?;
        write_value(step, &mut writer)?;
        let [a, b, c, d] = columns_of(cell.upper);
        [b - a, c - b, d - c].into_iter().try_for_each(|step| write_value(step, &mut writer))?;
    }
    if let Some(&code) = cell.rise().and_then(|rise| downs.0.get(half(rise, 6))) {
        writer.put(code)?;
    } else {
        writer.put(downs.1)?;
        for pair in cell.down {
            writer.put(Code::new(pair & 0xffff, 16))?;
            writer.put(Code::new(pair >> 16, 16))?;
        }
    }
    Some(writer)
}

/// The last cell of a row, filled up by its last pixel.
fn filled_up<T: Copy>(rest: &[T]) -> Option<[T; 4]> {
    let &last = rest.last()?;
    Some(core::array::from_fn(|i| rest.get(i).copied().unwrap_or(last)))
}

/// The columns of a cell.
fn columns_of([left, right]: [u32; 2]) -> [i32; 4] {
    [left, left >> 16, right, right >> 16].map(|column| i32::from(column as u16 as i16))
}

fn has_unknown(row: [u32; 2]) -> bool {
    columns_of(row).contains(&UNKNOWN)
}

/// A value, code or escape.
#[inline(never)]
fn write_value(step: i32, writer: &mut BitWriter<'_>) -> Option<()> {
    if let Some(code) = TABLES.value.get(step) {
        return writer.put(code);
    }
    writer.put(TABLES.value.escape())?;
    if (WIDE + 1..-WIDE).contains(&step) {
        return writer.put(Code::new(step.cast_unsigned() & 0xfff, 12));
    }
    writer.put(Code::new(WIDE.cast_unsigned() & 0xfff, 12))?;
    writer.put(Code::new(step.cast_unsigned() & 0xffff, 16))
}

/// Confidences of a cell after those of the column before, four times in a word.
#[inline(never)]
fn write_confidences<'a>(
    confidence: [u8; 4],
    before: u32,
    codes: &Codes<{ self::codes(12) }>,
    words: Words<'a>,
    pending: Pending,
) -> Option<BitWriter<'a>> {
    let mut writer = BitWriter { words, pending };
    let (word, first) = (u32::from_le_bytes(confidence), confidence[0]);
    let change = i32::from(first) - (before & 0xff).cast_signed();
    match codes.get(change >> 3) {
        Some(code) if word == splat(first.into()) && change & (STEP - 1) == 0 => writer.put(code)?,
        _ => {
            writer.put(codes.escape())?;
            write_each(before & 0xff, confidence, &mut writer)?;
        }
    }
    Some(writer)
}

/// Confidences after the escape.
fn write_each(before: u32, confidence: [u8; 4], writer: &mut BitWriter<'_>) -> Option<()> {
    let first = confidence[0];
    let other = confidence.into_iter().find(|&other| other != first);
    if confidence.into_iter().any(|one| one != first && Some(one) != other) {
        writer.put(Code::new(ALL, 4))?;
        return confidence.into_iter().try_for_each(|one| writer.put(Code::new(one.into(), 8)));
    }
    writer.put(Code::new((1..4).map(|i| u32::from(confidence[i] != first) << (i - 1)).sum(), 4))?;
    if u32::from(first) == before {
        writer.put(Code::new(0, 1))?;
    } else {
        writer.put(Code::new(1 | u32::from(first) << 1, 9))?;
    }
    match other {
        Some(GUESS) => writer.put(Code::new(0, 1)),
        Some(other) => writer.put(Code::new(1 | u32::from(other) << 1, 9)),
        None => Some(()),
    }
}

/// Reads the upper row, or the lower one; `None` if the bytes are not exactly two rows of this width.
pub(super) fn read(bytes: &[u8], is_lower: bool, disparity: &mut [Disparity], confidence: &mut [u8]) -> Option<()> {
    let mut reader = BitReader::new(bytes);
    let (mut before, mut is_steady) = (0, false);
    for cell in confidence.chunks_mut(4) {
        let change = reader.number(&CONFIDENCE[usize::from(is_steady)])?;
        is_steady = change == Some(0);
        let sure = match change {
            Some(change) => [u8::try_from(i32::from(before) + STEP * change).ok()?; 4],
            None => read_confidences(before, &mut reader)?,
        };
        before = sure[3];
        cell.copy_from_slice(&sure[..cell.len()]);
    }
    let (mut before, mut downs) = (0, 1);
    for cell in disparity.chunks_mut(4) {
        let shape = reader.number(&SHAPE)?;
        let mut column = before + read_value(&mut reader)?;
        let mut upper = shape.map_or([column; 4], |far| columns(far).map(|above| column + above));
        if shape.is_none() {
            for later in &mut upper[1..] {
                column = i32::from((column + read_value(&mut reader)?) as i16);
                *later = column;
            }
        }
        let upper = upper.map(|column| column as i16);
        before = upper[3].into();
        let mut down = [0; 4];
        if let Some(half) = reader.number(&DOWN[downs])? {
            downs = (half.signum() + 1) as usize;
            down = [2 * half as i16; 4];
        } else {
            for down in &mut down {
                *down = reader.take(16)? as u16 as i16;
            }
            let is_even = down == [down[0]; 4];
            downs = if is_even { down_index(down[0].into()) } else { 1 };
        }
        for ((to, from), down) in cell.iter_mut().zip(upper).zip(down) {
            *to = Disparity::from_bits(if is_lower { from.wrapping_add(down) } else { from });
        }
    }
    reader.is_done().then_some(())
}

fn read_value(reader: &mut BitReader<'_>) -> Option<i32> {
    if let Some(step) = reader.number(&VALUE)? {
        return Some(step);
    }
    let step = (reader.take(12)? << 20).cast_signed() >> 20;
    // Between any two disparities there is a step of 16 bits, that wraps around.
    if step == WIDE { Some((reader.take(16)? as u16 as i16).into()) } else { Some(step) }
}

fn read_confidences(before: u8, reader: &mut BitReader<'_>) -> Option<[u8; 4]> {
    let others = reader.take(4)?;
    if others == ALL {
        let mut sure = [0; 4];
        for one in &mut sure {
            *one = reader.take(8)? as u8;
        }
        return Some(sure);
    }
    let mut unless = |usual: u8| Some(if reader.take(1)? == 0 { usual } else { reader.take(8)? as u8 });
    let first = unless(before)?;
    let other = if others == 0 { first } else { unless(GUESS)? };
    Some(core::array::from_fn(|i| if others << 1 >> i & 1 == 1 { other } else { first }))
}
