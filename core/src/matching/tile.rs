//! A tile of 8 x 4 px: its hypotheses, the extremum search among them, and the four labels that its cells choose from.
//!
//! A label is a disparity less the least one searched, 0 to 255, so that it fits a byte.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "columns are below 1280, labels below 256"
)]

use crate::Config;
use crate::front_end::camera_view::Row;
use crate::lanes::trials::{Trial, Trials};
use crate::lanes::windows::tile_sads_around;
use crate::lanes::{choose, saturated_halves, splat_half, unseen};
use crate::matching::settled::SettledTile;

/// By how much the sum of a tile must be less than those a step beside it.
const CLEAR: u32 = 4;
/// A label whose sum is so much more than the least is not kept beside it.
const DEAR: u32 = 240;
/// What stands for no seed among the hypotheses.
const NO_SEED: u32 = u16::MAX as u32;

/// What the search of the tiles is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TileSettings<C> {
    pub(crate) cost: C,
    /// What the tile pays for a label one from that of its left or upper neighbour.
    pub(crate) near: u32,
    /// The same for a label further away.
    pub(crate) far: u32,
    /// Whether the extremum step is taken.
    pub(crate) extremum: bool,
}

/// What a label costs a cell, at most 255.
pub trait CellCost: Copy {
    /// What a label costs two cells side by side, in halves.
    ///
    /// - `cells`: their sums, in halves; `tile`: the sum of the tile.
    fn of(self, cells: u32, tile: u32) -> u32;
}

/// The cell's own sum, divided by 2 to this power.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OwnCost {
    pub(crate) shift: u32,
}

/// `(cell * its own sum + tile * the tile's sum) / 64`. The sum fits 16 bits, as those of limited features over a tile are below
/// 2000.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SharedCost {
    pub(crate) cell: u32,
    pub(crate) tile: u32,
}

impl CellCost for OwnCost {
    #[inline(always)]
    fn of(self, cells: u32, _: u32) -> u32 {
        saturated_halves(cells >> self.shift & splat_half(0xffff >> self.shift))
    }
}

impl CellCost for SharedCost {
    #[inline(always)]
    fn of(self, cells: u32, tile: u32) -> u32 {
        let shared = splat_half(self.tile).wrapping_mul(tile);
        saturated_halves(self.cell.wrapping_mul(cells).wrapping_add(shared) >> 6 & 0x03ff_03ff)
    }
}

/// What the search found of a tile of so many rows of cells.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Found<const ROWS: usize> {
    Settled(SettledTile<ROWS>),
    Open(Tile<ROWS>),
}

impl<const ROWS: usize> Found<ROWS> {
    /// The label of the least cost of the tile.
    #[inline(always)]
    pub(crate) const fn best(&self) -> u32 {
        match self {
            Self::Settled(SettledTile { label, .. }) => *label,
            Self::Open(Tile { best, .. }) => *best,
        }
    }
}

/// The four labels of a tile, ascending, and what each costs each of its cells.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile<const ROWS: usize> {
    /// A label a lane. Where there are fewer than four, the last is repeated at a cost of 255.
    pub(crate) labels: u32,
    /// Costs of the cells, left and right, row by row.
    pub(crate) costs: [[u32; 2]; ROWS],
    /// The label of the least cost of the tile.
    pub(crate) best: u32,
}

/// The features of a row of tiles in both views, and what is searched in them.
#[derive(Clone, Copy)]
pub(crate) struct TileRow<'a, C, const WORDS: usize> {
    pub(crate) left: &'a [Row<WORDS>; 4],
    pub(crate) right: &'a [Row<WORDS>; 4],
    /// Columns of a row, rounded up to words.
    columns: i32,
    min_disparity: i32,
    num_disparities: i32,
    settings: TileSettings<C>,
}

