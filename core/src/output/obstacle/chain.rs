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
    pub(super) confirmed: i16,
}

impl Chain {
    /// No block.
    pub(super) const NONE: Self = Self { bits: 0, weight: 0, own: 0, rises: false, confirmed: 0 };

    /// The chain of a block of disparity `bits`, greater than 0, and weight `own`: goes on from those beside and above it
    /// that agree, or begins.
    #[inline]
    pub(super) fn grow(bits: i16, own: u8, left: Self, above: [Self; 3], tolerance: u8) -> Self {
        let mut grown = Self { bits, weight: own, own, rises: false, confirmed: 0 };
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
        }
    }

    /// Whether blocks of so much weight agree, and not in one row only.
    pub(super) fn is_believed(&self, weight: u8) -> bool {
        self.weight >= weight && self.rises
    }
}
