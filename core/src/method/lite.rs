//! The method `lite`: seeds, greedy blocks.

use crate::answer::confidence::Merit;
use crate::matching::block::{Block, BlockRows, JUMP};
use crate::matching::cost::{BlockCost, ROWS};
use crate::matching::label::Labels;
use crate::matching::search::{Bias, Decided, search_block};
use crate::method::block_row::decide_row;
use crate::method::matcher::{Matcher, Stage};
use crate::method::pipeline::Pipeline;
use crate::stage::{StageClock, Untimed};

/// Columns of a block's window; two more than the block on either side.
const WIDTH: usize = 8;
/// Grey levels over a window of 48 pixels.
const BIAS: Bias = Bias { near: 50, far: 200 };
/// Most disparities that one block evaluates: 7 hypotheses, and 3 by a walk of one step.
const LABELS: usize = 10;

/// Stereo by seeds and greedy blocks: the cheapest method that holds up under noise.
///
/// Each 4x4 block tries the disparities of the nearest contour seeds and of the blocks decided before
/// it, pays for leaving its neighbours', and walks to the minimum.
///
/// # Examples
/// ```
/// use haarline::{Config, Lite, ScanlinePair, StereoMethod, blocks_for};
/// let mut lite = Lite::<{ blocks_for(320) }>::new(Config::for_width(320))?;
/// let mut rows = 0;
/// for _ in 0..240 {
///     let (left, right) = ([0; 320], [0; 320]); // from the camera
///     lite.push(ScanlinePair { left: &left, right: &right }, &mut |_| rows += 1).unwrap();
/// }
/// lite.finish(&mut |_| rows += 1);
/// assert_eq!(rows, 240);
/// # Ok::<(), haarline::ConfigError>(())
/// ```
pub type Lite<const BLOCKS: usize, C = Untimed> = Pipeline<Greedy, ROWS, BLOCKS, C>;

/// The matcher of [`Lite`]: every block for itself, no state beyond the blocks above.
#[derive(Debug, Clone, Default)]
pub struct Greedy;

impl<const BLOCKS: usize> Matcher<ROWS, BLOCKS> for Greedy {
    fn clear(&mut self) {}

    fn decide(&mut self, stage: &Stage<'_, ROWS, BLOCKS>, blocks: &mut BlockRows<BLOCKS>, clock: &impl StageClock) {
        decide_row(stage, blocks, clock, |cost, index, decided| greedy_block(stage, cost, index, decided));
    }

    fn finish(&mut self, _: &Stage<'_, ROWS, BLOCKS>, _: &mut BlockRows<BLOCKS>) {}
}

fn greedy_block<const BLOCKS: usize>(
    stage: &Stage<'_, ROWS, BLOCKS>,
    cost: &BlockCost<'_, WIDTH>,
    index: usize,
    decided: Decided,
) -> Option<Block> {
    let mut labels = Labels::<LABELS>::new(stage.config.min_disparity);
    let hypotheses = decided.hypotheses(stage.seeds, index, stage.parts.seeds);
    let found = search_block(cost, index, hypotheses, decided, BIAS, stage.parts.extremum, &mut labels)?;
    let mut block = cost.examine(stage.texture, index, found.at, found.cost)?;
    block.fraction = i8::try_from(found.refine_subpixel()).unwrap_or(0);
    let margin = labels.least_cost_beyond(found.at, JUMP).map(|rival| rival - found.cost);
    block.merit = Merit::new(found.cost, margin);
    Some(block)
}
