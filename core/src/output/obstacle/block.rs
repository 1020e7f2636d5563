//! Blocks that adjoin and agree: the longest chain of sure ones that ends at a block, and that of measured ones.

use crate::lanes::{add, max, select_ge_halves, splat_half};

/// A block, and the chains that end at it.
///
/// Chains are told in bytes: the weight of the sure ones, the number of the measured ones, at most 255; then what holds
/// anywhere in each of them: [`Block::ROWS`] and [`Block::COLUMNS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Block {
    /// Its disparity, 1/16 px, greater than 0; of none so far from all that it agrees with none.
    bits: i32,
    /// If it is sure, its disparity, and that which it and a block before it reach both; else 0. Lower and upper half.
    sure: u32,
    /// The chains as they are to those beside it, and as they are to those below it.
    beside: u32,
    below: u32,
    /// The disparity that it and two before it in the chain of sure ones reach, 0 if it has no two; and that which it and one
    /// before it in the chain of measured ones reach. 1/16 px, lower and upper half.
    reached: u32,
    /// Of the chain of sure ones that are of one surface: the farthest disparity, 1/16 px, and the weight. Lower and upper half.
    surface: u32,
}

impl Block {
    /// No block.
    pub(super) const NONE: Self = Self { bits: -(1 << 20), sure: 0, beside: 0, below: 0, reached: 0, surface: 0 };
    /// What two blocks reach may be so much more than what three do, 1/16 px: single ones are wrong by a little in noise.
    const MOST_ALONE: u32 = 2;
    /// The bytes of the chain of measured ones.
    const MEASURED: u32 = 0xff00_ff00;
    /// A chain goes on from one block row to the next.
    const ROWS: u32 = 0x0101_0000;
    /// Two blocks of the chain of sure ones lie side by side.
    const COLUMNS: u32 = 0x0080_0000;
    /// From this disparity on, 1/16 px, one column of blocks is not believed: it is narrower than an eighth of the baseline.
    const NO_LONE_COLUMN: u32 = 32 << 4;
    /// Up to this share of the tolerance a chain is nearer than its farthest block and still of one surface: where a thing
    /// stands before a wall, answers beside its outline lead from the one to the other by steps that agree.
    const ONE_SURFACE: [u32; 2] = [3, 4];

    /// Hands a block over, after which it is none.
    #[inline(always)]
    pub(super) fn hand_over(&mut self, to: &mut Self) {
        if self.is_none() {
            // Nobody asks for the rest.
            (to.bits, to.beside) = (Self::NONE.bits, Self::NONE.beside);
        } else {
            *to = *self;
            (self.bits, self.beside) = (Self::NONE.bits, Self::NONE.beside);
        }
    }

    /// Whether there is none.
    #[inline(always)]
    pub(super) const fn is_none(&self) -> bool {
        self.beside == Self::NONE.beside
    }

    /// Whether a chain that ends here goes on from one block row to the next: no other is believed or in doubt.
    #[inline(always)]
    pub(super) const fn is_of_rows(&self) -> bool {
        self.beside & Self::ROWS != 0
    }

    /// A measured block of disparity `bits`, greater than 0: its chains go on from those beside and above it that agree, or
    /// begin. `own` is what it weighs in a chain of sure ones; 0: nothing.
    #[inline(never)]
    pub(super) fn grow(bits: u32, own: u8, left: &Self, above: [&Self; 3], tolerance: u8) -> Self {
        let splat = splat_half(bits);
        let (least, span) = (bits.wrapping_sub(tolerance.into()), 2 * u32::from(tolerance));
        let counted = if own > 0 { u32::MAX } else { Self::MEASURED };
        let climb = u32::from(tolerance) * Self::ONE_SURFACE[0] / Self::ONE_SURFACE[1];
        // The greatest of those that agree: of their chains, of what they reach, of their disparities, of their surfaces.
        let (mut chains, mut sure, mut measured, mut surface) = (0, 0, 0, 0);
        for (before, before_chains) in
            [(left, left.beside), (above[0], above[0].below), (above[1], above[1].below), (above[2], above[2].below)]
        {
            let other = before.bits.cast_unsigned();
            if other.wrapping_sub(least) <= span {
                chains = max(chains, before_chains) | (chains | before_chains) & (Self::ROWS | Self::COLUMNS);
                sure = select_ge_halves(before.sure, sure, before.sure, sure);
                measured = measured.max(other);
                if (before.surface & 0xffff) + climb >= bits {
                    surface = before.surface.max(surface);
                }
            }
        }
        let is_left_sure = left.bits.cast_unsigned().wrapping_sub(least) <= span && left.sure != 0;
        let columns = if is_left_sure { Self::COLUMNS } else { 0 };
        let chains = add((chains | columns) & counted, u32::from(own) | 1 << 8);
        // What this block and those before it reach: sure ones, two and three; measured ones.
        let reached = select_ge_halves(sure, splat, splat, sure);
        let doubtful = measured.min(bits);
        let farthest = if surface == 0 { bits } else { bits.min(surface & 0xffff) };
        let weight = (surface >> 16) + u32::from(own);
        Self {
            bits: bits.cast_signed(),
            sure: if own > 0 { bits | reached << 16 } else { 0 },
            beside: chains,
            below: chains | Self::ROWS & counted,
            reached: reached >> 16 | doubtful << 16,
            surface: if own > 0 { farthest | weight << 16 } else { 0 },
        }
    }

    /// The disparity that is told of its chain of sure blocks, 1/16 px. One that is not sure where its surface ends is a mean of
    /// this surface and what is behind it: nobody else has to reach it.
    pub(super) fn told(&self, is_sure: bool) -> u32 {
        let (own, two, three) = (self.sure & 0xffff, self.sure >> 16, self.reached & 0xffff);
        match (is_sure, three) {
            (false, _) => two.max(own),
            (true, 0) => two,
            (true, _) => two.min(three + Self::MOST_ALONE),
        }
    }

    /// Whether sure blocks of so much weight agree, each with the next, and not in one row only.
    #[inline(always)]
    pub(super) const fn is_chain(&self, weight: u32) -> bool {
        self.beside & Self::ROWS & !Self::MEASURED != 0 && self.beside & 0xff >= weight
    }

    /// Whether they are enough for how near they are: side by side they would be 2/3 as long as the rig's baseline, which is as
    /// long in pixels as their disparity; and no lone column if near. What fits by chance before a pattern is nearer than
    /// anything, and of few blocks.
    #[inline(always)]
    pub(super) const fn is_large(&self) -> bool {
        let bits = self.bits.cast_unsigned();
        // A block weighs 2 and stands for 6 px, 96/16.
        let is_long = bits <= 48 * (self.beside & 0xff) || self.beside & 0xff == 0xff;
        is_long && (bits < Self::NO_LONE_COLUMN || self.beside & Self::COLUMNS != 0)
    }

    /// Whether those of them that are of this block's surface have so much weight.
    #[inline(always)]
    pub(super) const fn is_of_surface(&self, weight: u32) -> bool {
        self.surface >> 16 >= weight
    }

    /// The disparity that may be there, 1/16 px, if so many measured blocks agree, and not in one row only; else 0.
    #[inline(always)]
    pub(super) const fn doubtful(&self, length: u32) -> u32 {
        if self.beside & Self::ROWS & Self::MEASURED != 0 && self.beside >> 8 & 0xff >= length {
            self.reached >> 16
        } else {
            0
        }
    }
}
