//! What can go wrong at the camera, on purpose.

use core::str::FromStr;

/// Kinds of trouble, all in the middle of the frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultKind {
    /// The middle row is known to be lost.
    LostLine,
    /// The frame ends after half of its rows.
    Short,
    /// Rows go on after the last one, a quarter more.
    Long,
    /// Bytes came too fast in the middle row.
    Overrun,
    /// Eight rows of noise, every other one too short.
    Garbage,
    /// The pixel clock stops in the middle, for longer than a camera may be silent.
    Stall,
    /// The rows come all at once.
    Burst,
}

/// One fault in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fault {
    /// What goes wrong.
    pub kind: FaultKind,
    /// In which frame, from 0.
    pub frame: u32,
}

impl FromStr for Fault {
    type Err = &'static str;

    /// Reads `KIND@FRAME`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (kind, frame) = text.split_once('@').ok_or("a fault is KIND@FRAME")?;
        let kind = match kind {
            "lost-line" => FaultKind::LostLine,
            "short" => FaultKind::Short,
            "long" => FaultKind::Long,
            "overrun" => FaultKind::Overrun,
            "garbage" => FaultKind::Garbage,
            "stall" => FaultKind::Stall,
            "burst" => FaultKind::Burst,
            _ => return Err("no such fault"),
        };
        Ok(Self { kind, frame: frame.parse().map_err(|_| "the fault's frame is no number")? })
    }
}
