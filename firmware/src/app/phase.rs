//! What the program is doing, as two pins tell a current meter or a logic analyser.
//!
//! Where it does several things at once, the pins tell the one that takes the most power: it computes, even while rows are sent
//! and lines come; it sends, even while lines come. Only one pin changes at a time: where two phases follow each other that
//! differ in both, a short [`Phase::between`] comes before the second.

/// Something that may be going on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Activity {
    /// A frame comes from the cameras: from its start to its end.
    Capture,
    /// A row is sent: from the making of its packet to the last byte.
    Send,
    /// A row, or the end of a frame, is worked on.
    Compute,
}

/// What the pins tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Nothing: it sleeps.
    Idle,
    /// A frame comes, and nothing else goes on.
    Capture,
    /// A row is worked on.
    Compute,
    /// A row is sent, and none is worked on.
    Send,
}

impl Phase {
    /// Levels of the low and the high pin.
    #[must_use]
    pub const fn pins(self) -> [bool; 2] {
        match self {
            Self::Idle => [false, false],
            Self::Capture => [true, false],
            Self::Compute => [true, true],
            Self::Send => [false, true],
        }
    }

    /// What is told for a moment before `next`, if both pins differ. Never idle, nor a capture: from idle to capture a frame
    /// begins, and nothing else looks like that.
    #[must_use]
    pub const fn between(self, next: Self) -> Option<Self> {
        match (self, next) {
            (Self::Idle, Self::Compute) | (Self::Compute, Self::Idle) => Some(Self::Send),
            (Self::Capture, Self::Send) | (Self::Send, Self::Capture) => Some(Self::Compute),
            _ => None,
        }
    }
}

/// What is going on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Activities(u8);

impl Activities {
    /// Nothing.
    pub const NONE: Self = Self(0);

    /// Something begins or ends; the phase, if it is another one now.
    pub const fn set(&mut self, activity: Activity, is_on: bool) -> Option<Phase> {
        let before = self.phase();
        let bit = 1 << activity as u8;
        self.0 = if is_on { self.0 | bit } else { self.0 & !bit };
        let now = self.phase();
        if before as u8 == now as u8 { None } else { Some(now) }
    }

    /// The phase: of all that goes on, what takes the most power.
    #[must_use]
    pub const fn phase(self) -> Phase {
        match self.0 {
            0 => Phase::Idle,
            0b001 => Phase::Capture,
            0b010 | 0b011 => Phase::Send,
            _ => Phase::Compute,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Activity::{Capture, Compute, Send};

    #[test]
    fn what_takes_the_most_power_is_told() {
        for (on, phase) in [
            (&[][..], Phase::Idle),
            (&[Capture], Phase::Capture),
            (&[Send], Phase::Send),
            (&[Compute], Phase::Compute),
            (&[Capture, Send], Phase::Send),
            (&[Capture, Compute], Phase::Compute),
            (&[Send, Compute], Phase::Compute),
            (&[Capture, Send, Compute], Phase::Compute),
        ] {
            let mut activities = Activities::NONE;
            for &activity in on {
                activities.set(activity, true);
            }
            assert_eq!(activities.phase(), phase, "{on:?}");
        }
    }

    #[test]
    fn a_change_is_told_once_and_what_is_hidden_not_at_all() {
        let mut activities = Activities::NONE;
        assert_eq!(activities.set(Capture, true), Some(Phase::Capture));
        assert_eq!(activities.set(Capture, true), None);
        assert_eq!(activities.set(Compute, true), Some(Phase::Compute));
        assert_eq!(activities.set(Send, true), None, "hidden");
        assert_eq!(activities.set(Capture, false), None, "hidden");
        assert_eq!(activities.set(Compute, false), Some(Phase::Send));
        assert_eq!(activities.set(Send, false), Some(Phase::Idle));
    }

    #[test]
    fn whatever_begins_or_ends_one_pin_changes_at_a_time() {
        for before in 0..8 {
            for (activity, is_on) in [Capture, Send, Compute].into_iter().flat_map(|it| [(it, true), (it, false)]) {
                let mut activities = Activities(before);
                let from = activities.phase();
                let Some(to) = activities.set(activity, is_on) else { continue };
                let between = from.between(to);
                assert!(!matches!(between, Some(Phase::Idle | Phase::Capture)), "a frame seems to begin");
                let path: Vec<Phase> = [Some(from), between, Some(to)].into_iter().flatten().collect();
                for pair in path.windows(2) {
                    let [one, other] = [pair[0].pins(), pair[1].pins()];
                    let changed = one.iter().zip(other).filter(|(one, other)| *one != other).count();
                    assert_eq!(changed, 1, "{path:?}");
                }
            }
        }
    }

    #[test]
    fn the_pins_tell_the_phases_apart() {
        let levels = [Phase::Idle, Phase::Capture, Phase::Compute, Phase::Send].map(Phase::pins);
        assert_eq!(levels, [[false, false], [true, false], [true, true], [false, true]]);
    }
}
