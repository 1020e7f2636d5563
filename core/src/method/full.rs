//! The method `full`: seeds, a few labels a block, agreement of neighbours.

use crate::answer::boundary::choose_sources;
use crate::answer::confidence::Merit;
use crate::count;
use crate::front_end::noise::SmoothingLevel;
use crate::matching::block::{Block, BlockRows, JUMP};
use crate::matching::cost::{BlockCost, ROWS};
use crate::matching::extremum::Minimum;
use crate::matching::label::{Label, Labels};
use crate::matching::path::{Paths, Penalties};
use crate::matching::search::{Bias, Decided, search_block};
use crate::method::matcher::{Matcher, Stage};
use crate::method::pipeline::Pipeline;
use crate::stage::{self, StageClock, Untimed};

/// Feature rows in reach: those of the block row under way and of the one above, which is decided one
/// row late.
const FEATURE_ROWS: usize = ROWS + 4;
/// Columns of a block's window: the agreement does what a wider one would.
const WIDTH: usize = 4;
/// Labels that a block keeps.
const LABELS: usize = 7;
/// Grey levels over a window of 24 pixels, as are all constants here.
const BIAS: Bias = Bias { near: 12, far: 50 };
/// Price of a step and of a jump between neighbours; twice that under noise.
const PENALTIES: Penalties = Penalties { slope: 30, jump: 350 };
/// Blocks whose mean grey levels differ by more have a contour between them.
const GREY_STEP: u8 = 5;
/// Margins of a path and of a cost beyond these say no more.
const MOST_PATH_MARGIN: i32 = 384;
const MOST_COST_MARGIN: i32 = 240;

/// Stereo by seeds and agreement: the accuracy of semi-global matching from a few rows.
///
/// As [`Lite`](crate::Lite), each 4x4 block tries a handful of hypotheses. It keeps the cheapest as
/// labels, and a dynamic programme over them makes neighbours agree: along the block row in both
/// directions, from the rows above, and one row late from the row below.
///
/// # Examples
/// ```
/// use haarline::{Config, Full, blocks_for};
/// let full = Full::<{ blocks_for(320) }>::new(Config::for_width(320))?;
/// assert!(size_of_val(&full) <= 24 * 1024);
/// # Ok::<(), haarline::ConfigError>(())
/// ```
pub type Full<const BLOCKS: usize, C = Untimed> = Pipeline<Agreement<LABELS, BLOCKS>, FEATURE_ROWS, BLOCKS, C>;

/// [`Full`] with room for all disparities as labels but one of 256: an upper bound for studies, not for a chip.
pub type Exhaustive<const BLOCKS: usize> = Pipeline<Agreement<255, BLOCKS>, FEATURE_ROWS, BLOCKS>;

/// The matcher of [`Full`]: the labels of two block rows, `N` a block.
#[derive(Debug, Clone)]
pub struct Agreement<const N: usize, const BLOCKS: usize> {
    /// The row decided last, with the cost of all paths but those from below.
    above: [Paths<N>; BLOCKS],
    /// The row under way, with the cost of the paths from the left.
    row: [Paths<N>; BLOCKS],
}

impl<const N: usize, const BLOCKS: usize> Default for Agreement<N, BLOCKS> {
    fn default() -> Self {
        Self { above: [Paths::EMPTY; BLOCKS], row: [Paths::EMPTY; BLOCKS] }
    }
}

impl<const N: usize, const BLOCKS: usize> Matcher<FEATURE_ROWS, BLOCKS> for Agreement<N, BLOCKS> {
    fn clear(&mut self) {
        self.above.fill(Paths::EMPTY);
    }

