//! What went through and what went wrong since the start: carried by every result.

/// Counts since the start, each of which stops at [`u32::MAX`] instead of beginning anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "packet", derive(serde::Serialize, serde::Deserialize))]
pub struct Counters {
    /// Frames that the camera began, whatever became of them.
    pub frames: u32,
    /// Rows that the method delivered.
    pub rows: u32,
    /// Rows left out, because the vision task was late or because their line was lost; the method was
    /// told that they are missing.
    pub dropped_rows: u32,
    /// Frames left out, whole or from some row on, because the vision task was late.
    pub dropped_frames: u32,
    /// Times that the port lost bytes because nothing fetched them in time; the frame ends there.
    pub overruns: u32,
    /// Frames with fewer lines than configured.
    pub short: u32,
    /// Frames with more lines than configured; what is too much is not used.
    pub long: u32,
    /// Times that no line came for so long that the camera's clock must have stood still.
    pub stalled: u32,
    /// Times that DMA failed and was started anew; the frame ends there.
    pub dma_errors: u32,
}

impl Counters {
    /// Nothing happened yet.
    pub const ZERO: Self = Self {
        frames: 0,
        rows: 0,
        dropped_rows: 0,
        dropped_frames: 0,
        overruns: 0,
        short: 0,
        long: 0,
        stalled: 0,
        dma_errors: 0,
    };

    /// Whether every frame begun so far went through without a fault.
    #[must_use]
    pub const fn is_clean(&self) -> bool {
        let Self { frames: _, rows: _, dropped_rows, dropped_frames, overruns, short, long, stalled, dma_errors } =
            *self;
        dropped_rows | dropped_frames | overruns | short | long | stalled | dma_errors == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_went_through_is_clean_and_any_fault_is_not() {
        assert!(Counters { frames: 3, rows: 720, ..Counters::ZERO }.is_clean());
        assert!(!Counters { stalled: 1, ..Counters::ZERO }.is_clean());
        assert!(!Counters { dma_errors: 1, ..Counters::ZERO }.is_clean());
        assert!(!Counters { dropped_rows: 2, ..Counters::ZERO }.is_clean());
        assert_eq!(Counters::default(), Counters::ZERO);
    }
}
