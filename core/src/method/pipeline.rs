//! The pipeline for blocks: rows in, block rows to a matcher, rows out.

use crate::answer::consistency::answer;
use crate::answer::texture::Texture;
use crate::count;
use crate::front_end::exposure::Exposure;
use crate::front_end::noise::{Noise, SmoothingLevel};
use crate::front_end::ring::MARGIN;
use crate::front_end::view::{SMOOTH_LAG, View, sum_rows};
use crate::matching::block::{BlockRows, SIZE, SIZE_U32};
use crate::matching::seed::Seeds;
use crate::method::matcher::{Matcher, Stage};
use crate::method::missing_rows::MissingRows;
use crate::method::parts::Parts;
use crate::stage::{self, StageClock, Untimed};
use crate::{Config, ConfigError, DisparityRow, RowError, ScanlinePair, StereoMethod};

/// Half-support of the Haar wavelet that finds the contours, px.
const HALF_SUPPORT: u8 = 2;
/// Least response of a contour: 2 grey levels in 4 rows and 2 columns.
const CONTOUR_THRESHOLD: i32 = 2 * 4 * 2;
/// Rows of the image by which a feature row lags behind the camera.
const FEATURE_LAG: u32 = SMOOTH_LAG + 1;

/// Blocks that a row of `width` px needs, margins included: the capacity to build a method with.
///
/// # Examples
/// ```
/// use haarline::{Lite, blocks_for};
/// type Qvga = Lite<{ blocks_for(320) }>;
/// assert!(size_of::<Qvga>() <= 22 * 1024);
/// ```
#[must_use]
pub const fn blocks_for(width: u16) -> usize {
    (width as usize).div_ceil(SIZE) + 2 * MARGIN / SIZE
}

/// Checks the configuration of a method with a capacity of so many blocks.
pub(crate) fn check_capacity(config: &Config, blocks: usize) -> Result<(), ConfigError> {
    config.check()?;
    if blocks_for(config.width) > blocks {
        let max_width = u16::try_from(SIZE * blocks.saturating_sub(blocks_for(0))).unwrap_or(u16::MAX);
        return Err(ConfigError::Capacity { max_width });
    }
    Ok(())
}

/// A stereo method: the shared pipeline around the matcher `M`.
///
/// `BLOCKS` is the capacity: [`blocks_for`] the widest row. Of the same rows every capacity makes the
/// same answer. `FEATURE_ROWS` is what the matcher needs.
///
/// Rows come out at most [`Pipeline::LATENCY`] rows after the camera's. Everything that lasts from
/// row to row is in here; on the stack a few lines of scratch come and go, less than 16 bytes a
/// column.
#[derive(Debug, Clone)]
pub struct Pipeline<M, const FEATURE_ROWS: usize, const BLOCKS: usize, C = Untimed> {
    config: Config,
    parts: Parts,
    left: View<FEATURE_ROWS, BLOCKS>,
    right: View<FEATURE_ROWS, BLOCKS>,
    exposure: Exposure,
    noise: Noise,
    seeds: Seeds<BLOCKS>,
    blocks: BlockRows<BLOCKS>,
    pub(crate) matcher: M,
    /// Rows of this frame pushed or missed so far.
    rows: u32,
    /// Rows of this frame delivered so far.
    answered: u32,
    missing: MissingRows,
    clock: C,
}

impl<M, const FEATURE_ROWS: usize, const BLOCKS: usize, C> Pipeline<M, FEATURE_ROWS, BLOCKS, C> {
    /// Rows that come in after a row before it goes out, at most: the window of the next block row
    /// and the front end's lag.
    pub const LATENCY: u32 = 2 * SIZE_U32 + FEATURE_LAG;
}

impl<M, const FEATURE_ROWS: usize, const BLOCKS: usize> Pipeline<M, FEATURE_ROWS, BLOCKS>
where
    M: Matcher<FEATURE_ROWS, BLOCKS> + Default,
{
    /// Builds the method for rows of `config.width` px.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        Self::with_parts(config, Parts::ALL)
    }

    /// Builds the method of some of its parts only, to see what the others bring.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn with_parts(config: Config, parts: Parts) -> Result<Self, ConfigError> {
        Self::build(config, parts, Untimed)
    }
}

impl<M, const FEATURE_ROWS: usize, const BLOCKS: usize, C> Pipeline<M, FEATURE_ROWS, BLOCKS, C>
where
    M: Matcher<FEATURE_ROWS, BLOCKS> + Default,
    C: StageClock,
{
    /// Builds the method for rows of `config.width` px, with a clock that is told of its stages.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn timed(config: Config, clock: C) -> Result<Self, ConfigError> {
        Self::build(config, Parts::ALL, clock)
    }

    fn build(config: Config, parts: Parts, clock: C) -> Result<Self, ConfigError> {
        check_capacity(&config, BLOCKS)?;
        Ok(Self {
            config,
            parts,
            left: View::new(),
            right: View::new(),
            exposure: Exposure::new(),
            noise: Noise::default(),
            seeds: Seeds::new(),
            blocks: BlockRows::new(),
            matcher: M::default(),
            rows: 0,
            answered: 0,
            missing: MissingRows::default(),
            clock,
        })
    }
}

