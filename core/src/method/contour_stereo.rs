//! The method `contour`: contours of both views, matched (the paper's S2 and S3).

use crate::answer::linkage::{Links, PointRows};
use crate::answer::merit::Merit;
use crate::front_end::camera_view::{Row, replicate_borders, words_for};
use crate::front_end::contour_line::ContourLine;
use crate::front_end::scales::Scales;
use crate::lanes::rows::{gradient_across, gradient_down};
use crate::lanes::windows::Window;
use crate::matching::extremum::descend;
use crate::matching::pairing::{Pair, pair};
use crate::method::sparse::{LEAST_REACH, Points, Sparse, SparseRows};
use crate::stage::{Stage, StageClock, Untimed};
use crate::{Config, ConfigError};

/// Links of a point on a contour.
const LINKS: Links = Links { least: 10, share: 9 };
/// Steps of the walk from the distance of two contours to the least cost.
const STEPS: u8 = 1;

/// Which contours the method looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ContourSettings {
    /// Scales along the rows, which show upright contours.
    pub rows: Scales,
    /// Scales along the columns, which show lying contours; their disparity is searched along the row.
    pub columns: Scales,
    /// Least step of a contour, grey levels: the adjustable detail within a scale.
    pub threshold: u8,
    /// Contours along the rows by the decimated transform (eq. 1), at half-supports of 1, 2, 4, 8, 16
    /// only: cheaper, and fewer. The walk to the least cost is as long as the half-support then.
    pub decimated: bool,
    /// Whether points are left out that those around them do not support.
    pub linked_only: bool,
}

impl ContourSettings {
    /// What measured best: half-support 2 along rows and columns, steps of 2 grey levels.
    pub const DEFAULT: Self =
        Self { rows: Scales::SECOND, columns: Scales::SECOND, threshold: 2, decimated: false, linked_only: true };

    /// Checks every field; `rows` are the smoothed rows that the method keeps.
    fn check(&self, rows: usize) -> Result<(), ConfigError> {
        if self.rows.is_empty() && self.columns.is_empty() {
            return Err(ConfigError::NoScale);
        }
        if self.decimated && self.rows.iter().any(|s| !s.is_power_of_two()) {
            return Err(ConfigError::DecimatedScale);
        }
        if rows_for(self.columns.greatest()) > rows {
            let fits = |s: &u8| rows_for(*s) <= rows;
            let max_half_support = (1..=Scales::MAX_HALF_SUPPORT).rev().find(fits).unwrap_or(0);
            return Err(ConfigError::SupportCapacity { max_half_support });
        }
        Ok(())
    }
}

impl Default for ContourSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Smoothed rows that scales along the columns of up to that half-support need; 0 stands for none.
#[must_use]
pub const fn rows_for(half_support: u8) -> usize {
    let half_support = if half_support == 0 { 1 } else { half_support as usize };
    2 * half_support + 4
}

/// Sparse stereo by contours: few answers, at contours only, and hardly any of them wrong.
///
/// In each pair of rows the extrema of the Haar response along the rows, and those of the response down the columns (the
/// paper's section 3, eq. 1), are the contours, with polarity. A left contour takes the right one of the least cost in a
/// window of 8 x 2 px around both, if it stands out and if the two choose each other; their distance, refined by the
/// extremum search with its shortest support (section 4), is the disparity of the pixels on either side of the contour, in
/// both rows. Points that those around them do not support are left out. All else is unknown.
///
/// `BLOCKS` is the capacity: [`blocks_for`](crate::blocks_for) the widest row; `ROWS` is
/// [`rows_for`] the greatest half-support along the columns.
///
/// # Examples
/// ```
/// use haarline::{Config, ContourStereo, ScanlinePair, StereoMethod, blocks_for};
/// let mut contour = ContourStereo::<{ blocks_for(320) }>::new(Config::for_width(320))?;
/// assert!(size_of_val(&contour) <= 16 * 1024);
/// let (left, right) = ([0; 320], [0; 320]); // from the cameras
/// contour.push(ScanlinePair { left: &left, right: &right }, &mut |_| ()).unwrap();
/// # Ok::<(), haarline::ConfigError>(())
/// ```
pub type ContourStereo<const BLOCKS: usize, const ROWS: usize = { rows_for(2) }, C = Untimed> =
    Sparse<ContourPoints<BLOCKS>, ROWS, BLOCKS, C>;

impl<const ROWS: usize, const BLOCKS: usize> Sparse<ContourPoints<BLOCKS>, ROWS, BLOCKS> {
    /// Builds the method for rows of `config.width` px.
    ///
    /// # Errors
    /// If the configuration is invalid or over the capacity.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        Self::with_settings(config, ContourSettings::DEFAULT)
    }

    /// Builds the method for other contours.
    ///
    /// # Errors
    /// If the configuration or a setting is invalid or over the capacity.
    pub fn with_settings(config: Config, settings: ContourSettings) -> Result<Self, ConfigError> {
        Self::build_checked(config, settings, Untimed)
    }
}

impl<const ROWS: usize, const BLOCKS: usize, C: StageClock> Sparse<ContourPoints<BLOCKS>, ROWS, BLOCKS, C> {
    /// Builds the method for rows of `config.width` px, with a clock that is told of its stages.
    ///
    /// # Errors
    /// If the configuration is invalid or over the capacity.
    pub fn timed(config: Config, clock: C) -> Result<Self, ConfigError> {
        Self::build_checked(config, ContourSettings::DEFAULT, clock)
    }

