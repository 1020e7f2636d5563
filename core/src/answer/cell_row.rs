//! The cells of a row: what they answer, and the smoothing along the row.
#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "means of values stay among them")]

use crate::answer::cell::Cell;

/// Surfaces that differ by less than this are one, 1/256 px.
const SAME_SURFACE: i32 = 384;

/// The cells of a row.
#[derive(Debug, Clone)]
pub(crate) struct CellRow<const WORDS: usize> {
    /// As [`Cell::value`]; smoothed along the row once it is final.
    pub(crate) value: [u16; WORDS],
    /// Half of what `value` rises from the cell before to the cell after.
    pub(crate) slope: [i16; WORDS],
    /// As [`Cell::label`].
    pub(crate) label: [u8; WORDS],
    /// As [`Cell::merit`].
    pub(crate) merit: [u8; WORDS],
}

/// A cell of a row, to be written.
pub(crate) struct CellMut<'a> {
    value: &'a mut u16,
    label: &'a mut u8,
    merit: &'a mut u8,
}

impl CellMut<'_> {
    #[inline(always)]
    pub(crate) fn set(self, found: Cell) {
        (*self.value, *self.label, *self.merit) = (found.value, found.label, found.merit);
    }
}

impl<const WORDS: usize> CellRow<WORDS> {
    pub(crate) const EMPTY: Self = Self { value: [0; WORDS], slope: [0; WORDS], label: [0; WORDS], merit: [0; WORDS] };

    /// The cells of so many tiles.
    pub(crate) fn cells(&mut self, tiles: usize) -> impl DoubleEndedIterator<Item = CellMut<'_>> {
        let (value, label, merit) =
            (&mut self.value[..2 * tiles], &mut self.label[..2 * tiles], &mut self.merit[..2 * tiles]);
        let cells = value.iter_mut().zip(label).zip(merit);
        cells.map(|((value, label), merit)| CellMut { value, label, merit })
    }

    /// Smooths the values along the row, each with those neighbours that are the same surface.
    pub(crate) fn smooth(&mut self, cells: usize) {
        let (values, slopes) = (&mut self.value[..cells], &mut self.slope[..cells]);
        let (mut before, mut is_before) = (0, false);
        let mut here = values.first().map_or(0, |&value| i32::from(value));
        for i in 0..cells {
            let (after, is_after) = match values.get(i + 1) {
                Some(&after) => (i32::from(after), is_same_surface(i32::from(after), here)),
                None => (here, false),
            };
            let (smooth, slope) = blend(here, [(before, is_before), (after, is_after)]);
            (values[i], slopes[i]) = (smooth as u16, slope as i16);
            (before, is_before, here) = (here, is_after, after);
        }
    }
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
