//! Rows by lens tables: when each can come out, and how it is made.

use super::lens::{KNOT_ROWS, LensTable, NODE_PX, Reach, render};
use super::ring::Ring;
use super::stage::floor;
use super::{RectifiedRow, Rectifier};
use crate::ScanlinePair;
use crate::lanes::lens_runs::{LEN, Number, Segment, View, aim, curves, skip, start};

/// Rows that two lens tables need.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Schedule {
    /// Rows of each view in the ring.
    pub(super) rows: [usize; 2],
    /// Rows after which a row comes out, at most.
    pub(super) waits: usize,
}

impl Schedule {
    pub(super) fn of(lenses: &[LensTable; 2]) -> Self {
        let height = u32::from(lenses[0].size()[1]);
        // Noise is measured on three rows.
        let mut schedule = Self { rows: [3; 2], waits: 0 };
        let mut ready = 0;
        let mut reaches = lenses.each_ref().map(|table| Reach::start(table, |_, _| ()));
        for y in 0..height {
            if (y as usize).is_multiple_of(KNOT_ROWS) {
                for (reach, table) in reaches.iter_mut().zip(lenses) {
                    reach.aim(table, y, |_, _| ());
                }
            }
            let rows = reaches.map(|reach| reach.rows(height));
            ready = ready.max(rows[0][1] + 1).max(rows[1][1] + 1);
            for (len, rows) in schedule.rows.iter_mut().zip(rows) {
                *len = (*len).max((ready - rows[0]) as usize);
            }
            schedule.waits = schedule.waits.max(ready.saturating_sub(y + 1) as usize);
            reaches.iter_mut().for_each(Reach::advance);
        }
        schedule
    }
}

impl<const ROWS: usize, const WIDTH: usize> Rectifier<ROWS, WIDTH> {
    pub(super) fn start_lenses(&mut self) {
        self.next = 0;
        let Self { lenses: Some(lenses), segments, reaches, size, .. } = self else { return };
        for (view, (table, reach)) in lenses.iter().zip(reaches).enumerate() {
            let segments = segments_of(segments, size[0], view);
            *reach = Reach::start(table, |index, curves| {
                if let Some(segment) = segments.get_mut(index) {
                    *segment = start(curves);
                }
            });
        }
        self.aim_next();
    }

    /// Finds where the next row lies, once in [`KNOT_ROWS`] rows.
    fn aim_next(&mut self) {
        let Self { lenses: Some(lenses), segments, reaches, next, size, needed, .. } = self else { return };
        if (*next as usize).is_multiple_of(KNOT_ROWS) && *next < u32::from(size[1]) {
            for (view, (table, reach)) in lenses.iter().zip(&mut *reaches).enumerate() {
                let segments = segments_of(segments, size[0], view);
                reach.aim(table, *next, |index, curves| {
                    if let Some(segment) = segments.get_mut(index) {
                        aim::<WIDTH>(segment, curves, size[0] - 1);
                    }
                });
            }
        }
        *needed = reaches.map(|reach| reach.rows(size[1].into()));
    }

