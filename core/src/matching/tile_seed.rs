//! Seeds: for each tile the disparities of the nearest contours that both views see.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "columns are below 1280, labels below 256"
)]

use crate::Config;
use crate::front_end::camera_view::{CameraView, Row};
use crate::lanes::rows::{Window, response, responses};
use crate::lanes::{ONES, greatest, max, select_ge};

/// Marks a tile without a seed on that side.
const NONE: u16 = u16::MAX;
/// Percent of the least cost by which the second least must exceed it, as `second * 5 > best * UNIQUENESS`.
const UNIQUENESS: u32 = 8;

/// A contour: column in the upper half, strength in the lower one.
#[derive(Debug, Clone, Copy)]
struct Contour(u32);

impl Contour {
    const fn column(self) -> usize {
        (self.0 >> 16) as usize
    }

    const fn strength(self) -> u32 {
        self.0 & 0xffff
    }
}

/// The contours of one polarity along a row of tiles, at most one in eight columns, left to right.
#[derive(Debug, Clone)]
struct Contours<const WORDS: usize> {
    points: [Contour; WORDS],
    len: usize,
}

impl<const WORDS: usize> Contours<WORDS> {
    const EMPTY: Self = Self { points: [Contour(0); WORDS], len: 0 };

    fn as_slice(&self) -> &[Contour] {
        &self.points[..self.len]
    }

    /// Takes the strongest response of each tile, if it reaches `threshold`.
    ///
    /// - `words`: words of a row, margins included.
    fn find(&mut self, rows: &[&[u32]], words: usize, falling: bool, threshold: u32) {
        self.len = 0;
        for tile in 0..(words - 2).div_ceil(2) {
            let at = 2 * tile + 1;
            // The last tile may be half beyond the view.
            let is_whole = at + 2 < words;
            let [a, b] = if is_whole { responses(rows, at, falling) } else { [response(rows, at, falling), 0] };
            let most = greatest(max(a, b));
            let strength = most & 0xff;
            if strength < threshold {
                continue;
            }
            let first = select_ge(a, most, ONES, 0);
            let second = select_ge(b, most, ONES, 0);
            let offset = if first != 0 { first.trailing_zeros() / 8 } else { 4 + second.trailing_zeros() / 8 };
            if let Some(point) = self.points.get_mut(self.len) {
                *point = Contour((8 * tile as u32 + offset) << 16 | strength);
                self.len += 1;
            }
        }
    }
}

/// The contours of both views and the seeds of one row of tiles.
#[derive(Debug, Clone)]
pub(crate) struct TileSeeds<const WORDS: usize> {
    left: Contours<WORDS>,
    right: Contours<WORDS>,
    /// Label of the last seed at or before a tile, and of the first at or after it.
    nearest: [[u16; 2]; WORDS],
}

impl<const WORDS: usize> TileSeeds<WORDS> {
    pub(crate) const fn new() -> Self {
        Self { left: Contours::EMPTY, right: Contours::EMPTY, nearest: [[NONE; 2]; WORDS] }
    }

    /// Finds the contours of a row of tiles in the smoothed rows: those that rise on even rows of tiles, those that fall on odd.
    ///
    /// - `strong_noise`: of four rows instead of the middle two.
    pub(crate) fn find_contours(
        &mut self,
        views: [&CameraView<WORDS>; 2],
        tile_row: u32,
        words: usize,
        threshold: u32,
        strong_noise: bool,
    ) {
        let first = i64::from(4 * tile_row);
        let falling = tile_row % 2 == 1;
        for (view, contours) in views.into_iter().zip([&mut self.left, &mut self.right]) {
            let row = |y: i64| &view.smooth(first + y)[..];
            if strong_noise {
                contours.find(&[row(0), row(1), row(2), row(3)], words, falling, threshold);
            } else {
                contours.find(&[row(1), row(2)], words, falling, threshold);
            }
        }
    }

    /// Pairs the contours and gives each tile the nearest seeds.
    ///
    /// A left contour takes the right one of the least cost, if no second one comes near and if it is itself the cheapest for
    /// that one.
    pub(crate) fn pair(&mut self, config: &Config, left: &[Row<WORDS>; 4], right: &[Row<WORDS>; 4], tiles: usize) {
        self.nearest[..tiles].fill([NONE; 2]);
        let least = i32::from(config.min_disparity);
        let most = least + i32::from(config.num_disparities);
        let mut choice = [(0usize, false); WORDS];
        let mut suitor = [(u32::MAX, 0usize); WORDS];

        let (left_rows, right_rows) = (middle(left), middle(right));
        let mut start = 0;
        let candidates = self.right.as_slice();
        for (i, contour) in self.left.as_slice().iter().enumerate() {
            let column = contour.column() as i32;
            while candidates.get(start).is_some_and(|c| column - (c.column() as i32) >= most) {
                start += 1;
            }
            let (mut best, mut second, mut partner) = (u32::MAX, u32::MAX, usize::MAX);
            let window = Window::of(left_rows, contour.column());
            let strength = contour.strength();
            let Some((candidates, suitors)) = candidates.get(start..).zip(suitor.get_mut(start..)) else { break };
            for (j, (candidate, suitor)) in (start..).zip(candidates.iter().zip(suitors)) {
                if column - (candidate.column() as i32) < least {
                    break;
                }
                let other = candidate.strength();
                if strength > 2 * other || other > 2 * strength {
                    continue;
                }
                let cost = window.sad(Window::of(right_rows, candidate.column()));
                if cost < best {
                    (second, best, partner) = (best, cost, j);
                } else if cost < second {
                    second = cost;
                }
                if cost < suitor.0 {
                    *suitor = (cost, i);
                }
            }
            let is_unique = second == u32::MAX || 5 * second > UNIQUENESS * best;
            choice[i] = (partner, partner != usize::MAX && is_unique);
        }
        for (i, contour) in self.left.as_slice().iter().enumerate() {
            let (partner, is_unique) = choice[i];
            if !is_unique || suitor.get(partner).is_none_or(|s| s.1 != i) {
                continue;
            }
            if let Some(other) = candidates.get(partner) {
                let label = (contour.column() as i32 - other.column() as i32 - least) as u16;
                if let Some(nearest) = self.nearest.get_mut(contour.column() / 8) {
                    *nearest = [label; 2];
                }
            }
        }
        let mut last = NONE;
        for [from_left, _] in &mut self.nearest[..tiles] {
            last = if *from_left == NONE { last } else { *from_left };
            *from_left = last;
        }
        let mut next = NONE;
        for [_, from_right] in self.nearest[..tiles].iter_mut().rev() {
            next = if *from_right == NONE { next } else { *from_right };
            *from_right = next;
        }
    }

    /// Labels of the nearest seeds on either side of a tile; more than 255 where there is none.
    #[inline]
    pub(crate) fn nearest(&self, tile: usize) -> [u16; 2] {
        self.nearest[tile]
    }
}

/// The two rows in the middle of a tile.
fn middle<const WORDS: usize>(rows: &[Row<WORDS>; 4]) -> [&Row<WORDS>; 2] {
    [&rows[1], &rows[2]]
}
