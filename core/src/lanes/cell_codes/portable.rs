//! The same cell by cell.

use super::{
    DisparityCodes, FIRST_OF_TWO, JUMP, Listed, MIXED, MOST, MOST_BYTES, MOST_BYTES_OF_PAIR, ODD, Part, STEP, STEPS,
    STEPS_DOWN, WIDE,
};
use crate::Disparity;
use crate::lanes::demand;

impl Listed {
    fn push(&mut self, cell: usize) {
        if let Some(to) = self.cells.get_mut(self.count) {
            #[expect(clippy::cast_possible_truncation, reason = "at most MOST")]
            let number = cell as u8;
            *to = number;
            self.count += 1;
        }
    }
}

/// Writes the confidences of pairs of cells after a column of `before`: a byte for each pair, then what follows of cells; how many bytes,
/// if both rows have the same. Rows are equally long, and there is room for [`MOST_BYTES_OF_PAIR`] for each.
pub(crate) fn put_confidences([upper, lower]: [&[[u8; 8]]; 2], before: u8, room: &mut [u8]) -> Option<usize> {
    demand(upper.len() == lower.len() && MOST_BYTES_OF_PAIR * upper.len() <= room.len());
    let (codes, follows) = room.split_at_mut(upper.len());
    let (mut before, mut used) = (before, 0);
    for (&cells, to) in upper.iter().zip(codes) {
        *to = 0;
        for (side, &cell) in cells.as_chunks::<4>().0.iter().enumerate() {
            let code = code_of(cell, before);
            *to |= code << (4 * side);
            let more = match code.into() {
                MIXED => &cell[..],
                JUMP => &cell[..1],
                _ => &[],
            };
            write(more, &mut used, follows);
            before = cell[3];
        }
    }
    (upper == lower).then_some(upper.len() + used)
}

fn write(bytes: &[u8], used: &mut usize, room: &mut [u8]) {
    for (to, &byte) in room.iter_mut().skip(*used).zip(bytes) {
        *to = byte;
    }
    *used += bytes.len();
}

/// The four bits of a cell.
#[expect(clippy::cast_possible_truncation, reason = "less than 16")]
fn code_of(cell: [u8; 4], before: u8) -> u8 {
    let [first, ..] = cell;
    let more = u32::from(first).wrapping_sub(before.into()).wrapping_add(STEP * STEPS_DOWN);
    let code = match more / STEP {
        _ if cell != [first; 4] => MIXED,
        steps if steps < STEPS && more % STEP == 0 => steps,
        _ => JUMP,
    };
    code as u8
}

/// Writes the disparities of cells after a pixel of `before`; how many bytes. Rows are equally long, at most [`MOST`], and there is room
/// for [`MOST_BYTES`] for each cell.
pub(crate) fn put_disparities(
    [upper, lower]: [&[[Disparity; 4]]; 2],
    codes: &DisparityCodes,
    before: i16,
    room: &mut [u8],
    listed: &mut Listed,
) -> usize {
    demand(upper.len() == lower.len() && MOST_BYTES * upper.len() <= room.len() && upper.len() <= MOST);
    listed.count = 0;
    let (mut before, mut used) = (i32::from(before), 0);
    let mut push = |bytes: &[u8]| write(bytes, &mut used, room);
    #[expect(clippy::cast_possible_truncation, reason = "bytes are meant")]
    for (nth, (&upper, &lower)) in upper.iter().zip(lower).enumerate() {
        let columns = upper.map(Disparity::into_bits);
        let step = i32::from(columns[0]) - before;
        before = columns[3].into();
        let sum = sum_of(columns, lower.map(Disparity::into_bits), step, codes);
        let (one, two) = (sum & ((1 << Part::SECOND) - 1), sum >> Part::TWO);
        let [low, high, ..] = step.to_le_bytes();
        match two {
            _ if one < Part::NOT_ONE => push(&[one as u8]),
            0..Part::STEP_FOLLOWS => push(&[(FIRST_OF_TWO + (two >> 8)) as u8, two as u8]),
            Part::STEP_FOLLOWS..Part::NO_CODE => push(&[WIDE as u8, two as u8, low, high]),
            _ => {
                push(&[ODD as u8]);
                listed.push(nth);
            }
        }
    }
    used
}

/// The sum of what its numbers add.
fn sum_of(upper: [i16; 4], lower: [i16; 4], step: i32, codes: &DisparityCodes) -> u32 {
    let [a, b, c, d] = upper;
    let down: [i16; 4] = core::array::from_fn(|i| lower[i].wrapping_sub(upper[i]));
    let shape = part(&codes.shape, c.wrapping_sub(a).into());
    let is_odd =
        down != [down[0]; 4] || c.wrapping_sub(a) != d.wrapping_sub(b) || i32::from(b) - i32::from(a) != shape.second();
    if is_odd {
        return Part::NONE.0;
    }
    shape.0 + part(&codes.rise, down[0].into()).0 + part(&codes.step, step).0
}

/// The part of a number, or of the nearest one.
#[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, clippy::cast_sign_loss, reason = "few numbers")]
fn part<const N: usize>(parts: &[Part; N], number: i32) -> Part {
    let most = N as i32 / 2;
    parts[(number.clamp(-most, most - 1) + most) as usize]
}
