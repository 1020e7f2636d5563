//! Merit: how far a match stands out, and the confidence that it makes, 1 to 255.

/// Merit of a match: the margin to its best rival minus its own cost, both SADs of a window of
/// [`Merit::PIXELS`] pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct Merit(i16);

impl Merit {
    /// Pixels of the window that the constants here are made for.
    const PIXELS: i32 = 48;
    /// A margin beyond 10 grey levels a pixel says no more.
    const MOST_MARGIN: i32 = 10 * Self::PIXELS;
    /// What each neighbour on another surface takes away: 2 grey levels a pixel.
    const JUMP: i32 = 2 * Self::PIXELS;

    /// Merit of a match of `cost`, `margin` below its best rival more than a step away.
    pub(crate) fn new(cost: i32, margin: Option<i32>) -> Self {
        let margin = margin.unwrap_or(Self::MOST_MARGIN).min(Self::MOST_MARGIN);
        Self(i16::try_from(margin - cost).unwrap_or(i16::MIN))
    }

    /// Confidence of a match among its neighbours: `least` is the least merit of those on the same
    /// surface, itself included, and `jumps` counts those on another one.
    ///
    /// Linear: 255 stands for a margin of 10 grey levels a pixel at no cost, 1 for 16 grey levels a
    /// pixel less and all that is worse.
    pub(crate) fn confidence(self, least: Self, jumps: i32) -> u8 {
        let merit = (i32::from(self.0) + i32::from(least.0)) / 2 - Self::JUMP * jumps;
        let range = 16 * Self::PIXELS;
        let scaled = 255 - (Self::MOST_MARGIN - merit) * 254 / range;
        u8::try_from(scaled.clamp(1, 255)).unwrap_or(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn confidence_rises_with_the_margin_and_falls_with_cost_and_jumps() {
        let of = |merit: Merit, jumps| merit.confidence(merit, jumps);
        let perfect = Merit::new(0, None);
        assert_eq!(of(perfect, 0), 255);
        assert_eq!(of(Merit::new(2976, Some(-2976)), 4), 1);
        assert!(of(Merit::new(50, Some(150)), 0) > of(Merit::new(50, Some(50)), 0));
        assert!(of(Merit::new(50, Some(200)), 0) > of(Merit::new(80, Some(200)), 0));
        assert!(of(perfect, 0) > of(perfect, 1));
    }
}
