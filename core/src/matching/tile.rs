//! A tile of 8 x 4 px: its hypotheses, the extremum search among them, and the four labels that its cells choose from.
//!
//! A label is a disparity less the least one searched, 0 to 255, so that it fits a byte.

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
#[derive(Clone, Copy, Default)]
struct Trial {
    label: u32,
    /// Sum of the whole tile.
    sum: u32,
    /// Costs of the four cells.
    cells: u32,
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
    /// - `left`, `above`: what the neighbours decided, if there are any.
    #[inline(always)]
    pub(crate) fn search(
        &self,
        tile: usize,
        hypotheses: &[u32],
        left: Option<u32>,
        above: Option<u32>,
    ) -> Tile {
        let mut trials = Trials { list: [Trial::default(); MOST], len: 0 };
        // Label 0 would begin at this byte of the right row; the window may lie in the margins, not beyond.
        let origin = 8 * tile as i32 + 4 - self.min_disparity;
        let lowest = (origin - 4 * (self.words as i32 - 2)).max(0) as u32;
        let highest = (origin.min(self.num_disparities as i32 - 1)) as u32;
        if origin < 0 || lowest > highest {
            return Tile { labels: 0, costs: [u32::MAX; 4], best: 0 };
        }
        let origin = origin as usize;
        for &label in hypotheses {
            if label >= lowest && label <= highest && !trials.has(label) {
                self.evaluate(&mut trials, tile, origin, label);
            }
        }
        if trials.len == 0 {
            self.evaluate(&mut trials, tile, origin, ((lowest + highest) / 2).clamp(lowest, highest));
        }
        let settings = self.settings;
        let bias = |label: u32| {
            let lean = |to: Option<u32>| match to.map(|to| to.abs_diff(label)) {
                None | Some(0) => 0,
                Some(1) => settings.near,
                Some(_) => settings.far,
            };
            lean(left) + lean(above)
        };
        let mut best = 0;
        if trials.len > 1 {
            let mut least = u32::MAX;
            for (i, trial) in trials.as_slice().iter().enumerate() {
                let sum = trial.sum + bias(trial.label);
                if sum < least {
                    (least, best) = (sum, i);
                }
            }
        }
        // The extremum search with its shortest support: the costs one step before and one after, and a step downhill.
        let mut label = trials.list[best].label;
        if settings.extremum {
            let mut least = trials.list[best].sum + bias(label);
            for step in 0..2 {
                let at = label;
                if at > lowest {
                    let i = self.at(&mut trials, tile, origin, at - 1);
                    let sum = trials.list[i].sum + bias(at - 1);
                    if sum < least {
                        (least, label, best) = (sum, at - 1, i);
                    }
                }
                if at < highest {
                    let i = self.at(&mut trials, tile, origin, at + 1);
                    let sum = trials.list[i].sum + bias(at + 1);
                    if sum < least {
                        (least, label, best) = (sum, at + 1, i);
                    }
                }
                if label == at || step == 1 {
                    break;
                }
            }
        }
        trials.keep(best)
    }

    /// The place of a label in the list, after trying it if that was not done.
    #[inline(always)]
    fn at(&self, trials: &mut Trials, tile: usize, origin: usize, label: u32) -> usize {
        match trials.as_slice().iter().position(|trial| trial.label == label) {
            Some(i) => i,
            None => {
                self.evaluate(trials, tile, origin, label);
                trials.len - 1
            }
        }
    }

    #[inline(always)]
    fn evaluate(&self, trials: &mut Trials, tile: usize, origin: usize, label: u32) {
        crate::count::evaluations(1);
        let [a, b, c, d] = tile_sad(self.left, 2 * tile + 1, self.right, origin - label as usize);
        let sum = a + b + c + d;
        let shared = self.settings.tile * sum;
        let cost = |own: u32| saturated_byte(self.settings.cell * own + shared);
        let cells = cost(a) | cost(b) << 8 | cost(c) << 16 | cost(d) << 24;
        if let Some(trial) = trials.list.get_mut(trials.len) {
            *trial = Trial { label, sum, cells };
            trials.len += 1;
        }
    }
}

/// What was tried, in this order.
struct Trials {
    list: [Trial; MOST],
    len: usize,
}

impl Trials {
    #[inline(always)]
    fn as_slice(&self) -> &[Trial] {
        &self.list[..self.len.min(MOST)]
    }

    #[inline(always)]
    fn has(&self, label: u32) -> bool {
        self.as_slice().iter().any(|trial| trial.label == label)
    }

    /// The best, those one step before and after it, and the cheapest of the others.
    #[inline(always)]
    fn keep(&self, best: usize) -> Tile {
        let best = self.list[best];
        let (mut before, mut after) = (None, None);
        let mut other: Option<Trial> = None;
        for &trial in self.as_slice() {
            let distance = trial.label.wrapping_sub(best.label).cast_signed();
            match distance {
                0 => {}
                -1 => before = Some(trial),
                1 => after = Some(trial),
                _ if other.is_none_or(|other| trial.sum < other.sum) => other = Some(trial),
                _ => {}
            }
        }
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
        // The last label again, at a cost that nobody takes.
        let last = labels >> (8 * (len - 1)) & 0xff;
        for i in len..4 {
            labels |= last << (8 * i);
        }
        Tile { labels, costs: transposed(rows), best: best.label }
    }
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
