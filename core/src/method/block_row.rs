//! A block row decided from left to right, each block for itself: what `lite` and `wavelet_block` share.

use crate::answer::boundary::choose_sources;
use crate::matching::block::{Begun, Block, BlockRows};
use crate::matching::cost::{BlockCost, ROWS};
use crate::matching::search::Decided;
use crate::method::matcher::Stage;
use crate::stage::{self, StageClock};

/// Decides the next block row, each block by `decide`.
pub(crate) fn decide_row<const WIDTH: usize, const BLOCKS: usize>(
    stage: &Stage<'_, ROWS, BLOCKS>,
    blocks: &mut BlockRows<BLOCKS>,
    clock: &impl StageClock,
    decide: impl Fn(&BlockCost<'_, WIDTH>, usize, Decided) -> Option<Block>,
) {
    clock.enter(stage::Stage::Blocks);
    let (left, right) = stage.features(blocks.len());
    let cost = BlockCost { config: stage.config, left, right };
    let Begun { row, above, .. } = blocks.begin(stage.config.blocks());
    let above = above.as_deref();
    let mut decided = Decided::default();
    for (index, block) in row.iter_mut().enumerate() {
        decided.look_up(above, index);
        *block = decide(&cost, index, decided);
        decided.left = block.as_ref().map(Block::px);
    }
    clock.enter(stage::Stage::Consistency);
    choose_sources(row, above, &left, &right);
}