    pub(super) fn advance_lenses(&mut self, sink: &mut dyn FnMut(RectifiedRow<'_>)) {
        let height = u32::from(self.size[1]);
        while self.next < height {
            let needed = self.needed;
            if needed.iter().any(|rows| rows[1] >= self.came) {
                return;
            }
            self.emit_by_lenses(needed, sink);
        }
        // A frame of more rows than the tables have.
        while self.next < self.came {
            sink(RectifiedRow { y: self.next, pair: None });
            self.next += 1;
        }
    }

    /// The rows that still wait; what they need below the last row is that row.
    pub(super) fn finish_lenses(&mut self, sink: &mut dyn FnMut(RectifiedRow<'_>)) {
        let last = self.came.saturating_sub(1);
        while self.next < self.came {
            let needed = self.needed.map(|rows| rows.map(|row| row.min(last)));
            self.emit_by_lenses(needed, sink);
        }
    }

    fn emit_by_lenses(&mut self, needed: [[u32; 2]; 2], sink: &mut dyn FnMut(RectifiedRow<'_>)) {
        let (width, y) = (usize::from(self.size[0]), self.next);
        let middle = width / 2 / NODE_PX;
        let has_middle = [0, 1].into_iter().all(|view| {
            let segments = segments_of(&mut self.segments, self.size[0], view);
            let place = segments.get(middle).map_or(0, |segment| curves(segment)[1][0]);
            u32::try_from(floor(place + (1 << 15))).is_ok_and(|row| row < self.came)
        });
        let has = |ring: &Ring, [first, last]: [u32; 2]| !self.is_damaged || (first..=last).all(|row| ring.has(row));
        let is_whole = has(&self.left, needed[0]) && has(&self.right, needed[1]);
        let has_pair = is_whole && has_middle;
        let last = i32::try_from(self.came).unwrap_or(i32::MAX) - 1;
        let (rows, rings) = (&self.rows, [&self.left, &self.right]);
        for (view, (ring, out)) in rings.into_iter().zip(&mut self.out).enumerate() {
            let segments = segments_of(&mut self.segments, self.size[0], view);
            if !has_pair {
                segments.iter_mut().for_each(skip);
                continue;
            }
            let rows = ring.rows(rows);
            let first = (last + 1 - i32::try_from(rows.len()).unwrap_or(0)).max(0);
            render(segments, View { rows, first, last }, self.size[0], out);
        }
        self.reaches.iter_mut().for_each(Reach::advance);
        let [left, right] = self.out.each_ref().map(|row| row.get(..width).unwrap_or(&[]));
        sink(RectifiedRow { y, pair: has_pair.then_some(ScanlinePair { left, right }) });
        self.next += 1;
        self.aim_next();
    }
}

/// The segments of a view, the left one is view 0.
#[inline(always)]
fn segments_of(numbers: &mut [Number], width: u16, view: usize) -> &mut [Segment] {
    let count = usize::from(width).div_ceil(NODE_PX);
    numbers.as_chunks_mut().0.get_mut(view * count..(view + 1) * count).unwrap_or(&mut [])
}

/// Columns that a view's width needs of the capacity, so that its segments have room.
pub(super) const fn columns_needed(width: u16) -> usize {
    2 * LEN * (width as usize).div_ceil(NODE_PX)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::rectify::{Rectification, node_count};
    use crate::{ConfigError, Ramp};
    use std::boxed::Box;
    use std::vec::Vec;

    const SIZE: [u16; 2] = [97, 70];

    /// A lens that bends rows and columns: the places of a rectified pixel, px.
    fn bent(x: f64, y: f64, turn: f64) -> [f64; 2] {
        let (dx, dy) = (x - 50.0, y - 33.0);
        let k = 1.0 - 2e-5 * (dx * dx + dy * dy);
        [50.0 + k * dx - turn * dy + 0.3, 33.0 + k * dy + turn * dx - 0.8]
    }

    fn table(turn: f64) -> LensTable {
        let [columns, rows] = SIZE.map(node_count);
        let node = |i: usize| {
            let [x, y] = [i % columns, i / columns].map(|i| 32.0 * (f64::from(u16::try_from(i).unwrap()) - 1.0));
            let place = bent(x, y, turn);
            #[expect(clippy::cast_possible_truncation, reason = "a few px")]
            [(64.0 * (place[0] - x)).round() as i16, (64.0 * (place[1] - y)).round() as i16]
        };
        let nodes: Vec<[i16; 2]> = (0..columns * rows).map(node).collect();
        LensTable::new(SIZE, Box::leak(nodes.into_boxed_slice())).unwrap()
    }

    fn lenses() -> [LensTable; 2] {
        [table(0.02), table(-0.03)]
    }

    /// A view with slopes in both directions.
    fn grey(x: f64, y: f64) -> f64 {
        120.0 + 0.9 * (x - 50.0) + 0.8 * (y - 33.0)
    }

    /// Number of a row and its rectified views.
    type Played = (u32, Option<[Vec<u8>; 2]>);

    /// Plays a frame; of each row that comes out its number and both views.
    fn play<const ROWS: usize>(height: u16, lost: &[u16]) -> Vec<Played> {
        let rectification = Rectification { lenses: Some(lenses()), ..Rectification::default() };
        let mut rectifier = Box::new(Rectifier::<ROWS, 128>::new(SIZE, rectification).unwrap());
        let mut rows = Vec::new();
        let mut most = 0;
        for frame in 0..2 {
            rows.clear();
            rectifier.start();
            for y in 0..height {
                let before = rows.len();
                let mut note = |row: RectifiedRow<'_>| {
                    let pair = row.pair.map(|pair| [pair.left.to_vec(), pair.right.to_vec()]);
                    rows.push((row.y, pair));
                };
                if lost.contains(&y) && frame == 1 {
                    rectifier.miss(&mut note);
                } else {
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "grey levels")]
                    let row: Vec<u8> = (0..SIZE[0]).map(|x| grey(x.into(), y.into()).round() as u8).collect();
                    rectifier.push(ScanlinePair { left: &row, right: &row }, &mut note).unwrap();
                }
                most = most.max(rows.len() - before);
            }
            rectifier.finish(&mut |row| {
                rows.push((row.y, row.pair.map(|pair| [pair.left.to_vec(), pair.right.to_vec()])));
            });
        }
        assert!(most <= 2, "{most} rows with one push");
        rows
    }

