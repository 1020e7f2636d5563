//! The pipeline of `full` and `lite`: rows in, tiles matched row by row, rows out, the work spread over the rows.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "rows and tiles are far below 2^16"
)]

use crate::answer::answer_row::{AnswerRow, Sources};
use crate::answer::cell_row::CellRow;
use crate::answer::evidence::{Evidence, Floor, Worth};
use crate::answer::repetition::Repetition;
use crate::front_end::camera_pair::CameraPair;
use crate::front_end::camera_view::{FeatureRows, TILE_ROWS, words_for};
use crate::front_end::noise::{Noise, RawNoise, SmoothingLevel};
use crate::lanes::answer_rows::WordAligned;
use crate::lanes::rows::Clips;
use crate::matching::agreement::Penalties;
use crate::matching::block_search::{BlockRow, BlockSettings};
use crate::matching::tile::{TileRow, TileSettings};
use crate::matching::tile_seed::TileSeeds;
use crate::method::capacity::check_capacity;
use crate::method::deciding::{CellRows, Matching, MaybePaths};
use crate::method::parts::{Parts, Seeds};
use crate::output::frame_figures::{FrameFigures, FrameSums};
use crate::stage::{Stage, StageClock, Untimed};
use crate::{Config, ConfigError, Disparity, DisparityRow, Reading, RowError, ScanlinePair, StereoMethod};

/// Rows of the camera by which the newest smoothed row lags behind: half of the widest filter.
const SMOOTH_LAG: u32 = 2;

/// What depends on the noise.
#[derive(Clone, Copy)]
struct Settings<C> {
    clips: Clips,
    contour_threshold: u32,
    strong_noise: bool,
    tile: TileSettings<C>,
    penalties: Penalties,
}

/// A stereo method by tiles, whose cells come to their labels by `M`.
///
/// `BLOCKS` is the capacity: [`blocks_for`](crate::blocks_for) the widest row. Of the same rows every capacity makes the same answer.
#[derive(Debug, Clone)]
pub struct Tiled<M: Matching, const BLOCKS: usize, C = Untimed> {
    config: Config,
    #[cfg(feature = "ablation")]
    parts: Parts,
    cameras: CameraPair<BLOCKS, M::Features<BLOCKS>>,
    seeds: TileSeeds<BLOCKS>,
    paths: M::Paths<BLOCKS>,
    cells: M::Cells<BLOCKS>,
    repetition: Repetition,
    evidence: Evidence<BLOCKS>,
    worth: Worth<BLOCKS>,
    answer: AnswerRow<BLOCKS>,
    sums: FrameSums,
    /// Those of the last frame that ended.
    figures: Option<FrameFigures>,
    disparity: WordAligned<[[Disparity; 4]; BLOCKS]>,
    /// Cell rows answered, and rows delivered so far.
    answered: u32,
    delivered: u32,
    clock: C,
}

impl<M: Matching, const BLOCKS: usize> Tiled<M, BLOCKS> {
    /// Builds the method for rows of `config.width` px.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        Self::build(config, Parts::ALL, Untimed)
    }

    /// Builds the method of some of its parts only, to see what the others bring. Of the feature `ablation`.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    #[cfg(feature = "ablation")]
    pub fn with_parts(config: Config, parts: Parts) -> Result<Self, ConfigError> {
        Self::build(config, parts, Untimed)
    }
}

impl<M: Matching, const BLOCKS: usize, C> Tiled<M, BLOCKS, C> {
    /// Rows that come in after a row before it goes out, at most: what is agreed with the row of cells below waits for it.
    pub const LATENCY: u32 = if M::AGREEMENT { 13 } else { 12 };
    /// Rows of a cell.
    const CELL_HEIGHT: u32 = TILE_ROWS / M::ROWS;
}

