//! Where the search of a block begins: few hypotheses, and the cheapest of them wins.

use crate::count;
use crate::matching::block::Block;
use crate::matching::cost::BlockCost;
use crate::matching::label::{Label, Labels};

/// What a hypothesis pays for leaving the disparity of the block left or above, in units of the cost.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bias {
    /// One step off.
    pub(crate) near: i32,
    /// More.
    pub(crate) far: i32,
}

/// What the blocks decided before say, px.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Decided {
    pub(crate) left: Option<i32>,
    pub(crate) above: Option<i32>,
}

impl Decided {
    /// Goes on to a block: what the row above says of it. Who decides the blocks tells the left one.
    pub(crate) fn look_up(&mut self, above: Option<&[Option<Block>]>, index: usize) {
        self.above = above.and_then(|above| above.get(index)?.as_ref()).map(Block::px);
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
        pay(self.left) + pay(self.above)
    }
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
