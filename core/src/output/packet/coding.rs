//! How the pixels of a row are written: cells of four, runs of equal ones, or plain.
//!
//! # Cells
//! Four columns at a time, the last ones filled up with the last pixel. Four bits tell how they follow; those of two cells are
//! one byte before the first of them, the lower four for that one.
//!
//! | bits 0, 1 | disparities | bits 2, 3 | confidences |
//! |---|---|---|---|
//! | 0 | the last one four times | 0 | the last one four times |
//! | 1 | four steps of -8 to 7 in two bytes, each plus 8, the lower half first | 1 | one byte for all |
//! | 2 | four signed bytes, steps | 2 | four bytes |
//! | 3 | four times two bytes | | |
//!
//! A step is from the pixel before; before the first pixel disparity and confidence are 0.
//!
//! # Runs
//! A run is a token, whose low four bits hold its length less one, or 15 where one or two bytes with
//! the length less 16 follow; then what the token's high bits ask for:
//!
//! | high bits | disparity | confidence |
//! |---|---|---|
//! | 0 | unknown | 0 |
//! | 1 | two bytes | a byte |
//! | 2 | the last known one and a signed byte | a byte |
//! | 3 to 15 | the last known one and -6 to 6 | a byte |
//!
//! Before the first run of a row the last known disparity is 0. Two bytes are little-endian. A length
//! less 16 is one byte below 255, else 255 and two bytes.

use super::Coding;
use crate::{Disparity, DisparityRow};

const HOLE: u8 = 0;
const WIDE: u8 = 1;
const NARROW: u8 = 2;
/// The token's high bits for no change; 6 less and more stand for as many steps.
const SAME: u8 = 9;
const MOST_STEPS: i16 = 6;
/// The token's low bits where a longer length follows.
const LONG: u16 = 15;

/// Bytes that the pixels of a row need at most.
pub(super) const fn max_bytes(width: u16) -> usize {
    3 * width as usize
}

/// Some neighbours with the same disparity and confidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Run {
    disparity: Disparity,
    confidence: u8,
    /// 1 and more.
    length: u16,
}

/// The runs of a row of at most 65 535 px.
fn runs(row: DisparityRow<'_>) -> impl Iterator<Item = Run> {
    let (mut disparities, mut confidences) = (row.disparity, row.confidence);
    core::iter::from_fn(move || {
        let (&disparity, &confidence) = (disparities.first()?, confidences.first()?);
        let pixels = disparities.iter().zip(confidences);
        let count = pixels.take_while(|&(d, c)| *d == disparity && *c == confidence).count();
        disparities = disparities.get(count..)?;
        confidences = confidences.get(count..)?;
        Some(Run { disparity, confidence, length: u16::try_from(count).ok()? })
    })
}

/// Bytes as they are written.
struct Writer<'a> {
    room: &'a mut [u8],
    used: usize,
}

impl Writer<'_> {
    fn push<const N: usize>(&mut self, bytes: [u8; N]) -> Option<()> {
        *self.room.get_mut(self.used..)?.first_chunk_mut()? = bytes;
        self.used += N;
        Some(())
    }
}

/// Writes the pixels of a row; how many bytes they are, or `None` if there is not so much room.
pub(super) fn write(coding: Coding, row: DisparityRow<'_>, room: &mut [u8]) -> Option<usize> {
    let mut writer = Writer { room, used: 0 };
    match coding {
        Coding::Plain => {
            for (disparity, &confidence) in row.disparity.iter().zip(row.confidence) {
                let [low, high] = disparity.into_bits().to_le_bytes();
                writer.push([low, high, confidence])?;
            }
        }
        Coding::Cells => write_cells(row, &mut writer)?,
        Coding::Runs => {
            let mut last = 0;
            runs(row).try_for_each(|run| write_run(run, &mut last, &mut writer))?;
        }
    }
    Some(writer.used)
}