impl<M: Matching, const BLOCKS: usize, C: StageClock> Tiled<M, BLOCKS, C> {
    /// Builds the method for rows of `config.width` px, with a clock that is told of its stages.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn timed(config: Config, clock: C) -> Result<Self, ConfigError> {
        Self::build(config, Parts::ALL, clock)
    }

    #[cfg_attr(not(feature = "ablation"), expect(unused_variables, reason = "all there are"))]
    fn build(config: Config, parts: Parts, clock: C) -> Result<Self, ConfigError> {
        check_capacity(&config, BLOCKS)?;
        Ok(Self {
            config,
            #[cfg(feature = "ablation")]
            parts,
            cameras: CameraPair::EMPTY,
            seeds: TileSeeds::new(),
            paths: M::Paths::EMPTY,
            cells: M::Cells::EMPTY,
            repetition: Repetition::NONE,
            evidence: Evidence::EMPTY,
            worth: Worth::TRUSTED,
            answer: AnswerRow::EMPTY,
            sums: FrameSums::default(),
            figures: None,
            disparity: WordAligned([[Disparity::UNKNOWN; 4]; BLOCKS]),
            answered: 0,
            delivered: 0,
            clock,
        })
    }

    /// The parts that take part. Without the feature `ablation` the compiler sees that they are all.
    #[inline(always)]
    fn parts(&self) -> Parts {
        #[cfg(feature = "ablation")]
        return self.parts;
        #[cfg(not(feature = "ablation"))]
        Parts::ALL
    }

    /// The noise of the rows so far; without smoothing as if there were none.
    #[inline(always)]
    fn noise(&self) -> Noise {
        let mut noise = self.cameras.noise();
        if !self.parts().smoothing {
            noise.level = SmoothingLevel::Off;
        }
        noise
    }

    fn settings(&self) -> Settings<M::Cost> {
        let extremum = self.parts().extremum;
        let level = self.noise().level;
        let (cost, penalties) = M::costs(level >= SmoothingLevel::Medium);
        let contour = if M::AGREEMENT { 4 } else { 5 };
        let (contour_threshold, near, far) = match level {
            SmoothingLevel::Off | SmoothingLevel::Light => (2, 4, 24),
            SmoothingLevel::Medium => (contour, 6, 32),
            SmoothingLevel::Strong => (contour, 16, 96),
        };
        Settings {
            clips: level.clips(),
            contour_threshold,
            strong_noise: level == SmoothingLevel::Strong,
            tile: TileSettings { cost, near, far, extremum },
            penalties,
        }
    }

    fn tiles(&self) -> usize {
        usize::from(self.config.width).div_ceil(8)
    }

    /// Goes as far as the newest row of both views allows.
    #[inline(never)]
    fn advance(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = usize::from(self.config.width);
        let settings = self.settings();
        let newest = self.cameras.left.len() - 1;
        if newest >= SMOOTH_LAG {
            let level = self.noise().level;
            self.cameras.left.smooth_row(level, width);
            self.cameras.right.smooth_row(level, width);
        }
        if newest > SMOOTH_LAG {
            let Parts { reading, .. } = self.parts();
            for view in [&mut self.cameras.left, &mut self.cameras.right] {
                match reading {
                    Reading::Haar => view.feature_row(settings.clips, width),
                    Reading::Intensity => view.intensity_row(settings.clips, width),
                }
            }
            // The work on a row of tiles is spread over four rows of the camera.
            let done = self.cameras.left.features_len();
            let tile_row = (done / TILE_ROWS).wrapping_sub(1);
            let is_searched = done > TILE_ROWS;
            match done % TILE_ROWS {
                0 => self.pair_contours(tile_row),
                1 if is_searched => {
                    if M::AGREEMENT && tile_row > 0 {
                        self.answer(tile_row - 1);
                    }
                    self.search(tile_row, settings);
                }
                2 if is_searched && M::AGREEMENT => self.agree(tile_row, settings),
                2 if is_searched => {
                    self.smooth(tile_row);
                    self.answer(tile_row);
                }
                3 => {
                    if is_searched && M::AGREEMENT {
                        self.smooth(tile_row);
                        self.answer(tile_row);
                    }
                    let next = done / TILE_ROWS;
                    if TILE_ROWS * next < self.cameras.rows() {
                        self.find_contours(next, settings);
                    }
                }
                _ => {}
            }
        }
        self.deliver(sink);
    }

    #[inline(never)]
    fn find_contours(&mut self, tile_row: u32, settings: Settings<M::Cost>) {
        self.clock.enter(Stage::Contours);
        let words = words_for(usize::from(self.config.width));
        let Settings { contour_threshold, strong_noise, .. } = settings;
        self.seeds.find_contours(&self.cameras, tile_row, words, contour_threshold, strong_noise);
    }

    fn pair_contours(&mut self, tile_row: u32) {
        self.clock.enter(Stage::Seeds);
        let tiles = self.tiles();
        self.seeds.pair(&self.config, self.cameras.tiles(tile_row), tiles);
        // Every second row is enough, unless it repeats itself.
        if tile_row.is_multiple_of(2) || self.repetition.is_strong {
            self.repetition.observe(self.seeds.left_contours());
        }
        let range = self.config.num_disparities;
        match self.parts().seeds {
            Seeds::Contours => {}
            Seeds::None => self.seeds.replace(tiles, |_| [u16::MAX; 2]),
            Seeds::Random(seed) => self.seeds.replace(tiles, |tile| {
                [0, 1].map(|i| {
                    let number = (tile_row * 1024 + tile) * 2 + i;
                    (scramble(seed ^ scramble(number)) % u32::from(range).max(1)) as u16
                })
            }),
            Seeds::Grid => self.seeds.replace(tiles, |tile| {
                [0, 1].map(|i| {
                    let step = (tile_row * 5 + tile * 3) % 8 + 8 * i;
                    (step * u32::from(range) / 16) as u16
                })
            }),
        }
    }

    /// Searches the tiles, and decides the cells or begins their paths.
    #[inline(never)]
    fn search(&mut self, tile_row: u32, settings: Settings<M::Cost>) {
        self.clock.enter(Stage::Blocks);
        let (tiles, level) = (self.tiles(), self.noise().level);
        let [left, right] = self.cameras.tiles(tile_row);
        let row = TileRow::new(&self.config, left, right, settings.tile);
        let Parts { agreement, extremum, .. } = self.parts();
        let seeds = |tile: usize| self.seeds.nearest(tile).map(u32::from);
        let penalties = settings.penalties;
        // The cells above, a pair a tile.
        let pairs = |above: &'_ CellRow<BLOCKS>| match tile_row {
            0 => 0,
            _ => tiles.min(above.label.len() / 2),
        };
        if M::ROWS == 1 {
            let Ok([above, cells]) = self.cells.rows().get_disjoint_mut(cell_slots::<2, BLOCKS, M>(tile_row)) else {
                return;
            };
            let above = &above.label.as_chunks::<2>().0[..pairs(above)];
            let cells = cells.tiles(tiles);
            if M::SEARCH {
                let settings = BlockSettings::of(level, extremum);
                BlockRow::new(&self.config, row.left, row.right, settings).decide(seeds, above, cells);
            } else {
                row.decide_alone(penalties, seeds, above, [cells]);
            }
            return;
        }
        let slots = cell_slots::<3, BLOCKS, M>(tile_row);
        let Ok([above, upper, lower]) = self.cells.rows().get_disjoint_mut(slots) else { return };
        let above = &above.label.as_chunks::<2>().0[..pairs(above)];
        let rows = [upper.tiles(tiles), lower.tiles(tiles)];
        match self.paths.paths().filter(|_| agreement) {
            Some(paths) => row.begin_paths(penalties, seeds, above, rows, paths),
            None => row.decide_alone(penalties, seeds, above, rows),
        }
    }

    /// The agreement of the cells.
    fn agree(&mut self, tile_row: u32, settings: Settings<M::Cost>) {
        let tiles = self.tiles();
        let agreement = self.parts().agreement;
        if let Some(paths) = self.paths.paths().filter(|_| agreement) {
            self.clock.enter(Stage::Agreement);
            let slots = cell_slots::<3, BLOCKS, M>(tile_row);
            let Ok(rows) = self.cells.rows().get_disjoint_mut(slots) else { return };
            paths.agree(tiles, settings.penalties, tile_row == 0, rows);
        }
    }

    /// Smooths the cell rows that the row of tiles made final.
    #[inline(never)]
    fn smooth(&mut self, tile_row: u32) {
        let cells = usize::from(self.config.width).div_ceil(4);
        let last = self.last_final(tile_row);
        for row in (last + 1).saturating_sub(M::ROWS)..=last {
            let slot = row % M::Cells::<BLOCKS>::LEN;
            if let Some(row) = self.cells.rows().get_mut(slot as usize) {
                row.smooth(cells);
            }
        }
    }

    /// Below the last row of tiles there is nothing: decides the cells that waited for it, and repeats them.
    #[inline(never)]
    fn end_cells(&mut self) {
        let (tiles, cells) = (self.tiles(), usize::from(self.config.width).div_ceil(4));
        let penalties = self.settings().penalties;
        let agreement = self.parts().agreement;
        let slots = cell_slots::<2, BLOCKS, M>(self.tile_rows());
        let Ok([last, below]) = self.cells.rows().get_disjoint_mut(slots) else { return };
        if let Some(paths) = self.paths.paths().filter(|_| agreement) {
            self.clock.enter(Stage::Agreement);
            paths.end(tiles, penalties, last);
            last.smooth(cells);
        }
        below.clone_from(last);
    }

    /// Rows of tiles of the rows so far.
    const fn tile_rows(&self) -> u32 {
        self.cameras.rows().div_ceil(TILE_ROWS)
    }

    /// The last cell row that is final once this row of tiles is decided.
    fn last_final(&self, tile_row: u32) -> u32 {
        // The row below has its say in the agreement.
        let is_pending = M::AGREEMENT && self.parts().agreement;
        M::ROWS * (tile_row + 1) - 1 - u32::from(is_pending)
    }

    /// Answers the next cell row, if the row below it is final.
    fn answer(&mut self, tile_row: u32) {
        let row = self.answered;
        // The cell rows of a row of tiles share the evidence around the first of them.
        let number = row / M::ROWS;
        let last = number + 1;
        if (M::ROWS * last).max(row + 1) > self.last_final(tile_row) {
            return;
        }
        self.clock.enter(Stage::Consistency);
        let floor = Floor::of(self.noise(), self.settings().clips.zero(), M::AGREEMENT);
        let cells = usize::from(self.config.width).div_ceil(4);
        let is_judged = self.evidence.len() > last;
        while self.evidence.len() <= last.min(self.tile_rows() - 1) {
            self.measure_evidence(self.evidence.len(), floor);
        }
        if !is_judged && self.parts().texture {
            self.evidence.judge(number, cells, floor, &mut self.worth);
        }
        let [left, right] = features_of::<M, _, _>(&self.cameras, row);
        let sources = Sources {
            rows: [row.saturating_sub(1), row, row + 1].map(|row| self.cells.row(row)),
            left,
            right,
            worth: &self.worth,
            sure: floor.sure,
            zero: floor.zero,
        };
        if M::ROWS == 1 {
            self.answer.answer::<4>(&self.config, &sources);
        } else {
            self.answer.answer::<2>(&self.config, &sources);
        }
        if FrameSums::is_sampled(row / M::ROWS) {
            self.sums.count_sure(&self.answer.confidence.0[..cells]);
        }
        self.answered += 1;
    }

    /// Measures the evidence of the first cell row of a row of tiles, which is final.
    fn measure_evidence(&mut self, tile_row: u32, floor: Floor) {
        let row = M::ROWS * tile_row;
        let rows = features_of::<M, _, _>(&self.cameras, row);
        let labels = &self.cells.row(row).label[..usize::from(self.config.width).div_ceil(4)];
        self.evidence.measure(&self.config, rows, labels, floor, &self.repetition);
        if FrameSums::is_sampled(tile_row) {
            self.sums.add(self.evidence.newest(labels.len()), floor);
        }
    }

    /// Delivers the next row, if it is answered.
    fn deliver(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let y = self.delivered;
        if y >= self.cameras.rows() || y / Self::CELL_HEIGHT >= self.answered {
            return;
        }
        self.clock.enter(Stage::Consistency);
        self.delivered += 1;
        let width = usize::from(self.config.width);
        if self.cameras.is_missing(y) {
            let (unknown, none) = ([[Disparity::UNKNOWN; 4]; BLOCKS], [[0; 4]; BLOCKS]);
            let (disparity, confidence) = (&unknown.as_flattened()[..width], &none.as_flattened()[..width]);
            self.clock.enter(Stage::Output);
            sink(DisparityRow { y, disparity, confidence });
            return;
        }
        let (config, out) = (&self.config, &mut self.disparity.0);
        // Twice the distance from the middle of the cells, rows.
        let half_rows = (2 * (y % Self::CELL_HEIGHT) + 1).wrapping_sub(Self::CELL_HEIGHT).cast_signed();
        self.answer.write(config, half_rows, out);
        self.clock.enter(Stage::Output);
        let disparity = &self.disparity.0.as_flattened()[..width];
        sink(DisparityRow { y, disparity, confidence: &self.answer.confidence.0.as_flattened()[..width] });
    }
}