impl<'a, C: CellCost, const WORDS: usize> TileRow<'a, C, WORDS> {
    pub(crate) fn new(
        config: &Config,
        left: &'a [Row<WORDS>; 4],
        right: &'a [Row<WORDS>; 4],
        settings: TileSettings<C>,
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

    /// Decides the labels of a tile.
    ///
    /// - `trials`: of the tiles before in this row.
    /// - `hypotheses`: labels to try; those outside the search or the right view are passed over.
    /// - `left`, `above`: what the neighbours decided; more than 255 where there is none.
    #[inline(always)]
    pub(crate) fn search<const ROWS: usize>(
        &self,
        trials: &mut Trials<WORDS>,
        tile: usize,
        hypotheses: [u32; 6],
        left: u32,
        above: u32,
    ) -> Found<ROWS> {
        // Label 0 would begin at this byte of the right row; the window may lie in the margins, not beyond.
        let origin = 8 * tile as i32 + 4 - self.min_disparity;
        let lowest = (origin - self.columns).max(0).cast_unsigned();
        let Ok(highest) = u32::try_from(origin.min(self.num_disparities - 1)) else {
            return Found::Open(Tile::NOWHERE);
        };
        if highest < lowest {
            return Found::Open(Tile::NOWHERE);
        }
        let three = match self.try_around(tile, origin as usize, [lowest, highest], hypotheses, [left, above]) {
            Some(three) => three,
            None => match self.try_all(trials, tile, origin as usize, [lowest, highest], hypotheses, [left, above]) {
                Ok(three) => three,
                Err(few) => return Found::Open(few),
            },
        };
        self.settings.keep(trials, &three)
    }

    /// Tries all hypotheses of a tile: the best label, if those one step beside it are known, too; else what is kept.
    #[inline(always)]
    fn try_all<const ROWS: usize>(
        &self,
        trials: &mut Trials<WORDS>,
        tile: usize,
        origin: usize,
        [lowest, highest]: [u32; 2],
        hypotheses: [u32; 6],
        [left, above]: [u32; 2],
    ) -> Result<Three, Tile<ROWS>> {
        trials.start(tile, origin, lowest, highest);
        for label in hypotheses {
            trials.add(label);
        }
        if trials.len() == 0 {
            trials.add((lowest + highest) / 2);
        }
        trials.evaluate(0, self.left, self.right);
        let mut search = Search { row: self, trials, left, above, best: 0, least: u32::MAX };
        for i in 0..search.trials.len() {
            search.consider(search.trials.at(i).key);
        }
        // The extremum search with its shortest support: the costs one step before and one after, and a step downhill.
        let start = search.best;
        let label = Trial::label_of(start);
        if label <= lowest || label >= highest || !self.settings.extremum {
            return Err(search.search_at_end(lowest, highest));
        }
        let tried = search.trials.len();
        let [before, after] = [label - 1, label + 1].map(|label| search.trials.place_of(label));
        search.trials.evaluate(tried, self.left, self.right);
        let [before, after] = [before, after].map(|place| search.trials.at(place).key);
        search.consider(before);
        search.consider(after);
        let second = search.best;
        if second == start {
            let keys = [before, start, after];
            return Ok(Three {
                label,
                cells: keys.map(|key| search.trials.of(key).cells),
                sums: keys.map(Trial::sum_of),
                // These three are on the list.
                other: if search.trials.len() == 3 { u32::MAX } else { search.cheapest_beside(start) },
            });
        }
        Err(search.step_downhill(start, [before, after], lowest, highest))
    }

    /// Tries the label of the left neighbour and those one step beside it, where all hypotheses are among these three: what
    /// [`Self::try_all`] would find, if it is the best of them.
    #[inline(always)]
    fn try_around(
        &self,
        tile: usize,
        origin: usize,
        [lowest, highest]: [u32; 2],
        hypotheses: [u32; 6],
        [label, above]: [u32; 2],
    ) -> Option<Three> {
        let [_, second, after, _, seeds @ ..] = hypotheses;
        let before = label.wrapping_sub(1);
        let is_near = |other: u32| other.wrapping_sub(before) <= 2;
        let is_near_seed = |seed: u32| is_near(seed) || seed == NO_SEED;
        if !is_near(above)
            || label <= lowest
            || label >= highest
            || !(is_near(second) && is_near(after) && seeds.into_iter().all(is_near_seed) && self.settings.extremum)
        {
            return None;
        }
        crate::count::evaluations(3);
        let first = 2 * tile + 1;
        let [more, same, less] = tile_sads_around(self.left, first, self.right, origin - label as usize - 1);
        let [more_sum, sum, less_sum] = [more, same, less].map(|[upper, lower]| {
            let both = upper + lower;
            (both & 0xffff) + (both >> 16)
        });
        // The left neighbour has this label, the upper one may have one beside it.
        let TileSettings { near, far, .. } = self.settings;
        let [less_pays, pays, more_pays] = match above.wrapping_sub(label) {
            0 => [2 * near, 0, 2 * near],
            1 => [near + far, near, near],
            _ => [near, near, near + far],
        };
        if sum + pays >= (less_sum + less_pays).min(more_sum + more_pays) {
            return None;
        }
        Some(Three { label, cells: [less, same, more], sums: [less_sum, sum, more_sum], other: u32::MAX })
    }
}

/// The search of one tile.
struct Search<'a, C, const WORDS: usize> {
    row: &'a TileRow<'a, C, WORDS>,
    trials: &'a mut Trials<WORDS>,
    /// What the neighbours decided.
    left: u32,
    above: u32,
    /// The best trial so far, and its sum with what it pays for its neighbours.
    best: u32,
    least: u32,
}