/// Four pixels from `at` on, the last one again beyond the row.
fn cell<T: Copy>(row: &[T], at: usize) -> Option<[T; 4]> {
    match row.get(at..).and_then(|rest| rest.first_chunk()) {
        Some(&cell) => Some(cell),
        None => {
            let &last = row.last()?;
            Some([0, 1, 2, 3].map(|i| row.get(at + i).copied().unwrap_or(last)))
        }
    }
}

fn write_cells(row: DisparityRow<'_>, writer: &mut Writer<'_>) -> Option<()> {
    let (mut last, mut sure) = (0, 0);
    let mut token_at = 0;
    for (number, at) in (0..row.disparity.len()).step_by(4).enumerate() {
        if number % 2 == 0 {
            token_at = writer.used;
            writer.push([0])?;
        }
        let values = cell(row.disparity, at)?.map(Disparity::into_bits);
        let [a, b, c, d] = values;
        let steps = [a.wrapping_sub(last), b.wrapping_sub(a), c.wrapping_sub(b), d.wrapping_sub(c)];
        last = d;
        let least = steps.into_iter().fold(0, i16::min);
        let most = steps.into_iter().fold(0, i16::max);
        let bytes = steps.map(|step| step.to_le_bytes()[0]);
        let disparity = match (least, most) {
            (0, 0) => 0,
            (-8.., ..=7) => {
                let [a, b, c, d] = bytes.map(|step| step.wrapping_add(8) & 15);
                writer.push([a | b << 4, c | d << 4])?;
                1
            }
            (-128.., ..=127) => {
                writer.push(bytes)?;
                2
            }
            _ => {
                for value in values {
                    writer.push(value.to_le_bytes())?;
                }
                3
            }
        };
        let confidences = cell(row.confidence, at)?;
        let confidence = if confidences == [sure; 4] {
            0
        } else if confidences == [confidences[0]; 4] {
            writer.push([confidences[0]])?;
            1
        } else {
            writer.push(confidences)?;
            2
        };
        sure = confidences[3];
        *writer.room.get_mut(token_at)? |= (disparity | confidence << 2) << (4 * (number % 2));
    }
    Some(())
}

fn read_cells(bytes: &[u8], disparity: &mut [Disparity], confidence: &mut [u8]) -> Option<()> {
    let mut bytes = bytes.iter().copied();
    let (mut last, mut sure) = (0i16, 0);
    let mut token = 0;
    for (number, (disparities, confidences)) in disparity.chunks_mut(4).zip(confidence.chunks_mut(4)).enumerate() {
        token = if number % 2 == 0 { bytes.next()? } else { token >> 4 };
        let mut next = || bytes.next();
        let values = match token & 3 {
            0 => [last; 4],
            form => {
                let mut steps = [0i16; 4];
                match form {
                    1 => {
                        let [a, b] = [next()?, next()?];
                        steps = [a & 15, a >> 4, b & 15, b >> 4].map(|step| i16::from(step) - 8);
                    }
                    2 => {
                        for step in &mut steps {
                            *step = i16::from(next()?.cast_signed());
                        }
                    }
                    _ => {
                        let mut before = last;
                        for step in &mut steps {
                            let value = i16::from_le_bytes([next()?, next()?]);
                            (*step, before) = (value.wrapping_sub(before), value);
                        }
                    }
                }
                steps.map(|step| {
                    last = last.wrapping_add(step);
                    last
                })
            }
        };
        let sures = match token >> 2 & 3 {
            0 => [sure; 4],
            1 => [next()?; 4],
            2 => [next()?, next()?, next()?, next()?],
            _ => return None,
        };
        sure = sures[3];
        for ((to, from), (sure_to, sure)) in disparities.iter_mut().zip(values).zip(confidences.iter_mut().zip(sures)) {
            (*to, *sure_to) = (Disparity::from_bits(from), sure);
        }
    }
    bytes.next().is_none().then_some(())
}

