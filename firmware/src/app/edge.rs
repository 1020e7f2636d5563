//! Where rows come from and where results go: the two edges in which boards differ.
#![allow(async_fn_in_trait, reason = "one executor, nothing of it goes to another thread")]

use haarline::{Stage, StageClock, Untimed};

/// What a source of rows tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SourceEvent {
    /// A frame begins.
    Start,
    /// A row's raw bytes came, that many. The first ones are in the buffer.
    Row(usize),
    /// A line passed that is none of the picture's rows: the camera is not silent.
    Border,
    /// A row was lost.
    Lost,
    /// The frame ends.
    End,
    /// Bytes came faster than they were taken.
    Overrun,
    /// DMA failed, and was started anew.
    DmaError,
    /// There will be no more frames. A camera never says so.
    Over,
}

/// A camera interface: one call, one event.
pub trait RowSource {
    /// Waits for the next event; a row's bytes go into `bytes`. May be dropped while it waits.
    async fn next(&mut self, bytes: &mut [u8]) -> SourceEvent;

    /// Whether the next event is there already. Then it is taken before anybody else's turn.
    fn is_waiting(&self) -> bool {
        false
    }
}

/// Where packets go.
pub trait PacketSink {
    /// Sends a packet of that frame off, its final zero included.
    async fn send(&mut self, frame: u32, packet: &[u8]);

    /// After the last one, if the source had an end.
    async fn finish(&mut self);
}

/// A stage clock that also knows when nobody works on a row.
pub trait WorkClock: StageClock {
    /// The work on a row, or on the end of a frame, is done: what is executed from here on is no stage's.
    fn rest(&self, work: Work);

    /// Begins a stage, of none if it is `None`, within another; which one that was, to go back to.
    fn swap(&self, stage: Option<Stage>) -> Option<Stage>;
}

impl WorkClock for Untimed {
    fn rest(&self, _: Work) {}

    fn swap(&self, _: Option<Stage>) -> Option<Stage> {
        None
    }
}

/// What was worked on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// A row of the camera.
    Row,
    /// What was left to do at the end of a frame.
    FrameEnd,
}
