//! Blocks of 8 x 4 px, each with the disparity that the extremum search finds along its cost: the paper's sections 4 and 5.
//!
//! A label is a disparity less the least one searched, 0 to 255, as in [`tile`](crate::matching::tile).
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "columns are below 1280, labels below 256"
)]

use crate::Config;
use crate::answer::cell::{Cell, HALF};
use crate::answer::cell_row::TileCells;
use crate::front_end::camera_view::Row;
use crate::front_end::noise::SmoothingLevel;
use crate::lanes::windows::tile_sad;
use crate::lanes::{limited_to_byte, quotient};
use crate::matching::extremum::{FRAC_BITS, Method, Minimum, Settings, descend};

/// Support of the first start where no extremum is registered, the paper's s_1: costs, half of them on each side.
const FIRST_SUPPORT: u8 = 6;
/// Least height of an extremum that is registered, the paper's A_1: sums over the block.
const LEAST_HEIGHT: i32 = 1;
/// Most steps of a search, the paper's limit of iterations.
const LIMIT: u16 = 12;
/// Most disparities that a block evaluates: the starts, the supports around them and around every step, and two of its
/// neighbours. A power of two, so that a mask keeps within it.
const MOST: usize = 64;
/// Greatest margin that counts, in the units of a cell's cost.
const MOST_MARGIN: i32 = 64;
/// No label: nothing comes near it.
const NOBODY: u32 = u32::MAX / 2;

/// What the search of the blocks is told.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BlockSettings {
    /// What a start pays for lying one step from the left or the upper block.
    pub(crate) near: i32,
    /// The same for lying further away.
    pub(crate) far: i32,
    /// Whether the extremum search goes on from the best start.
    pub(crate) extremum: bool,
}

impl BlockSettings {
    pub(crate) fn of(level: SmoothingLevel, extremum: bool) -> Self {
        let (near, far) = match level {
            SmoothingLevel::Off | SmoothingLevel::Light => (4, 24),
            SmoothingLevel::Medium | SmoothingLevel::Strong => (24, 96),
        };
        Self { near, far, extremum }
    }
}

/// What was evaluated of a block.
struct Trials {
    /// Sum over the block; label.
    tried: [(u16, u8); MOST],
    len: usize,
    /// For each label the block that tried it last, from 1 on, and its place in the list: 10 and 6 bits.
    places: [u16; 256],
}

impl Trials {
    const fn new() -> Self {
        Self { tried: [(0, 0); MOST], len: 0, places: [0; 256] }
    }

    /// The sum of a label; evaluated now if it was not before.
    #[inline(always)]
    fn sum(&mut self, block: usize, label: u32, evaluate: impl FnOnce() -> u32) -> i32 {
        let place = self.places[label as usize % 256] as usize;
        if place / MOST == block + 1 {
            return i32::from(self.tried[place % MOST].0);
        }
        let sum = evaluate();
        // One beyond the room would be evaluated again if it was asked for again, and has no say in the margin.
        if self.len < MOST {
            self.places[label as usize % 256] = ((block + 1) * MOST + self.len) as u16;
            self.tried[self.len] = (sum as u16, label as u8);
            self.len += 1;
        }
        sum as i32
    }

    /// The least sum more than a step from a label.
    fn least_beyond(&self, label: u32) -> Option<i32> {
        let mut least = u16::MAX;
        for &(sum, other) in &self.tried[..self.len.min(MOST)] {
            if u32::from(other).wrapping_sub(label).wrapping_add(1) > 2 {
                least = least.min(sum);
            }
        }
        (least != u16::MAX).then_some(i32::from(least))
    }
}

/// A row of blocks in both views.
pub(crate) struct BlockRow<'a, const WORDS: usize> {
    left: &'a [Row<WORDS>; 4],
    right: &'a [Row<WORDS>; 4],
    /// Columns of a row, rounded up to words.
    columns: i32,
    min_disparity: i32,
    num_disparities: i32,
    settings: BlockSettings,
}

/// Where the labels of a block begin.
#[derive(Clone, Copy)]
struct Place {
    block: usize,
    /// The byte of the right row that label 0 begins at.
    origin: usize,
    /// The labels whose windows lie in the right view or its margins.
    lowest: u32,
    highest: u32,
}