    fn decide(
        &mut self,
        stage: &Stage<'_, FEATURE_ROWS, BLOCKS>,
        blocks: &mut BlockRows<BLOCKS>,
        clock: &impl StageClock,
    ) {
        clock.enter(stage::Stage::Blocks);
        let row = Row::new(stage, blocks.len());
        let last = Row::new(stage, blocks.len().saturating_sub(1));
        let count = stage.config.blocks();
        let mut begun = blocks.begin(count);
        self.collect_labels(&row, begun.above.as_deref());
        clock.enter(stage::Stage::Agreement);
        self.pass_rightwards(&row, count);
        let mut right = Paths::<N>::EMPTY;
        for index in (0..count).rev() {
            let Some((&from_left, above)) = self.row.get(index).zip(self.above.get_mut(index)) else { continue };
            let from_right = Paths::new(from_left.labels, |_, label| {
                label.cost + row.message_along(&right, label.disparity, [index, index + 1])
            });
            let along = Paths::new(from_left.labels, |i, label| from_left.of(i) + from_right.of(i) - label.cost);
            if let Some(block) = begun.above.as_deref_mut().and_then(|blocks| blocks.get_mut(index)) {
                // One row late: what this row says about the one above.
                let whole = Paths::new(above.labels, |i, label| above.of(i) + row.message(&along, label.disparity));
                *block = last.block(index, &whole, block.take());
            }
            *above = Paths::new(from_left.labels, |i, label| along.of(i) + row.message(above, label.disparity));
            if let Some(block) = begun.row.get_mut(index) {
                *block = row.block(index, above, None);
            }
            right = from_right;
        }
        clock.enter(stage::Stage::Consistency);
        if let Some(above) = begun.above {
            choose_sources(above, begun.second_above, &last.cost.left, &last.cost.right);
        }
    }

    fn finish(&mut self, stage: &Stage<'_, FEATURE_ROWS, BLOCKS>, blocks: &mut BlockRows<BLOCKS>) {
        let last = Row::new(stage, blocks.len().saturating_sub(1));
        if let Some(rows) = blocks.neighbourhood(stage.config.blocks(), true) {
            choose_sources(rows.row, rows.above, &last.cost.left, &last.cost.right);
        }
    }
}

impl<const N: usize, const BLOCKS: usize> Agreement<N, BLOCKS> {
    /// Fills the labels of the row under way: hypotheses left to right, then from the right block.
    fn collect_labels(&mut self, row: &Row<'_, BLOCKS>, above: Option<&[Option<Block>]>) {
        let count = row.stage.config.blocks();
        let mut greedy = [None; BLOCKS];
        let mut decided = Decided::default();
        for (index, (paths, greedy)) in self.row.iter_mut().zip(&mut greedy).enumerate().take(count) {
            decided.look_up(above, index);
            let mut labels = Labels::new(row.stage.config.min_disparity);
            *greedy = row.search(index, decided, &mut labels);
            decided.left = greedy.map(|(disparity, _)| disparity);
            paths.labels = labels;
        }
        // What is cheaper than a block's own choice travels on to the left.
        let mut right = None;
        for (index, (paths, greedy)) in self.row.iter_mut().zip(&greedy).enumerate().take(count).rev() {
            let own = *greedy;
            let offered = right.and_then(|(disparity, _): (i32, i32)| {
                let cost = paths.labels.cost_or(disparity, || row.cost.of(index, disparity))?;
                Some((disparity, cost))
            });
            right = match (own, offered) {
                (Some(own), Some(offered)) if offered.1 < own.1 => Some(offered),
                (None, offered) => offered,
                (own, _) => own,
            };
        }
    }

    /// Adds up the paths from the left.
    fn pass_rightwards(&mut self, row: &Row<'_, BLOCKS>, count: usize) {
        let mut left = Paths::<N>::EMPTY;
        for (index, paths) in self.row.iter_mut().enumerate().take(count) {
            *paths = Paths::new(paths.labels, |_, label| {
                label.cost + row.message_along(&left, label.disparity, [index, index.saturating_sub(1)])
            });
            left = *paths;
        }
    }
}

/// One block row with what it takes to decide its blocks.
struct Row<'a, const BLOCKS: usize> {
    stage: &'a Stage<'a, FEATURE_ROWS, BLOCKS>,
    cost: BlockCost<'a, WIDTH>,
    penalties: Penalties,
    is_first: bool,
}

