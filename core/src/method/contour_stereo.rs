//! The method `contour`: contours of both views, matched (the paper's S2 and S3).

use crate::answer::confidence::Merit;
use crate::answer::linkage::{Answers, Links};
use crate::count;
use crate::front_end::contour::{Contour, ContourLine};
use crate::front_end::ring::MARGIN;
use crate::front_end::scales::Scales;
use crate::front_end::view::sum_rows;
use crate::matching::cost::sad;
use crate::matching::extremum::descend;
use crate::matching::pairing::{Choice, Pairing};
use crate::method::sparse::{FEATURE_REACH, FEATURE_ROWS, Points, Sparse, SparseRow, SparseView};
use crate::stage::{Stage, StageClock, Untimed};
use crate::{Config, ConfigError};

/// Columns of the window that compares two contours, half of them on either side.
const WINDOW: usize = 2 * MARGIN;
/// Smoothed rows summed for the upright contours of a row, from the one above it on.
const SUMMED: i32 = 4;
/// Percent of the least cost by which the second least must exceed it.
const UNIQUENESS: u32 = 20;
/// Links of a point on a contour.
const LINKS: Links = Links { least: 7, share: 9 };
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
    /// What measured best: half-support 2 along rows, 1 along columns, steps of 2 grey levels.
    pub const DEFAULT: Self =
        Self { rows: Scales::SECOND, columns: Scales::FINEST, threshold: 2, decimated: false, linked_only: true };

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
    let above = 1 + half_support as usize;
    let below = if above < LEAST_BELOW { LEAST_BELOW } else { above };
    above + 1 + below
}

/// Smoothed rows that are there below a row in any case, since its features reach down.
const LEAST_BELOW: usize = FEATURE_ROWS / 2 + 1;

/// Sparse stereo by contours: few answers, at contours only, and hardly any of them wrong.
///
/// In each row the extrema of the Haar response along the row, and those along the columns, are the
/// contours, with polarity. A left contour takes the right one of the least cost in a small window around
/// both, if it stands out and if the two choose each other; their distance, refined by the cost, is the
/// disparity of the pixels on either side of the contour. Points that those around them do not support are left out. All else is unknown.
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
pub type ContourStereo<const BLOCKS: usize, const ROWS: usize = { rows_for(1) }, C = Untimed> =
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
        Self::build(config, ContourPoints { settings, left: ContourLine::new(), right: ContourLine::new() }, clock)
    }
}

/// The points of [`ContourStereo`].
#[derive(Debug, Clone)]
pub struct ContourPoints<const BLOCKS: usize> {
    settings: ContourSettings,
    left: ContourLine<BLOCKS>,
    right: ContourLine<BLOCKS>,
}

impl<const ROWS: usize, const BLOCKS: usize> Points<ROWS, BLOCKS> for ContourPoints<BLOCKS> {
    fn reach(&self) -> u32 {
        u32::from(self.settings.columns.greatest()) + 1
    }

    fn uses_features(&self) -> bool {
        true
    }

    fn links(&self) -> Option<Links> {
        self.settings.linked_only.then_some(LINKS)
    }

    fn measure(&mut self, row: &SparseRow<'_, ROWS, BLOCKS>, answers: &mut Answers<BLOCKS>, clock: &impl StageClock) {
        let cost = ContourCost::new(row);
        let settings = self.settings;
        let threshold = i32::from(settings.threshold).max(1);
        // The finer answer stands.
        for s in settings.rows.iter() {
            clock.enter(Stage::Contours);
            for (view, contours) in [(row.left, &mut self.left), (row.right, &mut self.right)] {
                find_upright(view, row, s, SUMMED * threshold * i32::from(s), settings.decimated, contours);
            }
            self.answer(&cost, if settings.decimated { s } else { STEPS }, answers, clock);
        }
        for s in settings.columns.iter() {
            clock.enter(Stage::Contours);
            for (view, contours) in [(row.left, &mut self.left), (row.right, &mut self.right)] {
                find_lying(view, row, s, threshold * i32::from(s), contours);
            }
            self.answer(&cost, STEPS, answers, clock);
        }
    }
}

impl<const BLOCKS: usize> ContourPoints<BLOCKS> {
    /// Pairs the contours and answers the pixels beside them.
    fn answer(&self, cost: &ContourCost<'_>, steps: u8, answers: &mut Answers<BLOCKS>, clock: &impl StageClock) {
        clock.enter(Stage::Seeds);
        let (left, right) = (self.left.as_slice(), self.right.as_slice());
        let whole = |contour: Contour| i32::from(contour.column >> 4);
        let pairing = Pairing::<BLOCKS>::of(cost.config, left, right, UNIQUENESS, |left, right| {
            u16::try_from(cost.of(whole(left), whole(left) - whole(right))?).ok()
        });
        clock.enter(Stage::Blocks);
        for (i, j, choice) in pairing.pairs() {
            if let (Some(&contour), Some(&other)) = (left.get(i), right.get(j)) {
                let x = whole(contour);
                cost.answer(x, x - whole(other), choice, steps, answers);
            }
        }
    }
}

