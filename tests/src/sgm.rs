//! Semi-global matching over three paths, streaming: the reference `sgm`.
//!
//! Each view becomes a census of signs: which of the eight pixels of a diamond, (0, +-2), (+-2, 0), (+-1, +-1), are
//! darker. A pixel and a disparity cost the signs that differ, 0 to 8, and 4 where the right view has no pixel.
//! Costs are summed along paths from the left, from the right and from above, where a step of one disparity costs
//! [`P1`] and any other [`P2`]. The least sum of the three wins, of equal ones that of the greatest disparity; a
//! parabola through its neighbours gives 1/16 px, and a median of 3 x 3 px takes single errors away.
//!
//! What is wrong in the left view's first columns, whose true disparity leaves the right view, stays in.
//!
//! A row's disparities leave when the third row below it has come.
//!
//! # Source
//! H. Hirschmueller, Stereo Processing by Semiglobal Matching and Mutual Information, IEEE PAMI 30 (2008); R. Zabih and
//! J. Woodfill, Non-parametric Local Transforms for Computing Visual Correspondence, ECCV 1994.

mod census;
mod claim;
mod median;
mod search;
mod winner;

use haarline::{Config, ConfigError, Disparity, DisparityRow, RowError, ScanlinePair, Stage, StageClock, StereoMethod};
use haarline::{Untimed, count};

use crate::simd::paths::{Column, Merits, floor, step_from_above, step_from_left, step_from_right};
pub use crate::simd::paths::{P1, P2};
use crate::simd::splat;
use claim::Claim;
use search::Search;
pub use search::words_for;

/// What a missing first row is taken for, grey level.
const MID_GREY: u8 = 128;
/// Rows of the raw views that are kept.
const RAW_ROWS: usize = census::ROWS;
/// Rows that a census waits for.
const REACH: u32 = census::REACH;
/// Rows of disparities that are kept.
const MATCHED_ROWS: usize = 3;
/// Confidence that a unit of cost takes away.
const DISAGREEMENT: u32 = 5;
/// What the confidence of a pixel is divided by whose column of the right view fits another surface better: a guess is left.
const ANOTHERS: u8 = 16;

/// Semi-global matching for rows of up to `WIDTH` px and up to `4 * WORDS` disparities.
///
/// It takes `WIDTH * (12 * WORDS + 45)` bytes and less than 2 KB more: 60 KB at 320 px and 48 disparities.
///
/// Every pixel is answered, also where the right view does not show it. The confidence is 255 where the three
/// paths agree on the winner, and 5 less for each unit of cost by which they prefer others, 35 at least. It is a 16th of
/// that, a guess, where the left-right check fails: where the column of the right view that the winner leads to does not
/// exist, or a winner of more confidence, more than a pixel away, leads there, too.
///
/// # Examples
/// ```
/// use haarline::{Config, StereoMethod};
/// use haarline_tests::{Sgm, sgm::words_for};
/// let config = Config { num_disparities: 48, ..Config::for_width(320) };
/// let method = Sgm::<320, { words_for(48) }>::new(config).unwrap();
/// assert_eq!(method.config().num_disparities, 48);
/// ```
#[derive(Debug, Clone)]
pub struct Sgm<const WIDTH: usize, const WORDS: usize, C = Untimed> {
    config: Config,
    search: Search,
    /// Rows of the frame that came or were lost.
    rows: u32,
    /// Whether row `y` was lost, at `y % RAW_ROWS`.
    missed: [bool; RAW_ROWS],
    /// The last rows of both views, row `y` at `y % RAW_ROWS`.
    raw: [[[u8; WIDTH]; RAW_ROWS]; 2],
    /// The signs of the row under way, of both views.
    census: [[u8; WIDTH]; 2],
    columns: [Column<WORDS>; WIDTH],
    /// By column, the floor of the path from above, and the greatest merit of that from the right, in all bytes.
    floors: [u32; WIDTH],
    mosts: [u32; WIDTH],
    /// By column of the right view, the best winner that leads there.
    claims: [Claim; WIDTH],
    /// Where the path from the right begins.
    edge: Column<WORDS>,
    /// The path from the left.
    left: Merits<WORDS>,
    /// Row `y` at `y % MATCHED_ROWS`, 1/16 px.
    disparities: [[i16; WIDTH]; MATCHED_ROWS],
    confidences: [[u8; WIDTH]; MATCHED_ROWS],
    /// The row that is delivered.
    disparity: [Disparity; WIDTH],
    clock: C,
}

