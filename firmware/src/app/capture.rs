//! The capture task: what the camera delivers goes into the ring, or is dropped and counted.

use embassy_futures::yield_now;
use embassy_time::{Duration, Instant, with_timeout};
use haarline::framing::{CameraEvent, Framing, Place, Step};

use crate::app::edge::{RowSource, SourceEvent};
use crate::app::ring::{MAX_RAW, RawKind, RawRow, SharedCounters, To};

/// How long a camera may deliver nothing until it counts as silent.
#[derive(Debug, Clone, Copy)]
pub struct Patience {
    /// Between two rows of a frame.
    pub within: Duration,
    /// Between two frames.
    pub between: Duration,
}

/// Before its first frame a camera has more time: sensors are set up first.
const FIRST_SILENCE: Duration = Duration::from_secs(1);

/// Takes the camera's events until it has no more, and hands the rows over. It waits for the camera
/// only: without room in the ring rows are dropped by the policy of [`haarline::framing`].
///
/// - `patience`: when the camera counts as silent; `raw_len`: bytes of a whole row; `height`: rows of a whole frame.
pub async fn capture(
    mut source: impl RowSource,
    mut ring: To<RawRow>,
    counters: &SharedCounters,
    patience: Patience,
    raw_len: usize,
    height: u32,
) {
    let mut framing = Framing::new(height);
    // Where a row goes while the ring is full: whether there is room counts when it is there.
    let mut spare = [0; MAX_RAW];
    let mut begun_us = 0;
    loop {
        let silence = match framing.counters().frames {
            0 => FIRST_SILENCE,
            _ if framing.is_under_way() => patience.within,
            _ => patience.between,
        };
        let (event, is_spare) = match ring.try_send() {
            Some(slot) => (with_timeout(silence, source.next(&mut slot.bytes)).await, false),
            None => (with_timeout(silence, source.next(&mut spare)).await, true),
        };
        let event = match event {
            Ok(SourceEvent::Over) => break,
            Ok(SourceEvent::Border) => continue,
            Ok(SourceEvent::Start) => {
                begun_us = Instant::now().as_micros();
                CameraEvent::Start
            }
            Ok(SourceEvent::Row(len)) => CameraEvent::Row { is_whole: len == raw_len },
            Ok(SourceEvent::Lost) => CameraEvent::Lost,
            Ok(SourceEvent::End) => CameraEvent::End,
            Ok(SourceEvent::Overrun) => CameraEvent::Overrun,
            Ok(SourceEvent::DmaError) => CameraEvent::DmaError,
            Err(_) => CameraEvent::Silence,
        };
        let before = *framing.counters();
        let step = framing.step(event, !ring.is_full());
        counters.update(framing.counters());
        if framing.counters().overruns != before.overruns {
            defmt::warn!("camera: overrun, resuming at the next frame");
        } else if framing.counters().dma_errors != before.dma_errors {
            defmt::warn!("camera: DMA failed, resuming at the next frame");
        } else if framing.counters().stalled != before.stalled {
            defmt::warn!("camera: silent");
        }
        if let Some(slot) = ring.try_send()
            && place(slot, step, raw_len)
        {
            slot.begun_us = begun_us;
            if let (true, Some(to), Some(from)) = (is_spare, slot.bytes.get_mut(..raw_len), spare.get(..raw_len)) {
                to.copy_from_slice(from);
            }
            ring.send_done();
        }
        if !source.is_waiting() {
            // Vision's turn, also where the source never lets anybody wait.
            yield_now().await;
        }
    }
    if let Step::Close { frame } = framing.step(CameraEvent::End, true) {
        hand_over(&mut ring, Step::Close { frame }).await;
        counters.update(framing.counters());
    }
    ring.send().await.kind = RawKind::Over;
    ring.send_done();
}

async fn hand_over(ring: &mut To<RawRow>, step: Step) {
    if place(ring.send().await, step, 0) {
        ring.send_done();
    }
}

/// Fills in what the slot holds; whether anything is to be handed over.
fn place(slot: &mut RawRow, step: Step, raw_len: usize) -> bool {
    (slot.kind, slot.place) = match step {
        Step::Skip => return false,
        Step::Take(place) => (RawKind::Row, place),
        Step::Miss(place) => (RawKind::Missing, place),
        Step::Close { frame } => (RawKind::Close, Place { frame, row: 0 }),
    };
    slot.len = raw_len;
    true
}
