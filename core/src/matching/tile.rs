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
use crate::lanes::{saturated_byte, saturated_halves};

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
    /// What four labels cost each of the four cells, a label a lane.
    ///
    /// - `cells`: for each label the sums of the cells, two in a word: the upper and the lower ones.
    /// - `tile`: for each label the sum of the tile.
    fn of(self, cells: [[u32; 2]; 4], tile: [u32; 4]) -> [u32; 4];
}

/// The cell's own sum, divided by 2 to this power.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OwnCost {
    pub(crate) shift: u32,
}

/// `(cell * its own sum + tile * the tile's sum) / 256`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SharedCost {
    pub(crate) cell: u32,
    pub(crate) tile: u32,
}

impl CellCost for OwnCost {
    #[inline(always)]
    fn of(self, [a, b, c, d]: [[u32; 2]; 4], _: [u32; 4]) -> [u32; 4] {
        let keep = (0xffff >> self.shift) * 0x0001_0001;
        let row = |row: usize| {
            let cost = |cells: [u32; 2]| saturated_halves(cells[row] >> self.shift & keep);
            let (first, second) = (cost(a) | cost(b) << 8, cost(c) | cost(d) << 8);
            [first & 0xffff | second << 16, first >> 16 | second & 0xffff_0000]
        };
        let ([a, b], [c, d]) = (row(0), row(1));
        [a, b, c, d]
    }
}

impl CellCost for SharedCost {
    #[inline(always)]
    fn of(self, [a, b, c, d]: [[u32; 2]; 4], tile: [u32; 4]) -> [u32; 4] {
        let [e, f, g, h] = tile.map(|sum| self.tile * sum);
        let cost = |own: u32, shared: u32| saturated_byte(self.cell * own + shared);
        let low = |row: usize| {
            let own = |cells: [u32; 2]| cells[row] & 0xffff;
            cost(own(a), e) | cost(own(b), f) << 8 | cost(own(c), g) << 16 | cost(own(d), h) << 24
        };
        let high = |row: usize| {
            let own = |cells: [u32; 2]| cells[row] >> 16;
            cost(own(a), e) | cost(own(b), f) << 8 | cost(own(c), g) << 16 | cost(own(d), h) << 24
        };
        [low(0), high(0), low(1), high(1)]
    }
}

/// The four labels of a tile, ascending, and what each costs each of its cells.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Tile {
    /// A label a lane. Where there are fewer than four, the last is repeated at a cost of 255.
    pub(crate) labels: u32,
    /// Costs of the cells: upper left, upper right, lower left, lower right.
    pub(crate) costs: [u32; 4],
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
    pub(crate) fn search(
        &self,
        trials: &mut Trials<WORDS>,
        tile: usize,
        hypotheses: [u32; 6],
        left: u32,
        above: u32,
    ) -> Tile {
        // Label 0 would begin at this byte of the right row; the window may lie in the margins, not beyond.
        let origin = 8 * tile as i32 + 4 - self.min_disparity;
        let lowest = (origin - self.columns).max(0).cast_unsigned();
        let Ok(highest) = u32::try_from(origin.min(self.num_disparities - 1)) else { return Tile::NOWHERE };
        if highest < lowest {
            return Tile::NOWHERE;
        }
        trials.start(tile, origin as usize, lowest, highest);
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
            return search.search_at_end(lowest, highest);
        }
        let tried = search.trials.len();
        let [before, after] = [label - 1, label + 1].map(|label| search.trials.place_of(label));
        search.trials.evaluate(tried, self.left, self.right);
        let [before, after] = [before, after].map(|place| search.trials.at(place).key);
        search.consider(before);
        search.consider(after);
        let second = search.best;
        if second == start {
            return search.keep(start, before, after);
        }
        search.step_downhill(start, [before, after], lowest, highest)
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

    /// Makes a trial the best if it is.
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
    fn step_downhill(&mut self, start: u32, [before, _]: [u32; 2], lowest: u32, highest: u32) -> Tile {
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
    fn search_at_end(&mut self, lowest: u32, highest: u32) -> Tile {
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

    /// The best, those one step before and after it, and the cheapest of the others.
    #[inline(always)]
    fn keep(&self, best: u32, before: u32, after: u32) -> Tile {
        let three = Trial::label_of(best) * 0x0001_0101 + 0x0001_0000 - 1;
        // These three are on the list.
        let other = if self.trials.len() == 3 { u32::MAX } else { self.cheapest_beside(best) };
        if other == u32::MAX {
            // The last label again, at a cost that nobody takes.
            let labels = three | Trial::label_of(after) << 24;
            let costs = self.costs([before, best, after, after]).map(|costs| costs | 0xff00_0000);
            return Tile { labels, costs, best: Trial::label_of(best) };
        }
        let (labels, keys) = if Trial::label_of(other) < Trial::label_of(best) {
            (Trial::label_of(other) | three << 8, [other, before, best, after])
        } else {
            (three | Trial::label_of(other) << 24, [before, best, after, other])
        };
        Tile { labels, costs: self.costs(keys), best: Trial::label_of(best) }
    }

    /// The trial of the least sum more than a step from the best; the first of equals; [`u32::MAX`] if there is none.
    #[inline(always)]
    fn cheapest_beside(&self, best: u32) -> u32 {
        let mut other = u32::MAX;
        for &Trial { key, .. } in self.trials.list() {
            if Trial::label_of(key).wrapping_sub(Trial::label_of(best)).wrapping_add(1) > 2 {
                other = other.min(key);
            }
        }
        other
    }

    /// The same where not both may be known.
    #[cold]
    #[inline(never)]
    fn keep_few(&self, best: u32, [before, after]: [Option<u32>; 2]) -> Tile {
        let (below, above) = match self.cheapest_beside(best) {
            u32::MAX => (None, None),
            other if Trial::label_of(other) < Trial::label_of(best) => (Some(other), None),
            other => (None, Some(other)),
        };
        let mut labels = 0;
        let mut keys = [best; 4];
        let mut len = 0;
        for key in [below, before, Some(best), after, above].into_iter().flatten() {
            labels |= Trial::label_of(key) << (8 * len);
            keys[len % 4] = key;
            len += 1;
        }
        let (mut beyond, last) = (0, Trial::label_of(keys[(len - 1) % 4]));
        for i in len..4 {
            labels |= last << (8 * i);
            beyond |= 0xff << (8 * i);
        }
        Tile { labels, costs: self.costs(keys).map(|costs| costs | beyond), best: Trial::label_of(best) }
    }

    /// What the labels of four trials cost each of the four cells.
    #[inline(always)]
    fn costs(&self, keys: [u32; 4]) -> [u32; 4] {
        let cells = keys.map(|key| self.trials.of(key).cells);
        self.row.settings.cost.of(cells, keys.map(Trial::sum_of))
    }
}

impl Tile {
    /// A tile that no label suits.
    const NOWHERE: Self = Self { labels: 0, costs: [u32::MAX; 4], best: 0 };
}

impl<C> TileSettings<C> {
    /// What a label pays for not being that of a neighbour; nothing if there is none.
    #[inline(always)]
    fn lean(&self, to: u32, label: u32) -> u32 {
        match to.abs_diff(label) {
            0 => 0,
            1 => self.near,
            _ => self.far,
        }
    }
}