impl<'a, const WORDS: usize> BlockRow<'a, WORDS> {
    pub(crate) fn new(
        config: &Config,
        left: &'a [Row<WORDS>; 4],
        right: &'a [Row<WORDS>; 4],
        settings: BlockSettings,
    ) -> Self {
        Self {
            left,
            right,
            columns: i32::from(config.width.div_ceil(4) * 4),
            min_disparity: i32::from(config.min_disparity),
            num_disparities: i32::from(config.num_disparities),
            settings,
        }
    }

    /// Decides the blocks of the row, from left to right, and then the cells at jumps between them.
    ///
    /// - `seeds`: labels of a block's nearest contours; `above`: those of the cells above the row, a pair a block.
    #[inline(never)]
    pub(crate) fn decide(&self, seeds: impl Fn(usize) -> [u32; 2], above: &[[u8; 2]], cells: TileCells<'_>) {
        let mut trials = Trials::new();
        let mut left = NOBODY;
        for block in 0..cells.label.len() {
            let up = above.get(block).map_or(NOBODY, |pair| u32::from(pair[0]));
            let [a, b] = seeds(block);
            let cell = self.place(block).map_or(Cell::default(), |place| {
                let found = self.search(place, &mut trials, [a, b, up, left], [left, up]);
                rate(&trials, &found)
            });
            left = u32::from(cell.label);
            cells.value[block] = [cell.value; 2];
            cells.label[block] = [cell.label; 2];
            cells.merit[block] = [cell.merit; 2];
        }
        self.choose_surfaces(above, cells);
    }

    /// Where the labels of a block begin; `None` if none lies in the right view.
    fn place(&self, block: usize) -> Option<Place> {
        let origin = 8 * block as i32 + 4 - self.min_disparity;
        let lowest = (origin - self.columns).max(0);
        let highest = origin.min(self.num_disparities - 1);
        (lowest <= highest).then_some(Place {
            block,
            origin: origin as usize,
            lowest: lowest as u32,
            highest: highest as u32,
        })
    }

    /// Sums of absolute differences of the two cells of a block.
    #[inline(always)]
    fn cells(&self, place: Place, label: u32) -> [u32; 2] {
        let [a, b, c, d] =
            tile_sad(self.left, 2 * place.block + 1, self.right, place.origin.wrapping_sub(label as usize));
        [a + c, b + d]
    }

    #[inline(never)]
    fn evaluate(&self, place: Place, label: u32) -> u32 {
        crate::count::evaluations(1);
        let [a, b] = self.cells(place, label);
        a + b
    }

    /// The extremum of a block's cost, from the best of the `starts` on.
    fn search(&self, place: Place, trials: &mut Trials, starts: [u32; 4], neighbours: [u32; 2]) -> Minimum {
        trials.len = 0;
        let range = place.lowest..=place.highest;
        let mut cost = |label: i32| {
            let label = label as u32;
            range.contains(&label).then(|| trials.sum(place.block, label, || self.evaluate(place, label)))
        };
        let price = |sum: i32, label: u32| sum + neighbours.iter().map(|&other| self.lean(other, label)).sum::<i32>();
        let mut best = None;
        let mut least = i32::MAX;
        for start in starts {
            let Some(sum) = cost(start as i32) else { continue };
            let priced = price(sum, start);
            if priced < least {
                (least, best) = (priced, Some((start as i32, sum)));
            }
        }
        let (start, sum) = best.unwrap_or_else(|| {
            let middle = i32::midpoint(place.lowest as i32, place.highest as i32);
            (middle, cost(middle).unwrap_or(0))
        });
        if !self.settings.extremum {
            return Minimum { at: start, cost: sum, before: None, after: None };
        }
        // Shortest support, two samples: most extrema are registered at once.
        let nearest = descend(start, sum, 1, &mut cost);
        if Self::is_registered(&nearest) {
            return nearest;
        }
        let Some(farther) = search_far(start, [place.lowest, place.highest], &mut cost) else { return nearest };
        let price = |end: &Minimum| price(end.cost, end.at as u32);
        if price(&farther) < price(&nearest) { farther } else { nearest }
    }

