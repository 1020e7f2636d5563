//! Block matching as OpenCV's StereoBM does it, streaming and in bounded memory: the reference `block`.
//!
//! Both views go through a capped horizontal Sobel filter. For each pixel and disparity the absolute
//! differences are summed over a square window. The least sum wins, unless the window has too little
//! texture or another disparity is nearly as good, and is refined from its two neighbours.
//!
//! # Design
//! A sum of each column and disparity over the window's rows is kept from row to row: the entering
//! row's difference is added, the leaving row's subtracted. A sum over the window's columns slides
//! along the row in the same way. So a pixel and disparity costs two differences and four additions
//! whatever the window's size. The leaving difference is computed again from the kept rows; keeping
//! it would need a window of rows for every disparity.
//!
//! A row's disparities leave when the row `WINDOW / 2 + 1` below it has come.
//!
//! # Agreement with OpenCV
//! Results equal those of `StereoBM_create(num_disparities, WINDOW)` of OpenCV 5.0.0, bit by bit,
//! also in what comes from its borders and its arithmetic:
//! - known are only pixels whose window lies in the left view and which have every disparity in the
//!   right view;
//! - for `min_disparity` < 0 the last columns of the right view are used again where a window
//!   reaches over the edge;
//! - the prefilter's border columns are flat, its rows are mirrored at the frame's edges, and the
//!   last row of a frame of odd height is flat;
//! - of equal costs the greater disparity wins, and disparities are rounded up to 1/16 px.
//!
//! Different on purpose:
//! - pixels are unknown where OpenCV leaves stray values: all if no column can be answered (it leaves
//!   the map as it was allocated), and with a positive `min_disparity` the first ones of the row
//!   below the answered rows (its last columns run over into the next row);
//! - no answer is [`Disparity::UNKNOWN`] instead of `16 * (min_disparity - 1)`;
//! - `num_disparities` need not be a multiple of 16, and frames may be lower than the window;
//! - there are no left-right check and no speckle filter, which are off in OpenCV's defaults too.
//!
//! # Source
//! OpenCV's class, contributed by K. Konolige: <https://docs.opencv.org/4.x/d9/dba/classcv_1_1StereoBM.html>;
//! its right margin: <https://github.com/opencv/opencv/pull/9816>. What neither says was found by
//! comparing maps.

mod absolute;
mod area;
mod prefilter;
mod settings;
mod sums;
mod view;
mod winner;

use haarline::{Config, ConfigError, Disparity, DisparityRow, RowError, ScanlinePair, StereoMethod, count};
use haarline::{Stage, StageClock, Untimed};

pub use absolute::AbsoluteSums;
use area::SearchArea;
pub use prefilter::sobel_x;
pub use settings::BlockSettings;
pub use sums::{Measure, Place, RunningSums, Step, Sums};
use view::View;
pub use winner::Winner;

/// Block matching over `WINDOW` x `WINDOW` px, for rows of up to `WIDTH` px and up to `DISPARITIES`
/// disparities.
///
/// `WINDOW` is odd, `5..=21`, so that every sum fits 16 bits: 21 * 21 * 126 < 2^16.
///
/// It takes `WIDTH * (2 * DISPARITIES + 2 * WINDOW + 13)` bytes and less than 1 KB more:
/// 51 KB at 320 px and 64 disparities. Building a large one passes copies over the stack in debug.
///
/// The confidence is the lead over the best disparity more than one away: 12 + 43 x (1 - best cost /
/// second cost), rounded down. 12 is as good as a guess between the two (only with the uniqueness
/// gate off); the default gate of 15 percent lets values from 17 up through. All are doubtful at most: 64
/// and more is *sure*, and a lead alone tells neither a fence nor what the right view does not see.
///
/// # Examples
/// ```
/// use haarline::{Config, StereoMethod};
/// use haarline_tests::{BlockSettings, StereoBm};
/// let config = Config { num_disparities: 48, ..Config::for_width(320) };
/// let method: StereoBm<320, 64> = StereoBm::new(config, BlockSettings::default()).unwrap();
/// assert_eq!(method.config().num_disparities, 48);
/// ```
pub type StereoBm<const WIDTH: usize, const DISPARITIES: usize, const WINDOW: usize = 9, C = Untimed> =
    BlockMatcher<AbsoluteSums<WIDTH, DISPARITIES>, WIDTH, WINDOW, C>;

