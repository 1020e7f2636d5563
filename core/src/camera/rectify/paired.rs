//! Rectification by whole pixels: brings together the rows and columns of two cameras that are a little off.
//!
//! Real pairs of small cameras look a few rows past each other. Whole rows need no frame buffer: the view
//! that is ahead waits in a ring of as many rows as the offset has.

use crate::frame_figures::FrameFigures;
use crate::{Config, ConfigError, DisparityRow, RowError, ScanlinePair, StereoMethod};

/// How far the right view is displaced against the left one, in whole pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Offset {
    /// What the left view shows in row `y`, the right one shows in row `y + rows`;
    /// within ±[`Offset::MAX_ROWS`].
    pub rows: i8,
    /// The right view shows everything so many columns further right than rectified cameras would;
    /// within ±[`Offset::MAX_COLUMNS`]. Taking it away makes every disparity greater by as much.
    pub columns: i16,
}

impl Offset {
    /// Greatest magnitude of the row offset.
    pub const MAX_ROWS: i8 = 16;
    /// Greatest magnitude of the column offset.
    pub const MAX_COLUMNS: i16 = 128;

    /// Rows that one view waits for the other: the capacity to build a [`Paired`] with.
    #[must_use]
    pub const fn waiting_rows(self) -> usize {
        self.rows.unsigned_abs() as usize
    }
}

/// A stereo method behind a pair of displaced cameras: takes the rows as they come, hands on those that
/// belong together.
///
/// Rows without a partner, at the top or at the bottom of the frame, and those whose partner was lost,
/// are missed: their disparities come out unknown. Rows are those of the left view, and come out
/// as many rows later as the offset has, if that is positive.
///
/// `ROWS` is the capacity: [`Offset::waiting_rows`] or more; `WIDTH` the greatest width, px. It holds
/// `WIDTH * (ROWS + 1)` bytes besides the method. Of the same rows every capacity makes the same answer.
///
/// # Examples
/// ```
/// use haarline::rectify::{Offset, Paired};
/// use haarline::{Config, Lite, ScanlinePair, StereoMethod, blocks_for};
/// let lite = Lite::<{ blocks_for(64) }>::new(Config::for_width(64))?;
/// let mut paired = Paired::<_, 2, 64>::new(lite, Offset { rows: 2, columns: 0 })?;
/// let mut rows = 0;
/// for _ in 0..24 {
///     paired.push(ScanlinePair { left: &[9; 64], right: &[9; 64] }, &mut |_| rows += 1).unwrap();
/// }
/// paired.finish(&mut |_| rows += 1);
/// assert_eq!(rows, 24);
/// # Ok::<(), haarline::ConfigError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Paired<M, const ROWS: usize, const WIDTH: usize> {
    method: M,
    offset: Offset,
    /// The newest rows of the view that is ahead: the left one of a positive offset, else the right one.
    waiting: [[u8; WIDTH]; ROWS],
    /// Which of them there are, a bit each.
    present: u32,
    /// The right row with its column offset taken away.
    shifted: [u8; WIDTH],
    /// Rows of this frame pushed or missed so far.
    rows: u32,
}

impl<M: StereoMethod, const ROWS: usize, const WIDTH: usize> Paired<M, ROWS, WIDTH> {
    /// Puts `method` behind cameras of that offset.
    ///
    /// # Errors
    /// If the offset is out of its range, or offset or width are over the capacity.
    pub fn new(method: M, offset: Offset) -> Result<Self, ConfigError> {
        let max_rows = u8::try_from(ROWS).unwrap_or(u8::MAX).min(Offset::MAX_ROWS.unsigned_abs());
        if offset.rows.unsigned_abs() > max_rows {
            return Err(ConfigError::RowOffset { max_rows });
        }
        if offset.columns.unsigned_abs() > Offset::MAX_COLUMNS.unsigned_abs() {
            return Err(ConfigError::ColumnOffset);
        }
        if usize::from(method.config().width) > WIDTH {
            return Err(ConfigError::Capacity { max_width: u16::try_from(WIDTH).unwrap_or(u16::MAX) });
        }
        Ok(Self { method, offset, waiting: [[0; WIDTH]; ROWS], present: 0, shifted: [0; WIDTH], rows: 0 })
    }

    /// The method behind.
    #[must_use]
    pub const fn method(&self) -> &M {
        &self.method
    }

