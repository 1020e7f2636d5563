//! What the program does, as two pins tell it.

use serde::Serialize;

/// What the program does. Where it does several things at once, the pins tell the last of these.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// It sleeps: nothing comes, nothing is computed or sent.
    Idle,
    /// Lines come from the cameras.
    Capture,
    /// A row is computed.
    Compute,
    /// Rows are sent.
    Send,
}

impl Phase {
    /// All, in the order of their code.
    pub const ALL: [Self; 4] = [Self::Idle, Self::Capture, Self::Compute, Self::Send];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Capture => "capture",
            Self::Compute => "compute",
            Self::Send => "send",
        }
    }

    /// By the levels of the low and the high pin: a Gray code, so that from one to the next only one pin changes.
    #[must_use]
    pub const fn of_pins(low: bool, high: bool) -> Self {
        match (high, low) {
            (false, false) => Self::Idle,
            (false, true) => Self::Capture,
            (true, true) => Self::Compute,
            (true, false) => Self::Send,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_differ_in_one_pin() {
        let pins = |phase: Phase| {
            let all = [(false, false), (false, true), (true, false), (true, true)];
            all.into_iter().find(|&(high, low)| Phase::of_pins(low, high) == phase).unwrap()
        };
        for pair in Phase::ALL.windows(2) {
            let [(high, low), (next_high, next_low)] = [pins(pair[0]), pins(pair[1])];
            assert_eq!(u8::from(high != next_high) + u8::from(low != next_low), 1, "{pair:?}");
        }
    }
}
