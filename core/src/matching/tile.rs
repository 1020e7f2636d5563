//! A tile of 8 x 4 px: its hypotheses, the extremum search among them, and the four labels that its cells choose from.
//!
//! A label is a disparity less the least one searched, 0 to 255, so that it fits a byte.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "columns are below 1280, labels below 256"
)]

use crate::Config;
use crate::front_end::camera_view::Row;
use crate::lanes::rows::tile_sad;
use crate::lanes::saturated_byte;

/// Most disparities that a tile tries: seven hypotheses, and the steps of the extremum search.
const MOST: usize = 12;

/// What the search of the tiles is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TileSettings {
    /// A cell's cost is `(cell * its own sum + tile * the tile's sum) / 256`, at most 255.
    pub(crate) cell: u32,
    /// See `cell`.
    pub(crate) tile: u32,
    /// What the tile pays for a label one from that of its left or upper neighbour.
    pub(crate) near: u32,
    /// The same for a label further away.
    pub(crate) far: u32,
    /// Whether the extremum step is taken.
    pub(crate) extremum: bool,
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

/// A disparity that was tried.
#[derive(Clone, Copy)]
struct Trial {
    label: u32,
    /// Sum of the whole tile.
    sum: u32,
    /// Costs of the four cells.
    cells: u32,
}

/// What was tried of a tile, in this order, and which labels these are.
pub(crate) struct Trials {
    list: [Trial; MOST],
    len: usize,
    tried: [u32; 8],
}

impl Trials {
    pub(crate) const fn new() -> Self {
        Self { list: [Trial { label: 0, sum: 0, cells: 0 }; MOST], len: 0, tried: [0; 8] }
    }

    #[inline(always)]
    fn clear(&mut self) {
        (self.len, self.tried) = (0, [0; 8]);
    }

    #[inline(always)]
    fn as_slice(&self) -> &[Trial] {
        &self.list[..self.len.min(MOST)]
    }

    /// Whether a label, at most 255, was not tried yet; from now on it was.
    #[inline(always)]
    fn is_new(&mut self, label: u32) -> bool {
        let (word, bit) = (&mut self.tried[(label >> 5 & 7) as usize], 1 << (label & 31));
        let is_new = *word & bit == 0;
        *word |= bit;
        is_new
    }

    #[inline(always)]
    fn push(&mut self, trial: Trial) {
        if let Some(place) = self.list.get_mut(self.len) {
            *place = trial;
            self.len += 1;
        }
    }
}

/// The features of a row of tiles in both views, and what is searched in them.
#[derive(Clone, Copy)]
pub(crate) struct TileRow<'a, const WORDS: usize> {
    pub(crate) left: &'a [Row<WORDS>; 4],
    pub(crate) right: &'a [Row<WORDS>; 4],
    /// Words of a row, margins included.
    pub(crate) words: usize,
    pub(crate) min_disparity: i32,
    pub(crate) num_disparities: u32,
    pub(crate) settings: TileSettings,
}

impl<'a, const WORDS: usize> TileRow<'a, WORDS> {
    pub(crate) fn new(
        config: &Config,
        left: &'a [Row<WORDS>; 4],
        right: &'a [Row<WORDS>; 4],
        settings: TileSettings,
    ) -> Self {
        Self {
            left,
            right,
            words: crate::front_end::camera_view::words_for(usize::from(config.width)),
            min_disparity: i32::from(config.min_disparity),
            num_disparities: u32::from(config.num_disparities),
            settings,
        }
    }

    /// Decides the labels of a tile.
    ///
    /// - `hypotheses`: labels to try; those outside the search or the right view are passed over.
    /// - `left`, `above`: what the neighbours decided; more than 255 where there is none.
    #[inline(always)]
    pub(crate) fn search(&self, trials: &mut Trials, tile: usize, hypotheses: &[u32], left: u32, above: u32) -> Tile {
        trials.clear();
        // Label 0 would begin at this byte of the right row; the window may lie in the margins, not beyond.
        let origin = 8 * tile as i32 + 4 - self.min_disparity;
        let lowest = (origin - 4 * (self.words as i32 - 2)).max(0) as u32;
        let highest = origin.min(self.num_disparities as i32 - 1);
        if highest < lowest as i32 {
            return Tile { labels: 0, costs: [u32::MAX; 4], best: 0 };
        }
        let highest = highest as u32;
        let at = At { left: 2 * tile + 1, origin: origin as usize };
        for &label in hypotheses {
            if label.wrapping_sub(lowest) <= highest - lowest && trials.is_new(label) {
                trials.push(self.evaluate(at, label));
            }
        }
        if trials.len == 0 {
            let middle = (lowest + highest) / 2;
            trials.is_new(middle);
            trials.push(self.evaluate(at, middle));
        }
        let bias = |label: u32| self.settings.lean(left, label) + self.settings.lean(above, label);
        let mut best = trials.list[0];
        let mut least = u32::MAX;
        if trials.len > 1 {
            for &trial in trials.as_slice() {
                let sum = trial.sum + bias(trial.label);
                if sum < least {
                    (least, best) = (sum, trial);
                }
            }
        } else {
            least = best.sum + bias(best.label);
        }
        // The extremum search with its shortest support: the costs one step before and one after, and a step downhill.
        let mut sides = [None; 2];
        if self.settings.extremum {
            for step in 0..2 {
                let middle = best.label;
                sides = [middle.wrapping_sub(1), middle + 1]
                    .map(|label| (label.wrapping_sub(lowest) <= highest - lowest).then(|| self.at(trials, at, label)));
                let start = best;
                for side in sides.into_iter().flatten() {
                    let sum = side.sum + bias(side.label);
                    if sum < least {
                        (least, best) = (sum, side);
                    }
                }
                if best.label == start.label {
                    break;
                }
                if step == 1 {
                    // What lies beyond the last step is not looked at.
                    sides = if best.label < start.label { [None, Some(start)] } else { [Some(start), None] };
                }
            }
        }
        keep(trials, best, sides)
    }