    fn clear(&mut self) {
        self.present = 0;
        self.rows = 0;
    }

    /// Where the next row waits. Its place is that of the row which it relieves: the one whose partner
    /// comes now.
    fn slot(&self) -> usize {
        self.rows as usize % self.offset.waiting_rows().max(1)
    }

    /// Whether the next row only waits: no row of the left view is complete with it.
    fn only_waits(&self) -> bool {
        u32::try_from(self.offset.rows).is_ok_and(|rows| self.rows < rows)
    }
}

impl<M: StereoMethod, const ROWS: usize, const WIDTH: usize> StereoMethod for Paired<M, ROWS, WIDTH> {
    fn config(&self) -> &Config {
        self.method.config()
    }

    fn start(&mut self) {
        self.clear();
        self.method.start();
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        pair.check(self.config().width)?;
        let (slot, only_waits) = (self.slot(), self.only_waits());
        self.rows += 1;
        let left = pair.left;
        let right = shift(pair.right, self.offset.columns, &mut self.shifted);
        if self.offset.rows == 0 {
            return self.method.push(ScanlinePair { left, right }, sink);
        }
        let Some(waiting) = self.waiting.get_mut(slot).and_then(|row| row.get_mut(..left.len())) else {
            return Ok(());
        };
        let left_waits = self.offset.rows > 0;
        if self.present >> slot & 1 == 1 {
            let (left, right) = if left_waits { (&*waiting, right) } else { (left, &*waiting) };
            self.method.push(ScanlinePair { left, right }, sink)?;
        } else if !only_waits {
            self.method.miss(sink);
        }
        waiting.copy_from_slice(if left_waits { left } else { right });
        self.present |= 1 << slot;
        Ok(())
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let (slot, only_waits) = (self.slot(), self.only_waits());
        self.present &= !(1 << slot);
        self.rows += 1;
        if !only_waits {
            self.method.miss(sink);
        }
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let alone = u32::try_from(self.offset.rows).unwrap_or(0).min(self.rows);
        for _ in 0..alone {
            self.method.miss(sink);
        }
        self.clear();
        self.method.finish(sink);
    }

    fn figures(&self) -> Option<FrameFigures> {
        self.method.figures()
    }

    fn cell_height(&self) -> u32 {
        self.method.cell_height()
    }
}

