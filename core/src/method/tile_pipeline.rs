//! The pipeline of `full` and `lite`: rows in, tiles matched row by row, rows out, the work spread over the rows.

use crate::answer::cell::winner;
use crate::answer::cell_rows::{AnswerRow, Answering, CELL_ROWS, CellRow, OFFSET};
use crate::front_end::camera_view::{CameraView, TILE_ROWS, words_for};
use crate::front_end::exposure::Exposure;
use crate::front_end::noise::{Noise, NoiseHistogram, SmoothingLevel};
use crate::lanes::rows::Clips;
use crate::lanes::{ONES, add, add_halves, difference, min, select_ge, splat, sub};
use crate::matching::agreement::{Penalties, extend, normalised};
use crate::matching::tile::{TileRow, TileSettings};
use crate::matching::tile_seed::TileSeeds;
use crate::method::parts::{Parts, Seeds};
use crate::stage::{Stage, StageClock, Untimed};
use crate::{Config, ConfigError, Disparity, DisparityRow, RowError, ScanlinePair, StereoMethod, blocks_for};

/// Rows of the camera by which the newest smoothed row lags behind: half of the widest filter.
const SMOOTH_LAG: u32 = 2;
/// Rows of a cell.
const CELL_HEIGHT: u32 = 2;

/// What depends on the noise.
#[derive(Clone, Copy)]
struct Settings {
    clips: Clips,
    contour_threshold: u32,
    strong_noise: bool,
    tile: TileSettings,
    penalties: Penalties,
}

/// A stereo method by tiles; with `AGREEMENT` neighbouring cells agree on their labels, without it each decides alone.
///
/// `BLOCKS` is the capacity: [`blocks_for`] the widest row. Of the same rows every capacity makes the same answer.
#[derive(Debug, Clone)]
pub struct Tiled<const AGREEMENT: bool, const BLOCKS: usize, C = Untimed> {
    config: Config,
    parts: Parts,
    left: CameraView<BLOCKS>,
    right: CameraView<BLOCKS>,
    exposure: Exposure,
    histograms: [NoiseHistogram; 2],
    noise: Noise,
    seeds: TileSeeds<BLOCKS>,
    /// Labels of the tiles under way, and of those above.
    labels: [u32; BLOCKS],
    labels_above: [u32; BLOCKS],
    /// Costs of the cells under way, upper and lower.
    costs: [[u32; BLOCKS]; 2],
    /// Sums of the paths from the left.
    from_left: [[u32; BLOCKS]; 2],
    /// Of the lower cells above: sums of the path from the top, of all paths so far, and their costs.
    from_top: [u32; BLOCKS],
    pending: [u32; BLOCKS],
    costs_above: [u32; BLOCKS],
    cells: [CellRow<BLOCKS>; CELL_ROWS],
    answers: [AnswerRow<BLOCKS>; 2],
    disparity: [[Disparity; 4]; BLOCKS],
    /// Rows of this frame pushed or missed so far.
    rows: u32,
    /// Cell rows answered, and rows delivered so far.
    answered: u32,
    delivered: u32,
    missing: u32,
    clock: C,
}

impl<const AGREEMENT: bool, const BLOCKS: usize> Tiled<AGREEMENT, BLOCKS> {
    /// Builds the method for rows of `config.width` px.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        Self::build(config, Parts::ALL, Untimed)
    }

    /// Builds the method of some of its parts only, to see what the others bring.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn with_parts(config: Config, parts: Parts) -> Result<Self, ConfigError> {
        Self::build(config, parts, Untimed)
    }
}

impl<const AGREEMENT: bool, const BLOCKS: usize, C> Tiled<AGREEMENT, BLOCKS, C> {
    /// Rows that come in after a row before it goes out, at most.
    pub const LATENCY: u32 = 13;
}