    /// The trial of a label, after trying it if that was not done.
    #[inline(always)]
    fn at(&self, trials: &mut Trials, at: At, label: u32) -> Trial {
        if trials.is_new(label) {
            let trial = self.evaluate(at, label);
            trials.push(trial);
            return trial;
        }
        trials.as_slice().iter().find(|trial| trial.label == label).copied().unwrap_or(trials.list[0])
    }

    #[inline(always)]
    fn evaluate(&self, at: At, label: u32) -> Trial {
        crate::count::evaluations(1);
        let [a, b, c, d] = tile_sad(self.left, at.left, self.right, at.origin - label as usize);
        let sum = a + b + c + d;
        let shared = self.settings.tile * sum;
        let cost = |own: u32| saturated_byte(self.settings.cell * own + shared);
        Trial { label, sum, cells: cost(a) | cost(b) << 8 | cost(c) << 16 | cost(d) << 24 }
    }
}

/// Where a tile lies: its first word, and the byte of the right row that label 0 begins at.
#[derive(Clone, Copy)]
struct At {
    left: usize,
    origin: usize,
}

impl TileSettings {
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

/// The best, those one step before and after it, and the cheapest of the others.
#[inline(always)]
fn keep(trials: &Trials, best: Trial, sides: [Option<Trial>; 2]) -> Tile {
    let mut other: Option<Trial> = None;
    for &trial in trials.as_slice() {
        if trial.label.wrapping_sub(best.label).wrapping_add(1) > 2 && other.is_none_or(|other| trial.sum < other.sum) {
            other = Some(trial);
        }
    }
    let ([Some(before), Some(after)], best_label) = (sides, best.label) else { return keep_few(best, sides, other) };
    let three = best_label * 0x0001_0101 + 0x0001_0000 - 1;
    let (labels, rows) = match other {
        Some(other) if other.label < best_label => {
            (other.label | three << 8, [other.cells, before.cells, best.cells, after.cells])
        }
        Some(other) => (three | other.label << 24, [before.cells, best.cells, after.cells, other.cells]),
        // The last label again, at a cost that nobody takes.
        None => (three | after.label << 24, [before.cells, best.cells, after.cells, u32::MAX]),
    };
    Tile { labels, costs: transposed(rows), best: best_label }
}

/// The same at an end of the range.
#[cold]
#[inline(never)]
fn keep_few(best: Trial, [before, after]: [Option<Trial>; 2], other: Option<Trial>) -> Tile {
    let (below, above) = match other {
        Some(other) if other.label < best.label => (Some(other), None),
        other => (None, other),
    };
    let mut labels = 0;
    let mut rows = [u32::MAX; 4];
    let mut len = 0;
    for trial in [below, before, Some(best), after, above].into_iter().flatten() {
        labels |= trial.label << (8 * len);
        rows[len] = trial.cells;
        len += 1;
    }
    let last = labels >> (8 * (len - 1)) & 0xff;
    for i in len..4 {
        labels |= last << (8 * i);
    }
    Tile { labels, costs: transposed(rows), best: best.label }
}

/// Column `i` of the matrix of four rows of four bytes.
#[inline(always)]
fn transposed([a, b, c, d]: [u32; 4]) -> [u32; 4] {
    const EVEN: u32 = 0x00ff_00ff;
    let (even, odd) = (a & EVEN | (b & EVEN) << 8, a >> 8 & EVEN | b & !EVEN);
    let (even2, odd2) = (c & EVEN | (d & EVEN) << 8, c >> 8 & EVEN | d & !EVEN);
    let low = |x: u32, y: u32| x & 0xffff | y << 16;
    let high = |x: u32, y: u32| x >> 16 | y & 0xffff_0000;
    [low(even, even2), low(odd, odd2), high(even, even2), high(odd, odd2)]
}
