//! The search of one block: few hypotheses, the cheapest wins, a walk to the minimum.

use crate::count;
use crate::matching::block::Block;
use crate::matching::cost::BlockCost;
use crate::matching::extremum::{Minimum, descend};
use crate::matching::label::{Label, Labels};
use crate::matching::seed::Seeds;

/// Steps of the walk from the best hypothesis.
const STEPS: u8 = 1;

/// What a hypothesis pays for leaving the disparity of the block left or above, in units of the cost.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bias {
    /// One step off.
    pub(crate) near: i32,
    /// More.
    pub(crate) far: i32,
}

/// What the blocks decided before say, px: left, above, above left, above right.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Decided {
    pub(crate) left: Option<i32>,
    pub(crate) above: [Option<i32>; 3],
}

impl Decided {
    /// Goes on to a block: what the row above says of it. Who decides the blocks tells the left one.
    pub(crate) fn look_up(&mut self, above: Option<&[Option<Block>]>, index: usize) {
        let at = |block: Option<usize>| above?.get(block?)?.as_ref().map(Block::px);
        self.above = [Some(index), index.checked_sub(1), Some(index + 1)].map(at);
    }

    /// What a disparity pays for leaving the neighbours'.
    pub(crate) fn penalty(self, disparity: i32, bias: Bias) -> i32 {
        count::additions(1);
        count::subtractions(2);
        count::comparisons(6);
        let pay = |neighbour: Option<i32>| match neighbour.map(|other| (other - disparity).abs()) {
            None | Some(0) => 0,
            Some(1) => bias.near,
            Some(_) => bias.far,
        };
        pay(self.left) + pay(self.above[0])
    }

    /// All disparities worth trying: of the nearest seeds, their mean, and the decided blocks'.
    pub(crate) fn hypotheses<const BLOCKS: usize>(
        self,
        seeds: &Seeds<BLOCKS>,
        index: usize,
        use_seeds: bool,
    ) -> impl Iterator<Item = i32> {
        let (left, right) = if use_seeds { seeds.nearest(index) } else { (None, None) };
        let mean = left.zip(right).map(|(a, b)| (a + b).div_euclid(2));
        let [above, above_left, above_right] = self.above;
        [left, right, mean, above, above_left, above_right, self.left].into_iter().flatten()
    }
}

/// Finds the disparity of one block. Everything that was evaluated is left in `labels`.
///
/// The hypothesis of the least cost and bias wins; from there the extremum search with its shortest
/// support walks at most one step, so that both its neighbours are known as well; without `walk` it
/// stays.
pub(crate) fn search_block<const WIDTH: usize, const N: usize>(
    cost: &BlockCost<'_, WIDTH>,
    index: usize,
    hypotheses: impl Iterator<Item = i32>,
    decided: Decided,
    bias: Bias,
    walk: bool,
    labels: &mut Labels<N>,
) -> Option<Minimum> {
    let start = best_hypothesis(cost, index, hypotheses, decided, bias, labels)?;
    if !walk {
        return Some(Minimum { at: start.disparity, cost: start.cost, before: None, after: None });
    }
    Some(descend(start.disparity, start.cost, STEPS, |d| {
        count::comparisons(1);
        labels.cost_or(d, || cost.of(index, d))
    }))
}

/// The hypothesis of the least cost and bias; all of them become labels.
pub(crate) fn best_hypothesis<const WIDTH: usize, const N: usize>(
    cost: &BlockCost<'_, WIDTH>,
    index: usize,
    hypotheses: impl Iterator<Item = i32>,
    decided: Decided,
    bias: Bias,
    labels: &mut Labels<N>,
) -> Option<Label> {
    let mut best: Option<(i32, Label)> = None;
    for disparity in hypotheses {
        if labels.cost_of(disparity).is_some() {
            continue;
        }
        let Some(plain) = labels.cost_or(disparity, || cost.of(index, disparity)) else { continue };
        count::additions(1);
        count::comparisons(1);
        let biased = plain + decided.penalty(disparity, bias);
        if best.is_none_or(|(least, _)| biased < least) {
            best = Some((biased, Label { disparity, cost: plain }));
        }
    }
    best.map(|(_, label)| label)
}
