//! The answer of a cell, 4 columns of a tile and two of its rows or all: which of its labels wins, and what lies between them.
#![cfg_attr(haarline_sse2, allow(dead_code, reason = "what goes word by word is held against the quads in tests"))]
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "clamped before"
)]

#[cfg(haarline_sse2)]
pub(crate) mod quad;

use crate::lanes::{add, difference, least, limited_to_byte, quotient, select_ge, splat, zero_lane_bits};

/// Greatest margin that counts.
pub(crate) const MOST_MARGIN: u32 = 64;
/// What is added to [`Cell::value`], so that it is never negative.
pub(crate) const HALF: u32 = 128;

/// What a cell answers before it is compared with its neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Cell {
    /// The label.
    pub(crate) label: u8,
    /// Disparity less the least one searched, 1/256 px, and [`HALF`] more.
    pub(crate) value: u16,
    /// 128, and how far it stands out from labels more than a step away, less twice its cost.
    pub(crate) merit: u8,
}

/// The label of the least sum; the least of `sums` is 0.
#[cfg(not(haarline_dsp))]
#[inline(always)]
pub(crate) fn label(sums: u32, labels: u32) -> u8 {
    byte(labels >> zero_lane_bits(sums))
}

/// The label of the least sum, refined to a fraction; the least of `sums` is 0.
///
/// The fraction is that of a V through the sums and the costs at the label and one step on either side: sums of absolute
/// differences have a kink at their minimum, not a parabola.
///
/// - `beside`: less than 255 in the lanes whose neighbours are the labels one less and one more.
#[inline(always)]
pub(crate) fn winner(sums: u32, labels: u32, costs: u32, beside: u32) -> Cell {
    let bits = zero_lane_bits(sums);
    let label = u32::from(byte(labels >> bits));
    // One step to either side is the same surface. The label itself limits the margin.
    let margin;
    let mut fraction = 0;
    if byte(beside >> bits) == u8::MAX {
        let distance = difference(labels, splat(label));
        margin = u32::from(byte(least(select_ge(distance, splat(2), sums, splat(MOST_MARGIN)))));
    } else {
        // Neither the first lane nor the last: turned, these are the lanes before, here and after; what is left is further away.
        let turn = bits.wrapping_sub(8);
        margin = (sums.rotate_right(turn) >> 24).min(MOST_MARGIN);
        let [before, here, after, _] = add(sums, costs).rotate_right(turn).to_le_bytes().map(i32::from);
        let rise = before.max(after) - here;
        if rise > 0 {
            fraction = quotient((before - after) * 128, rise).clamp(-128, 127);
        }
    }
    let cost = i32::from(byte(costs >> bits));
    let merit = limited_to_byte(128 + margin.cast_signed() - 2 * cost);
    Cell { label: byte(label), value: ((label << 8) + HALF).wrapping_add_signed(fraction) as u16, merit: merit as u8 }
}

/// The lowest lane.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the lowest lane is meant")]
const fn byte(word: u32) -> u8 {
    word as u8
}