impl<M, const FEATURE_ROWS: usize, const BLOCKS: usize, C> Pipeline<M, FEATURE_ROWS, BLOCKS, C>
where
    M: Matcher<FEATURE_ROWS, BLOCKS>,
    C: StageClock,
{
    /// Goes as far as the newest row of both views allows.
    fn advance(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = usize::from(self.config.width);
        let newest = self.left.raw.len() - 1;
        if newest >= SMOOTH_LAG {
            let gain = self.exposure.gain();
            self.left.smooth_row(self.noise.level, gain, width);
            self.right.smooth_row(self.noise.level, gain, width);
            if self.left.smooth.len().is_multiple_of(SIZE_U32) {
                self.clock.enter(stage::Stage::Contours);
                self.find_contours(width);
                self.clock.enter(stage::Stage::Features);
            }
        }
        if newest >= FEATURE_LAG {
            let reading = self.matcher.reading();
            self.left.feature_row(reading, width);
            self.right.feature_row(reading, width);
            // One row below the block row's last one ends its window.
            let features = self.left.features.len();
            if features > SIZE_U32 && features % SIZE_U32 == 1 {
                self.match_blocks();
                self.answer(sink, false);
            }
        }
    }

    /// Contours of the block row whose four smoothed rows are the newest.
    fn find_contours(&mut self, width: usize) {
        let first = i64::from(self.left.smooth.len() - SIZE_U32);
        let mut sums = [[0u16; 4]; BLOCKS];
        let views = [(&self.right, &mut self.seeds.right), (&self.left, &mut self.seeds.left)];
        for (view, contours) in views {
            let sums = sums.as_flattened_mut();
            sum_rows(view.smooth.window(first), sums);
            // Columns beside the image complete the support at its border columns.
            let beside = usize::from(HALF_SUPPORT);
            let line = sums.get(MARGIN - beside..MARGIN + width + beside - 1).unwrap_or(&[]);
            count::additions(3 * width);
            // A running response, its magnitude and that of its neighbours, the threshold.
            count::additions(2 * line.len());
            count::subtractions(3 * line.len());
            count::comparisons(6 * line.len());
            contours.find(line, -i32::from(HALF_SUPPORT), HALF_SUPPORT, CONTOUR_THRESHOLD);
        }
    }

    /// Decides the next block row.
    fn match_blocks(&mut self) {
        // The three rows in the middle of the block row, where its contours are.
        let middle = i64::from(self.blocks.len() * SIZE_U32) + 1;
        let (left, right) = (self.left.features.window::<3>(middle), self.right.features.window::<3>(middle));
        self.clock.enter(stage::Stage::Seeds);
        self.seeds.find(&self.config, &left, &right);
        let (stage, matcher, blocks, clock) = self.stage();
        matcher.decide(&stage, blocks, clock);
    }

    /// What the matcher sees, apart from what it changes.
    fn stage(&mut self) -> (Stage<'_, FEATURE_ROWS, BLOCKS>, &mut M, &mut BlockRows<BLOCKS>, &C) {
        let stage = Stage {
            config: &self.config,
            seeds: &self.seeds,
            texture: self.texture(),
            parts: self.parts,
            left: &self.left,
            right: &self.right,
        };
        (stage, &mut self.matcher, &mut self.blocks, &self.clock)
    }

    fn texture(&self) -> Texture {
        if self.parts.texture { Texture::of(self.noise, self.matcher.reading()) } else { Texture::OFF }
    }

    /// Delivers the rows of the last block row but one, or of the last one at the end of the frame.
    fn answer(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>), at_end: bool) {
        self.clock.enter(stage::Stage::Consistency);
        let texture = self.texture();
        let Some(blocks) = self.blocks.neighbourhood(self.config.blocks(), at_end) else { return };
        let rows = self.answered..(self.answered + SIZE_U32).min(self.rows);
        self.answered = rows.end;
        let missing = self.missing;
        let clock = &self.clock;
        let mut hand_over = |row: DisparityRow<'_>| {
            clock.enter(stage::Stage::Output);
            sink(row);
            clock.enter(stage::Stage::Consistency);
        };
        answer::<BLOCKS>(&self.config, texture, blocks, rows, |y| missing.has(y), &mut hand_over);
    }
}

impl<M, const FEATURE_ROWS: usize, const BLOCKS: usize, C> StereoMethod for Pipeline<M, FEATURE_ROWS, BLOCKS, C>
where
    M: Matcher<FEATURE_ROWS, BLOCKS>,
    C: StageClock,
{
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        self.left.clear();
        self.right.clear();
        self.exposure = Exposure::new();
        self.noise = Noise::default();
        self.blocks.clear();
        self.matcher.clear();
        (self.rows, self.answered, self.missing) = (0, 0, MissingRows::default());
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        pair.check(self.config.width)?;
        self.clock.enter(stage::Stage::Features);
        self.left.raw.push_pixels(pair.left);
        self.right.raw.push_pixels(pair.right);
        self.missing.set(self.rows, false);
        if !self.missing.has_any_of_three(self.rows) {
            self.left.measure_noise(pair.left.len());
            self.right.measure_noise(pair.right.len());
        }
        self.exposure.add(pair.left);
        self.exposure.add(pair.right);
        self.noise = Noise::of(&self.left.noise, &self.right.noise, self.exposure.gain());
        if !self.parts.smoothing {
            self.noise.level = SmoothingLevel::Off;
        }
        self.rows += 1;
        self.advance(sink);
        Ok(())
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.clock.enter(stage::Stage::Features);
        self.left.raw.push_again();
        self.right.raw.push_again();
        self.missing.set(self.rows, true);
        self.rows += 1;
        self.advance(sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.clock.enter(stage::Stage::Features);
        // The last row stands in for those below the image until all block rows are decided.
        let block_rows = self.rows.div_ceil(SIZE_U32);
        while self.blocks.len() < block_rows {
            self.clock.enter(stage::Stage::Features);
            self.left.raw.push_again();
            self.right.raw.push_again();
            self.advance(sink);
        }
        if self.answered < self.rows {
            self.clock.enter(stage::Stage::Consistency);
            let (stage, matcher, blocks, _) = self.stage();
            matcher.finish(&stage, blocks);
            self.answer(sink, true);
        }
        self.start();
    }
}
