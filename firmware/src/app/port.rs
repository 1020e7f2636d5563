//! Rows out of a camera port that stores words through DMA into a ring, whatever the camera does.
//!
//! The port's interrupts come at the end of a line and of a frame, and tell how far DMA has come.
//! [`Port`] makes rows of that: a row is handed on when the words up to the end of its line are
//! exactly those of a row. It is served in interrupts and does nothing that takes long; whoever takes
//! the rows reads them out of the ring later.
//!
//! # Policy
//! - A line with the wrong number of words may have left bytes in the port that shift all that follows:
//!   the rest of the frame is lost, line by line, and the port restarted at the frame's end.
//! - After an overrun, or where nobody takes the rows, the port restarts at once and waits for the next frame.
//! - After a DMA error it stands still until whoever owns the DMA has restarted it.
//!
//! Served so late that the next line has begun, the rows wait for a later interrupt; a wrong line may
//! then pass if the one after it makes up for it. A line that is too long by less than a word is seen
//! when the bytes it left fill one, and one without a whole word only by the frame that is a row short.

/// What has happened since the last look.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Flags {
    /// A line ended, captured or not.
    pub line: bool,
    /// A captured frame ended.
    pub frame: bool,
    /// The port lost bytes.
    pub overrun: bool,
    /// DMA failed and stopped.
    pub dma_error: bool,
}

/// Where the camera is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sync {
    /// Pixels are coming.
    InLine,
    /// Between two lines.
    BetweenLines,
    /// Between two frames.
    BetweenFrames,
}

/// The registers of a port and of its DMA.
pub trait PortRegisters {
    /// Reads the flags and clears those that were set.
    fn take_flags(&mut self) -> Flags;
    /// Where the camera is now.
    fn sync(&self) -> Sync;
    /// Where in the ring DMA stores next, words.
    fn ring_position(&self) -> u32;
    /// Waits for a small part of a microsecond.
    fn wait(&mut self);
    /// Stops storing.
    fn stop(&mut self);
    /// Throws away what the port holds, and stores from the next frame's start on.
    fn restart(&mut self);
}

/// What the port tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PortEvent {
    /// A frame begins.
    Start,
    /// A whole row is in the ring.
    Row {
        /// Words stored before it since the port was started, wrapping around.
        at: u32,
    },
    /// A row is lost.
    Lost,
    /// The frame ends.
    End,
    /// What follows up to the next start is lost.
    Overrun,
    /// DMA failed: nothing comes until it is restarted.
    DmaError,
}

/// Where the events go.
pub trait Events {
    /// Events that there is room for.
    fn room(&self) -> usize;
    /// Takes an event for which there is room.
    fn push(&mut self, event: PortEvent);
}

/// Most rows that wait for an interrupt which is not late. The ring must have room for them, for one under
/// way, and for as many as the queue of events takes.
const MAX_LATE: u32 = 3;

/// Looks at DMA, each after a wait, until the words of a line that has ended must have been stored: ten microseconds or so.
/// At the end of a line the last ones are still on their way, through the port's and the DMA's own memories.
const LOOKS: u32 = 100;

/// Places that are kept for an overrun and a DMA error: both must be told.
const KEPT: usize = 2;

/// The state of a port.
#[derive(Debug, Clone)]
pub struct Port {
    /// Words of a row, and of the ring.
    row: u32,
    ring: u32,
    /// The last position in the ring, and words stored in all.
    position: u32,
    stored: u32,
    /// Words stored before the row under way.
    begin: u32,
    state: State,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Not started, or DMA failed.
    Stopped,
    /// No row of a frame came yet.
    Between,
    /// Rows of a frame came.
    Open,
    /// A line of the frame was wrong.
    OutOfStep,
}

impl Port {
    /// A port that is not started, for rows of `row` words in a ring of `ring` words.
    #[must_use]
    pub const fn new(row: u32, ring: u32) -> Self {
        Self { row, ring, position: 0, stored: 0, begin: 0, state: State::Stopped }
    }

    /// Starts; DMA stands at the ring's beginning and no event is waiting.
    pub fn start(&mut self, registers: &mut impl PortRegisters) {
        let _ = registers.take_flags();
        *self = Self { state: State::Between, ..Self::new(self.row, self.ring) };
        registers.restart();
    }

