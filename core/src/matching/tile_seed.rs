//! Seeds: for each tile the disparities of the nearest contours that both views see.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "columns are below 1280, labels below 256"
)]

use crate::Config;
use crate::front_end::camera_pair::CameraPair;
use crate::front_end::camera_view::{FeatureRows, Row};
use crate::lanes::partners::{Contour, Wanted, cheapest};
#[cfg(haarline_sse2)]
use crate::lanes::rows::haar_peaks_of_pairs;
use crate::lanes::rows::haar_responses;
use crate::lanes::{ONES, choose, greatest, max, select_ge, signed_halved_sum};

/// Marks a tile without a seed on that side.
const NONE: u16 = u16::MAX;
/// Marks a contour without a partner: a row has at most 160.
const NOBODY: u32 = u32::MAX;
/// Percent of the least cost by which the second least must exceed it, as `second * 5 > best * UNIQUENESS`.
const UNIQUENESS: u32 = 6;

/// The contours of both views and the seeds of one row of tiles.
#[derive(Debug, Clone)]
pub(crate) struct TileSeeds<const WORDS: usize> {
    /// The contours of one polarity along a row of tiles, at most one in eight columns, left to right: of the left view in
    /// the first half, of the right view in the second.
    contours: [Contour; WORDS],
    len: [usize; 2],
    /// Label of the last seed at or before a tile, and of the first at or after it.
    nearest: [[u16; 2]; WORDS],
}

impl<const WORDS: usize> TileSeeds<WORDS> {
    pub(crate) const fn new() -> Self {
        Self { contours: [Contour { place: 0, partner: 0 }; WORDS], len: [0; 2], nearest: [[NONE; 2]; WORDS] }
    }

    /// Finds the contours of a row of tiles in the smoothed rows: those that rise on even rows of tiles, those that fall on odd.
    ///
    /// - `words`: of a row, margins included.
    /// - `strong_noise`: of four rows instead of the middle two.
    pub(crate) fn find_contours<F: FeatureRows<WORDS>>(
        &mut self,
        cameras: &CameraPair<WORDS, F>,
        tile_row: u32,
        words: usize,
        threshold: u32,
        strong_noise: bool,
    ) {
        let first = 4 * tile_row;
        let (left, right) = self.contours.split_at_mut(WORDS / 2);
        for ((view, contours), len) in [&cameras.left, &cameras.right].into_iter().zip([left, right]).zip(&mut self.len)
        {
            let rows = [0, 1, 2, 3].map(|y| view.smooth(first + y));
            let means;
            let rows = if strong_noise {
                means = means_of_four(rows, words);
                means.each_ref()
            } else {
                [rows[1], rows[2]]
            };
            *len = find(rows, words, tile_row % 2 == 1, threshold, contours);
        }
    }

    /// Pairs the contours and gives each tile the nearest seeds.
    ///
    /// A left contour takes the right one of the least cost, if no second one comes near and if it is itself the cheapest for
    /// that one.
    #[inline(never)]
    pub(crate) fn pair(&mut self, config: &Config, [left, right]: [&[Row<WORDS>; 4]; 2], tiles: usize) {
        let least = i32::from(config.min_disparity);
        let most = least + i32::from(config.num_disparities);
        let (left_rows, right_rows) = (middle(left), middle(right));
        let (contours, candidates) = self.contours.split_at_mut(WORDS / 2);
        let (contours, candidates) = (&mut contours[..self.len[0]], &mut candidates[..self.len[1]]);
        let mut start = 0;
        for (i, contour) in (0..).zip(contours.iter_mut()) {
            // The contours from this column on, as places.
            let from = |column: i32| (column.max(0) << 16).cast_unsigned();
            let column = contour.column() as i32;
            let (first, end) = (from(column - most + 1), from(column - least + 1));
            // Mostly one or two, which nobody could foresee.
            #[cfg(not(haarline_dsp))]
            for _ in 0..2 {
                start += usize::from(candidates.get(start).is_some_and(|c| c.place < first));
            }
            while candidates.get(start).is_some_and(|c| c.place < first) {
                start += 1;
            }
            let wanted = Wanted::of(*contour, left_rows, i, end);
            let candidates = candidates.get_mut(start..).unwrap_or_default();
            let [best, second] = cheapest(&wanted, start as u32, right_rows, candidates);
            let (cost, other) = (best >> 8, second >> 8);
            contour.partner = if cfg!(not(haarline_dsp)) {
                let is_unique = (best != u32::MAX) & ((second == u32::MAX) | (5 * other > UNIQUENESS * cost));
                choose(is_unique, best & 0xff, NOBODY)
            } else if best != u32::MAX && (second == u32::MAX || 5 * other > UNIQUENESS * cost) {
                best & 0xff
            } else {
                NOBODY
            };
        }
        spread(&mut self.nearest[..tiles], contours, candidates, least);
    }

