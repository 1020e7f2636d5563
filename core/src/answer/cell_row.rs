//! The cells of a row: what they answer, and the smoothing along the row.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "values have 16 bits"
)]

use crate::answer::neighbourhood::fill_up;
use crate::lanes::smoothing::Values;
use crate::lanes::splat_half;

/// Surfaces that differ by less than this are one, 1/256 px.
const SAME_SURFACE: i32 = 384;

/// The cells of a row.
#[derive(Debug, Clone)]
pub struct CellRow<const WORDS: usize> {
    /// As [`Cell::value`]; smoothed along the row once it is final.
    pub(crate) values: Values<WORDS>,
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
    pub(crate) const EMPTY: Self =
        Self { values: Values { value: [0; WORDS], slope: [0; WORDS] }, label: [0; WORDS], merit: [0; WORDS] };

    /// The cells of so many tiles.
    pub(crate) fn tiles(&mut self, tiles: usize) -> TileCells<'_> {
        TileCells {
            value: &mut self.values.value.as_chunks_mut().0[..tiles],
            label: &mut self.label.as_chunks_mut().0[..tiles],
            merit: &mut self.merit.as_chunks_mut().0[..tiles],
        }
    }

    /// Smooths the values along the row, each with those neighbours that are the same surface.
    #[inline(never)]
    pub(crate) fn smooth(&mut self, cells: usize) {
        fill_up(&mut self.label, cells);
        fill_up(&mut self.merit, cells);
        self.values.smooth(cells, SAME_SURFACES);
    }
}

/// Most that surfaces differ by that are one, in both halves.
pub(crate) const SAME_SURFACES: u32 = splat_half(SAME_SURFACE.cast_unsigned() - 1);

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