/// The steps of block matching around the sums `S` of a cost: [`StereoBm`], [`Ssd`](crate::Ssd), [`Ncc`](crate::Ncc).
#[derive(Debug, Clone)]
pub struct BlockMatcher<S, const WIDTH: usize, const WINDOW: usize, C = Untimed> {
    config: Config,
    settings: BlockSettings,
    /// Columns to answer; none if the range is too large for the row.
    area: Option<SearchArea>,
    /// Rows of the frame that came or were lost.
    rows: u32,
    /// Whether row `y` was lost, at `y % WINDOW`.
    missed: [bool; WINDOW],
    left: View<WIDTH, WINDOW>,
    right: View<WIDTH, WINDOW>,
    sums: S,
    /// Magnitudes of the left response summed over the window's rows, by cost column.
    column_texture: [u16; WIDTH],
    /// The sum of them over the whole window.
    window_texture: u32,
    disparity: [Disparity; WIDTH],
    confidence: [u8; WIDTH],
    clock: C,
}

impl<S: Sums, const WIDTH: usize, const WINDOW: usize> BlockMatcher<S, WIDTH, WINDOW> {
    /// Prepares the first frame.
    ///
    /// # Errors
    /// If `config` is out of range, or over the capacity: [`ConfigError::Capacity`] for the width,
    /// [`ConfigError::DisparityCapacity`] for the disparities.
    pub fn new(config: Config, settings: BlockSettings) -> Result<Self, ConfigError> {
        Self::timed(config, settings, Untimed)
    }
}

impl<S: Sums, const WIDTH: usize, const WINDOW: usize, C: StageClock> BlockMatcher<S, WIDTH, WINDOW, C> {
    /// Pixels of the window to each side of its centre.
    #[expect(clippy::cast_possible_truncation, reason = "a window of at most 21 px")]
    const RADIUS: u32 = (WINDOW / 2) as u32;

    /// As [`new`](BlockMatcher::new), with a clock that is told of the stages.
    ///
    /// # Errors
    /// As there.
    pub fn timed(config: Config, settings: BlockSettings, clock: C) -> Result<Self, ConfigError> {
        const {
            assert!(WINDOW % 2 == 1 && 5 <= WINDOW && WINDOW <= 21, "an odd window of 5 to 21 px");
            assert!(0 < S::DISPARITIES && S::DISPARITIES <= Config::MAX_DISPARITIES as usize);
            assert!(Config::MIN_WIDTH as usize <= WIDTH && WIDTH <= Config::MAX_WIDTH as usize);
        }
        config.check()?;
        if usize::from(config.width) > WIDTH {
            return Err(ConfigError::Capacity { max_width: u16::try_from(WIDTH).unwrap_or(u16::MAX) });
        }
        if usize::from(config.num_disparities) > S::DISPARITIES {
            return Err(ConfigError::DisparityCapacity {
                max_disparities: u16::try_from(S::DISPARITIES).unwrap_or(u16::MAX),
            });
        }
        let mut method = Self {
            config,
            settings: settings.with_valid_cap(),
            area: SearchArea::new(&config, WINDOW / 2),
            rows: 0,
            missed: [false; WINDOW],
            left: View::new(),
            right: View::new(),
            sums: S::new(),
            column_texture: [0; WIDTH],
            window_texture: 0,
            disparity: [Disparity::UNKNOWN; WIDTH],
            confidence: [0; WIDTH],
            clock,
        };
        method.start();
        Ok(method)
    }

    /// What it decides by.
    #[must_use]
    pub const fn settings(&self) -> &BlockSettings {
        &self.settings
    }

    /// Counts the row just kept, and works on the row before it, whose prefilter was waiting.
    fn count(&mut self, missed: bool, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let y = self.rows;
        self.missed[y as usize % WINDOW] = missed;
        self.rows += 1;
        if let Some(before) = y.checked_sub(1) {
            self.enter(before, false, sink);
        }
    }

    /// Moves the window down to row `y`, and delivers the row in its middle.
    fn enter(&mut self, y: u32, last: bool, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let (width, cap) = (usize::from(self.config.width), self.settings.prefilter_cap);
        self.clock.enter(Stage::Features);
        self.left.prefilter(y, width, last, cap);
        self.right.prefilter(y, width, last, cap);
        self.clock.enter(Stage::Blocks);
        if let Some(area) = self.area {
            self.update_columns(area, y);
        }
        self.left.advance(y);
        self.right.advance(y);

        let Some(middle) = y.checked_sub(Self::RADIUS) else { return };
        match self.area {
            Some(area) if middle >= Self::RADIUS && !self.missed[middle as usize % WINDOW] => self.match_row(area),
            _ => self.forget_row(),
        }
        self.deliver(middle, sink);
    }

    /// Brings the columns' sums up to date: row `y` enters, row `y - WINDOW` leaves.
    fn update_columns(&mut self, area: SearchArea, y: u32) {
        let cap = self.settings.prefilter_cap;
        let searched = usize::from(self.config.num_disparities);
        let width = usize::from(self.config.width);
        let [left, right] = [&self.left, &self.right]
            .map(|view| Step { entering: &view.entering()[..width], leaving: &view.leaving(y)[..width] });
        self.sums.enter_row(left, right, cap);
        // Of texture two differences and two sums.
        for (column, texture) in self.column_texture.iter_mut().enumerate().take(area.cost_columns) {
            let place = area.place(column);
            let pixel = Step { entering: left.entering[place.left], leaving: left.leaving[place.left] };
            *texture = *texture + difference(pixel.entering, cap) - difference(pixel.leaving, cap);
            let candidates = Step {
                entering: &right.entering[place.right..][..searched],
                leaving: &right.leaving[place.right..][..searched],
            };
            self.sums.enter(column, pixel, candidates, cap);
        }
    }