    /// Column, upper half, and strength, lower half, of each contour of the left view that was found last, left to right.
    pub(crate) fn left_contours(&self) -> impl Iterator<Item = u32> + Clone {
        self.contours[..self.len[0]].iter().map(|contour| contour.place)
    }

    /// Puts other seeds in the place of those of the contours.
    pub(crate) fn replace(&mut self, tiles: usize, seeds: impl Fn(u32) -> [u16; 2]) {
        for (tile, nearest) in (0..).zip(&mut self.nearest[..tiles]) {
            *nearest = seeds(tile);
        }
    }

    /// Labels of the nearest seeds on either side of a tile; more than 255 where there is none.
    #[inline]
    pub(crate) fn nearest(&self, tile: usize) -> [u16; 2] {
        self.nearest[tile]
    }
}

/// Gives each tile the nearest seeds on either side: the labels of contours that are each other's best.
///
/// - `least`: the least disparity.
#[cfg(haarline_dsp)]
#[inline(always)]
fn spread(nearest: &mut [[u16; 2]], contours: &[Contour], candidates: &[Contour], least: i32) {
    // From right to left: of the tiles up to the next seed.
    let (mut end, mut next) = (nearest.len(), NONE);
    for (i, contour) in contours.iter().enumerate().rev() {
        let tile = contour.column() / 8;
        if tile < end
            && let Some(other) = candidates.get(contour.partner as usize)
            && other.partner & 0xff == i as u32
        {
            let label = (contour.column() as i32 - other.column() as i32 - least) as u16;
            fill(&mut nearest[tile..end], [label, next]);
            nearest[tile] = [label; 2];
            (end, next) = (tile, label);
        }
    }
    fill(&mut nearest[..end], [NONE, next]);
}

/// The same without branches, which nobody could foresee: the seeds are put where they are, and taken along from there.
#[cfg(not(haarline_dsp))]
fn spread(nearest: &mut [[u16; 2]], contours: &[Contour], candidates: &[Contour], least: i32) {
    fill(nearest, [NONE; 2]);
    if let Some(last) = candidates.len().checked_sub(1) {
        for (i, contour) in (0..).zip(contours) {
            let (partner, tile) = (contour.partner as usize, contour.column() / 8);
            let other = candidates[partner.min(last)];
            let label = (contour.column() as i32 - other.column() as i32 - least) as u16;
            if let Some(seed) = nearest.get_mut(tile) {
                let is_mutual = (partner <= last) & (other.partner & 0xff == i);
                seed[0] = choose(is_mutual, label, seed[0]);
            }
        }
    }
    let taken_along = |from: u16, seed: u16| choose(seed == NONE, from, seed);
    let mut next = NONE;
    for tile in nearest.iter_mut().rev() {
        next = taken_along(next, tile[0]);
        tile[1] = next;
    }
    let mut last = NONE;
    for tile in nearest {
        last = taken_along(last, tile[0]);
        tile[0] = last;
    }
}