    #[test]
    fn every_row_comes_out_once_and_shows_what_the_lens_showed() {
        let rows = play::<40>(SIZE[1], &[]);
        assert!(rows.iter().map(|row| row.0).eq(0..u32::from(SIZE[1])));
        let mut compared = 0;
        for (y, pair) in rows {
            for (view, turn) in pair.iter().flatten().zip([0.02, -0.03]) {
                for (x, &found) in (0..).zip(view) {
                    let place = bent(f64::from(x), f64::from(y), turn);
                    if (0.0..96.0).contains(&place[0]) && (0.0..69.0).contains(&place[1]) {
                        let wanted = grey(place[0], place[1]);
                        assert!((f64::from(found) - wanted).abs() < 1.3, "{x}, {y}: {found} {wanted}");
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 11_000, "{compared}");
    }

    #[test]
    fn a_larger_ring_makes_the_same_rows() {
        assert_eq!(play::<40>(SIZE[1], &[]), play::<90>(SIZE[1], &[]));
        let short = play::<40>(41, &[]);
        assert!(short.len() >= 41 && short.len() <= 60, "{}", short.len());
        assert_eq!(play::<40>(SIZE[1] + 3, &[]).len(), usize::from(SIZE[1]) + 3);
    }

    #[test]
    fn a_lost_row_takes_those_that_need_it_and_no_other() {
        let (whole, damaged) = (play::<40>(SIZE[1], &[]), play::<40>(SIZE[1], &[20]));
        let missed = damaged.iter().filter(|row| row.1.is_none()).count();
        assert!((2..12).contains(&missed), "{missed}");
        for (whole, damaged) in whole.iter().zip(&damaged) {
            assert!(damaged.1.is_none() || damaged.1 == whole.1);
        }
    }

    #[test]
    fn a_table_that_needs_more_rows_than_there_are_is_refused_with_their_number() {
        let rectification = Rectification { lenses: Some(lenses()), ..Rectification::default() };
        let needed = rectification.rows_needed(SIZE);
        let Err(error) = Rectifier::<8, 128>::new(SIZE, rectification) else { panic!("8 rows are too few") };
        assert_eq!(error, ConfigError::RingRows { needed: u16::try_from(needed).unwrap(), rows: 8 });
        assert!((9..=40).contains(&needed), "{needed}");
        let other = Rectifier::<40, 128>::new([97, 71], rectification).map(|_| ());
        assert_eq!(other, Err(ConfigError::LensSize));
        assert_eq!(Rectification::from(Ramp::whole(3)).rows_needed([97, 70]), 5);
    }
}
