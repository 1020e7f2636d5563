//! Two rows of a method that answers in cells of 4 x 2 px, as what was decided of each cell.
//!
//! Of a cell four numbers are told, each by a prefix code of its own ([`Codes`]), in this order:
//!
//! 1. *shape*: what lies between the middle of the cell and its outer columns, 1/16 px. With `far` so much the columns are
//!    0, `far - near`, `far + near`, `2 far` above the first, `near` being a third of `far`, rounded. The escape says that the
//!    columns do not lie so: at a jump, or where a part of the cell is hidden; then three more *values* follow, the steps to
//!    the second, third and fourth column.
//! 2. *value*: the upper left pixel less the pixel before it, 1/16 px; before the row is 0. After the escape 12 bits follow;
//!    if these are 0x800, 16 more.
//! 3. *down*: half of what the lower row has more than the upper one. There are three codes: for cells after one with less
//!    than none, with none and with more. After the escape 16 bits follow for each column, the lower row less the upper one.
//! 4. *confidence*: an eighth of what it is more than that of the column before. There are two codes, for cells after one
//!    with a change and with none. After the escape 4 bits follow. If they are 8, all four confidences do, a byte each; else
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

use super::bits::{BitReader, BitWriter, Code, Codes};
use crate::answer::cell_row::word;
use crate::lanes::{splat_half, sub_halves};
use crate::{Disparity, DisparityRow};

/// Numbers that have a code, either side of 0, and the escape.
const fn codes(most: usize) -> usize {
    2 * most + 2
}

const VALUE: Codes<{ codes(20) }> = Codes::of([
    11, 11, 10, 10, 10, 10, 10, 9, 9, 9, 8, 8, 8, 7, 6, 6, 5, 4, 4, 3, 2, 3, 4, 4, 5, 6, 6, 7, 8, 8, 8, 9, 9, 10, 10,
    10, 10, 10, 10, 10, 10, 4,
]);
const SHAPE: Codes<{ codes(10) }> = Codes::of([10, 10, 9, 8, 7, 6, 5, 4, 4, 3, 2, 3, 3, 4, 5, 6, 7, 8, 9, 10, 10, 4]);
/// After less than none, none, and more.
const DOWN: [Codes<{ codes(6) }>; 3] = [
    Codes::of([11, 9, 6, 5, 3, 1, 2, 5, 5, 7, 8, 10, 12, 12]),
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
    down: [Codes<{ codes(6) }>; 3],
    confidence: [Codes<{ codes(12) }>; 2],
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
        Self { value: VALUE, shape, no_shape: SHAPE.escape(), down: DOWN, confidence: CONFIDENCE }
    }
}

/// The columns of a cell of a shape, less the first.
const fn columns(far: i32) -> [i32; 4] {
    let near = (2 * far + 3).div_euclid(6);
    [0, far - near, far + near, 2 * far]
}

/// Writes two rows, of the same width; how many bytes they are. `None` if there is not so much room, if they differ in
/// confidence, or if something in them is unknown: then they are none of a method that answers in cells.
#[inline(never)]
pub(super) fn write(upper: DisparityRow<'_>, lower: DisparityRow<'_>, room: &mut [u8]) -> Option<usize> {
    let words = room.as_chunks::<4>().0.len();
    let mut writer = BitWriter::new(room);
    let mut before = Before::START;
    let rows = [upper.disparity.as_chunks::<4>(), lower.disparity.as_chunks::<4>()];
    let sure = [upper.confidence.as_chunks::<4>(), lower.confidence.as_chunks::<4>()];
    let cells = rows[0].0.iter().zip(rows[1].0).zip(sure[0].0.iter().zip(sure[1].0));
    for ((&upper, &lower), (&confidence, &same)) in cells {
        if confidence != same {
            return None;
        }
        before.write(upper, lower, confidence, &mut writer)?;
    }
    if let [Some(upper), Some(lower)] = rows.map(|(_, rest)| filled_up(rest)) {
        let [Some(confidence), Some(same)] = sure.map(|(_, rest)| filled_up(rest)) else { return None };
        if confidence != same {
            return None;
        }
        before.write(upper, lower, confidence, &mut writer)?;
    }
    let (unused, last) = writer.finish()?;
    Some(4 * (words - unused) - (4 - last) % 4)
}

/// The last cell of a row, filled up by its last pixel.
fn filled_up<T: Copy>(rest: &[T]) -> Option<[T; 4]> {
    let &last = rest.last()?;
    Some(core::array::from_fn(|i| rest.get(i).copied().unwrap_or(last)))
}

/// What a cell is told by: the pixel before it.
#[derive(Clone, Copy)]
struct Before {
    value: i32,
    confidence: i32,
    /// Which of the codes is next: by the last *down*, and by the last change of confidence.
    down: usize,
    is_steady: bool,
}

impl Before {
    const START: Self = Self { value: 0, confidence: 0, down: 1, is_steady: false };

