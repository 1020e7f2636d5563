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

mod area;
mod prefilter;
mod settings;
mod view;
mod winner;

use haarline::{Config, ConfigError, Disparity, DisparityRow, RowError, ScanlinePair, StereoMethod};
use haarline::{Stage, StageClock, Untimed};

use area::SearchArea;
pub use prefilter::sobel_x;
pub use settings::BlockSettings;
use view::View;
use winner::Winner;

/// Block matching over `WINDOW` x `WINDOW` px, for rows of up to `WIDTH` px and up to `DISPARITIES`
/// disparities.
///
/// `WINDOW` is odd, `5..=21`, so that every sum fits 16 bits: 21 * 21 * 126 < 2^16.
///
/// It takes `WIDTH * (2 * DISPARITIES + 2 * WINDOW + 13)` bytes and less than 1 KB more:
/// 51 KB at 320 px and 64 disparities. Building a large one passes copies over the stack in debug.
///
/// The confidence is the lead over the best disparity more than one away: 255 x (1 - best cost /
/// second cost), rounded down. 0 is as good as a guess between the two (only with the uniqueness
/// gate off); the default gate of 15 percent lets values from 33 up through.
///
/// # Examples
/// ```
/// use haarline::{Config, StereoMethod};
/// use haarline_tests::{BlockSettings, StereoBm};
/// let config = Config { num_disparities: 48, ..Config::for_width(320) };
/// let method: StereoBm<320, 64> = StereoBm::new(config, BlockSettings::default()).unwrap();
/// assert_eq!(method.config().num_disparities, 48);
/// ```
#[derive(Debug, Clone)]
pub struct StereoBm<const WIDTH: usize, const DISPARITIES: usize, const WINDOW: usize = 9, C = Untimed> {
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
    /// Absolute differences summed over the window's rows, by cost column and disparity.
    column_costs: [[u16; DISPARITIES]; WIDTH],
    /// Magnitudes of the left response summed over the window's rows, by cost column.
    column_texture: [u16; WIDTH],
    /// The sums over the whole window, by disparity.
    window_costs: [u16; DISPARITIES],
    window_texture: u32,
    disparity: [Disparity; WIDTH],
    confidence: [u8; WIDTH],
    clock: C,
}

impl<const WIDTH: usize, const DISPARITIES: usize, const WINDOW: usize> StereoBm<WIDTH, DISPARITIES, WINDOW> {
    /// Prepares the first frame.
    ///
    /// # Errors
    /// If `config` is out of range, or over the capacity: [`ConfigError::Capacity`] for the width,
    /// [`ConfigError::DisparityCapacity`] for more than `DISPARITIES`.
    pub fn new(config: Config, settings: BlockSettings) -> Result<Self, ConfigError> {
        Self::timed(config, settings, Untimed)
    }
}

impl<const WIDTH: usize, const DISPARITIES: usize, const WINDOW: usize, C: StageClock>
    StereoBm<WIDTH, DISPARITIES, WINDOW, C>
{
    /// Pixels of the window to each side of its centre.
    #[expect(clippy::cast_possible_truncation, reason = "a window of at most 21 px")]
    const RADIUS: u32 = (WINDOW / 2) as u32;

    /// As [`new`](StereoBm::new), with a clock that is told of the stages.
    ///
    /// # Errors
    /// As there.
    pub fn timed(config: Config, settings: BlockSettings, clock: C) -> Result<Self, ConfigError> {
        const {
            assert!(WINDOW % 2 == 1 && 5 <= WINDOW && WINDOW <= 21, "an odd window of 5 to 21 px");
            assert!(0 < DISPARITIES && DISPARITIES <= Config::MAX_DISPARITIES as usize);
            assert!(Config::MIN_WIDTH as usize <= WIDTH && WIDTH <= Config::MAX_WIDTH as usize);
        }
        config.check()?;
        if usize::from(config.width) > WIDTH {
            return Err(ConfigError::Capacity { max_width: u16::try_from(WIDTH).unwrap_or(u16::MAX) });
        }
        if usize::from(config.num_disparities) > DISPARITIES {
            return Err(ConfigError::DisparityCapacity {
                max_disparities: u16::try_from(DISPARITIES).unwrap_or(u16::MAX),
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
            column_costs: [[0; DISPARITIES]; WIDTH],
            column_texture: [0; WIDTH],
            window_costs: [0; DISPARITIES],
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
        let (left_in, left_out) = (self.left.entering(), self.left.leaving(y));
        let (right_in, right_out) = (self.right.entering(), self.right.leaving(y));
        let columns = self.column_costs.iter_mut().zip(&mut self.column_texture).take(area.cost_columns);
        for (column, (costs, texture)) in columns.enumerate() {
            let left = area.left_column(column);
            let right = area.right_column(column);
            let (pixel_in, pixel_out) = (left_in[left], left_out[left]);
            *texture = *texture + difference(pixel_in, cap) - difference(pixel_out, cap);
            let candidates = right_in[right..][..searched].iter().zip(&right_out[right..][..searched]);
            for (cost, (&other_in, &other_out)) in costs[..searched].iter_mut().zip(candidates) {
                *cost = *cost + difference(pixel_in, other_in) - difference(pixel_out, other_out);
            }
        }
    }

    /// Slides the window along the row, and fills `disparity` and `confidence`.
    fn match_row(&mut self, area: SearchArea) {
        let searched = usize::from(self.config.num_disparities);
        self.forget_row();
        self.window_texture = self.column_texture[..WINDOW].iter().copied().map(u32::from).sum();
        self.window_costs[..searched].fill(0);
        for column in &self.column_costs[..WINDOW] {
            for (cost, entering) in self.window_costs[..searched].iter_mut().zip(column) {
                *cost += entering;
            }
        }
        self.decide(area.first);
        for x in area.first + 1..area.end {
            self.slide(x - area.first - 1);
            self.decide(x);
        }
    }

    /// Moves the window from its first cost column, `leaving`, on by one.
    fn slide(&mut self, leaving: usize) {
        let searched = usize::from(self.config.num_disparities);
        let entering = leaving + WINDOW;
        self.window_texture += u32::from(self.column_texture[entering]);
        self.window_texture -= u32::from(self.column_texture[leaving]);
        let columns = self.column_costs[entering].iter().zip(&self.column_costs[leaving]);
        for (cost, (entering, leaving)) in self.window_costs[..searched].iter_mut().zip(columns) {
            *cost = *cost + entering - leaving;
        }
    }

    /// Fills in the window's centre, column `x`, if its winner passes the gates.
    fn decide(&mut self, x: usize) {
        if self.window_texture < self.settings.texture_threshold {
            return;
        }
        let costs = &self.window_costs[..usize::from(self.config.num_disparities)];
        let winner = Winner::find(costs);
        let ratio = self.settings.uniqueness_ratio;
        if ratio > 0 && !winner.is_unique(ratio) {
            return;
        }
        let q8 = self.disparity_px(winner.index) * 256 + winner.refine(costs);
        self.disparity[x] = Disparity::from_bits(round_up_to_q4(q8));
        self.confidence[x] = winner.margin();
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

impl<const WIDTH: usize, const DISPARITIES: usize, const WINDOW: usize, C: StageClock> StereoMethod
    for StereoBm<WIDTH, DISPARITIES, WINDOW, C>
{
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        self.rows = 0;
        // Above the frame both views count as flat: without difference, without texture.
        self.left.reset(self.settings.prefilter_cap);
        self.right.reset(self.settings.prefilter_cap);
        self.column_costs.as_flattened_mut().fill(0);
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

/// Absolute difference of two responses, or of a response and the cap: at most 126.
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