    /// Slides the window along the row, and fills `disparity` and `confidence`.
    fn match_row(&mut self, area: SearchArea) {
        let searched = usize::from(self.config.num_disparities);
        self.forget_row();
        self.window_texture = self.column_texture[..WINDOW].iter().copied().map(u32::from).sum();
        self.sums.begin(searched);
        for column in 0..WINDOW {
            self.sums.add(area.place(column), searched);
        }
        self.decide(area.first);
        for x in area.first + 1..area.end {
            self.slide(area, x - area.first - 1);
            self.decide(x);
        }
    }

    /// Moves the window from its first cost column, `leaving`, on by one.
    fn slide(&mut self, area: SearchArea, leaving: usize) {
        let entering = leaving + WINDOW;
        self.window_texture += u32::from(self.column_texture[entering]);
        self.window_texture -= u32::from(self.column_texture[leaving]);
        let columns = Step { entering: area.place(entering), leaving: area.place(leaving) };
        self.sums.slide(columns, usize::from(self.config.num_disparities));
    }

    /// Fills in the window's centre, column `x`, if its winner passes the gates.
    #[inline(always)]
    fn decide(&mut self, x: usize) {
        if self.window_texture < self.settings.texture_threshold {
            return;
        }
        let searched = usize::from(self.config.num_disparities);
        // Each slides into its place by running sums, whatever the window.
        count::evaluations(searched);
        let winner = self.sums.winner(searched);
        let ratio = self.settings.uniqueness_ratio;
        if ratio > 0 && !winner.is_unique(ratio) {
            return;
        }
        let refined = winner.refine();
        let q8 = self.disparity_px(winner.index) * 256 + refined;
        self.disparity[x] = Disparity::from_bits(round_up_to_q4(q8));
        self.confidence[x] = winner.confidence();
    }

    /// Disparity at that position of the costs, px; position 0 is the greatest disparity.
    fn disparity_px(&self, index: usize) -> i32 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "below 256")]
        let index = index as i32;
        i32::from(self.config.min_disparity) + i32::from(self.config.num_disparities) - 1 - index
    }

    /// Makes the whole row unknown.
    fn forget_row(&mut self) {
        self.disparity.fill(Disparity::UNKNOWN);
        self.confidence.fill(0);
    }

    /// Hands the row over as row `y` of the frame.
    fn deliver(&self, y: u32, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = usize::from(self.config.width);
        self.clock.enter(Stage::Output);
        sink(DisparityRow { y, disparity: &self.disparity[..width], confidence: &self.confidence[..width] });
    }
}

impl<S: Sums, const WIDTH: usize, const WINDOW: usize, C: StageClock> StereoMethod
    for BlockMatcher<S, WIDTH, WINDOW, C>
{
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        self.rows = 0;
        // Above the frame both views count as flat: without difference, without texture.
        self.left.reset(self.settings.prefilter_cap);
        self.right.reset(self.settings.prefilter_cap);
        self.sums.reset();
        self.column_texture.fill(0);
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        for view in [pair.left, pair.right] {
            if view.len() != usize::from(self.config.width) {
                return Err(RowError::Width { expected: self.config.width, found: view.len() });
            }
        }
        self.clock.enter(Stage::Features);
        self.left.take(self.rows, pair.left);
        self.right.take(self.rows, pair.right);
        self.count(false, sink);
        Ok(())
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.clock.enter(Stage::Features);
        self.left.stand_in(self.rows);
        self.right.stand_in(self.rows);
        self.count(true, sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        if let Some(last) = self.rows.checked_sub(1) {
            self.enter(last, true, sink);
        }
        // The windows of these rows would reach over the lower edge.
        self.forget_row();
        for y in self.rows.saturating_sub(Self::RADIUS)..self.rows {
            self.deliver(y, sink);
        }
        self.start();
    }
}

/// Magnitude of a response that is `cap` too great: at most 63.
fn difference(one: u8, other: u8) -> u16 {
    u16::from(one.abs_diff(other))
}

/// From 1/256 px to 1/16 px, rounded up. Every disparity that can be searched fits.
fn round_up_to_q4(q8: i32) -> i16 {
    let q4 = (q8 + 15) >> (8 - Disparity::FRAC_BITS);
    #[expect(clippy::cast_possible_truncation, reason = "-129 * 16..=384 * 16")]
    let q4 = q4 as i16;
    q4
}