impl<const AGREEMENT: bool, const BLOCKS: usize, C: StageClock> Tiled<AGREEMENT, BLOCKS, C> {
    /// Builds the method for rows of `config.width` px, with a clock that is told of its stages.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn timed(config: Config, clock: C) -> Result<Self, ConfigError> {
        Self::build(config, Parts::ALL, clock)
    }

    fn build(config: Config, parts: Parts, clock: C) -> Result<Self, ConfigError> {
        config.check()?;
        if blocks_for(config.width) > BLOCKS {
            let max_width = u16::try_from(4 * BLOCKS.saturating_sub(blocks_for(0))).unwrap_or(u16::MAX);
            return Err(ConfigError::Capacity { max_width });
        }
        Ok(Self {
            config,
            parts,
            left: CameraView::new(),
            right: CameraView::new(),
            exposure: Exposure::new(),
            histograms: [NoiseHistogram::new(), NoiseHistogram::new()],
            noise: Noise::default(),
            seeds: TileSeeds::new(),
            labels: [0; BLOCKS],
            labels_above: [0; BLOCKS],
            costs: [[0; BLOCKS]; 2],
            from_left: [[0; BLOCKS]; 2],
            from_top: [0; BLOCKS],
            pending: [0; BLOCKS],
            costs_above: [0; BLOCKS],
            cells: [const { CellRow::EMPTY }; CELL_ROWS],
            answers: [const { AnswerRow::EMPTY }; 2],
            disparity: [[Disparity::UNKNOWN; 4]; BLOCKS],
            rows: 0,
            answered: 0,
            delivered: 0,
            missing: 0,
            clock,
        })
    }

    fn settings(&self) -> Settings {
        let extremum = self.parts.extremum;
        let (cell, tile, penalties) = match (AGREEMENT, self.noise.level >= SmoothingLevel::Medium) {
            (true, false) => (128, 0, Penalties::new(4, 24)),
            (true, true) => (64, 0, Penalties::new(7, 34)),
            (false, false) => (88, 10, Penalties::new(1, 3)),
            (false, true) => (160, 24, Penalties::new(3, 16)),
        };
        let contour = if AGREEMENT { 4 } else { 5 };
        let (clips, contour_threshold, near, far) = match self.noise.level {
            SmoothingLevel::Off | SmoothingLevel::Light => (Clips::new(15, 4), 2, 4, 24),
            SmoothingLevel::Medium => (Clips::new(31, 0), contour, 6, 24),
            SmoothingLevel::Strong => (Clips::new(31, 0), contour, 16, 96),
        };
        Settings {
            clips,
            contour_threshold,
            strong_noise: self.noise.level == SmoothingLevel::Strong,
            tile: TileSettings { cell, tile, near, far, extremum },
            penalties,
        }
    }

    fn tiles(&self) -> usize {
        usize::from(self.config.width).div_ceil(8)
    }

    /// Goes as far as the newest row of both views allows.
    fn advance(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = usize::from(self.config.width);
        let settings = self.settings();
        let newest = self.left.len() - 1;
        if newest >= SMOOTH_LAG {
            self.left.smooth_row(self.noise.level, width);
            self.right.smooth_row(self.noise.level, width);
        }
        if newest > SMOOTH_LAG {
            self.left.feature_row(settings.clips, width);
            self.right.feature_row(settings.clips, width);
            // The work on a row of tiles is spread over four rows of the camera.
            let done = self.left.features_len();
            let tile_row = (done / TILE_ROWS).wrapping_sub(1);
            match done % TILE_ROWS {
                0 => self.pair_contours(tile_row),
                1 if done > TILE_ROWS => self.search(tile_row, settings),
                2 if done > TILE_ROWS => self.agree(tile_row, settings),
                3 => {
                    if done > TILE_ROWS {
                        self.answer(tile_row);
                    }
                    self.clock.enter(Stage::Contours);
                    let views = [&self.left, &self.right];
                    self.seeds.find_contours(
                        views,
                        done / TILE_ROWS,
                        words_for(width),
                        settings.contour_threshold,
                        settings.strong_noise,
                    );
                }
                _ => {}
            }
        }
        self.deliver(sink);
    }

    fn pair_contours(&mut self, tile_row: u32) {
        self.clock.enter(Stage::Seeds);
        let tiles = self.tiles();
        self.seeds.pair(&self.config, self.left.tiles(tile_row), self.right.tiles(tile_row), tiles);
    }

    /// Labels of the tiles, and the paths from the left.
    fn search(&mut self, tile_row: u32, settings: Settings) {
        self.clock.enter(Stage::Blocks);
        let tiles = self.tiles();
        let row = TileRow::new(&self.config, self.left.tiles(tile_row), self.right.tiles(tile_row), settings.tile);
        let above = (tile_row > 0).then(|| self.cells[cell_slot(2 * tile_row - 1)].label.as_flattened());
        let mut left = None;
        let mut hypotheses = [0; 8];
        for tile in 0..tiles {
            let mut len = 0;
            let mut propose = |label: u32| {
                hypotheses[len] = label;
                len += 1;
            };
            let mut up = None;
            if let Some(above) = above {
                let at = |cell: usize| u32::from(above[cell]);
                up = Some(at(2 * tile));
                propose(at(2 * tile));
                propose(at(2 * tile + 1));
                if tile > 0 {
                    propose(at(2 * tile - 1));
                }
                if tile + 1 < tiles {
                    propose(at(2 * tile + 2));
                }
            }
            if let Some(left) = left {
                propose(left);
            }
            match self.parts.seeds {
                Seeds::Contours => self.seeds.nearest(tile).map(|label| propose(u32::from(label))),
                Seeds::Random(seed) => [0, 1].map(|i| {
                    let number = (tile_row * 1024 + tile as u32) * 2 + i;
                    propose(scramble(seed ^ scramble(number)) % u32::from(self.config.num_disparities));
                }),
                Seeds::Grid => [0, 1].map(|i| {
                    let step = (tile_row * 5 + tile as u32 * 3) % 8 + 8 * i;
                    propose(step * u32::from(self.config.num_disparities) / 16);
                }),
                Seeds::None => [(); 2],
            };
            let found = row.search(tile, &hypotheses[..len], left, up);
            self.labels[tile] = found.labels;
            let [a, b, c, d] = found.costs;
            (self.costs[0][2 * tile], self.costs[0][2 * tile + 1]) = (a, b);
            (self.costs[1][2 * tile], self.costs[1][2 * tile + 1]) = (c, d);
            left = Some(found.best);
        }
        if AGREEMENT && self.parts.agreement {
            self.pass_rightwards(tiles, settings.penalties);
        } else {
            self.decide_alone(tile_row, tiles, settings.penalties);
        }
    }

    /// The paths from the left.
    fn pass_rightwards(&mut self, tiles: usize, penalties: Penalties) {
        let mut sums = [0; 2];
        let mut before = self.labels[0];
        for tile in 0..tiles {
            let labels = self.labels[tile];
            let steps = penalties.steps(labels);
            for row in 0..2 {
                let message = if before == labels {
                    penalties.same_labels(sums[row], steps)
                } else {
                    penalties.other_labels(sums[row], before, labels)
                };
                let first = extend(self.costs[row][2 * tile], message);
                let second = extend(self.costs[row][2 * tile + 1], penalties.same_labels(first, steps));
                (self.from_left[row][2 * tile], self.from_left[row][2 * tile + 1]) = (first, second);
                sums[row] = second;
            }
            before = labels;
        }
    }

    /// The other paths: from the right, from the top and, one cell row late, from below. Decides the upper cells and those
    /// above them; the lower ones for the time being.
    fn agree(&mut self, tile_row: u32, settings: Settings) {
        if !AGREEMENT || !self.parts.agreement {
            return;
        }
        self.clock.enter(Stage::Agreement);
        let penalties = settings.penalties;
        let tiles = self.tiles();
        let mut right = [0; 2];
        let mut after = self.labels[tiles - 1];
        let slots = [cell_slot(2 * tile_row + 5), cell_slot(2 * tile_row), cell_slot(2 * tile_row + 1)];
        for tile in (0..tiles).rev() {
            let labels = self.labels[tile];
            let above = self.labels_above[tile];
            let steps = penalties.steps(labels);
            for cell in [2 * tile + 1, 2 * tile] {
                let mut along = [0; 2];
                for row in 0..2 {
                    let message = if cell == 2 * tile || after == labels {
                        penalties.same_labels(right[row], steps)
                    } else {
                        penalties.other_labels(right[row], after, labels)
                    };
                    right[row] = extend(self.costs[row][cell], message);
                    along[row] = add(self.from_left[row][cell], right[row]);
                }
                let costs = [self.costs[0][cell], self.costs[1][cell]];
                let is_same = above == labels;
                let message = match tile_row {
                    0 => 0,
                    _ if is_same => penalties.same_labels(self.from_top[cell], steps),
                    _ => penalties.other_labels(self.from_top[cell], above, labels),
                };
                let top = extend(costs[0], message);
                let lower_top = extend(costs[1], penalties.same_labels(top, steps));
                let sums = [normalised(add(along[0], top)), normalised(add(along[1], lower_top))];
                if tile_row > 0 {
                    let upper = normalised(along[0]);
                    let message = if is_same {
                        penalties.same_labels(upper, steps)
                    } else {
                        penalties.other_labels(upper, labels, above)
                    };
                    let whole = normalised(add(self.pending[cell], message));
                    self.cells[slots[0]].set(cell, winner(whole, above, self.costs_above[cell]));
                }
                let lower = penalties.same_labels(normalised(along[1]), steps);
                self.cells[slots[1]].set(cell, winner(normalised(add(sums[0], lower)), labels, costs[0]));
                self.cells[slots[2]].set(cell, winner(sums[1], labels, costs[1]));
                self.from_top[cell] = lower_top;
                self.pending[cell] = sums[1];
                self.costs_above[cell] = costs[1];
            }
            self.labels_above[tile] = labels;
            after = labels;
        }
    }

    /// Without agreement: each cell takes its least cost, and pays a little for a label that its neighbours have not.
    fn decide_alone(&mut self, tile_row: u32, tiles: usize, penalties: Penalties) {
        for row in 0..2 {
            let cell_row = 2 * tile_row + row as u32;
            let mut left = None;
            let above = self.cells[cell_slot(cell_row + 5)].label;
            let out = &mut self.cells[cell_slot(cell_row)];
            for cell in 0..2 * tiles {
                let labels = self.labels[cell / 2];
                let costs = self.costs[row][cell];
                let mut sums = costs;
                if let Some(left) = left {
                    sums = add(sums, penalties.of(labels, left));
                }
                if cell_row > 0 {
                    sums = add(sums, penalties.of(labels, u32::from(above.as_flattened()[cell])));
                }
                let found = winner(normalised(sums), labels, costs);
                left = Some(u32::from(found.label));
                out.set(cell, found);
            }
        }
    }

    /// Answers the cell rows that have become final.
    fn answer(&mut self, tile_row: u32) {
        self.clock.enter(Stage::Consistency);
        let final_row = if AGREEMENT && self.parts.agreement { 2 * tile_row } else { 2 * tile_row + 1 };
        self.answer_until(final_row, tile_row);
    }

    /// Answers the cell rows above `final_row`, the last one that is final.
    fn answer_until(&mut self, final_row: u32, _tile_row: u32) {
        let width = usize::from(self.config.width);
        let cells = width.div_ceil(4);
        let first_new = if final_row < 2 { 0 } else { final_row - 1 };
        for row in first_new..=final_row {
            self.cells[cell_slot(row)].smooth(cells);
        }
        while self.answered < final_row {
            let row = self.answered;
            let above = row.saturating_sub(1);
            let tile_row = row / 2;
            let inside = 2 * (row as usize % 2);
            let (left, right) = (self.left.tiles(tile_row), self.right.tiles(tile_row));
            let answering = Answering {
                rows: [above, row, row + 1].map(|row| &self.cells[cell_slot(row)]),
                left: [&left[inside], &left[inside + 1]],
                right: [&right[inside], &right[inside + 1]],
                min_disparity: i32::from(self.config.min_disparity),
                width,
            };
            answering.answer(&mut self.answers[(row % 2) as usize]);
            self.answered += 1;
        }
    }

    /// Delivers the next row, if it is answered.
    fn deliver(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let y = self.delivered;
        if y >= self.rows || y / CELL_HEIGHT >= self.answered {
            return;
        }
        self.clock.enter(Stage::Consistency);
        self.delivered += 1;
        let width = usize::from(self.config.width);
        let cells = width.div_ceil(4);
        let answer = &self.answers[(y / CELL_HEIGHT % 2) as usize];
        if self.missing >> (y % 32) & 1 == 1 {
            let unknown = [[Disparity::UNKNOWN; 4]; BLOCKS];
            let none = [[0; 4]; BLOCKS];
            self.clock.enter(Stage::Output);
            sink(DisparityRow { y, disparity: &unknown.as_flattened()[..width], confidence: &none.as_flattened()[..width] });
            return;
        }
        // From 1/64 to 1/16 px, rounded; the offset goes and the least disparity comes.
        let base = 16 * i32::from(self.config.min_disparity) - OFFSET / 4;
        let base = (base.cast_unsigned() & 0xffff).wrapping_mul(0x0001_0001);
        let is_lower = y % CELL_HEIGHT == 1;
        let mut confidence = [[0; 4]; BLOCKS];
        for c in 0..cells {
            let slope = answer.slope[c];
            let row = |pair: u32| {
                let moved = if is_lower { add_halves(pair, slope) } else { crate::lanes::sub_halves(pair, slope) };
                let rounded = add_halves(moved, 0x0002_0002) >> 2 & 0x3fff_3fff;
                add_halves(rounded, base)
            };
            let [a, b] = answer.pixels[c].map(row);
            let bits = |word: u32| Disparity::from_bits((word & 0xffff) as u16 as i16);
            self.disparity[c] = [bits(a), bits(a >> 16), bits(b), bits(b >> 16)];
            confidence[c] = answer.confidence[c].to_le_bytes();
        }
        self.clock.enter(Stage::Output);
        sink(DisparityRow {
            y,
            disparity: &self.disparity.as_flattened()[..width],
            confidence: &confidence.as_flattened()[..width],
        });
    }

    fn measure(&mut self, pair: ScanlinePair<'_>) {
        // Much at first, so that the level is right soon.
        let (every, stride) = if self.rows < crate::tuning::t(60, 48) as u32 { (1, 4) } else { (4, 16) };
        if self.rows % every == 0 {
            let first = (self.rows / every * 5) as usize % stride;
            self.exposure.sample(pair.left, first, stride);
            self.exposure.sample(pair.right, first, stride);
        }
    }

    fn measure_noise(&mut self, width: usize) {
        let (every, stride, weight) = if self.rows < crate::tuning::t(60, 48) as u32 { (1, 4, 1) } else { (4, 16, crate::tuning::t(61,32) as u16) };
        // A stand-in has no noise of its own, and second differences span three rows.
        let is_whole = !(0..3).any(|back| self.missing >> (self.rows.wrapping_sub(back) % 32) & 1 == 1);
        if self.rows % every == 0 {
            if self.rows >= 2 && is_whole {
                let y = i64::from(self.rows) - 1;
                let first = (self.rows / every * 5) as usize % stride;
                for (view, histogram) in [&self.left, &self.right].into_iter().zip(&mut self.histograms) {
                    histogram.sample([&view.raw(y - 1)[..], &view.raw(y)[..], &view.raw(y + 1)[..]], first, stride, weight, width);
                }
            }
            let [left, right] = &self.histograms;
            self.noise = Noise::of(left, right, crate::front_end::exposure::Gain::default());
            if !self.parts.smoothing {
                self.noise.level = SmoothingLevel::Off;
            }
        }
    }
}

