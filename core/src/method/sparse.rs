//! The frame around the sparse methods: rows in, points measured in one pair of rows after the other, rows out.
//! Its names are public and its module is not: nobody outside implements a method of points.

use crate::answer::linkage::{Links, PointRows};
use crate::front_end::camera_pair::CameraPair;
use crate::front_end::camera_view::Row;
use crate::front_end::noise::RawNoise;
use crate::lanes::rows::Clips;
use crate::method::capacity::check_capacity;
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
    smooth: &'a [[Row<BLOCKS>; ROWS]; 2],
}

impl<'a, const ROWS: usize, const BLOCKS: usize> SparseRows<'a, ROWS, BLOCKS> {
    /// A smoothed row of the left view, 0, or of the right one, 1; `offset` is that from the first of the two rows. Above the
    /// image its first row goes on, below it its last.
    pub(crate) fn row(&self, view: usize, offset: i64) -> &'a Row<BLOCKS> {
        let y = (i64::from(self.y) + offset).clamp(0, self.newest.into());
        &self.smooth[view][usize::try_from(y).unwrap_or(0) % ROWS]
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
    /// The features of a pair of rows are made when they are due.
    cameras: CameraPair<BLOCKS, [[[u32; BLOCKS]; 4]; 0]>,
    /// The newest smoothed rows of the left view and of the right one.
    smooth: [[Row<BLOCKS>; ROWS]; 2],
    points: PointRows<BLOCKS>,
    /// The pair of rows that goes out.
    disparity: [[Disparity; 4]; BLOCKS],
    confidence: [[u8; 4]; BLOCKS],
    /// Rows of this frame smoothed so far.
    smoothed: u32,
    /// Pairs of rows measured and written, and rows delivered so far.
    measured: u32,
    written: u32,
    delivered: u32,
    clock: C,
}

impl<M: Points<ROWS, BLOCKS>, const ROWS: usize, const BLOCKS: usize, C: StageClock> Sparse<M, ROWS, BLOCKS, C> {
    /// A method of points, whose settings are checked; `clock` is told of its stages.
    pub(crate) fn build(config: Config, method: M, clock: C) -> Result<Self, ConfigError> {
        check_capacity(&config, BLOCKS)?;
        Ok(Self {
            config,
            method,
            cameras: CameraPair::EMPTY,
            smooth: [[[0; BLOCKS]; ROWS]; 2],
            points: PointRows::new(),
            disparity: [[Disparity::UNKNOWN; 4]; BLOCKS],
            confidence: [[0; 4]; BLOCKS],
            smoothed: 0,
            measured: 0,
            written: 0,
            delivered: 0,
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
        if self.cameras.left.len() > SMOOTH_LAG {
            let level = self.cameras.noise().level;
            let views = [&mut self.cameras.left, &mut self.cameras.right];
            for (view, rows) in views.into_iter().zip(&mut self.smooth) {
                view.smooth_row(level, width);
                rows[self.smoothed as usize % ROWS] = *view.smooth(self.smoothed);
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
        if (y..y + POINT_ROWS).any(|y| y < self.cameras.rows() && !self.cameras.is_missing(y)) {
            let (config, clips) = (&self.config, self.cameras.noise().level.clips());
            let rows = SparseRows { config, clips, y, newest: self.smoothed - 1, smooth: &self.smooth };
            self.method.measure(&rows, &mut self.points, &self.clock);
        }
    }

    /// Delivers the next row, if it is written.
    fn deliver(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let y = self.delivered;
        if y >= self.cameras.rows() || y / POINT_ROWS >= self.written {
            return;
        }
        self.delivered += 1;
        let width = usize::from(self.config.width);
        self.clock.enter(Stage::Output);
        if self.cameras.is_missing(y) {
            let (unknown, none) = ([[Disparity::UNKNOWN; 4]; BLOCKS], [[0; 4]; BLOCKS]);
            let (disparity, confidence) = (&unknown.as_flattened()[..width], &none.as_flattened()[..width]);
            return sink(DisparityRow { y, disparity, confidence });
        }
        let disparity = &self.disparity.as_flattened()[..width];
        sink(DisparityRow { y, disparity, confidence: &self.confidence.as_flattened()[..width] });
    }
}

impl<M: Points<ROWS, BLOCKS>, const ROWS: usize, const BLOCKS: usize, C: StageClock> StereoMethod
    for Sparse<M, ROWS, BLOCKS, C>
{
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        self.cameras.clear();
        self.points.clear();
        (self.smoothed, self.measured, self.written, self.delivered) = (0, 0, 0, 0);
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        pair.check(self.config.width)?;
        self.clock.enter(Stage::Features);
        self.cameras.push(pair);
        self.advance(sink);
        Ok(())
    }

    fn take_noise(&mut self, noise: &RawNoise) {
        self.cameras.take_noise(noise);
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.clock.enter(Stage::Features);
        self.cameras.miss();
        self.advance(sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        // The last row stands in for those below the image.
        while self.delivered < self.cameras.rows() {
            self.clock.enter(Stage::Features);
            self.cameras.go_on();
            self.advance(sink);
        }
        self.start();
    }
}