impl<C: CellCost, const WORDS: usize> Search<'_, C, WORDS> {
    /// The trial of a label, after trying it if that was not done.
    #[inline(never)]
    fn at(&mut self, label: u32) -> u32 {
        let tried = self.trials.len();
        let place = self.trials.place_of(label);
        self.trials.evaluate(tried, self.row.left, self.row.right);
        self.trials.at(place).key
    }

    /// Makes a trial the best if it is, without a branch: which it is nobody could foresee.
    #[cfg(not(haarline_dsp))]
    #[inline(always)]
    fn consider(&mut self, key: u32) {
        let settings = &self.row.settings;
        let label = Trial::label_of(key);
        let sum = Trial::sum_of(key) + settings.lean(self.left, label) + settings.lean(self.above, label);
        let is_better = sum < self.least;
        self.least = choose(is_better, sum, self.least);
        self.best = choose(is_better, key, self.best);
    }

    /// Makes a trial the best if it is.
    #[cfg(haarline_dsp)]
    #[inline(always)]
    fn consider(&mut self, key: u32) {
        let settings = &self.row.settings;
        // What is no better before it pays for its neighbours is none afterwards.
        if Trial::sum_of(key) < self.least {
            let label = Trial::label_of(key);
            let sum = Trial::sum_of(key) + settings.lean(self.left, label) + settings.lean(self.above, label);
            if sum < self.least {
                (self.least, self.best) = (sum, key);
            }
        }
    }

    /// One more step from the trial before or after `start`, where that is better.
    #[inline(never)]
    fn step_downhill<const ROWS: usize>(
        &mut self,
        start: u32,
        [before, _]: [u32; 2],
        lowest: u32,
        highest: u32,
    ) -> Tile<ROWS> {
        let second = self.best;
        let is_down = second == before;
        let beyond = if is_down { Trial::label_of(second).wrapping_sub(1) } else { Trial::label_of(second) + 1 };
        if beyond < lowest || beyond > highest {
            return self.keep_few(second, if is_down { [None, Some(start)] } else { [Some(start), None] });
        }
        let next = self.at(beyond);
        self.consider(next);
        if self.best != second {
            // What lies beyond the last step is not looked at.
            return self.keep_few(next, if is_down { [None, Some(second)] } else { [Some(second), None] });
        }
        let (before, after) = if is_down { (next, start) } else { (start, next) };
        self.keep_few(second, [Some(before), Some(after)])
    }

    /// The extremum step, if it is taken at all, from a label at an end of the range.
    #[cold]
    #[inline(never)]
    fn search_at_end<const ROWS: usize>(&mut self, lowest: u32, highest: u32) -> Tile<ROWS> {
        if !self.row.settings.extremum {
            return self.keep_few(self.best, [None; 2]);
        }
        let start = self.best;
        let around = |key: u32| {
            let label = Trial::label_of(key);
            [(label > lowest).then(|| label - 1), (label < highest).then(|| label + 1)]
        };
        let mut sides = around(start).map(|label| label.map(|label| self.at(label)));
        for side in sides.into_iter().flatten() {
            self.consider(side);
        }
        if self.best != start {
            let second = self.best;
            let is_down = Trial::label_of(second) < Trial::label_of(start);
            let next = around(second)[usize::from(!is_down)].map(|label| self.at(label));
            sides = if is_down { [next, Some(start)] } else { [Some(start), next] };
            if let Some(next) = next {
                self.consider(next);
            }
            if self.best != second {
                sides = if is_down { [None, Some(second)] } else { [Some(second), None] };
            }
        }
        self.keep_few(self.best, sides)
    }

    /// The trial of the least sum more than a step from the best; the first of equals; [`u32::MAX`] if there is none.
    #[inline(never)]
    fn cheapest_beside(&self, best: u32) -> u32 {
        let nearest = Trial::label_of(best).wrapping_sub(1);
        let least = |other: u32, trial: &Trial| {
            if Trial::label_of(trial.key).wrapping_sub(nearest) > 2 { other.min(trial.key) } else { other }
        };
        let (twos, last) = unseen(self.trials.list()).as_chunks::<2>();
        let other = twos.iter().fold(u32::MAX, |other, two| unseen(two).iter().fold(other, least));
        last.iter().fold(other, least)
    }

    /// The same where not both may be known.
    #[cold]
    #[inline(never)]
    fn keep_few<const ROWS: usize>(&self, best: u32, [before, after]: [Option<u32>; 2]) -> Tile<ROWS> {
        let other = self.cheapest_beside(best);
        let is_below = Trial::label_of(other) < Trial::label_of(best);
        let (below, above) =
            ((other != u32::MAX && is_below).then_some(other), (other != u32::MAX && !is_below).then_some(other));
        let mut keys = [best; 4];
        let mut len = 0;
        for key in [below, before, Some(best), after, above].into_iter().flatten() {
            keys[len % 4] = key;
            len += 1;
        }
        let (mut labels, mut beyond) = (0, 0);
        for i in 0..4 {
            let last = i.min(len - 1);
            labels |= Trial::label_of(keys[last % 4]) << (8 * i);
            beyond |= if i == last { 0 } else { 0xff << (8 * i) };
        }
        let costs = keys.map(|key| self.row.settings.costs(self.trials.of(key).cells, Trial::sum_of(key)));
        Tile { labels, costs: by_cell(costs).map(|row| row.map(|costs| costs | beyond)), best: Trial::label_of(best) }
    }
}