    /// What a start pays for not being the label of a neighbour; nothing if there is none.
    #[inline(always)]
    fn lean(&self, neighbour: u32, label: u32) -> i32 {
        match neighbour.abs_diff(label) {
            0 => 0,
            1 => self.settings.near,
            2..256 => self.settings.far,
            _ => 0,
        }
    }

    /// Whether both ends of the bracket (eq. 9) are known and rise by A_1.
    fn is_registered(minimum: &Minimum) -> bool {
        let rises = |end: Option<i32>| end.is_some_and(|end| end - minimum.cost >= LEAST_HEIGHT);
        rises(minimum.before) && rises(minimum.after)
    }

    /// Where the surfaces of neighbouring blocks differ, their cells there take the one that fits clearly better.
    #[inline(never)]
    fn choose_surfaces(&self, above: &[[u8; 2]], mut cells: TileCells<'_>) {
        let mut before = None;
        for block in 0..cells.label.len() {
            let own = u32::from(cells.label[block][1]);
            if let Some(left) = before
                && jumps(left, own)
            {
                self.take(block - 1, left, own, [1], &mut cells);
                self.take(block, own, left, [0], &mut cells);
            }
            before = Some(own);
            if let Some(&[up, _]) = above.get(block)
                && jumps(up.into(), own)
            {
                self.take(block, own, up.into(), [0, 1], &mut cells);
            }
        }
    }

    /// Gives the cells in some columns of a block that have its own label the one of another surface, where it fits clearly
    /// better.
    fn take<const N: usize>(&self, block: usize, own: u32, other: u32, columns: [usize; N], cells: &mut TileCells<'_>) {
        let Some([of_own, of_other]) = self.compare(block, own, other) else { return };
        for column in columns {
            if u32::from(cells.label[block][column]) == own && 2 * of_other[column] < of_own[column] {
                cells.label[block][column] = other as u8;
                cells.value[block][column] = ((other << 8) + HALF) as u16;
            }
        }
    }

    /// The sums of a block's cells at two labels.
    fn compare(&self, block: usize, own: u32, other: u32) -> Option<[[u32; 2]; 2]> {
        let place = self.place(block)?;
        let range = place.lowest..=place.highest;
        (range.contains(&own) && range.contains(&other)).then(|| [self.cells(place, own), self.cells(place, other)])
    }
}

/// Whether the surfaces of two labels differ.
const fn jumps(a: u32, b: u32) -> bool {
    a.abs_diff(b) > 1
}

/// The proposed search from `start` over the whole labels of `domain`; `None` if that is shorter than the first support.
#[cold]
#[inline(never)]
fn search_far(start: i32, domain: [u32; 2], mut cost: impl FnMut(i32) -> Option<i32>) -> Option<Minimum> {
    let whole = |label: i32| label << FRAC_BITS;
    let nearest = |coordinate: i32| (coordinate + whole(1) / 2) >> FRAC_BITS;
    let settings = Settings {
        start: [whole(start)],
        first_support: FIRST_SUPPORT,
        support_increment: 0,
        least_height: LEAST_HEIGHT,
        limit: LIMIT,
        ..Settings::new([whole(domain[0] as i32)], [whole(domain[1] as i32)])
    };
    let found = settings.build().ok()?.run(Method::Proposed, |&[coordinate]| cost(nearest(coordinate)));
    let at = nearest(found.at[0]);
    let here = cost(at)?;
    Some(descend(at, here, 1, cost))
}

/// The answer of the cells of a block: its label, the fraction of a V through the sums around it, and how far it stands
/// out from the sums of other surfaces.
fn rate(trials: &Trials, found: &Minimum) -> Cell {
    let label = found.at as u32;
    let fraction = match (found.before, found.after) {
        (Some(before), Some(after)) if before.max(after) > found.cost => {
            quotient((before - after) * 128, before.max(after) - found.cost).clamp(-128, 127)
        }
        _ => 0,
    };
    // A cell has a half of the block's pixels, and a quarter of its sum is its cost.
    let margin = trials.least_beyond(label).map_or(MOST_MARGIN, |rival| ((rival - found.cost) / 8).min(MOST_MARGIN));
    let merit = limited_to_byte(128 + margin - 2 * (found.cost / 8));
    Cell { label: label as u8, value: ((label << 8) + HALF).wrapping_add_signed(fraction) as u16, merit: merit as u8 }
}
