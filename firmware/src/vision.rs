//! The vision task: raw rows in, disparity rows out.

use haarline::framing::Place;
use haarline::{DisparityRow, Stage, StereoMethod, Wiring};

use crate::edge::{Work, WorkClock};
use crate::ring::{From, MAX_WIDTH, RawKind, RawRow, ResultKind, ResultRow, SharedCounters, To};

/// Runs the stereo method over what comes until there is no more. Where nobody takes the results in
/// time they are dropped: the counters tell of more rows than arrive.
pub async fn vision(
    method: &mut dyn StereoMethod,
    wiring: Wiring,
    clock: &impl WorkClock,
    mut raw: From<RawRow>,
    mut results: To<ResultRow>,
    counters: &SharedCounters,
) {
    let width = usize::from(method.config().width);
    let (mut left, mut right) = ([0; MAX_WIDTH], [0; MAX_WIDTH]);
    let (Some(left), Some(right)) = (left.get_mut(..width), right.get_mut(..width)) else { return };
    let mut open = None;
    loop {
        let slot = raw.receive().await;
        let frame = slot.place.frame;
        // The end of a frame is told by its own mark, or for want of room by the next frame.
        if let Some(ended) = open
            && (ended != frame || matches!(slot.kind, RawKind::Close | RawKind::Over))
        {
            method.finish(&mut |row| hand_over(&row, ended, &mut results, counters));
            clock.rest(Work::FrameEnd);
            open = None;
            end(ended, &mut results, counters);
        }
        let mut take = |row: DisparityRow<'_>| hand_over(&row, frame, &mut results, counters);
        match slot.kind {
            RawKind::Row => {
                clock.enter(Stage::Unpack);
                let bytes = slot.bytes.get(..slot.len).unwrap_or(&[]);
                let pair = wiring.pair(bytes, left, right);
                if !pair.is_ok_and(|pair| method.push(pair, &mut take).is_ok()) {
                    method.miss(&mut take);
                }
                clock.rest(Work::Row);
                open = Some(frame);
            }
            RawKind::Missing => {
                method.miss(&mut take);
                clock.rest(Work::Row);
                open = Some(frame);
            }
            RawKind::Close => {}
            RawKind::Over => break,
        }
        raw.receive_done();
    }
    results.send().await.kind = ResultKind::Over;
    results.send_done();
}

/// Tells that a frame has ended.
fn end(frame: u32, results: &mut To<ResultRow>, counters: &SharedCounters) {
    if let Some(slot) = results.try_send() {
        (slot.kind, slot.place, slot.counters) = (ResultKind::End, Place { frame, row: 0 }, counters.get());
        results.send_done();
    }
}

fn hand_over(row: &DisparityRow<'_>, frame: u32, results: &mut To<ResultRow>, counters: &SharedCounters) {
    counters.count_row();
    let Some(slot) = results.try_send() else { return };
    let width = row.disparity.len();
    let (Some(disparity), Some(confidence)) = (slot.disparity.get_mut(..width), slot.confidence.get_mut(..width))
    else {
        return;
    };
    disparity.copy_from_slice(row.disparity);
    confidence.copy_from_slice(row.confidence);
    (slot.kind, slot.place, slot.width) = (ResultKind::Row, Place { frame, row: row.y }, width);
    slot.counters = counters.get();
    results.send_done();
}
