//! The cells of a row: what they answer, and the smoothing along the row.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "values have 16 bits"
)]

use crate::answer::neighbourhood::fill_up;
use crate::lanes::{
    difference_of_halves, halved_difference_halves, halved_sum_halves, held, select_ge_halves, splat_half, sub_halves,
};

/// Surfaces that differ by less than this are one, 1/256 px.
const SAME_SURFACE: i32 = 384;

/// The cells of a row.
#[derive(Debug, Clone)]
pub struct CellRow<const WORDS: usize> {
    /// As [`Cell::value`]; smoothed along the row once it is final.
    pub(crate) value: [u16; WORDS],
    /// Half of what `value` rises from the cell before to the cell after.
    pub(crate) slope: [i16; WORDS],
    /// As [`Cell::label`].
    pub(crate) label: [u8; WORDS],
    /// As [`Cell::merit`].
    pub(crate) merit: [u8; WORDS],
}

/// The cells of a row of tiles, two a tile.
pub(crate) struct TileCells<'a> {
    pub(crate) value: &'a mut [[u16; 2]],
    pub(crate) label: &'a mut [[u8; 2]],
    pub(crate) merit: &'a mut [[u8; 2]],
}

impl<const WORDS: usize> CellRow<WORDS> {
    pub(crate) const EMPTY: Self = Self { value: [0; WORDS], slope: [0; WORDS], label: [0; WORDS], merit: [0; WORDS] };

    /// The cells of so many tiles.
    pub(crate) fn tiles(&mut self, tiles: usize) -> TileCells<'_> {
        TileCells {
            value: &mut self.value.as_chunks_mut().0[..tiles],
            label: &mut self.label.as_chunks_mut().0[..tiles],
            merit: &mut self.merit.as_chunks_mut().0[..tiles],
        }
    }

    /// Smooths the values along the row twice, each with those neighbours that are the same surface; two cells a word.
    #[inline(never)]
    pub(crate) fn smooth(&mut self, cells: usize) {
        fill_up(&mut self.label, cells);
        fill_up(&mut self.merit, cells);
        let pairs = cells.div_ceil(2);
        let values = &mut self.value.as_chunks_mut::<2>().0[..pairs];
        let slopes = &mut self.slope.as_chunks_mut::<2>().0[..pairs];
        // Beyond the ends is another surface.
        if let Some(last) = values.last_mut()
            && !cells.is_multiple_of(2)
        {
            last[1] = last[0] ^ FAR;
        }
        let far = u32::from(FAR);
        let same = held(SAME_SURFACES);
        let beside = |before: u32, here: u32, next: u32| [before >> 16 | here << 16, here >> 16 | next << 16];
        let once = |before: u32, here: u32, next: u32| {
            let [before, after] = beside(before, here, next);
            blend_pair(same, here, before, after).0
        };
        let twice = |before: u32, here: u32, next: u32| {
            let [before, after] = beside(before, here, next);
            let (smooth, slope) = blend_pair_widely(same, here, before, after);
            (halves(smooth), halves(slope).map(u16::cast_signed))
        };
        // Two pairs side by side as they are, and two that were smoothed once, a pair before these.
        let mut values_ahead = values.iter().map(|&pair| word(pair));
        let first = values_ahead.next().unwrap_or_default();
        let second = values_ahead.next().unwrap_or(first >> 16 ^ far);
        let (mut before, mut here) = (first, second);
        let mut smooth_here = once((first ^ far) << 16, first, second);
        let mut smooth_before = (smooth_here ^ far) << 16;
        for i in 2..pairs {
            let next = word(values[i]);
            let smooth_next = once(before, here, next);
            (values[i - 2], slopes[i - 2]) = twice(smooth_before, smooth_here, smooth_next);
            (before, here) = (here, next);
            (smooth_before, smooth_here) = (smooth_here, smooth_next);
        }
        let smooth_next = once(before, here, here >> 16 ^ far);
        let smooth_beyond = smooth_next >> 16 ^ far;
        if let ([.., value, last_value], [.., slope, last_slope]) = (values, slopes) {
            (*value, *slope) = twice(smooth_before, smooth_here, smooth_next);
            (*last_value, *last_slope) = twice(smooth_here, smooth_next, smooth_beyond);
        }
    }
}

/// Makes of a value one of another surface.
const FAR: u16 = 0x8000;

/// Two cells in a word.
#[inline(always)]
pub(crate) const fn word([a, b]: [u16; 2]) -> u32 {
    a as u32 | (b as u32) << 16
}

/// The two cells of a word.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the halves are meant")]
pub(crate) const fn halves(word: u32) -> [u16; 2] {
    [word as u16, (word >> 16) as u16]
}

/// Most that surfaces differ by that are one, in both halves.
pub(crate) const SAME_SURFACES: u32 = splat_half(SAME_SURFACE.cast_unsigned() - 1);

/// [`blend`] of two cells a word: values and slopes. `same` is [`SAME_SURFACES`].
#[inline(always)]
pub(crate) fn blend_pair(same: u32, here: u32, before: u32, after: u32) -> (u32, u32) {
    let (from_before, from_after) = (difference_of_halves(before, here), difference_of_halves(after, here));
    // A neighbour on another surface is like the cell itself.
    let before = select_ge_halves(same, from_before, before, here);
    let after = select_ge_halves(same, from_after, after, here);
    let furthest = select_ge_halves(from_before, from_after, from_before, from_after);
    let mean = halved_sum_halves(halved_sum_halves(before, after), here);
    let value = select_ge_halves(same, furthest, mean, here);
    let slope = select_ge_halves(same, furthest, halved_difference_halves(after, before), sub_halves(after, before));
    (value, slope)
}

/// The same with more of the neighbours, three eighths each where both are on the surface.
#[inline(always)]
fn blend_pair_widely(same: u32, here: u32, before: u32, after: u32) -> (u32, u32) {
    let (from_before, from_after) = (difference_of_halves(before, here), difference_of_halves(after, here));
    let before = select_ge_halves(same, from_before, before, here);
    let after = select_ge_halves(same, from_after, after, here);
    let furthest = select_ge_halves(from_before, from_after, from_before, from_after);
    let sides = halved_sum_halves(before, after);
    let mean = halved_sum_halves(sides, halved_sum_halves(sides, here));
    let value = select_ge_halves(same, furthest, mean, here);
    let slope = select_ge_halves(same, furthest, halved_difference_halves(after, before), sub_halves(after, before));
    (value, slope)
}

/// Whether two values may lie on one surface.
#[inline(always)]
pub(crate) const fn is_same_surface(a: i32, b: i32) -> bool {
    ((a - b + SAME_SURFACE - 1).cast_unsigned()) < 2 * SAME_SURFACE.cast_unsigned() - 1
}

/// A value smoothed by its neighbours on the same surface, and its slope. Of each neighbour: its value, and whether it lies
/// on that surface.
#[inline(always)]
pub(crate) const fn blend(here: i32, neighbours: [(i32, bool); 2]) -> (i32, i32) {
    let [(before, is_before), (after, is_after)] = neighbours;
    match (is_before, is_after) {
        (true, true) => ((before + after + 2 * here) >> 2, (after - before) >> 1),
        (true, false) => (here, here - before),
        (false, true) => (here, after - here),
        (false, false) => (here, 0),
    }
}
