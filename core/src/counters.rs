//! What happened to the camera's frames and rows, counted.

/// Counts since the start, each wrapping around. Every result carries them, so that whoever receives
/// results knows why some are missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Frames that began.
    pub frames: u32,
    /// Rows handed over to the stereo method.
    pub rows: u32,
    /// Rows of a frame that the camera interface knows it has lost.
    pub lost: u32,
    /// Rows with too few or too many bytes.
    pub garbled: u32,
    /// Rows that came and were dropped: of a frame given up, or of no frame.
    pub dropped_rows: u32,
    /// Frames given up because the stereo method was late.
    pub dropped_frames: u32,
    /// Result rows dropped because whoever takes them was late.
    pub dropped_results: u32,
    /// Frames given up because bytes came faster than they were taken.
    pub overruns: u32,
    /// Frames that ended early.
    pub short: u32,
    /// Frames with more rows than there should be; the first ones count.
    pub long: u32,
    /// Times that the camera fell silent.
    pub stalled: u32,
}

impl Counters {
    /// Nothing happened yet.
    pub const ZERO: Self = Self {
        frames: 0,
        rows: 0,
        lost: 0,
        garbled: 0,
        dropped_rows: 0,
        dropped_frames: 0,
        dropped_results: 0,
        overruns: 0,
        short: 0,
        long: 0,
        stalled: 0,
    };
}