/// `row` moved left by `columns`, its border pixels repeated.
fn shift<'a, const WIDTH: usize>(row: &'a [u8], columns: i16, room: &'a mut [u8; WIDTH]) -> &'a [u8] {
    let by = usize::from(columns.unsigned_abs()).min(row.len());
    let (Some(room), false) = (room.get_mut(..row.len()), by == 0) else { return row };
    let (first, last) = (row.first().copied().unwrap_or(0), row.last().copied().unwrap_or(0));
    let kept = row.len() - by;
    if columns > 0 {
        let (moved, border) = room.split_at_mut(kept);
        moved.copy_from_slice(row.get(by..).unwrap_or(&[]));
        border.fill(last);
    } else {
        let (border, moved) = room.split_at_mut(by);
        border.fill(first);
        moved.copy_from_slice(row.get(..kept).unwrap_or(&[]));
    }
    room
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::Disparity;
    use proptest::prelude::*;
    use std::vec::Vec;

    const WIDTH: u16 = 32;

    /// Writes down what it is given: the first pixels of both rows, or nothing where a row is missed.
    #[derive(Debug)]
    struct Notes {
        config: Config,
        rows: Vec<Option<(u8, u8)>>,
    }

    impl StereoMethod for Notes {
        fn config(&self) -> &Config {
            &self.config
        }

        fn start(&mut self) {
            self.rows.clear();
        }

        fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
            self.rows.push(Some((pair.left[0], pair.right[0])));
            sink(DisparityRow { y: 0, disparity: &[Disparity::from_px(0)], confidence: &[1] });
            Ok(())
        }

        fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
            self.rows.push(None);
            sink(DisparityRow { y: 0, disparity: &[Disparity::UNKNOWN], confidence: &[0] });
        }

        fn finish(&mut self, _: &mut dyn FnMut(DisparityRow<'_>)) {}
    }

    fn notes() -> Notes {
        Notes { config: Config::for_width(WIDTH), rows: Vec::new() }
    }

    /// Plays a frame whose left rows are 0, 1, ... and whose right rows are 100, 101, ...; `lost` ones
    /// are missed. What the method was given, and how many rows came out.
    fn play<const ROWS: usize>(rows: i8, lost: &[u8], height: u8) -> (Vec<Option<(u8, u8)>>, usize) {
        let mut paired = Paired::<_, ROWS, 40>::new(notes(), Offset { rows, columns: 0 }).unwrap();
        let mut out = 0;
        for frame in 0..2 {
            paired.start();
            out = 0;
            for y in 0..height {
                if lost.contains(&y) && frame == 1 {
                    paired.miss(&mut |_| out += 1);
                } else {
                    let (left, right) = ([y; WIDTH as usize], [100 + y; WIDTH as usize]);
                    paired.push(ScanlinePair { left: &left, right: &right }, &mut |_| out += 1).unwrap();
                }
            }
            paired.finish(&mut |_| out += 1);
        }
        (paired.method.rows, out)
    }

    #[test]
    fn a_row_meets_the_one_that_lies_lower_in_the_right_view() {
        let expected = [Some((0, 102)), Some((1, 103)), Some((2, 104)), None, None];
        assert_eq!(play::<2>(2, &[], 5), (expected.to_vec(), 5));
    }

    #[test]
    fn a_row_meets_the_one_that_lies_higher_in_the_right_view() {
        let expected = [None, None, Some((2, 100)), Some((3, 101)), Some((4, 102))];
        assert_eq!(play::<2>(-2, &[], 5), (expected.to_vec(), 5));
    }

    #[test]
    fn offsets_and_widths_are_held_to_range_and_capacity() {
        let new = |rows, columns| Paired::<_, 4, 32>::new(notes(), Offset { rows, columns }).map(|_| ());
        assert_eq!(new(-4, -128), Ok(()));
        assert_eq!(new(5, 0), Err(ConfigError::RowOffset { max_rows: 4 }));
        assert_eq!(new(0, 129), Err(ConfigError::ColumnOffset));
        let wide = Notes { config: Config::for_width(33), ..notes() };
        let built = Paired::<_, 0, 32>::new(wide, Offset::default()).map(|_| ());
        assert_eq!(built, Err(ConfigError::Capacity { max_width: 32 }));
        let far = Paired::<_, 40, 32>::new(notes(), Offset { rows: 17, columns: 0 }).map(|_| ());
        assert_eq!(far, Err(ConfigError::RowOffset { max_rows: 16 }));
    }

    #[test]
    fn a_row_of_another_width_is_refused_and_does_not_count() {
        let mut paired = Paired::<_, 1, 40>::new(notes(), Offset { rows: 1, columns: 0 }).unwrap();
        let row = |y: u8| [y; WIDTH as usize];
        for y in [1, 2] {
            paired.push(ScanlinePair { left: &row(y), right: &row(y + 100) }, &mut |_| ()).unwrap();
            let narrow = ScanlinePair { left: &[0; 31], right: &[0; 31] };
            assert_eq!(paired.push(narrow, &mut |_| ()), Err(RowError::Width { expected: WIDTH, found: 31 }));
        }
        assert_eq!(paired.method.rows, [Some((1, 102))]);
    }

    #[test]
    fn columns_move_by_the_offset_and_borders_repeat() {
        let moved = |columns| shift(&[1, 2, 3, 4], columns, &mut [0; 6]).to_vec();
        assert_eq!(moved(0), [1, 2, 3, 4]);
        assert_eq!(moved(1), [2, 3, 4, 4]);
        assert_eq!(moved(-2), [1, 1, 1, 2]);
        assert_eq!((moved(9), moved(-9)), ([4; 4].to_vec(), [1; 4].to_vec()));
    }

    proptest! {
        #[test]
        fn every_row_comes_out_once_with_its_partner_or_missed(
            rows in -16_i8..=16, height in 0_u8..60, lost in prop::collection::vec(0_u8..60, 0..5),
        ) {
            let partner = |y: u8| {
                let right = i16::from(y) + i16::from(rows);
                let right = u8::try_from(right).ok().filter(|&right| right < height)?;
                (!lost.contains(&y) && !lost.contains(&right)).then_some((y, 100 + right))
            };
            let expected: Vec<_> = (0..height).map(partner).collect();
            prop_assert_eq!(play::<16>(rows, &lost, height), (expected.clone(), usize::from(height)));
            prop_assert_eq!(play::<20>(rows, &lost, height).0, expected);
        }
    }
}
