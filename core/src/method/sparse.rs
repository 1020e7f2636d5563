//! The frame around the sparse methods: rows in, points measured in one pair of rows after the other, rows out.
//! Its names are public and its module is not: nobody outside implements a method of points.

use crate::answer::linkage::{Links, PointRows};
use crate::front_end::camera_view::{CameraView, Row};
use crate::front_end::exposure::{Exposure, Gain};
use crate::front_end::noise::{Noise, NoiseHistogram, RawNoise};
use crate::front_end::sampling::Sampling;
use crate::lanes::rows::Clips;
use crate::method::capacity::check_capacity;
use crate::method::missing_rows::MissingRows;
use crate::stage::{Stage, StageClock, Untimed};
use crate::{Config, ConfigError, Disparity, DisparityRow, RowError, ScanlinePair, StereoMethod};

/// Rows of the camera by which the newest smoothed row lags behind: half of the widest filter.
const SMOOTH_LAG: u32 = 2;
/// Rows of the image that share their points.
pub(crate) const POINT_ROWS: u32 = 2;
/// Smoothed rows below the first of the two that every method needs.
pub(crate) const LEAST_REACH: u32 = 2;

/// How a method measures the points of a pair of rows; [`Sparse`] does the rest.
pub trait Points<const ROWS: usize, const BLOCKS: usize> {
    /// Smoothed rows below the first of the two that it looks at; at least two.
    fn reach(&self) -> u32;

    /// The links without which a point is left out.
    fn links(&self) -> Option<Links>;

    /// Measures the points of the rows, and tells `clock` of its stages.
    fn measure(&mut self, rows: &SparseRows<'_, ROWS, BLOCKS>, points: &mut PointRows<BLOCKS>, clock: &impl StageClock);
}

/// A pair of rows that is due: everything that its points may be measured by.
pub struct SparseRows<'a, const ROWS: usize, const BLOCKS: usize> {
    pub(crate) config: &'a Config,
    /// How strong gradients are limited.
    pub(crate) clips: Clips,
    y: u32,
    newest: u32,
    views: &'a [SparseView<ROWS, BLOCKS>; 2],
}

impl<'a, const ROWS: usize, const BLOCKS: usize> SparseRows<'a, ROWS, BLOCKS> {
    /// A smoothed row of the left view, 0, or of the right one, 1; `offset` is that from the first of the two rows. Above the
    /// image its first row goes on, below it its last.
    pub(crate) fn row(&self, view: usize, offset: i64) -> &'a Row<BLOCKS> {
        let y = (i64::from(self.y) + offset).clamp(0, self.newest.into());
        &self.views[view].rows[usize::try_from(y).unwrap_or(0) % ROWS]
    }
}

/// One view and its newest smoothed rows; the features of a pair of rows are made when they are due.
#[derive(Debug, Clone)]
struct SparseView<const ROWS: usize, const BLOCKS: usize> {
    camera: CameraView<BLOCKS, [[[u32; BLOCKS]; 4]; 0]>,
    rows: [Row<BLOCKS>; ROWS],
    noise: NoiseHistogram,
}

impl<const ROWS: usize, const BLOCKS: usize> SparseView<ROWS, BLOCKS> {
    const fn new() -> Self {
        Self { camera: CameraView::new(), rows: [[0; BLOCKS]; ROWS], noise: NoiseHistogram::new() }
    }
}

/// A sparse stereo method: the front end that all methods of the core share, and points measured by `M`.
///
/// `BLOCKS` is the capacity, [`blocks_for`](crate::blocks_for) the widest row; `ROWS` the smoothed rows that are kept. Of
/// the same rows every capacity makes the same answer. All pixels without a point are unknown.
#[derive(Debug, Clone)]
pub struct Sparse<M, const ROWS: usize, const BLOCKS: usize, C = Untimed> {
    config: Config,
    method: M,
    views: [SparseView<ROWS, BLOCKS>; 2],
    exposure: Exposure,
    noise: Noise,
    /// Whether it is that of rows before they were interpolated.
    has_raw_noise: bool,
    points: PointRows<BLOCKS>,
    /// The pair of rows that goes out.
    disparity: [[Disparity; 4]; BLOCKS],
    confidence: [[u8; 4]; BLOCKS],
    /// Rows of this frame pushed or missed, and smoothed so far.
    rows: u32,
    smoothed: u32,
    /// Pairs of rows measured and written, and rows delivered so far.
    measured: u32,
    written: u32,
    delivered: u32,
    missing: MissingRows,
    clock: C,
}

impl<M: Points<ROWS, BLOCKS>, const ROWS: usize, const BLOCKS: usize, C: StageClock> Sparse<M, ROWS, BLOCKS, C> {
    /// A method of points, whose settings are checked; `clock` is told of its stages.
    pub(crate) fn build(config: Config, method: M, clock: C) -> Result<Self, ConfigError> {
        check_capacity(&config, BLOCKS)?;
        Ok(Self {
            config,
            method,
            views: [SparseView::new(), SparseView::new()],
            exposure: Exposure::new(),
            noise: Noise::default(),
            has_raw_noise: false,
            points: PointRows::new(),
            disparity: [[Disparity::UNKNOWN; 4]; BLOCKS],
            confidence: [[0; 4]; BLOCKS],
            rows: 0,
            smoothed: 0,
            measured: 0,
            written: 0,
            delivered: 0,
            missing: MissingRows::default(),
            clock,
        })
    }