    /// Serves the port's interrupts and those of its DMA.
    pub fn serve(&mut self, registers: &mut impl PortRegisters, events: &mut impl Events) {
        let flags = registers.take_flags();
        if self.state == State::Stopped {
            return;
        }
        if flags.dma_error {
            registers.stop();
            self.state = State::Stopped;
            if events.room() > 0 {
                events.push(PortEvent::DmaError);
            }
        } else if flags.overrun {
            self.give_up(registers, events);
        } else if flags.frame {
            self.end_frame(flags.line, registers, events);
        } else if flags.line {
            self.end_line(registers, events);
        }
    }

    /// Words that DMA has stored since the start, wrapping around.
    pub fn stored(&mut self, registers: &impl PortRegisters) -> u32 {
        self.follow(registers);
        self.stored
    }

    /// Follows DMA; it never laps the ring between two interrupts.
    fn follow(&mut self, registers: &impl PortRegisters) {
        let position = registers.ring_position() % self.ring;
        let came = (position + self.ring - self.position) % self.ring;
        self.position = position;
        self.stored = self.stored.wrapping_add(came);
    }

    /// Follows DMA until it has stored whole rows, while the camera stays between lines; where the camera is then.
    fn follow_to_row(&mut self, registers: &mut impl PortRegisters) -> Sync {
        for _ in 0..LOOKS {
            // In this order: what is stored after a look at the signals is not of an earlier line.
            let sync = registers.sync();
            self.follow(registers);
            if sync == Sync::InLine || self.state == State::OutOfStep || self.pending().is_multiple_of(self.row) {
                return sync;
            }
            registers.wait();
        }
        registers.sync()
    }

    /// Words since the last row.
    fn pending(&self) -> u32 {
        self.stored.wrapping_sub(self.begin)
    }

    fn end_line(&mut self, registers: &mut impl PortRegisters, events: &mut impl Events) {
        let sync = self.follow_to_row(registers);
        if self.pending() > MAX_LATE * self.row {
            self.give_up(registers, events);
        } else if sync == Sync::InLine {
            // Too late to tell where the line ended.
        } else if self.state == State::OutOfStep {
            self.begin = self.stored;
            self.tell(PortEvent::Lost, registers, events);
        } else {
            self.hand_on(registers, events);
        }
    }

    /// Hands on the rows up to the end of a line, if they are whole.
    fn hand_on(&mut self, registers: &mut impl PortRegisters, events: &mut impl Events) {
        let is_whole = self.pending().is_multiple_of(self.row);
        while self.pending() > 0 {
            let at = self.begin;
            self.begin = if self.pending() < self.row { self.stored } else { at.wrapping_add(self.row) };
            let event = if is_whole { PortEvent::Row { at } } else { PortEvent::Lost };
            if !self.tell(event, registers, events) {
                return;
            }
        }
        if !is_whole {
            self.state = State::OutOfStep;
        }
    }

    fn end_frame(&mut self, has_line: bool, registers: &mut impl PortRegisters, events: &mut impl Events) {
        let sync = self.follow_to_row(registers);
        if sync != Sync::BetweenFrames || self.pending() > MAX_LATE * self.row {
            self.give_up(registers, events);
            return;
        }
        if self.state == State::OutOfStep {
            self.begin = self.stored;
            if has_line {
                self.tell(PortEvent::Lost, registers, events);
            }
        } else {
            self.hand_on(registers, events);
        }
        match self.state {
            State::Open => {
                self.tell(PortEvent::End, registers, events);
            }
            State::OutOfStep => {
                if self.tell(PortEvent::End, registers, events) {
                    registers.restart();
                }
            }
            State::Stopped | State::Between => return,
        }
        self.state = State::Between;
    }

    /// Tells of the frame under way, its start first; without room it is given up.
    fn tell(&mut self, event: PortEvent, registers: &mut impl PortRegisters, events: &mut impl Events) -> bool {
        let is_new = self.state == State::Between;
        if events.room() < 1 + usize::from(is_new) + KEPT {
            self.give_up(registers, events);
            return false;
        }
        if is_new {
            self.state = State::Open;
            events.push(PortEvent::Start);
        }
        events.push(event);
        true
    }

    fn give_up(&mut self, registers: &mut impl PortRegisters, events: &mut impl Events) {
        registers.restart();
        self.follow(registers);
        self.begin = self.stored;
        self.state = State::Between;
        // Without room for it there is one waiting.
        if events.room() > 1 {
            events.push(PortEvent::Overrun);
        }
    }
}

#[cfg(test)]
mod tests;