impl<'a, const BLOCKS: usize> Row<'a, BLOCKS> {
    fn new(stage: &'a Stage<'a, FEATURE_ROWS, BLOCKS>, block_row: u32) -> Self {
        let (left, right) = stage.features(block_row);
        let noisy = stage.noise.level >= SmoothingLevel::Medium;
        let factor = if noisy { 2 } else { 1 };
        Self {
            stage,
            cost: BlockCost { config: stage.config, left, right },
            penalties: Penalties { slope: factor * PENALTIES.slope, jump: factor * PENALTIES.jump },
            is_first: block_row == 0,
        }
    }

    /// The message of the block beside: surfaces may change for half the price where the grey level does.
    fn message_along<const N: usize>(&self, from: &Paths<N>, disparity: i32, blocks: [usize; 2]) -> i32 {
        count::subtractions(1);
        count::comparisons(2);
        let [a, b] = blocks.map(|index| self.stage.grey.get(index).copied().unwrap_or(0));
        let jump = self.penalties.jump / if a.abs_diff(b) > GREY_STEP { 2 } else { 1 };
        self.weigh(from, disparity, Penalties { jump, ..self.penalties })
    }

    /// The message of the block above or below.
    fn message<const N: usize>(&self, from: &Paths<N>, disparity: i32) -> i32 {
        self.weigh(from, disparity, self.penalties)
    }

    /// A message, or none where the agreement is left out.
    fn weigh<const N: usize>(&self, from: &Paths<N>, disparity: i32, penalties: Penalties) -> i32 {
        if self.stage.parts.agreement { from.message(disparity, penalties) } else { 0 }
    }

    /// Evaluates the hypotheses of a block; the greedy choice and its cost.
    fn search<const N: usize>(&self, index: usize, decided: Decided, labels: &mut Labels<N>) -> Option<(i32, i32)> {
        let parts = self.stage.parts;
        let first = i32::from(self.stage.config.min_disparity);
        let all = first..first + i32::from(self.stage.config.num_disparities);
        let try_all = parts.exhaustive || !parts.seeds && self.is_first;
        let hypotheses = decided.hypotheses(self.stage.seeds, index, parts.seeds);
        let hypotheses = hypotheses.chain(all.filter(|_| try_all));
        let found = search_block(&self.cost, index, hypotheses, decided, BIAS, parts.extremum, labels)?;
        Some((found.at, found.cost))
    }

    /// The block that the best path goes through. `before` is what was thought of it so far.
    fn block<const N: usize>(&self, index: usize, paths: &Paths<N>, before: Option<Block>) -> Option<Block> {
        let (label, _) = if self.stage.parts.agreement {
            paths.best()?
        } else {
            (paths.labels.iter().min_by_key(|label| label.cost)?, 0)
        };
        let Label { disparity, cost } = label;
        let mut block = match before.filter(|block| block.px() == disparity) {
            Some(block) => block,
            None => self.cost.examine(self.stage.texture, index, disparity, cost)?,
        };
        let side = |disparity| paths.labels.cost_of(disparity).or_else(|| self.cost.of(index, disparity));
        let minimum = Minimum { at: disparity, cost, before: side(disparity - 1), after: side(disparity + 1) };
        block.fraction = i8::try_from(minimum.refine_subpixel()).unwrap_or(0);
        block.merit = merit(paths, label);
        Some(block)
    }
}

/// Merit of a label: half the margin of its path and half that of its cost, less its cost.
fn merit<const N: usize>(paths: &Paths<N>, label: Label) -> Merit {
    count::subtractions(paths.labels.len());
    count::comparisons(3 * paths.labels.len());
    let path_of = |(other, path): (Label, i32)| ((other.disparity - label.disparity).abs() > JUMP).then_some(path);
    let own = paths.iter().find(|(other, _)| *other == label).map_or(0, |(_, path)| path);
    let path_margin = paths.iter().filter_map(path_of).min().map_or(MOST_PATH_MARGIN, |path| path - own);
    let rival = paths.labels.least_cost_beyond(label.disparity, JUMP);
    let cost_margin = rival.map_or(MOST_COST_MARGIN, |rival| rival - label.cost);
    // Merits are made for 48 pixels; here are 24.
    let margin = path_margin.min(MOST_PATH_MARGIN) + cost_margin.min(MOST_COST_MARGIN);
    Merit::new(2 * label.cost, Some(margin))
}
