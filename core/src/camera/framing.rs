//! Frames out of a camera's events, whatever happens on the way.
//!
//! # Policy
//! - A row that is known to be lost, or has the wrong number of bytes, is *missed*: the rows after it
//!   stay in their places, its disparities come out unknown.
//! - When the stereo method is late and the ring of rows full, the rest of the frame is dropped. To
//!   leave single rows out would not help: a missed row costs as much as any other.
//! - A frame that ends early is answered as far as it came: by its end, the next one's start, an overrun,
//!   a failure of DMA or silence. Nothing is made up for the rows that never came.
//! - After an overrun, a failure of DMA, a silence or a row without room everything up to the next frame's
//!   start is dropped.
//! - Surplus rows of a frame are left out.
//!
//! So the first frame that comes whole after any trouble is the frame of a run without it.

use crate::Counters;

/// What a camera interface tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraEvent {
    /// A frame begins.
    Start,
    /// A row came; whole, if it has as many bytes as it should.
    Row {
        /// Whether it has.
        is_whole: bool,
    },
    /// A row was lost.
    Lost,
    /// The frame ends.
    End,
    /// Bytes came faster than they were taken: what follows is out of step.
    Overrun,
    /// DMA failed: what follows is lost up to the next frame.
    DmaError,
    /// Nothing came for longer than a row should take.
    Silence,
}

/// What is to be done about it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Nothing.
    Skip,
    /// The row belongs there: hand it over.
    Take(Place),
    /// The row that belongs there is missing: tell it.
    Miss(Place),
    /// That frame has ended: tell it where there is room. A place in a later frame tells the same.
    Close {
        /// The frame.
        frame: u32,
    },
}

/// Where a row belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Place {
    /// Number of the frame, from 0 on, wrapping around.
    pub frame: u32,
    /// Row of the frame, from 0 at the top, without a gap.
    pub row: u32,
}

/// Decides what every event of the camera means for the frame under way.
///
/// # Examples
/// ```
/// use haarline::framing::{CameraEvent, Framing, Place, Step};
/// let mut framing = Framing::new(2);
/// let row = CameraEvent::Row { is_whole: true };
/// assert_eq!(framing.step(row, true), Step::Skip); // of a frame whose start was not seen
/// assert_eq!(framing.step(CameraEvent::Start, true), Step::Skip);
/// assert_eq!(framing.step(row, true), Step::Take(Place { frame: 0, row: 0 }));
/// assert_eq!(framing.step(CameraEvent::Lost, true), Step::Miss(Place { frame: 0, row: 1 }));
/// assert_eq!(framing.step(CameraEvent::End, true), Step::Close { frame: 0 });
/// assert_eq!((framing.counters().frames, framing.counters().dropped_rows), (1, 1));
/// ```
#[derive(Debug, Clone)]
pub struct Framing {
    /// Rows of a whole frame.
    height: u32,
    state: State,
    /// Number of the frame under way, or of the next one.
    frame: u32,
    /// Whether the camera has been silent since its last event.
    silent: bool,
    counters: Counters,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// No frame is under way.
    Between,
    /// That many rows of the frame are placed.
    Under(u32),
    /// All rows are placed and another one came.
    Surplus,
    /// The rest of the frame is dropped.
    Late,
}

impl Framing {
    /// Waits for the first frame of `height` rows.
    #[must_use]
    pub const fn new(height: u32) -> Self {
        Self { height, state: State::Between, frame: 0, silent: false, counters: Counters::ZERO }
    }

    /// Whether a frame has begun and not ended: the next row is due soon.
    #[must_use]
    pub fn is_under_way(&self) -> bool {
        self.state != State::Between
    }

    /// What happened so far; rows that a method delivers are not counted here.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Takes the next event. `has_room` tells whether a row can be handed over now.
    pub fn step(&mut self, event: CameraEvent, has_room: bool) -> Step {
        let was_silent = core::mem::replace(&mut self.silent, event == CameraEvent::Silence);
        match event {
            CameraEvent::Start => self.start(),
            CameraEvent::Row { is_whole } => self.row(is_whole, has_room),
            CameraEvent::Lost => self.lost(has_room),
            CameraEvent::End => self.end(),
            CameraEvent::Overrun => {
                count(&mut self.counters.overruns);
                self.close()
            }
            CameraEvent::DmaError => {
                count(&mut self.counters.dma_errors);
                self.close()
            }
            CameraEvent::Silence => {
                if !was_silent {
                    count(&mut self.counters.stalled);
                }
                self.close()
            }
        }
    }

    fn start(&mut self) -> Step {
        if self.state != State::Between {
            self.end();
        }
        count(&mut self.counters.frames);
        self.state = State::Under(0);
        Step::Skip
    }

    fn row(&mut self, is_whole: bool, has_room: bool) -> Step {
        let place = self.place(has_room);
        match (self.state, place) {
            (State::Under(_), Some(place)) if is_whole => return Step::Take(place),
            (State::Under(_), Some(place)) => return self.miss(place),
            (State::Under(_), None) => {
                count(&mut self.counters.long);
                self.state = State::Surplus;
            }
            (State::Between | State::Late | State::Surplus, _) => {}
        }
        Step::Skip
    }

    fn lost(&mut self, has_room: bool) -> Step {
        self.place(has_room).map_or(Step::Skip, |place| self.miss(place))
    }

    fn miss(&mut self, place: Place) -> Step {
        count(&mut self.counters.dropped_rows);
        Step::Miss(place)
    }

