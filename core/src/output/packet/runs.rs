//! Rows of any method: runs of equal pixels, or each pixel as it is: three bytes, the disparity, little-endian, and the confidence.
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

use super::writer::{Writer, take};
use crate::{Disparity, DisparityRow};

const HOLE: u8 = 0;
const WIDE: u8 = 1;
const NARROW: u8 = 2;
/// The token's high bits for no change; 6 less and more stand for as many steps.
const SAME: u8 = 9;
const MOST_STEPS: i16 = 6;
/// The token's low bits where a longer length follows.
const LONG: u16 = 15;

/// Bytes of a plain pixel.
pub(super) const BYTES: usize = 3;

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

/// Writes the pixels of a row, equal neighbours once; how many bytes they are, or `None` if there is not so much room.
pub(super) fn write_runs(row: DisparityRow<'_>, room: &mut [u8]) -> Option<usize> {
    let (mut writer, mut last) = (Writer::new(room), 0);
    runs(row).try_for_each(|run| write_run(run, &mut last, &mut writer))?;
    Some(writer.count())
}

/// Writes them as they are.
pub(super) fn write_plain(row: DisparityRow<'_>, room: &mut [u8]) -> Option<usize> {
    let mut writer = Writer::new(room);
    for (disparity, &confidence) in row.disparity.iter().zip(row.confidence) {
        let [low, high] = disparity.into_bits().to_le_bytes();
        writer.push([low, high, confidence])?;
    }
    Some(writer.count())
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

/// Reads as many pixels as there is room for, as they are; `None` if the bytes are not exactly those.
pub(super) fn read_plain(bytes: &[u8], disparity: &mut [Disparity], confidence: &mut [u8]) -> Option<()> {
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

/// The same of runs.
pub(super) fn read_runs(bytes: &[u8], disparity: &mut [Disparity], confidence: &mut [u8]) -> Option<()> {
    let (mut bytes, mut last, mut x) = (bytes, 0, 0);
    while x < disparity.len() {
        let run = read_run(&mut bytes, &mut last)?;
        let end = x + usize::from(run.length);
        disparity.get_mut(x..end)?.fill(run.disparity);
        confidence.get_mut(x..end)?.fill(run.confidence);
        x = end;
    }
    bytes.is_empty().then_some(())
}

fn read_run(bytes: &mut &[u8], last: &mut i16) -> Option<Run> {
    let [token] = take(bytes)?;
    let mut length = u16::from(token & 15) + 1;
    if length > LONG {
        length = length.checked_add(read_length(bytes)?)?;
    }
    let form = token >> 4;
    if form == HOLE {
        return Some(Run { disparity: Disparity::UNKNOWN, confidence: 0, length });
    }
    let bits = match form {
        WIDE => i16::from_le_bytes(take(bytes)?),
        NARROW => last.wrapping_add(i16::from(i8::from_le_bytes(take(bytes)?))),
        near => last.wrapping_add(i16::from(near) - i16::from(SAME)),
    };
    *last = bits;
    let [confidence] = take(bytes)?;
    Some(Run { disparity: Disparity::from_bits(bits), confidence, length })
}

fn read_length(bytes: &mut &[u8]) -> Option<u16> {
    match take(bytes)? {
        [255] => Some(u16::from_le_bytes(take(bytes)?)),
        [short] => Some(short.into()),
    }
}