    #[inline(always)]
    fn write(
        &mut self,
        upper: [Disparity; 4],
        lower: [Disparity; 4],
        confidence: [u8; 4],
        writer: &mut BitWriter<'_>,
    ) -> Option<()> {
        let [upper, lower] = [upper, lower].map(|row| {
            let [a, b, c, d] = row.map(|disparity| disparity.into_bits().cast_unsigned());
            [word([a, b]), word([c, d])]
        });
        let first = i32::from(upper[0] as i16);
        let last = upper[1].cast_signed() >> 16;
        let step = first - self.value;
        self.value = last;
        let shape = TABLES.shape.get(Codes::<{ codes(10) }>::index((last - first) >> 1));
        let base = splat_half(upper[0] & 0xffff);
        let above = [sub_halves(upper[0], base), sub_halves(upper[1], base)];
        match (shape, TABLES.value.get(step)) {
            (Some(shape), Some(value)) if shape.columns == above => writer.put_two(shape.code, value)?,
            (Some(shape), None) if shape.columns == above && first != UNKNOWN => {
                writer.put(shape.code)?;
                write_value(step, writer)?;
            }
            _ => write_columns(upper, step, writer)?,
        }
        let down = [sub_halves(lower[0], upper[0]), sub_halves(lower[1], upper[1])];
        let rise = i32::from(down[0] as i16);
        let down_code = match TABLES.down[self.down].get(rise >> 1) {
            Some(code) if down == [splat_half(rise.cast_unsigned() & 0xffff); 2] && rise & 1 == 0 => code,
            _ => return self.write_uneven(lower, down, confidence, writer),
        };
        self.down = (rise.signum() + 1) as usize;
        let sure = u32::from_le_bytes(confidence);
        let before = self.confidence;
        let change = (sure & 0xff).cast_signed() - self.confidence;
        self.confidence = (sure >> 24).cast_signed();
        let codes = &TABLES.confidence[usize::from(self.is_steady)];
        match codes.get(change >> 3) {
            Some(code) if sure == (sure & 0xff) * 0x0101_0101 && change & (STEP - 1) == 0 => {
                self.is_steady = change == 0;
                writer.put_two(down_code, code)
            }
            _ => {
                self.is_steady = false;
                writer.put_two(down_code, codes.escape())?;
                write_confidences(before, confidence, writer)
            }
        }
    }

    /// A lower row that does not lie beside the upper one: where it comes to the least disparity.
    #[inline(never)]
    fn write_uneven(
        &mut self,
        lower: [u32; 2],
        down: [u32; 2],
        confidence: [u8; 4],
        writer: &mut BitWriter<'_>,
    ) -> Option<()> {
        if has_unknown(lower) {
            return None;
        }
        writer.put(TABLES.down[self.down].escape())?;
        self.down = 1;
        for pair in down {
            writer.put(Code::new(pair & 0xffff, 16))?;
            writer.put(Code::new(pair >> 16, 16))?;
        }
        writer.put(TABLES.confidence[usize::from(self.is_steady)].escape())?;
        let before = self.confidence;
        (self.confidence, self.is_steady) = (i32::from(confidence[3]), false);
        write_confidences(before, confidence, writer)
    }
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

/// Columns that have no shape; `None` if one is unknown.
#[inline(never)]
fn write_columns(upper: [u32; 2], step: i32, writer: &mut BitWriter<'_>) -> Option<()> {
    if has_unknown(upper) {
        return None;
    }
    writer.put(TABLES.no_shape)?;
    write_value(step, writer)?;
    let [a, b, c, d] = columns_of(upper);
    [b - a, c - b, d - c].into_iter().try_for_each(|step| write_value(step, writer))
}

/// Confidences after the escape.
#[inline(never)]
fn write_confidences(before: i32, confidence: [u8; 4], writer: &mut BitWriter<'_>) -> Option<()> {
    let first = confidence[0];
    let other = confidence.into_iter().find(|&other| other != first);
    if confidence.into_iter().any(|one| one != first && Some(one) != other) {
        writer.put(Code::new(ALL, 4))?;
        return confidence.into_iter().try_for_each(|one| writer.put(Code::new(one.into(), 8)));
    }
    writer.put(Code::new((1..4).map(|i| u32::from(confidence[i] != first) << (i - 1)).sum(), 4))?;
    if i32::from(first) == before {
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
    let mut before = Before::START;
    for (disparities, confidences) in disparity.chunks_mut(4).zip(confidence.chunks_mut(4)) {
        let (upper, lower, sure) = before.read(&mut reader)?;
        let row = if is_lower { lower } else { upper };
        for ((to, from), (sure_to, sure)) in disparities.iter_mut().zip(row).zip(confidences.iter_mut().zip(sure)) {
            (*to, *sure_to) = (Disparity::from_bits(from), sure);
        }
    }
    reader.is_done().then_some(())
}

impl Before {
    fn read(&mut self, reader: &mut BitReader<'_>) -> Option<([i16; 4], [i16; 4], [u8; 4])> {
        let shape = reader.number(&SHAPE)?;
        let first = self.value + read_value(reader)?;
        let mut upper = match shape {
            Some(far) => columns(far).map(|column| first + column),
            None => [first; 4],
        };
        if shape.is_none() {
            for i in 1..4 {
                upper[i] = i32::from((upper[i - 1] + read_value(reader)?) as i16);
            }
        }
        let upper = upper.map(|column| column as i16);
        self.value = upper[3].into();
        let lower = match reader.number(&DOWN[self.down])? {
            Some(down) => {
                self.down = (down.signum() + 1) as usize;
                upper.map(|column| column.wrapping_add(2 * down as i16))
            }
            None => {
                self.down = 1;
                let mut lower = upper;
                for column in &mut lower {
                    *column = column.wrapping_add(reader.take(16)? as u16 as i16);
                }
                lower
            }
        };
        let change = reader.number(&CONFIDENCE[usize::from(self.is_steady)])?;
        self.is_steady = change == Some(0);
        let sure = match change {
            Some(change) => [u8::try_from(self.confidence + STEP * change).ok()?; 4],
            None => read_confidences(u8::try_from(self.confidence).ok()?, reader)?,
        };
        self.confidence = sure[3].into();
        Some((upper, lower, sure))
    }
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