    /// Rows that come in after a row before it goes out: the smoothing's and the method's reach, and the next pair of rows,
    /// whose points have their say.
    #[must_use]
    pub fn latency(&self) -> u32 {
        SMOOTH_LAG + self.method.reach() + POINT_ROWS + 1
    }

    /// Goes as far as the newest row of both views allows.
    fn advance(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = usize::from(self.config.width);
        if self.views[0].camera.len() > SMOOTH_LAG {
            for view in &mut self.views {
                view.camera.smooth_row(self.noise.level, width);
                view.rows[self.smoothed as usize % ROWS] = *view.camera.smooth(self.smoothed.into());
            }
            self.smoothed += 1;
            // One row measures a pair, the next one writes the pair before.
            if self.smoothed > POINT_ROWS * self.measured + self.method.reach() {
                self.measure();
            } else if self.measured > self.written + 1 {
                self.clock.enter(Stage::Consistency);
                let links = self.method.links();
                self.points.write(&self.config, links, &mut self.disparity, &mut self.confidence);
                self.written += 1;
            }
        }
        self.deliver(sink);
    }

    /// Measures the points of the next pair of rows; rows that are missing or below the image have none.
    fn measure(&mut self) {
        let y = POINT_ROWS * self.measured;
        self.measured += 1;
        self.points.begin();
        if (y..y + POINT_ROWS).any(|y| y < self.rows && !self.missing.has(y)) {
            let (config, clips) = (&self.config, self.noise.level.clips());
            let rows = SparseRows { config, clips, y, newest: self.smoothed - 1, views: &self.views };
            self.method.measure(&rows, &mut self.points, &self.clock);
        }
    }

    /// Delivers the next row, if it is written.
    fn deliver(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let y = self.delivered;
        if y >= self.rows || y / POINT_ROWS >= self.written {
            return;
        }
        self.delivered += 1;
        let width = usize::from(self.config.width);
        self.clock.enter(Stage::Output);
        if self.missing.has(y) {
            let (unknown, none) = ([[Disparity::UNKNOWN; 4]; BLOCKS], [[0; 4]; BLOCKS]);
            let (disparity, confidence) = (&unknown.as_flattened()[..width], &none.as_flattened()[..width]);
            return sink(DisparityRow { y, disparity, confidence });
        }
        let disparity = &self.disparity.as_flattened()[..width];
        sink(DisparityRow { y, disparity, confidence: &self.confidence.as_flattened()[..width] });
    }

    /// Takes the noise of some pixels of the row that came before the newest.
    fn measure_noise(&mut self) {
        let Some(sampling) = Sampling::of(self.rows).filter(|_| !self.has_raw_noise) else { return };
        if self.rows >= 2 && !self.missing.has_any_of_three(self.rows) {
            let y = i64::from(self.rows) - 1;
            for view in &mut self.views {
                let rows = [y - 1, y, y + 1].map(|y| view.camera.raw(y));
                view.noise.sample(rows, sampling.first, sampling.stride, sampling.weight, self.config.width.into());
            }
        }
        if self.rows < 16 || self.rows.is_multiple_of(8) {
            let [left, right] = &self.views;
            self.noise = Noise::of(&left.noise, &right.noise, Gain::default());
        }
    }
}

impl<M: Points<ROWS, BLOCKS>, const ROWS: usize, const BLOCKS: usize, C: StageClock> StereoMethod
    for Sparse<M, ROWS, BLOCKS, C>
{
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        for view in &mut self.views {
            view.camera.clear();
            view.noise.clear();
        }
        self.exposure = Exposure::new();
        (self.noise, self.has_raw_noise) = (Noise::default(), false);
        self.points.clear();
        (self.rows, self.smoothed, self.measured) = (0, 0, 0);
        (self.written, self.delivered, self.missing) = (0, 0, MissingRows::default());
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        pair.check(self.config.width)?;
        self.clock.enter(Stage::Features);
        self.missing.set(self.rows, false);
        if let Some(sampling) = Sampling::of(self.rows) {
            self.exposure.sample(pair.left, sampling.first, sampling.stride);
            self.exposure.sample(pair.right, sampling.first, sampling.stride);
        }
        let gain = self.exposure.gain();
        let [left, right] = &mut self.views;
        left.camera.push(pair.left, gain);
        right.camera.push(pair.right, gain);
        self.measure_noise();
        self.rows += 1;
        self.advance(sink);
        Ok(())
    }

    fn take_noise(&mut self, noise: &RawNoise) {
        self.has_raw_noise = true;
        self.noise = noise.noise(self.exposure.gain());
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.clock.enter(Stage::Features);
        self.views.iter_mut().for_each(|view| view.camera.push_again());
        self.missing.set(self.rows, true);
        self.rows += 1;
        self.advance(sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        // The last row stands in for those below the image.
        while self.delivered < self.rows {
            self.clock.enter(Stage::Features);
            self.views.iter_mut().for_each(|view| view.camera.push_again());
            self.advance(sink);
        }
        self.start();
    }
}