impl<const WIDTH: usize, const WORDS: usize> Sgm<WIDTH, WORDS> {
    /// Prepares the first frame.
    ///
    /// # Errors
    /// If `config` is out of range, or over the capacity: [`ConfigError::Capacity`] for the width,
    /// [`ConfigError::DisparityCapacity`] for the disparities.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        Self::timed(config, Untimed)
    }
}

impl<const WIDTH: usize, const WORDS: usize, C: StageClock> Sgm<WIDTH, WORDS, C> {
    /// Rows that come in after a row before it goes out.
    pub const LATENCY: u32 = REACH + 1;

    /// As [`new`](Sgm::new), with a clock that is told of the stages.
    ///
    /// # Errors
    /// As there.
    pub fn timed(config: Config, clock: C) -> Result<Self, ConfigError> {
        const {
            assert!(Config::MIN_WIDTH as usize <= WIDTH && WIDTH <= Config::MAX_WIDTH as usize);
            assert!(0 < WORDS && WORDS <= words_for(Config::MAX_DISPARITIES), "words_for() gives the capacity");
        }
        config.check()?;
        if usize::from(config.width) > WIDTH {
            return Err(ConfigError::Capacity { max_width: u16::try_from(WIDTH).unwrap_or(u16::MAX) });
        }
        let search = Search::new(&config);
        if search.words > WORDS {
            return Err(ConfigError::DisparityCapacity {
                max_disparities: u16::try_from(4 * WORDS).unwrap_or(u16::MAX),
            });
        }
        let mut method = Self {
            config,
            search,
            rows: 0,
            missed: [false; RAW_ROWS],
            raw: [[[0; WIDTH]; RAW_ROWS]; 2],
            census: [[0; WIDTH]; 2],
            columns: [Column::EMPTY; WIDTH],
            floors: [0; WIDTH],
            mosts: [0; WIDTH],
            claims: [Claim::NONE; WIDTH],
            edge: Column::EMPTY,
            left: Merits::EMPTY,
            disparities: [[0; WIDTH]; MATCHED_ROWS],
            confidences: [[0; WIDTH]; MATCHED_ROWS],
            disparity: [Disparity::UNKNOWN; WIDTH],
            clock,
        };
        method.edge.begin_right(search.words);
        method.start();
        Ok(method)
    }

    fn width(&self) -> usize {
        usize::from(self.config.width)
    }

    /// Counts the row just kept, and works on the one whose neighbours below are there now.
    fn count(&mut self, missed: bool, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let y = self.rows;
        self.missed[y as usize % RAW_ROWS] = missed;
        self.rows += 1;
        if let Some(y) = y.checked_sub(REACH) {
            self.match_row(y);
            if let Some(before) = y.checked_sub(1) {
                self.answer(before, y, sink);
            }
        }
    }

    /// Matches row `y`.
    fn match_row(&mut self, y: u32) {
        let (width, last) = (self.width(), self.rows - 1);
        self.clock.enter(Stage::Features);
        let rows = [y.saturating_sub(2), y.saturating_sub(1), y, (y + 1).min(last), (y + 2).min(last)];
        for (raw, census) in self.raw.iter().zip(&mut self.census) {
            census::census(rows.map(|y| &raw[y as usize % RAW_ROWS][..width]), &mut census[..width]);
        }
        self.clock.enter(Stage::Blocks);
        count::evaluations(width * self.search.labels);
        self.leftward(width);
        self.rightward(width, y);
        self.check(width, y);
    }

    /// Compares all pixels of the row, and follows the path from the right.
    fn leftward(&mut self, width: usize) {
        let words = self.search.words;
        let [left, right] = &self.census;
        let right = &right[..width];
        let columns = self.columns[..width].iter_mut().zip(&left[..width]).zip(&mut self.mosts).enumerate().rev();
        let (mut before, mut most) = (&mut self.edge, splat(P2));
        for (x, ((column, &pixel), kept)) in columns {
            self.search.compare(x, pixel, right, &mut column.agreement[..words]);
            most = step_from_right(before, column, words, floor(most));
            *kept = most;
            before = column;
        }
    }

