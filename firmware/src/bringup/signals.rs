//! Clock and sync signals of the camera port, from how often they changed and what came with them.

use core::fmt;

/// What was seen for some time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counted {
    /// Frames that began or ended.
    pub frames: u32,
    /// Lines that ended.
    pub lines: u32,
    /// Of them, those with the right number of bytes.
    pub whole: u32,
    /// Whether the port stored bytes.
    pub has_bytes: bool,
}

/// What that means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Frames come.
    Good,
    /// Nothing ever changes, whether the sensors are triggered or free-running.
    NoPixelClock,
    /// Frames come only if the sensors are free-running.
    NoTrigger,
    /// Bytes come, lines do not end.
    NoLines,
    /// Lines come, frames do not end.
    NoFrames,
    /// Frames come, but no line has as many bytes as it should.
    WrongLines,
}

impl Verdict {
    /// From what was seen with the trigger, and without it where the sensors can do that.
    #[must_use]
    pub fn of(triggered: Counted, free: Option<Counted>) -> Self {
        let one = |counted: Counted| {
            if counted.frames > 0 && counted.whole > 0 {
                Self::Good
            } else if counted.frames > 0 && counted.lines > 0 {
                Self::WrongLines
            } else if counted.lines == 0 && counted.has_bytes {
                Self::NoLines
            } else if counted.lines > 0 && counted.frames == 0 {
                Self::NoFrames
            } else {
                Self::NoPixelClock
            }
        };
        match (one(triggered), free.map(one)) {
            (Self::NoPixelClock, Some(Self::Good)) => Self::NoTrigger,
            (Self::NoPixelClock, Some(other)) => other,
            (found, _) => found,
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Good => "frames come",
            Self::NoPixelClock => "neither clock nor sync signals come: the pixel clock's wire",
            Self::NoTrigger => "frames come without the trigger only: the trigger's wire",
            Self::NoLines => "bytes come, but no line ends: the line signal's wire",
            Self::NoFrames => "lines come, but no frame ends: the frame signal's wire",
            Self::WrongLines => {
                "no line has the right number of bytes: clock and line signal of different sensors, or a bad clock"
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_missing_signal_has_its_verdict() {
        let good = Counted { frames: 10, lines: 2400, whole: 2400, has_bytes: true };
        let none = Counted::default();
        assert_eq!(Verdict::of(good, None), Verdict::Good);
        assert_eq!(Verdict::of(none, Some(good)), Verdict::NoTrigger);
        assert_eq!(Verdict::of(none, Some(none)), Verdict::NoPixelClock);
        assert_eq!(Verdict::of(none, None), Verdict::NoPixelClock);
        assert_eq!(Verdict::of(Counted { frames: 0, lines: 0, whole: 0, ..good }, None), Verdict::NoLines);
        assert_eq!(Verdict::of(Counted { frames: 0, ..good }, None), Verdict::NoFrames);
        assert_eq!(Verdict::of(Counted { whole: 0, ..good }, None), Verdict::WrongLines);
    }
}
