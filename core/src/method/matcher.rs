//! The seam between the shared pipeline and the methods. Its names are public and its module is not:
//! nobody outside implements it.

use crate::Config;
use crate::answer::texture::Texture;
use crate::front_end::reading::Reading;
use crate::front_end::ring::MARGIN;
use crate::front_end::view::View;
use crate::matching::block::{BlockRows, SIZE, SIZE_U32};
use crate::matching::seed::Seeds;
use crate::method::parts::Parts;
use crate::stage::StageClock;

/// How a method decides the blocks; the pipeline does the rest.
pub trait Matcher<const FEATURE_ROWS: usize, const BLOCKS: usize> {
    /// What its blocks consist of.
    fn reading(&self) -> Reading {
        Reading::Haar
    }

    /// Forgets the frame.
    fn clear(&mut self);

    /// Begins the next row of `blocks`, and makes the one above final.
    fn decide(
        &mut self,
        stage: &Stage<'_, FEATURE_ROWS, BLOCKS>,
        blocks: &mut BlockRows<BLOCKS>,
        clock: &impl StageClock,
    );

    /// Makes the last row final.
    fn finish(&mut self, stage: &Stage<'_, FEATURE_ROWS, BLOCKS>, blocks: &mut BlockRows<BLOCKS>);
}

/// What a matcher sees when a block row is due.
pub struct Stage<'a, const FEATURE_ROWS: usize, const BLOCKS: usize> {
    pub(crate) config: &'a Config,
    pub(crate) seeds: &'a Seeds<BLOCKS>,
    pub(crate) texture: Texture,
    pub(crate) parts: Parts,
    pub(crate) left: &'a View<FEATURE_ROWS, BLOCKS>,
    pub(crate) right: &'a View<FEATURE_ROWS, BLOCKS>,
}

impl<'a, const FEATURE_ROWS: usize, const BLOCKS: usize> Stage<'a, FEATURE_ROWS, BLOCKS> {
    /// Feature rows of both views from one row above a block row on, as far as the view and its margins
    /// reach, whatever the capacity has beyond: no window can lie further right.
    pub(crate) fn features<const N: usize>(&self, block_row: u32) -> ([&'a [u8]; N], [&'a [u8]; N]) {
        let first = i64::from(block_row * SIZE_U32) - 1;
        let end = SIZE * self.config.blocks() + 2 * MARGIN;
        let cut = |row: &'a [u8]| row.get(..end).unwrap_or(row);
        (self.left.features.window(first).map(cut), self.right.features.window(first).map(cut))
    }
}
