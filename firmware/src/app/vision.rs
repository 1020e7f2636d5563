//! The vision task: raw rows in, disparity rows out.

use haarline::framing::Place;
use haarline::packet::FrameEnd;
use haarline::{DisparityRow, Stage, StereoMethod, Wiring};

use crate::app::edge::{Work, WorkClock};
use crate::app::lookout::{Lookout, Sighting};
use crate::app::ring::{From, MAX_WIDTH, RawKind, RawRow, ResultKind, ResultRows, SLOT_ROWS, SharedCounters, To};

/// A row of a view, at a word: so it is written and read by words.
#[repr(align(4))]
struct View([u8; MAX_WIDTH]);

/// Runs the stereo method over what comes until there is no more, and looks for obstacles where a `lookout` is
/// given. Where nobody takes the results in time their frame is dropped as a whole, and counted.
pub async fn vision<const SECTORS: usize, const BLOCKS: usize>(
    method: &mut dyn StereoMethod,
    wiring: Wiring,
    clock: &impl WorkClock,
    lookout: Option<Lookout<SECTORS, BLOCKS, impl FnMut(Sighting<SECTORS>)>>,
    mut raw: From<RawRow>,
    results: To<ResultRows>,
    counters: &SharedCounters,
) {
    let width = usize::from(method.config().width);
    let (mut left, mut right) = (View([0; MAX_WIDTH]), View([0; MAX_WIDTH]));
    let (Some(left), Some(right)) = (left.0.get_mut(..width), right.0.get_mut(..width)) else { return };
    // Rows of a cell are sent together, others two at a time.
    let together = usize::try_from(method.cell_height()).map_or(2, |rows| rows.clamp(2, SLOT_ROWS));
    let mut takers = Takers { lookout, results, counters, end: FrameEnd::NONE, together, waiting: 0 };
    // The frame under way, and when it began.
    let mut open = None;
    loop {
        let slot = raw.receive().await;
        let frame = slot.place.frame;
        // The end of a frame is told by its own mark, or for want of room by the next frame.
        if let Some((ended, begun_us)) = open
            && (ended != frame || matches!(slot.kind, RawKind::Close | RawKind::Over))
        {
            method.finish(&mut |row| takers.row(&row, ended));
            clock.rest(Work::FrameEnd);
            open = None;
            takers.end.figures = method.figures();
            takers.end(ended, begun_us);
        }
        let mut take = |row: DisparityRow<'_>| takers.row(&row, frame);
        match slot.kind {
            RawKind::Row => {
                clock.enter(Stage::Unpack);
                let bytes = slot.bytes.get(..slot.len).unwrap_or(&[]);
                let pair = wiring.pair(bytes, left, right);
                if !pair.is_ok_and(|pair| method.push(pair, &mut take).is_ok()) {
                    method.miss(&mut take);
                }
                clock.rest(Work::Row);
                open = Some((frame, slot.begun_us));
            }
            RawKind::Missing => {
                method.miss(&mut take);
                clock.rest(Work::Row);
                open = Some((frame, slot.begun_us));
            }
            RawKind::Close => {}
            RawKind::Over => break,
        }
        raw.receive_done();
    }
    takers.results.send().await.kind = ResultKind::Over;
    takers.results.send_done();
}

/// Who takes disparity rows.
struct Takers<'a, const SECTORS: usize, const BLOCKS: usize, T> {
    lookout: Option<Lookout<SECTORS, BLOCKS, T>>,
    results: To<ResultRows>,
    counters: &'a SharedCounters,
    /// What becomes of the frame under way.
    end: FrameEnd,
    /// Rows that go into a packet together.
    together: usize,
    /// Rows that wait in a slot for those below them.
    waiting: usize,
}

impl<const SECTORS: usize, const BLOCKS: usize, T: FnMut(Sighting<SECTORS>)> Takers<'_, SECTORS, BLOCKS, T> {
    fn row(&mut self, row: &DisparityRow<'_>, frame: u32) {
        self.counters.count_row();
        if let Some(lookout) = &mut self.lookout {
            lookout.row(row);
        }
        if self.end.is_cut {
            return;
        }
        let Some(slot) = self.results.try_send() else {
            self.cut();
            return;
        };
        let (width, nth) = (row.disparity.len(), self.waiting);
        let (Some(disparity), Some(confidence)) = (slot.disparity.get_mut(nth), slot.confidence.get_mut(nth)) else {
            return;
        };
        let (Some(disparity), Some(confidence)) = (disparity.get_mut(..width), confidence.get_mut(..width)) else {
            return;
        };
        row.copy_to(disparity, confidence);
        if nth == 0 {
            (slot.kind, slot.place) = (ResultKind::Rows, Place { frame, row: row.y });
            (slot.width, slot.together) = (width, self.together);
        }
        slot.count = nth + 1;
        self.waiting = nth + 1;
        if (row.y as usize + 1).is_multiple_of(SLOT_ROWS) {
            self.hand_on();
        }
    }

    /// Hands the slot on that was written last.
    fn hand_on(&mut self) {
        self.waiting = 0;
        if let Some(slot) = self.results.try_send() {
            self.end.rows += u32::try_from(slot.count).unwrap_or(0);
            slot.counters = self.counters.get();
            self.results.send_done();
        }
    }

    /// Nobody takes the rows in time: the frame is not sent to its end.
    fn cut(&mut self) {
        self.waiting = 0;
        self.end.is_cut = true;
        self.end.unsent_frames = self.end.unsent_frames.saturating_add(1);
    }

    /// Tells that a frame has ended.
    fn end(&mut self, frame: u32, begun_us: u64) {
        if self.waiting > 0 {
            self.hand_on();
        }
        if self.end.rows > 0 || !self.end.is_cut {
            match self.results.try_send() {
                Some(slot) => {
                    (slot.kind, slot.place) = (ResultKind::End, Place { frame, row: 0 });
                    (slot.counters, slot.end) = (self.counters.get(), self.end);
                    self.results.send_done();
                }
                // Whoever makes the packets sees by the next frame that there was no end.
                None if !self.end.is_cut => self.cut(),
                None => {}
            }
        }
        self.counters.end_frame(self.end);
        if let Some(lookout) = &mut self.lookout {
            lookout.end(frame, begun_us, self.end.figures);
        }
        self.end = FrameEnd { unsent_frames: self.end.unsent_frames, ..FrameEnd::NONE };
    }
}