/// Finds the upright contours of a row.
fn find_upright<const ROWS: usize, const BLOCKS: usize>(
    view: &SparseView<ROWS, BLOCKS>,
    row: &SparseRow<'_, ROWS, BLOCKS>,
    half_support: u8,
    threshold: i32,
    decimated: bool,
    contours: &mut ContourLine<BLOCKS>,
) {
    let width = usize::from(row.config.width);
    let mut sums = [[0u16; 4]; BLOCKS];
    let sums = sums.as_flattened_mut();
    sum_rows(view.smooth.window(row.y - 1), sums);
    count::additions(3 * width);
    if decimated {
        contours.find_decimated(sums.get(MARGIN..MARGIN + width).unwrap_or(&[]), half_support, threshold);
        return;
    }
    // Columns beside the image complete the support at its border columns, as many as there are.
    let beside = half_support.min(MARGIN_U8);
    let (first, columns) = (MARGIN - usize::from(beside), width + 2 * usize::from(beside) - 1);
    contours.find(sums.get(first..first + columns).unwrap_or(&[]), -i32::from(beside), half_support, threshold);
}

const MARGIN_U8: u8 = 4;
const _: () = assert!(MARGIN_U8 as usize == MARGIN, "one margin");

/// Finds the lying contours that cross a row.
fn find_lying<const ROWS: usize, const BLOCKS: usize>(
    view: &SparseView<ROWS, BLOCKS>,
    row: &SparseRow<'_, ROWS, BLOCKS>,
    half_support: u8,
    threshold: i32,
    contours: &mut ContourLine<BLOCKS>,
) {
    let width = usize::from(row.config.width);
    let mut responses = [[[0i16; 4]; BLOCKS]; 3];
    let s = i64::from(half_support);
    for (y, responses) in (row.y - 1..).zip(&mut responses) {
        for distance in 0..s {
            let (below, above) = (view.smooth.row(y + distance), view.smooth.row(y - 1 - distance));
            for ((response, &below), &above) in responses.as_flattened_mut().iter_mut().zip(below).zip(above) {
                *response += i16::from(below) - i16::from(above);
            }
        }
    }
    count::additions(3 * (usize::from(half_support) - 1) * width);
    count::subtractions(3 * usize::from(half_support) * width);
    let [above, here, below] = &responses;
    let rows = [above, here, below].map(|row| row.as_flattened().get(MARGIN..MARGIN + width).unwrap_or(&[]));
    contours.find_lying(rows, threshold);
}

/// The windows around the contours of a row.
struct ContourCost<'a> {
    config: &'a Config,
    /// Feature rows of both views around the row, with margins.
    left: [&'a [u8]; FEATURE_ROWS],
    right: [&'a [u8]; FEATURE_ROWS],
}

impl<'a> ContourCost<'a> {
    fn new<const ROWS: usize, const BLOCKS: usize>(row: &SparseRow<'a, ROWS, BLOCKS>) -> Self {
        let first = row.y - i64::from(FEATURE_REACH);
        // Whatever the capacity has beyond the margins is out of reach.
        let end = usize::from(row.config.width) + 2 * MARGIN;
        let cut = |row: &'a [u8]| row.get(..end).unwrap_or(row);
        let (left, right) = (row.left.features.window(first).map(cut), row.right.features.window(first).map(cut));
        Self { config: row.config, left, right }
    }

    /// What it costs that the contour at column `x` has that disparity, `0..=1488`: the SAD of the windows.
    fn of(&self, x: i32, disparity: i32) -> Option<i32> {
        // With the margin of as many columns, the window's first column is the contour's.
        let (left, right) = (usize::try_from(x).ok()?, usize::try_from(x - disparity).ok()?);
        count::evaluations(1);
        count::additions(WINDOW * FEATURE_ROWS);
        count::subtractions(WINDOW * FEATURE_ROWS);
        count::comparisons(WINDOW * FEATURE_ROWS);
        sad::<WINDOW>(&self.left, &self.right, left, right)
    }

    /// Refines the disparity of the contour at column `x` and answers the pixel on either side of it.
    fn answer<const BLOCKS: usize>(
        &self,
        x: i32,
        disparity: i32,
        choice: Choice,
        steps: u8,
        answers: &mut Answers<BLOCKS>,
    ) {
        let minimum = descend(disparity, i32::from(choice.cost), steps, |d| self.of(x, d));
        let bits = 16 * minimum.at + minimum.refine_subpixel();
        let margin = (choice.second != u16::MAX).then(|| i32::from(choice.second) - minimum.cost);
        // Merits are made for 48 pixels; here are 24.
        let merit = Merit::new(2 * minimum.cost, margin.map(|margin| 2 * margin));
        // The edge lies before its column.
        for pixel in [x - 1, x] {
            answers.add(self.config, pixel, bits, merit);
        }
    }
}