impl<const ROWS: usize> Tile<ROWS> {
    /// A tile that no label suits.
    const NOWHERE: Self = Self { labels: 0, costs: [[u32::MAX; 2]; ROWS], best: 0 };
}

impl<C: CellCost> TileSettings<C> {
    /// What a label costs the cells of a tile, row by row, two in a word.
    ///
    /// - `cells`: the sums of the upper and the lower two rows of pixels; `tile`: of all four.
    #[inline(always)]
    fn costs<const ROWS: usize>(&self, [upper, lower]: [u32; 2], tile: u32) -> [u32; ROWS] {
        core::array::from_fn(|row| {
            let cells = match (ROWS, row) {
                (1, _) => upper + lower,
                (_, 0) => upper,
                _ => lower,
            };
            self.cost.of(cells, tile)
        })
    }

    /// Keeps the best, those one step beside it, and the cheapest of the others if it comes near.
    #[inline(always)]
    fn keep<const ROWS: usize, const WORDS: usize>(
        &self,
        trials: &Trials<WORDS>,
        &Three { label, cells, sums, other }: &Three,
    ) -> Found<ROWS> {
        let [a, b, c] = [0, 1, 2].map(|i| self.costs(cells[i], sums[i]));
        let three = label * 0x0001_0101 + 0x0001_0000 - 1;
        let [before, here, after] = sums;
        let (labels, costs) = if Trial::sum_of(other) >= here + DEAR {
            if before.min(after) >= here + CLEAR {
                return Found::Settled(SettledTile { label, costs: [a, b, c] });
            }
            // The last label again, at a cost that nobody takes.
            (three | (label + 1) << 24, [a, b, c, [0x00ff_00ff; ROWS]])
        } else {
            let fourth = self.costs(trials.of(other).cells, Trial::sum_of(other));
            if Trial::label_of(other) < label {
                (Trial::label_of(other) | three << 8, [fourth, a, b, c])
            } else {
                (three | Trial::label_of(other) << 24, [a, b, c, fourth])
            }
        };
        Found::Open(Tile { labels, costs: by_cell(costs), best: label })
    }
}

/// The best label of a tile.
struct Three {
    label: u32,
    /// The sums of the cells, for the label before it, itself and the one after it.
    cells: [[u32; 2]; 3],
    /// The same of the tile.
    sums: [u32; 3],
    /// The key of the cheapest trial more than a step away; [`u32::MAX`] if there is none.
    other: u32,
}

/// What each of four labels costs two cells in a row, a label a lane, in the order of the cells.
#[inline(always)]
fn by_cell<const ROWS: usize>([a, b, c, d]: [[u32; ROWS]; 4]) -> [[u32; 2]; ROWS] {
    core::array::from_fn(|row| {
        let (first, second) = (a[row] | b[row] << 8, c[row] | d[row] << 8);
        [first & 0xffff | second << 16, first >> 16 | second & 0xffff_0000]
    })
}

impl<C> TileSettings<C> {
    /// What a label pays for not being that of a neighbour; nothing if there is none.
    #[inline(always)]
    fn lean(&self, to: u32, label: u32) -> u32 {
        if cfg!(not(haarline_dsp)) {
            let distance = to.abs_diff(label);
            return choose(distance == 0, 0, choose(distance == 1, self.near, self.far));
        }
        match to.abs_diff(label) {
            0 => 0,
            1 => self.near,
            _ => self.far,
        }
    }
}