    /// Follows the paths from the left and from above, and chooses the winners of row `y`.
    fn rightward(&mut self, width: usize, y: u32) {
        let Search { labels, words, greatest, .. } = self.search;
        self.left.begin(words);
        let mut from_left = splat(P2);
        let row = y as usize % MATCHED_ROWS;
        self.claims[..width].fill(Claim::NONE);
        let answers = self.disparities[row].iter_mut().zip(&mut self.confidences[row]);
        let columns = self.columns[..width].iter_mut().zip(&mut self.floors).zip(&self.mosts).zip(answers);
        for (x, (((column, kept), &from_right), (disparity, confidence))) in columns.enumerate() {
            from_left = step_from_left(&mut self.left, column, words, floor(from_left));
            let (from_above, best) = step_from_above(column, words, *kept);
            *kept = floor(from_above);
            let (label, refined) = winner::winner(&column.agreement[..words], best, labels);
            let disagreement = (from_left + from_above + from_right - best) % 256;
            let bits = ((greatest - label.cast_signed()) << Disparity::FRAC_BITS) + refined;
            *disparity = truncated(bits);
            *confidence = (255 - DISAGREEMENT * disagreement).to_le_bytes()[0];
            let whole = whole(*disparity);
            if let Some(claim) = claim_at(&mut self.claims[..width], x, whole) {
                claim.raise(*confidence, (greatest - whole).cast_unsigned());
            }
        }
    }

    /// The left-right check of row `y`: the winners of the right view's columns are the best of those that lead there.
    fn check(&mut self, width: usize, y: u32) {
        let row = y as usize % MATCHED_ROWS;
        let greatest = self.search.greatest;
        let claims = &mut self.claims[..width];
        let answers = self.disparities[row][..width].iter().zip(&mut self.confidences[row]);
        for (x, (&bits, confidence)) in answers.enumerate() {
            let whole = whole(bits);
            let claim = claim_at(claims, x, whole);
            let is_mutual = claim.is_some_and(|claim| claim.is_near((greatest - whole).cast_unsigned()));
            if !is_mutual {
                *confidence /= ANOTHERS;
            }
        }
    }

    /// Delivers row `y`, around which all rows down to `last` are matched.
    fn answer(&mut self, y: u32, last: u32, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = self.width();
        let confidence = &mut self.confidences[y as usize % MATCHED_ROWS][..width];
        let disparity = &mut self.disparity[..width];
        self.clock.enter(Stage::Consistency);
        if self.missed[y as usize % RAW_ROWS] {
            disparity.fill(Disparity::UNKNOWN);
            confidence.fill(0);
        } else {
            let rows = [y.saturating_sub(1), y, last];
            median::median(rows.map(|y| &self.disparities[y as usize % MATCHED_ROWS][..width]), disparity);
        }
        self.clock.enter(Stage::Output);
        sink(DisparityRow { y, disparity, confidence });
    }
}

/// A disparity, px, of its bits, rounded.
#[inline(always)]
const fn whole(bits: i16) -> isize {
    (bits as isize + (1 << (Disparity::FRAC_BITS - 1))) >> Disparity::FRAC_BITS
}

/// That of the right view's column in which the left view's column `x` is seen at a disparity.
#[inline(always)]
fn claim_at(claims: &mut [Claim], x: usize, disparity: isize) -> Option<&mut Claim> {
    claims.get_mut(usize::try_from(x.cast_signed() - disparity).ok()?)
}

/// Bits of a disparity: -128 * 16 - 8 to 383 * 16 + 8.
#[inline(always)]
fn truncated(bits: isize) -> i16 {
    #[expect(clippy::cast_possible_truncation, reason = "within 16 bits")]
    let bits = bits as i16;
    bits
}

impl<const WIDTH: usize, const WORDS: usize, C: StageClock> StereoMethod for Sgm<WIDTH, WORDS, C> {
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        self.rows = 0;
        let words = self.search.words;
        self.columns.iter_mut().for_each(|column| column.begin_above(words));
        self.floors.fill(0);
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        for view in [pair.left, pair.right] {
            if view.len() != usize::from(self.config.width) {
                return Err(RowError::Width { expected: self.config.width, found: view.len() });
            }
        }
        self.clock.enter(Stage::Features);
        let width = self.width();
        for (raw, row) in self.raw.iter_mut().zip([pair.left, pair.right]) {
            raw[self.rows as usize % RAW_ROWS][..width].copy_from_slice(row);
        }
        self.count(false, sink);
        Ok(())
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        for raw in &mut self.raw {
            raw[self.rows as usize % RAW_ROWS] = match self.rows.checked_sub(1) {
                Some(before) => raw[before as usize % RAW_ROWS],
                None => [MID_GREY; WIDTH],
            };
        }
        self.count(true, sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let rows = self.rows;
        for y in rows.saturating_sub(REACH)..rows {
            self.match_row(y);
            if let Some(before) = y.checked_sub(1) {
                self.answer(before, y, sink);
            }
        }
        if let Some(last) = rows.checked_sub(1) {
            self.answer(last, last, sink);
        }
        self.start();
    }
}
