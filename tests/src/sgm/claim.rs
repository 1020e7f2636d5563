//! What the right view's columns are matched with.

/// The best winner of the left view that leads to a column of the right view: the most confident one, and of
/// equal ones that of the greatest disparity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Claim(u16);

impl Claim {
    /// Nobody leads there.
    pub const NONE: Self = Self(0);

    /// Takes a winner, if it is better. Labels, below 256, begin with the greatest disparity.
    #[inline(always)]
    pub fn raise(&mut self, confidence: u8, label: usize) {
        let [label, ..] = label.to_le_bytes();
        self.0 = self.0.max(u16::from_be_bytes([confidence, !label]));
    }

    /// Whether the winner is that label or one beside it.
    #[inline(always)]
    pub fn is_near(self, label: usize) -> bool {
        let [_, kept] = self.0.to_be_bytes();
        usize::from(!kept).wrapping_sub(label).wrapping_add(1) <= 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_better_and_then_the_nearer_winner_stays() {
        let mut claim = Claim::NONE;
        let mut raise = |confidence, label| {
            claim.raise(confidence, label);
            claim
        };
        assert!(raise(30, 9).is_near(8) && raise(29, 2).is_near(10) && !raise(30, 20).is_near(7));
        assert!(raise(30, 0).is_near(0) && raise(31, 255).is_near(254) && !raise(31, 255).is_near(256 + 1));
    }
}
