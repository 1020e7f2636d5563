//! The vision task: raw rows in, disparity rows out.

use haarline::framing::Place;
use haarline::{DisparityRow, Stage, StereoMethod, Wiring};

use crate::edge::{Work, WorkClock};
use crate::lookout::{Lookout, Sighting};
use crate::ring::{From, MAX_WIDTH, RawKind, RawRow, ResultKind, ResultRow, SharedCounters, To};

/// Runs the stereo method over what comes until there is no more, and looks for obstacles where a `lookout` is
/// given. Where nobody takes the results in time they are dropped: the counters tell of more rows than arrive.
pub async fn vision<const SECTORS: usize, const BLOCKS: usize>(
    method: &mut dyn StereoMethod,
    wiring: Wiring,
    clock: &impl WorkClock,
    lookout: Option<Lookout<SECTORS, BLOCKS, impl FnMut(Sighting<SECTORS>)>>,
    mut raw: From<RawRow>,
    results: To<ResultRow>,
    counters: &SharedCounters,
) {
    let width = usize::from(method.config().width);
    let (mut left, mut right) = ([0; MAX_WIDTH], [0; MAX_WIDTH]);
    let (Some(left), Some(right)) = (left.get_mut(..width), right.get_mut(..width)) else { return };
    let mut takers = Takers { lookout, results, counters };
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
    results: To<ResultRow>,
    counters: &'a SharedCounters,
}

impl<const SECTORS: usize, const BLOCKS: usize, T: FnMut(Sighting<SECTORS>)> Takers<'_, SECTORS, BLOCKS, T> {
    fn row(&mut self, row: &DisparityRow<'_>, frame: u32) {
        self.counters.count_row();
        if let Some(lookout) = &mut self.lookout {
            lookout.row(row);
        }
        let Some(slot) = self.results.try_send() else { return };
        let width = row.disparity.len();
        let (Some(disparity), Some(confidence)) = (slot.disparity.get_mut(..width), slot.confidence.get_mut(..width))
        else {
            return;
        };
        disparity.copy_from_slice(row.disparity);
        confidence.copy_from_slice(row.confidence);
        (slot.kind, slot.place, slot.width) = (ResultKind::Row, Place { frame, row: row.y }, width);
        slot.counters = self.counters.get();
        self.results.send_done();
    }

    /// Tells that a frame has ended.
    fn end(&mut self, frame: u32, begun_us: u64) {
        if let Some(slot) = self.results.try_send() {
            (slot.kind, slot.place) = (ResultKind::End, Place { frame, row: 0 });
            slot.counters = self.counters.get();
            self.results.send_done();
        }
        if let Some(lookout) = &mut self.lookout {
            lookout.end(frame, begun_us);
        }
    }
}
