//! The confidences of cells.
//!
//! A byte for two cells, the left one in its lower four bits:
//!
//! | four bits | a cell's confidence |
//! |---|---|
//! | 0 to 13 | (-7 to 6) x 8 more than that of the column before; before the row it is 0 |
//! | 14 | another one: it follows, a byte |
//! | 15 | not the same in all columns: all four follow |
//!
//! What follows comes after the bytes of all cells, in their order.

use super::super::writer::{Writer, take};
use super::PAIR;
use crate::lanes::cell_codes::{JUMP, MOST_BYTES_OF_PAIR, STEP, STEPS, STEPS_DOWN, put_confidences};

/// Writes those of two rows; `None` if they differ or there is no more room.
pub(super) fn write(rows: [&[[u8; PAIR]]; 2], before: u8, writer: &mut Writer<'_>) -> Option<()> {
    let count = put_confidences(rows, before, writer.room(MOST_BYTES_OF_PAIR * rows[0].len())?)?;
    writer.add(count);
    Some(())
}

/// Reads those of a row; `None` if the bytes are none.
pub(super) fn read(bytes: &mut &[u8], before: &mut u8, confidence: &mut [u8]) -> Option<()> {
    let (codes, mut follows) = bytes.split_at_checked(confidence.len().div_ceil(PAIR))?;
    let codes = codes.iter().flat_map(|codes| [codes & 15, codes >> 4]);
    let mut cells = confidence.chunks_mut(4);
    for code in codes {
        let cell = read_cell(code, *before, &mut follows)?;
        *before = cell[3];
        // The last pair may be filled up by a whole cell.
        let to = cells.next().unwrap_or_default();
        to.copy_from_slice(cell.get(..to.len())?);
    }
    *bytes = follows;
    Some(())
}

fn read_cell(code: u8, before: u8, follows: &mut &[u8]) -> Option<[u8; 4]> {
    match code.into() {
        steps @ 0..STEPS => {
            let sure = (u32::from(before) + STEP * steps).checked_sub(STEP * STEPS_DOWN)?;
            Some([u8::try_from(sure).ok()?; 4])
        }
        JUMP => take(follows).map(|[sure]| [sure; 4]),
        _ => take(follows),
    }
}