/// A well-mixed number for each number (the finaliser of MurmurHash3).
const fn scramble(number: u32) -> u32 {
    let mixed = (number ^ number >> 16).wrapping_mul(0x85eb_ca6b);
    let mixed = (mixed ^ mixed >> 13).wrapping_mul(0xc2b2_ae35);
    mixed ^ mixed >> 16
}

fn cell_slot(row: u32) -> usize {
    row as usize % CELL_ROWS
}

impl<const AGREEMENT: bool, const BLOCKS: usize, C: StageClock> StereoMethod for Tiled<AGREEMENT, BLOCKS, C> {
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        self.left.clear();
        self.right.clear();
        self.exposure = Exposure::new();
        self.histograms = [NoiseHistogram::new(), NoiseHistogram::new()];
        self.noise = Noise::default();
        (self.rows, self.answered, self.delivered, self.missing) = (0, 0, 0, 0);
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        pair.check(self.config.width)?;
        self.clock.enter(Stage::Features);
        self.missing &= !(1 << (self.rows % 32));
        self.measure(pair);
        let gain = self.exposure.gain();
        self.left.push(pair.left, gain);
        self.right.push(pair.right, gain);
        self.measure_noise(pair.left.len());
        self.rows += 1;
        self.advance(sink);
        Ok(())
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.clock.enter(Stage::Features);
        self.left.push_again();
        self.right.push_again();
        self.missing |= 1 << (self.rows % 32);
        self.rows += 1;
        self.advance(sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        // The last row stands in for those below the image.
        while self.delivered < self.rows {
            self.clock.enter(Stage::Features);
            self.left.push_again();
            self.right.push_again();
            self.advance(sink);
        }
        self.start();
    }
}