fn write_run(run: Run, last: &mut i16, writer: &mut Writer<'_>) -> Option<()> {
    let Run { disparity, confidence, length } = run;
    let bits = disparity.into_bits();
    let change = bits.wrapping_sub(*last);
    let form = match (disparity.is_known(), confidence) {
        (true, _) => form_of(change),
        (false, 0) => HOLE,
        (false, _) => WIDE,
    };
    let [short, _] = (length - 1).min(LONG).to_le_bytes();
    writer.push([form << 4 | short])?;
    if length > LONG {
        write_length(length - 1 - LONG, writer)?;
    }
    if form == HOLE {
        return Some(());
    }
    *last = bits;
    let [low, high] = bits.to_le_bytes();
    let [step, _] = change.to_le_bytes();
    match form {
        WIDE => writer.push([low, high, confidence]),
        NARROW => writer.push([step, confidence]),
        _ => writer.push([confidence]),
    }
}

fn write_length(more: u16, writer: &mut Writer<'_>) -> Option<()> {
    match more.to_le_bytes() {
        [low, 0] if low < 255 => writer.push([low]),
        [low, high] => writer.push([255, low, high]),
    }
}

fn form_of(change: i16) -> u8 {
    if change.unsigned_abs() <= MOST_STEPS.unsigned_abs() {
        let [change, _] = change.to_le_bytes();
        SAME.wrapping_add(change)
    } else if i8::try_from(change).is_ok() {
        NARROW
    } else {
        WIDE
    }
}

/// Reads as many pixels as there is room for; `None` if the bytes are not exactly those.
pub(super) fn read(coding: Coding, bytes: &[u8], disparity: &mut [Disparity], confidence: &mut [u8]) -> Option<()> {
    match coding {
        Coding::Plain => {
            let (pixels, rest) = bytes.as_chunks::<3>();
            if pixels.len() != disparity.len() || !rest.is_empty() {
                return None;
            }
            for ((&[low, high, sure], disparity), confidence) in pixels.iter().zip(disparity).zip(confidence) {
                *disparity = Disparity::from_bits(i16::from_le_bytes([low, high]));
                *confidence = sure;
            }
            Some(())
        }
        Coding::Cells => read_cells(bytes, disparity, confidence),
        Coding::Runs => read_runs(bytes, disparity, confidence),
    }
}

fn read_runs(bytes: &[u8], disparity: &mut [Disparity], confidence: &mut [u8]) -> Option<()> {
    let mut bytes = bytes.iter().copied();
    let (mut last, mut x) = (0, 0);
    while x < disparity.len() {
        let run = read_run(&mut bytes, &mut last)?;
        let end = x + usize::from(run.length);
        disparity.get_mut(x..end)?.fill(run.disparity);
        confidence.get_mut(x..end)?.fill(run.confidence);
        x = end;
    }
    bytes.next().is_none().then_some(())
}

fn read_run(bytes: &mut impl Iterator<Item = u8>, last: &mut i16) -> Option<Run> {
    let token = bytes.next()?;
    let mut length = u16::from(token & 15) + 1;
    if length > LONG {
        length = length.checked_add(read_length(bytes)?)?;
    }
    let form = token >> 4;
    if form == HOLE {
        return Some(Run { disparity: Disparity::UNKNOWN, confidence: 0, length });
    }
    let bits = match form {
        WIDE => i16::from_le_bytes([bytes.next()?, bytes.next()?]),
        NARROW => last.wrapping_add(i16::from(i8::from_le_bytes([bytes.next()?]))),
        near => last.wrapping_add(i16::from(near) - i16::from(SAME)),
    };
    *last = bits;
    Some(Run { disparity: Disparity::from_bits(bits), confidence: bytes.next()?, length })
}

fn read_length(bytes: &mut impl Iterator<Item = u8>) -> Option<u16> {
    match bytes.next()? {
        255 => Some(u16::from_le_bytes([bytes.next()?, bytes.next()?])),
        short => Some(short.into()),
    }
}
