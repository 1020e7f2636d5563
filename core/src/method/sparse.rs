//! The frame around the sparse methods: rows in, points measured in one row after the other, rows out.
//! Its names are public and its module is not: nobody outside implements a method of points.

use crate::answer::linkage::{AnswerRing, Answers, LINK_REACH, Links};
use crate::count;
use crate::front_end::exposure::Exposure;
use crate::front_end::noise::{Noise, SmoothingLevel};
use crate::front_end::view::{SMOOTH_LAG, View};
use crate::method::missing_rows::MissingRows;
use crate::method::pipeline::check_capacity;
use crate::stage::{Stage, StageClock, Untimed};
use crate::{Config, ConfigError, DisparityRow, Reading, RowError, ScanlinePair, StereoMethod};

/// Feature rows above and below a row that its answer may look at.
pub(crate) const FEATURE_REACH: u32 = 1;
/// Feature rows that are kept.
pub(crate) const FEATURE_ROWS: usize = 2 * FEATURE_REACH as usize + 1;
/// Rows by which the first answer lags behind the camera at least: smoothing, the features' third row and
/// their reach.
const LEAST_LAG: u32 = SMOOTH_LAG + 1 + FEATURE_REACH;

/// Rows by which an answer lags behind its measurement.
#[expect(clippy::cast_possible_truncation, reason = "2")]
const LINK_ROWS: u32 = LINK_REACH as u32;

/// A view with `ROWS` smoothed rows.
pub type SparseView<const ROWS: usize, const BLOCKS: usize> = View<FEATURE_ROWS, BLOCKS, ROWS>;

/// How a method measures the points of one row; [`Sparse`] does the rest.
pub trait Points<const ROWS: usize, const BLOCKS: usize> {
    /// Smoothed rows below a row that its answer looks at.
    fn reach(&self) -> u32;

    /// Whether feature rows are wanted.
    fn uses_features(&self) -> bool;

    /// The links without which a point is left out.
    fn links(&self) -> Option<Links>;

    /// Measures the points of the row, and tells `clock` of its stages.
    fn measure(&mut self, row: &SparseRow<'_, ROWS, BLOCKS>, answers: &mut Answers<BLOCKS>, clock: &impl StageClock);
}

/// A row that is due: everything that its points may be measured by.
pub struct SparseRow<'a, const ROWS: usize, const BLOCKS: usize> {
    pub(crate) config: &'a Config,
    /// Row of the image.
    pub(crate) y: i64,
    pub(crate) left: &'a SparseView<ROWS, BLOCKS>,
    pub(crate) right: &'a SparseView<ROWS, BLOCKS>,
}

/// A sparse stereo method: the front end that all methods of the core share, and points measured by `M`.
///
/// `BLOCKS` is the capacity, [`blocks_for`](crate::blocks_for) the widest row; `ROWS` the smoothed rows that are kept. Of
/// the same rows every capacity makes the same answer. All pixels without a point are unknown.
#[derive(Debug, Clone)]
pub struct Sparse<M, const ROWS: usize, const BLOCKS: usize, C = Untimed> {
    config: Config,
    points: M,
    left: SparseView<ROWS, BLOCKS>,
    right: SparseView<ROWS, BLOCKS>,
    exposure: Exposure,
    noise: Noise,
    answers: AnswerRing<BLOCKS>,
    /// The row that goes out.
    out: Answers<BLOCKS>,
    /// Rows of this frame measured so far.
    measured: u32,
    /// Rows of this frame pushed or missed so far.
    rows: u32,
    /// Rows of this frame delivered so far.
    answered: u32,
    missing: MissingRows,
    clock: C,
}

impl<M: Points<ROWS, BLOCKS>, const ROWS: usize, const BLOCKS: usize, C: StageClock> Sparse<M, ROWS, BLOCKS, C> {
    /// A method of `points`, whose settings are checked; `clock` is told of its stages.
    pub(crate) fn build(config: Config, points: M, clock: C) -> Result<Self, ConfigError> {
        check_capacity(&config, BLOCKS)?;
        Ok(Self {
            config,
            points,
            left: View::new(),
            right: View::new(),
            exposure: Exposure::new(),
            noise: Noise::default(),
            answers: AnswerRing::new(),
            out: Answers::UNKNOWN,
            measured: 0,
            rows: 0,
            answered: 0,
            missing: MissingRows::default(),
            clock,
        })
    }

    /// Rows that come in after a row before it goes out.
    #[must_use]
    pub fn latency(&self) -> u32 {
        self.measure_lag() + LINK_ROWS
    }

