//! Chains of blocks that adjoin and agree.

/// The longest chain that ends at a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Chain {
    /// Disparity of the block, 1/16 px; 0 where there is none.
    bits: i16,
    /// Weight of the blocks in it, the block included.
    weight: u8,
    /// Weight of the block itself.
    own: u8,
    /// Whether it goes on from one block row to the next anywhere.
    rises: bool,
    /// The disparity that this block and one before it reach both, 1/16 px.
    confirmed: i16,
    /// The same of this block and two before it; 0: it has no two.
    reached: i16,
}

impl Chain {
    /// No block.
    pub(super) const NONE: Self = Self { bits: 0, weight: 0, own: 0, rises: false, confirmed: 0, reached: 0 };
    /// What two blocks reach may be so much more than what three do, 1/16 px: single ones are wrong by a little in noise.
    const MOST_ALONE: i16 = 2;

    /// The chain of a block of disparity `bits`, greater than 0, and weight `own`: goes on from those beside and above it
    /// that agree, or begins.
    #[inline]
    pub(super) fn grow(bits: i16, own: u8, left: Self, above: [Self; 3], tolerance: u8) -> Self {
        let mut grown = Self { bits, own, weight: own, ..Self::NONE };
        grown.join(left, tolerance, left.rises);
        for chain in above {
            grown.join(chain, tolerance, true);
        }
        grown
    }

    fn join(&mut self, chain: Self, tolerance: u8, rises: bool) {
        if chain.bits != 0 && chain.bits.abs_diff(self.bits) <= u16::from(tolerance) {
            self.weight = self.weight.max(chain.weight.saturating_add(self.own));
            self.rises |= rises;
            self.confirmed = self.confirmed.max(chain.bits.min(self.bits));
            self.reached = self.reached.max(chain.confirmed.min(self.bits));
        }
    }

    /// The disparity that is told of it, 1/16 px.
    pub(super) fn told(&self) -> i16 {
        if self.reached > 0 { self.confirmed.min(self.reached + Self::MOST_ALONE) } else { self.confirmed }
    }

    /// Whether blocks of so much weight agree, and not in one row only.
    pub(super) fn is_believed(&self, weight: u8) -> bool {
        self.weight >= weight && self.rises
    }
}
