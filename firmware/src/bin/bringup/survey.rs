//! What comes out of the camera port.

use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer};
use haarline_firmware::app::edge::{RowSource, SourceEvent};
use haarline_firmware::app::settings::WIDTH;
use haarline_firmware::board::camera::Camera;
use haarline_firmware::bringup::lines::Seen;
use haarline_firmware::bringup::signals::Counted;

/// Between two looks at how far DMA has come.
const LOOK: Duration = Duration::from_micros(700);
/// Bytes of a row.
pub const ROW: usize = 2 * WIDTH as usize;

/// Counts what comes in a time.
pub async fn count(camera: &mut Camera, time: Duration) -> Counted {
    let mut counted = Counted::default();
    let mut bytes = [0; ROW];
    let (end, position) = (Instant::now() + time, Camera::position());
    while Instant::now() < end {
        match select(camera.next(&mut bytes), Timer::after(LOOK)).await {
            Either::First(event) => match event {
                SourceEvent::Row(_) | SourceEvent::Border => {
                    counted.lines += 1;
                    counted.whole += 1;
                }
                SourceEvent::Lost => counted.lines += 1,
                SourceEvent::End => counted.frames += 1,
                // Lines whose end is not told look like too many bytes.
                SourceEvent::Overrun => counted.has_bytes = true,
                _ => {}
            },
            Either::Second(()) => {}
        }
        // In the middle of a frame: the ring may hold a whole number of times in one.
        counted.has_bytes |= Camera::position() != position;
    }
    counted
}

/// Waits until the sensor shows a frame of after this, and looks at its rows; whether there was one.
pub async fn frame(camera: &mut Camera, patience: Duration, mut row: impl FnMut(usize, &[u8])) -> bool {
    let mut bytes = [0; ROW];
    let end = Instant::now() + patience;
    // What was written holds from the next frame on, and that one may have begun.
    let (mut starts, mut nth) = (0, 0);
    loop {
        let Either::First(event) = select(camera.next(&mut bytes), Timer::at(end)).await else { return false };
        match event {
            SourceEvent::Start => (starts, nth) = (starts + 1, 0),
            SourceEvent::Row(_) if starts > 2 => {
                row(nth, &bytes);
                nth += 1;
            }
            SourceEvent::End if starts > 2 && nth > 0 => return true,
            _ => {}
        }
    }
}

/// What the data lines were in a frame: its samples of two bytes.
pub async fn seen(camera: &mut Camera, patience: Duration) -> Option<Seen> {
    let mut seen = Seen::NOTHING;
    let is_whole = frame(camera, patience, |nth, row| {
        // A few rows tell as much as all.
        if nth % 16 == 8 {
            samples(row).skip(row.len() / 8).for_each(|sample| seen.add(sample));
        }
    });
    is_whole.await.then_some(seen)
}

/// The samples of a row.
pub fn samples(row: &[u8]) -> impl Iterator<Item = u16> + '_ {
    row.as_chunks::<2>().0.iter().map(|&sample| u16::from_le_bytes(sample))
}