    fn build_checked(config: Config, settings: ContourSettings, clock: C) -> Result<Self, ConfigError> {
        settings.check(ROWS)?;
        Self::build(config, ContourPoints { settings }, clock)
    }
}

/// The points of [`ContourStereo`].
#[derive(Debug, Clone)]
pub struct ContourPoints<const BLOCKS: usize> {
    settings: ContourSettings,
}

impl<const ROWS: usize, const BLOCKS: usize> Points<ROWS, BLOCKS> for ContourPoints<BLOCKS> {
    fn reach(&self) -> u32 {
        LEAST_REACH.max(u32::from(self.settings.columns.greatest()) + 1)
    }

    fn links(&self) -> Option<Links> {
        self.settings.linked_only.then_some(LINKS)
    }

    fn measure(
        &mut self,
        rows: &SparseRows<'_, ROWS, BLOCKS>,
        points: &mut PointRows<BLOCKS>,
        clock: &impl StageClock,
    ) {
        let windows = Windows::new(rows);
        let (settings, width) = (self.settings, usize::from(rows.config.width));
        let threshold = settings.threshold;
        let mut lines = [const { ContourLine::new() }; 2];
        // The finer answer stands.
        for s in settings.rows.iter() {
            clock.enter(Stage::Contours);
            for (view, contours) in lines.iter_mut().enumerate() {
                let four = [-1, 0, 1, 2].map(|y| rows.row(view, y));
                if settings.decimated {
                    contours.find_decimated(four, s, threshold, width);
                } else {
                    contours.find_upright(four, s, threshold, width);
                }
            }
            answer(&lines, &windows, if settings.decimated { s } else { STEPS }, points, clock);
        }
        for s in settings.columns.iter() {
            clock.enter(Stage::Contours);
            for (view, contours) in lines.iter_mut().enumerate() {
                contours.find_lying(|y| rows.row(view, y), s, threshold, width);
            }
            answer(&lines, &windows, STEPS, points, clock);
        }
    }
}

/// Pairs the contours and answers the pixels beside them.
#[inline(never)]
fn answer<const BLOCKS: usize>(
    lines: &[ContourLine<BLOCKS>; 2],
    windows: &Windows<'_, BLOCKS>,
    steps: u8,
    points: &mut PointRows<BLOCKS>,
    clock: &impl StageClock,
) {
    clock.enter(Stage::Seeds);
    let [left, right] = lines.each_ref().map(ContourLine::as_slice);
    let cost_of = |column: usize| {
        let window = windows.left(column);
        move |other: usize| window.sad(&windows.features[1], other)
    };
    pair::<BLOCKS, _>(windows.config, left, right, cost_of, |pair| windows.answer(pair, steps, points));
}

/// Windows of 8 columns around the contours of a pair of rows: the gradient along the upper row, that down in the lower one.
struct Windows<'a, const BLOCKS: usize> {
    config: &'a Config,
    features: [[Row<BLOCKS>; 2]; 2],
}

impl<'a, const BLOCKS: usize> Windows<'a, BLOCKS> {
    #[inline(never)]
    fn new<const ROWS: usize>(rows: &SparseRows<'a, ROWS, BLOCKS>) -> Self {
        let width = usize::from(rows.config.width);
        let words = words_for(width);
        let features = [0, 1].map(|view| {
            let row = |y: i64| &rows.row(view, y)[..words];
            let mut features = [[0; BLOCKS]; 2];
            let [upper, lower] = &mut features;
            gradient_across([row(0), row(1)], rows.clips, &mut upper[..words]);
            gradient_down([row(0), row(2)], rows.clips, &mut lower[..words]);
            replicate_borders(upper, width);
            replicate_borders(lower, width);
            features
        });
        Self { config: rows.config, features }
    }

    /// The window around the contour before a column; the margin is as wide as half of it.
    #[inline(always)]
    fn left(&self, column: usize) -> Window {
        Window::of(&self.features[0], column)
    }

    /// Refines the disparity of a pair and answers the pixel on either side of the contour.
    #[inline(never)]
    fn answer(&self, pair: Pair, steps: u8, points: &mut PointRows<BLOCKS>) {
        let signed = |value: usize| i32::try_from(value).unwrap_or(0);
        let (x, other) = (signed(pair.left.column()), signed(pair.right.column()));
        let window = self.left(pair.left.column());
        let columns = 0..=i32::from(self.config.width);
        let cost = |disparity: i32| {
            let column = usize::try_from(x - disparity).ok().filter(|_| columns.contains(&(x - disparity)))?;
            crate::count::evaluations(1);
            i32::try_from(window.sad(&self.features[1], column)).ok()
        };
        let minimum = descend(x - other, i32::try_from(pair.cost).unwrap_or(0), steps, cost);
        let bits = 16 * minimum.at + minimum.refine_subpixel();
        // The edge lies before its column.
        points.add(self.config, x - 1, 2, bits, || {
            // Merits are made for 48 pixels of gradients twice as strong; here are 16.
            let margin = pair.second.map(|second| 6 * (i32::try_from(second).unwrap_or(0) - minimum.cost));
            Merit::new(6 * minimum.cost, margin)
        });
    }
}
