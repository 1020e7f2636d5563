//! The answer of a cell, 4 x 2 px: which of its tile's labels wins, and what lies between them.

use crate::lanes::{lane, normalised_place};

/// Greatest margin that counts.
const MOST_MARGIN: u32 = 64;

/// What a cell answers before it is compared with its neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Cell {
    /// The label.
    pub(crate) label: u8,
    /// Disparity less the least one searched, 1/256 px.
    pub(crate) value: i32,
    /// How far it stands out from labels more than a step away, less twice its cost; 128 is as far as that.
    pub(crate) merit: u8,
}

/// The label of the least sum (the least of `sums` is 0), refined to a fraction.
///
/// The fraction is that of a V through the sums and the costs at the label and one step on either side: sums of absolute
/// differences have a kink at their minimum, not a parabola.
#[inline(always)]
pub(crate) fn winner(sums: u32, labels: u32, costs: u32) -> Cell {
    let place = normalised_place(sums);
    let label = lane(labels, place);
    let mut fraction = 0;
    if place == 1 || place == 2 {
        let (around, shift) = (labels >> (8 * (place - 1)), 8 * (place - 1));
        if around & 0x00ff_ffff == label.wrapping_mul(0x0001_0101).wrapping_add(0x0001_0000).wrapping_sub(1) & 0x00ff_ffff {
            let (sums, costs) = (sums >> shift, costs >> shift);
            let total = |i: u32| (lane(sums, i) + lane(costs, i)).cast_signed();
            let (before, here, after) = (total(0), total(1), total(2));
            let rise = before.max(after) - here;
            if rise > 0 {
                fraction = ((before - after) * 128 / rise).clamp(-127, 127);
            }
        }
    }
    let mut margin = MOST_MARGIN;
    for i in 0..4 {
        // One step to either side is the same surface.
        if lane(labels, i).wrapping_add(1).wrapping_sub(label) > 2 {
            margin = margin.min(lane(sums, i));
        }
    }
    let merit = 128 + margin.cast_signed() - 2 * lane(costs, place).cast_signed();
    Cell {
        label: label as u8,
        value: (label << 8).cast_signed() + fraction,
        merit: merit.clamp(0, 255) as u8,
    }
}