/// A well-mixed number for each number (the finaliser of MurmurHash3).
const fn scramble(number: u32) -> u32 {
    let mixed = (number ^ number >> 16).wrapping_mul(0x85eb_ca6b);
    let mixed = (mixed ^ mixed >> 13).wrapping_mul(0xc2b2_ae35);
    mixed ^ mixed >> 16
}

/// Two feature rows of a cell row in either view: of cells as high as a tile the lower two, which are overwritten last.
fn features_of<M: Matching, const WORDS: usize, F: FeatureRows<WORDS>>(
    cameras: &CameraPair<WORDS, F>,
    row: u32,
) -> [&[[u32; WORDS]; 2]; 2] {
    let half = if M::ROWS == 1 { 1 } else { row as usize % 2 };
    cameras.tiles(row / M::ROWS).map(|rows| &rows.as_chunks().0[half])
}

/// Where the cell row above a row of tiles is, and its own: `N` in all.
fn cell_slots<const N: usize, const WORDS: usize, M: Matching>(tile_row: u32) -> [usize; N] {
    let first = M::ROWS * tile_row + M::Cells::<WORDS>::LEN - 1;
    core::array::from_fn(|i| (first as usize + i) % M::Cells::<WORDS>::LEN as usize)
}

impl<M: Matching, const BLOCKS: usize, C: StageClock> StereoMethod for Tiled<M, BLOCKS, C> {
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        self.cameras.clear();
        self.sums = FrameSums::default();
        self.repetition = Repetition::NONE;
        self.evidence.clear();
        (self.answered, self.delivered) = (0, 0);
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        pair.check(self.config.width)?;
        self.clock.enter(Stage::Features);
        self.sums.compare(pair);
        self.cameras.push(pair);
        self.advance(sink);
        Ok(())
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.clock.enter(Stage::Features);
        self.cameras.miss();
        self.advance(sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        if self.cameras.rows() > 0 {
            // The last row stands in for those below the image, as far as filters and the last tiles ask for them.
            let needed = TILE_ROWS * self.tile_rows() + if M::AGREEMENT { 3 } else { 2 };
            while self.cameras.left.features_len() < needed {
                self.clock.enter(Stage::Features);
                self.cameras.go_on();
                self.advance(sink);
            }
            self.end_cells();
            while self.delivered < self.cameras.rows() {
                if self.delivered / Self::CELL_HEIGHT >= self.answered {
                    self.answer(self.tile_rows());
                }
                self.deliver(sink);
            }
        }
        self.figures = self.sums.figures(self.cameras.is_dark());
        self.start();
    }

    fn take_noise(&mut self, noise: &RawNoise) {
        self.cameras.take_noise(noise);
    }

    fn figures(&self) -> Option<FrameFigures> {
        self.figures
    }

    fn cell_height(&self) -> u32 {
        Self::CELL_HEIGHT
    }
}
