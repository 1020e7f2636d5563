//! Whether the vision task still works: then the watchdog is fed.

use embassy_time::{Duration, Ticker};

use crate::app::ring::SharedCounters;
use crate::app::statistics::StageTotals;

/// What starts the chip anew unless it is fed.
pub trait Watchdog {
    /// Starts it.
    fn unleash(&mut self);
    /// Feeds it.
    fn pet(&mut self);
}

/// Feeds the watchdog from inside the vision task, every `period`: not while that one is busy for ever, nor while it
/// leaves the camera's frames where they are.
pub async fn feed(
    clock: &impl StageTotals,
    counters: &SharedCounters,
    mut watchdog: impl Watchdog,
    period: Duration,
) -> ! {
    watchdog.unleash();
    let mut ticker = Ticker::every(period);
    let (mut rows, mut frames) = (0, 0);
    loop {
        let (rows_before, frames_before) = (rows, frames);
        (rows, frames) = (clock.rows(), counters.get().frames);
        if rows != rows_before || frames == frames_before {
            watchdog.pet();
        }
        ticker.next().await;
    }
}
