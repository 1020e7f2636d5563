//! What it takes to be believed.

use crate::answer::confidence::{FRINGE, SURE};

/// What it takes to be believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Blocks in a chain that adjoin and agree, from two block rows at least; half of them, rounded up, must be of one
    /// surface: no more than 3/4 of the tolerance nearer than the farthest of these. Those whose surface is sure, but not where it
    /// ends ([`FRINGE`]), count by a half. What is near is large: from 30 px on it must be a block for each 6 px,
    /// which side by side would be 2/3 as long as the baseline, and from 32 px on two of them side by side. Where it is not, the
    /// sector is unknown.
    pub agreeing_blocks: u8,
    /// Difference of disparity up to which two blocks agree, 1/16 px.
    pub tolerance: u8,
    /// By how much a disparity may be wrong without ground being taken for something that stands on it,
    /// 1/16 px.
    pub doubt: u8,
    /// Least confidence of a block.
    pub min_confidence: u8,
    /// So many blocks in a chain of measured answers, sure or not, may be something. Where that is nearer by a sixteenth than
    /// what is sure, in two rows of blocks and in more than three for each five in which something is sure, the sector is
    /// unknown, and so are those of the blocks beside it that are not sure: so that a dark or blank thing is not told as far
    /// as the wall behind it. 0: never.
    pub doubtful_blocks: u8,
    /// From this distance over the ground on, mm, a sector in which nothing is in the way may be told to be free
    /// ([`Obstacles::free`](super::Obstacles::free)); 0: never.
    pub free_beyond_mm: u32,
}

impl Settings {
    /// Five sure blocks within 1 px, half a pixel of doubt; four doubtful ones.
    pub const DEFAULT: Self = Self {
        agreeing_blocks: 5,
        tolerance: 16,
        doubt: 8,
        min_confidence: SURE,
        doubtful_blocks: 4,
        free_beyond_mm: 0,
    };

    /// Weight of a sure block in a chain; that of a fringe is half of it.
    pub(super) const SURE_WEIGHT: u8 = 2;

    /// From which confidence on a block weighs something in a chain. If another confidence than what is sure is asked for,
    /// there is no fringe.
    pub(super) fn fringe(&self) -> u8 {
        if self.min_confidence == SURE { FRINGE } else { self.min_confidence }
    }
}