/// Gives tiles the same seeds.
#[inline(never)]
fn fill(tiles: &mut [[u16; 2]], seeds: [u16; 2]) {
    for tile in tiles {
        *tile = seeds;
    }
}

/// Two rows whose mean is that of four.
#[inline(never)]
fn means_of_four<const WORDS: usize>([a, b, c, d]: [&Row<WORDS>; 4], words: usize) -> [Row<WORDS>; 2] {
    let mut means = [[0; WORDS]; 2];
    let [middle, outer] = &mut means;
    for word in 0..words.min(WORDS) {
        middle[word] = signed_halved_sum(b[word], c[word]);
        outer[word] = signed_halved_sum(a[word], d[word]);
    }
    means
}

/// Takes the strongest response of each tile, if it reaches `threshold`; how many there are.
#[inline(never)]
fn find<const WORDS: usize>(
    rows: [&Row<WORDS>; 2],
    words: usize,
    falling: bool,
    threshold: u32,
    contours: &mut [Contour],
) -> usize {
    let mut len = 0;
    let mut keep = |column: u32, strength: u32| {
        // But for Cortex-M it costs less to write one too many than to branch.
        let is_strong = strength >= threshold;
        if (is_strong || cfg!(not(haarline_dsp)))
            && let Some(contour) = contours.get_mut(len)
        {
            *contour = Contour { place: column << 16 | strength, partner: u32::MAX };
            len += usize::from(is_strong);
        }
    };
    #[cfg(haarline_sse2)]
    let done = haar_peaks_of_pairs(rows, words, falling, &mut keep);
    #[cfg(not(haarline_sse2))]
    let done = 0;
    let mut column = 8 * done as u32;
    haar_responses(rows, words, falling, done, |[a, b]| {
        let most = greatest(max(a, b));
        let strength = most & 0xff;
        if strength >= threshold {
            let first = select_ge(a, most, ONES, 0);
            let second = select_ge(b, most, ONES, 0);
            let offset = if first != 0 { first.trailing_zeros() / 8 } else { 4 + second.trailing_zeros() / 8 };
            keep(column + offset, strength);
        }
        column += 8;
    });
    len
}

/// The two rows in the middle of a tile.
fn middle<const WORDS: usize>([_, middle @ .., _]: &[Row<WORDS>; 4]) -> &[Row<WORDS>; 2] {
    middle
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_tile_has_the_nearest_seeds() {
        const TILES: usize = 20;
        let mut seed = 1_u32;
        let mut next = || crate::random::next(&mut seed) >> 4;
        for _ in 0..300 {
            let right: [Contour; 16] = core::array::from_fn(|i| Contour {
                place: (2 * i as u32) << 16,
                partner: (next() << 8) | (next() % 12),
            });
            let left: [Contour; 12] = core::array::from_fn(|i| {
                let column = 40 + 8 * i as u32 + next() % 8;
                Contour { place: column << 16, partner: if next() % 2 == 0 { NOBODY } else { next() % 16 } }
            });
            let (left, right) = (&left[..next() as usize % 13], &right[..next() as usize % 17]);
            let mut seeds = [NONE; TILES];
            for (i, contour) in left.iter().enumerate() {
                let other = right.get(contour.partner as usize).filter(|other| other.partner & 0xff == i as u32);
                if let Some(other) = other {
                    seeds[contour.column() / 8] = (contour.column() + 2 - other.column()) as u16;
                }
            }
            let mut nearest = [[7; 2]; TILES];
            spread(&mut nearest, left, right, -2);
            for (tile, nearest) in nearest.iter().enumerate() {
                let is_seed = |label: &&u16| **label != NONE;
                let before = seeds[..=tile].iter().rev().find(is_seed);
                let after = seeds[tile..].iter().find(is_seed);
                assert_eq!(*nearest, [before, after].map(|label| label.copied().unwrap_or(NONE)));
            }
        }
    }
}