    /// Where the next row belongs, if it is one of the frame's; without room the frame is given up.
    fn place(&mut self, has_room: bool) -> Option<Place> {
        match self.state {
            State::Under(row) if row < self.height && has_room => {
                self.state = State::Under(row + 1);
                Some(Place { frame: self.frame, row })
            }
            State::Under(row) if row < self.height => {
                count(&mut self.counters.dropped_frames);
                self.state = State::Late;
                None
            }
            _ => None,
        }
    }

    fn end(&mut self) -> Step {
        if let State::Under(rows) = self.state
            && rows < self.height
        {
            count(&mut self.counters.short);
        }
        self.close()
    }

    fn close(&mut self) -> Step {
        if self.state == State::Between {
            return Step::Skip;
        }
        let frame = self.frame;
        self.frame = frame.wrapping_add(1);
        self.state = State::Between;
        Step::Close { frame }
    }
}

const fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}

#[cfg(test)]
mod tests {
    use super::CameraEvent::{DmaError, End, Lost, Overrun, Silence, Start};
    use super::*;
    use proptest::prelude::*;
    extern crate std;
    use std::vec::Vec;

    const HEIGHT: u32 = 4;
    const ROW: CameraEvent = CameraEvent::Row { is_whole: true };
    const GARBLED: CameraEvent = CameraEvent::Row { is_whole: false };

    /// The steps of the events as text, and the counters.
    fn run(framing: &mut Framing, events: &[CameraEvent]) -> std::string::String {
        let step = |event: &CameraEvent| match framing.step(*event, true) {
            Step::Skip => '.',
            Step::Take(place) => char::from_digit(place.row, 10).unwrap(),
            Step::Miss(_) => 'm',
            Step::Close { .. } => '|',
        };
        events.iter().map(step).collect()
    }

    #[test]
    fn every_trouble_ends_with_its_frame_and_is_counted_once() {
        let none = Counters { frames: 2, ..Counters::ZERO };
        let cases: [(&[CameraEvent], &str, Counters); 10] = [
            (&[Start, ROW, ROW, ROW, ROW, End], ".0123|", none),
            (&[Start, ROW, Lost, ROW, ROW, End], ".0m23|", Counters { dropped_rows: 1, ..none }),
            (&[Start, ROW, GARBLED, ROW, ROW, End], ".0m23|", Counters { dropped_rows: 1, ..none }),
            (&[Start, ROW, ROW, End], ".01|", Counters { short: 1, ..none }),
            (&[Start, ROW, ROW], ".01", Counters { short: 1, ..none }),
            (&[Start, ROW, ROW, ROW, ROW, ROW, ROW, End], ".0123..|", Counters { long: 1, ..none }),
            (&[Start, ROW, Overrun, ROW, End], ".0|..", Counters { overruns: 1, ..none }),
            (&[Start, ROW, DmaError, ROW, End], ".0|..", Counters { dma_errors: 1, ..none }),
            (&[Start, ROW, Silence, Silence, ROW, End], ".0|...", Counters { stalled: 1, ..none }),
            (&[ROW, Lost, End, Start, ROW, ROW, ROW, ROW, Lost, End], "....0123.|", none),
        ];
        for (events, steps, counters) in cases {
            let mut framing = Framing::new(HEIGHT);
            assert_eq!(run(&mut framing, events), steps, "{events:?}");
            assert_eq!(run(&mut framing, &[Start, ROW, ROW, ROW, ROW, End]), ".0123|", "after {events:?}");
            assert_eq!(*framing.counters(), counters, "{events:?}");
        }
    }

    #[test]
    fn without_room_the_rest_of_the_frame_is_dropped() {
        let mut framing = Framing::new(HEIGHT);
        framing.step(Start, true);
        framing.step(ROW, true);
        assert_eq!([false, true, true].map(|room| framing.step(ROW, room)), [Step::Skip; 3]);
        assert_eq!(framing.step(End, false), Step::Close { frame: 0 });
        assert_eq!(*framing.counters(), Counters { frames: 1, dropped_frames: 1, ..Counters::ZERO });
    }

    proptest! {
        #[test]
        fn a_whole_frame_is_whole_after_anything(
            events in prop::collection::vec((
                prop::sample::select([Start, ROW, ROW, ROW, GARBLED, Lost, End, Overrun, DmaError, Silence].as_slice()),
                prop::bool::weighted(0.9),
            ), 0..60),
        ) {
            let mut framing = Framing::new(HEIGHT);
            let mut last = None;
            for (event, has_room) in events {
                match framing.step(event, has_room) {
                    Step::Take(place) | Step::Miss(place) => {
                        // Places go up without a gap, from row 0 of each frame.
                        match last {
                            Some(Place { frame, row }) if frame == place.frame => prop_assert_eq!(place.row, row + 1),
                            before => prop_assert!(place.row == 0 && before.is_none_or(|b: Place| b.frame < place.frame)),
                        }
                        prop_assert!(place.row < HEIGHT && has_room);
                        last = Some(place);
                    }
                    Step::Skip | Step::Close { .. } => {}
                }
            }
            let before = *framing.counters();
            framing.step(Start, true);
            let opened = *framing.counters();
            prop_assert!(opened.short - before.short <= 1);
            let rows: Vec<Step> = (0..HEIGHT).map(|_| framing.step(ROW, true)).collect();
            for (row, step) in (0..).zip(rows) {
                prop_assert!(matches!(step, Step::Take(place) if place.row == row));
                prop_assert!(last.is_none_or(|last| matches!(step, Step::Take(place) if place.frame > last.frame)));
            }
            let closes = matches!(framing.step(End, true), Step::Close { .. });
            prop_assert!(closes && !framing.is_under_way());
            prop_assert_eq!(*framing.counters(), opened);
        }
    }
}