    /// Rows that come in after a row before it is measured.
    fn measure_lag(&self) -> u32 {
        LEAST_LAG.max(SMOOTH_LAG + self.points.reach())
    }

    /// Goes as far as the newest row of both views allows.
    fn advance(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = usize::from(self.config.width);
        let (newest, latency) = (self.left.raw.len() - 1, self.measure_lag());
        if newest >= SMOOTH_LAG {
            let gain = self.exposure.gain();
            self.left.smooth_row(self.noise.level, gain, width);
            self.right.smooth_row(self.noise.level, gain, width);
            count_smoothing(self.noise.level, 2 * width);
        }
        // As late as they are needed, so that few of them need be kept.
        if newest + FEATURE_REACH >= latency && self.points.uses_features() {
            self.left.feature_row(Reading::Haar, width);
            self.right.feature_row(Reading::Haar, width);
            // Two rows' [1 2 1] or three columns' and their difference, clipped on both sides.
            count::additions(2 * 8 * width);
            count::subtractions(2 * width);
            count::comparisons(2 * 2 * width);
        }
        if newest >= latency {
            self.measure();
            if self.measured > LINK_ROWS {
                self.answer(sink);
            }
            self.clock.enter(Stage::Features);
        }
    }

    /// Measures the points of the next row; a missing row has none.
    fn measure(&mut self) {
        let y = self.measured;
        self.measured += 1;
        let answers = self.answers.push();
        if y < self.rows && !self.missing.has(y) {
            let row = SparseRow { config: &self.config, y: i64::from(y), left: &self.left, right: &self.right };
            self.points.measure(&row, answers, &self.clock);
        }
    }

    /// Delivers the next row.
    fn answer(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = usize::from(self.config.width);
        self.clock.enter(Stage::Consistency);
        self.answers.answer(width, self.points.links(), &mut self.out);
        let disparity = self.out.disparity.as_flattened().get(..width).unwrap_or(&[]);
        let confidence = self.out.confidence.as_flattened().get(..width).unwrap_or(&[]);
        self.clock.enter(Stage::Output);
        sink(DisparityRow { y: self.answered, disparity, confidence });
        self.answered += 1;
    }

    /// Takes the newest row into what is known of light and noise.
    fn judge(&mut self, pair: ScanlinePair<'_>) {
        if !self.missing.has_any_of_three(self.rows) {
            self.left.measure_noise(pair.left.len());
            self.right.measure_noise(pair.right.len());
        }
        self.exposure.add(pair.left);
        self.exposure.add(pair.right);
        self.noise = Noise::of(&self.left.noise, &self.right.noise, self.exposure.gain());
        // One pixel in four: a second difference over 9 pixels, its bin, and two thresholds of light.
        let looked_at = 2 * pair.left.len() / 4;
        count::additions(5 * looked_at);
        count::subtractions(13 * looked_at);
        count::comparisons(4 * looked_at);
    }
}

/// Operations of [`View::smooth_row`] on that many pixels, rounding included.
fn count_smoothing(level: SmoothingLevel, pixels: usize) {
    let additions = match level {
        SmoothingLevel::Off => 0,
        SmoothingLevel::Light => 13,
        SmoothingLevel::Medium => 11,
        SmoothingLevel::Strong => 12,
    };
    count::additions(additions * pixels);
}

impl<M: Points<ROWS, BLOCKS>, const ROWS: usize, const BLOCKS: usize, C: StageClock> StereoMethod
    for Sparse<M, ROWS, BLOCKS, C>
{
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        self.left.clear();
        self.right.clear();
        self.exposure = Exposure::new();
        self.noise = Noise::default();
        self.answers.clear();
        (self.rows, self.measured, self.answered, self.missing) = (0, 0, 0, MissingRows::default());
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        pair.check(self.config.width)?;
        self.clock.enter(Stage::Features);
        self.left.raw.push_pixels(pair.left);
        self.right.raw.push_pixels(pair.right);
        self.missing.set(self.rows, false);
        self.judge(pair);
        self.rows += 1;
        self.advance(sink);
        Ok(())
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.clock.enter(Stage::Features);
        self.left.raw.push_again();
        self.right.raw.push_again();
        self.missing.set(self.rows, true);
        self.rows += 1;
        self.advance(sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.clock.enter(Stage::Features);
        // The last row stands in for those below the image until all rows are answered.
        while self.answered < self.rows {
            self.left.raw.push_again();
            self.right.raw.push_again();
            self.advance(sink);
        }
        self.start();
    }
}
