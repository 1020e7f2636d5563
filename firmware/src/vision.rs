//! The vision task: raw rows in, disparity rows out.

use haarline::framing::Place;
use haarline::{DisparityRow, ScanlinePair, Stage, StereoMethod};

use crate::edge::{Work, WorkClock};
use crate::ring::{From, MAX_WIDTH, RawKind, RawRow, ResultRow, SharedCounters, To};

/// Makes two rows of `left.len()` pixels of a camera's raw row; whether it could.
pub type Unpack<'a> = &'a dyn Fn(&[u8], &mut [u8], &mut [u8]) -> bool;

/// Runs the stereo method over what comes until there is no more. Where nobody takes the results in
/// time they are dropped and counted.
pub async fn vision(
    method: &mut dyn StereoMethod,
    unpack: Unpack<'_>,
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
        }
        let mut take = |row: DisparityRow<'_>| hand_over(&row, frame, &mut results, counters);
        match slot.kind {
            RawKind::Row => {
                clock.enter(Stage::Unpack);
                let bytes = slot.bytes.get(..slot.len).unwrap_or(&[]);
                let whole = unpack(bytes, left, right) && method.push(ScanlinePair { left, right }, &mut take).is_ok();
                if !whole {
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
    results.send().await.is_over = true;
    results.send_done();
}

fn hand_over(row: &DisparityRow<'_>, frame: u32, results: &mut To<ResultRow>, counters: &SharedCounters) {
    let Some(slot) = results.try_send() else {
        counters.drop_result();
        return;
    };
    let width = row.disparity.len();
    let (Some(disparity), Some(confidence)) = (slot.disparity.get_mut(..width), slot.confidence.get_mut(..width))
    else {
        return;
    };
    disparity.copy_from_slice(row.disparity);
    confidence.copy_from_slice(row.confidence);
    (slot.is_over, slot.place, slot.width) = (false, Place { frame, row: row.y }, width);
    slot.counters = counters.get();
    results.send_done();
}
