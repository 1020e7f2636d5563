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
mod median;
mod path;

use core::cell::Cell;

use haarline::{Config, ConfigError, Disparity, DisparityRow, RowError, ScanlinePair, Stage, StageClock, StereoMethod};
use haarline::{Untimed, count};

use crate::word::{count_ones, greatest, max, splat};
pub use path::{P1, P2};

/// Words that hold so many labels, four each: the capacity of [`Sgm`].
#[must_use]
pub const fn words_for(disparities: u16) -> usize {
    disparities.div_ceil(4) as usize
}

/// What a missing first row is taken for, grey level.
const MID_GREY: u8 = 128;
/// Agreement with what lies outside the right view, of 8.
const OUTSIDE: u8 = 4;
/// Rows of the raw views, and of disparities.
const RAW_ROWS: usize = census::ROWS;
const ROWS: usize = 3;

/// Semi-global matching for rows of up to `WIDTH` px and up to `4 * WORDS` disparities.
///
/// It takes `WIDTH * (12 * WORDS + 25)` bytes and less than 1 KB more: 53 KB at 320 px and 48 disparities.
///
/// Every pixel is answered, also where the right view does not show it. The confidence is 255 where the three
/// paths agree on the winner, and 5 less for each unit of cost by which they prefer others, 35 at least.
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
    /// Rows of the frame that came or were lost.
    rows: u32,
    /// Whether row `y` was lost, at `y % RAW_ROWS`.
    missed: [bool; RAW_ROWS],
    /// The last rows, row `y` at `y % RAW_ROWS`.
    raw: [[[u8; WIDTH]; RAW_ROWS]; 2],
    census: [[u8; WIDTH]; 2],
    /// By column and label, the greatest disparity's first, four in a word: 8 less the census's Hamming distance.
    agreement: [[u32; WORDS]; WIDTH],
    /// Merits of the path from the right.
    right: [[u32; WORDS]; WIDTH],
    /// Those from above.
    above: [[u32; WORDS]; WIDTH],
    above_floor: [u8; WIDTH],
    right_floor: [u8; WIDTH],
    /// That from the left.
    left: [u32; WORDS],
    sums: [u32; WORDS],
    /// Row `y` at `y % ROWS`, 1/16 px.
    disparities: [[i16; WIDTH]; ROWS],
    confidences: [[u8; WIDTH]; ROWS],
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
    pub const LATENCY: u32 = 3;

    /// As [`new`](Sgm::new), with a clock that is told of the stages.
    ///
    /// # Errors
    /// As there.
    pub fn timed(config: Config, clock: C) -> Result<Self, ConfigError> {
        config.check()?;
        if usize::from(config.width) > WIDTH {
            return Err(ConfigError::Capacity { max_width: u16::try_from(WIDTH).unwrap_or(u16::MAX) });
        }
        if usize::from(config.num_disparities) > 4 * WORDS {
            return Err(ConfigError::DisparityCapacity {
                max_disparities: u16::try_from(4 * WORDS).unwrap_or(u16::MAX),
            });
        }
        let mut method = Self {
            config,
            rows: 0,
            missed: [false; RAW_ROWS],
            raw: [[[0; WIDTH]; RAW_ROWS]; 2],
            census: [[0; WIDTH]; 2],
            agreement: [[0; WORDS]; WIDTH],
            right: [[0; WORDS]; WIDTH],
            above: [[0; WORDS]; WIDTH],
            above_floor: [0; WIDTH],
            right_floor: [0; WIDTH],
            left: [0; WORDS],
            sums: [0; WORDS],
            disparities: [[0; WIDTH]; ROWS],
            confidences: [[0; WIDTH]; ROWS],
            disparity: [Disparity::UNKNOWN; WIDTH],
            clock,
        };
        method.start();
        Ok(method)
    }

    fn width(&self) -> usize {
        usize::from(self.config.width)
    }

    /// The disparity of label 0.
    fn greatest_px(&self) -> isize {
        isize::from(self.config.min_disparity) + usize::from(self.config.num_disparities).cast_signed() - 1
    }

    /// Counts the row just kept, and works on the one whose neighbours below are there now.
    fn count(&mut self, missed: bool, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let y = self.rows;
        self.missed[y as usize % RAW_ROWS] = missed;
        self.rows += 1;
        if let Some(y) = y.checked_sub(2) {
            self.match_row(y);
            if let Some(before) = y.checked_sub(1) {
                self.answer(before, y, sink);
            }
        }
    }

    /// Matches row `y`: the path from the right first, then from the left to the right the others and the choice.
    fn match_row(&mut self, y: u32) {
        let width = self.width();
        let last = self.rows - 1;
        self.clock.enter(Stage::Features);
        for (raw, census) in self.raw.iter().zip(&mut self.census) {
            let rows = [y.saturating_sub(2), y.saturating_sub(1), y, (y + 1).min(last), (y + 2).min(last)];
            census::census(rows.map(|y| &raw[y as usize % RAW_ROWS][..width]), &mut census[..width]);
        }
        self.clock.enter(Stage::Blocks);
        let words = words_for(self.config.num_disparities);
        count::evaluations(width * usize::from(self.config.num_disparities));
        let mut floor = 0;
        for x in (0..width).rev() {
            self.compare(x);
            let (here, beyond) = self.right[x..].split_at_mut(1);
            let here = Cell::from_mut(&mut here[0][..words]).as_slice_of_cells();
            let agreement = &self.agreement[x][..words];
            floor = match beyond.first_mut().filter(|_| x + 1 < width) {
                Some(before) => {
                    path::step(Cell::from_mut(&mut before[..words]).as_slice_of_cells(), floor, agreement, here)
                }
                None => {
                    here.iter().for_each(|word| word.set(splat(P2)));
                    path::step(here, 0, agreement, here)
                }
            };
            self.right_floor[x] = floor;
        }
        self.left[..words].fill(splat(P2));
        let mut floor = 0;
        for x in 0..width {
            let agreement = &self.agreement[x][..words];
            let left = Cell::from_mut(&mut self.left[..words]).as_slice_of_cells();
            floor = path::step(left, floor, agreement, left);
            let above = Cell::from_mut(&mut self.above[x][..words]).as_slice_of_cells();
            self.above_floor[x] = path::step(above, self.above_floor[x], agreement, above);
            let mut best = 0;
            for (sum, ((left, above), right)) in self.sums.iter_mut().zip(left.iter().zip(above).zip(&self.right[x])) {
                *sum = left.get() + above.get() + right;
                best = max(best, *sum);
            }
            let most = floor + self.above_floor[x] + self.right_floor[x] + 3 * P2;
            let best = greatest(best);
            self.decide(x, y, best, most - best);
        }
    }

    /// Compares a pixel with all that it may be.
    fn compare(&mut self, x: usize) {
        let words = words_for(self.config.num_disparities);
        let searched = usize::from(self.config.num_disparities);
        let first = x.cast_signed() - self.greatest_px();
        let [left, right] = &self.census;
        let right = &right[..usize::from(self.config.width)];
        let pixel = splat(!left[x]);
        let agreement = &mut self.agreement[x][..words];
        let inside = usize::try_from(first).ok().and_then(|first| right.get(first..first + 4 * words));
        if let Some(candidates) = inside {
            let (candidates, _) = candidates.as_chunks::<4>();
            for (agreement, &candidates) in agreement.iter_mut().zip(candidates) {
                *agreement = count_ones(pixel ^ u32::from_le_bytes(candidates));
            }
            if searched % 4 != 0 {
                agreement[words - 1] &= u32::MAX >> (8 * (4 - searched % 4));
            }
            return;
        }
        for (word, agreement) in agreement.iter_mut().enumerate() {
            *agreement = u32::from_le_bytes(core::array::from_fn(|label| {
                let label = 4 * word + label;
                if label >= searched {
                    return 0;
                }
                let column = usize::try_from(first + label.cast_signed()).ok();
                column
                    .and_then(|column| right.get(column))
                    .map_or(OUTSIDE, |other| count_ones(u32::from(!left[x] ^ other)).to_le_bytes()[0])
            }));
        }
    }

    /// Fills in the winner, whose sum is `best`.
    fn decide(&mut self, x: usize, y: u32, best: u8, disagreement: u8) {
        let searched = usize::from(self.config.num_disparities);
        let label = |at: usize| self.sums[at / 4].to_le_bytes()[at % 4];
        let index = (0..searched).position(|at| label(at) == best).unwrap_or(0);
        let mut q4 = 16 * (self.greatest_px() - index.cast_signed());
        if index > 0 && index + 1 < searched {
            let (before, after) = (isize::from(label(index - 1)), isize::from(label(index + 1)));
            let curvature = 2 * isize::from(best) - before - after;
            if curvature > 0 {
                q4 += (16 * (before - after + curvature) + curvature) / (2 * curvature) - 8;
            }
        }
        self.disparities[y as usize % ROWS][x] = i16::try_from(q4).unwrap_or(0);
        self.confidences[y as usize % ROWS][x] = 255 - 5 * disagreement;
    }

    /// Delivers row `y`, above which and down to row `last` all are matched.
    fn answer(&mut self, y: u32, last: u32, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = self.width();
        self.clock.enter(Stage::Consistency);
        let rows = [y.saturating_sub(1), y, last].map(|y| &self.disparities[y as usize % ROWS][..width]);
        let mut out = [0; WIDTH];
        median::median(rows, &mut out[..width]);
        let missed = self.missed[y as usize % RAW_ROWS];
        if missed {
            self.confidences[y as usize % ROWS].fill(0);
        }
        for (disparity, &bits) in self.disparity.iter_mut().zip(&out) {
            *disparity = if missed { Disparity::UNKNOWN } else { Disparity::from_bits(bits) };
        }
        self.clock.enter(Stage::Output);
        sink(DisparityRow {
            y,
            disparity: &self.disparity[..width],
            confidence: &self.confidences[y as usize % ROWS][..width],
        });
    }
}

impl<const WIDTH: usize, const WORDS: usize, C: StageClock> StereoMethod for Sgm<WIDTH, WORDS, C> {
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        self.rows = 0;
        self.above.as_flattened_mut().fill(splat(P2));
        self.above_floor.fill(0);
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
        for y in rows.saturating_sub(2)..rows {
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
