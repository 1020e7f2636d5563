//! Once a second what was counted is put where a probe fetches it when the run is over: nobody listens to a log while a
//! current is measured.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_time::{Duration, Instant, Ticker};
use haarline::Stage;
use haarline_link::measured::{Measured, WORDS};

use crate::app::ring::SharedCounters;
use crate::app::statistics::StageTotals;

/// The words in memory.
#[repr(transparent)]
pub struct Words([AtomicU32; WORDS]);

impl Words {
    /// Nothing was counted yet.
    #[expect(clippy::new_without_default, reason = "a static needs it const")]
    #[must_use]
    pub const fn new() -> Self {
        Self([const { AtomicU32::new(0) }; WORDS])
    }

    /// Puts them there, the first one first and the last one last: they differ while it is under way.
    pub fn put(&self, measured: &Measured, turn: u32) {
        for (place, word) in self.0.iter().zip(measured.words(turn)) {
            place.store(word, Ordering::Release);
        }
    }
}

/// Counts for ever. `slept_us` is how long nobody had anything to do so far.
pub async fn measuring(
    clock: &impl StageTotals,
    counters: &SharedCounters,
    slept_us: fn() -> u64,
    clock_hz: u32,
    size: [u16; 2],
    words: &Words,
) -> ! {
    let mut ticker = Ticker::every(Duration::from_secs(1));
    let mut turn = 0_u32;
    let ms = |us: u64| u32::try_from(us / 1000).unwrap_or(u32::MAX);
    loop {
        ticker.next().await;
        turn = turn.wrapping_add(1);
        let counted = counters.get();
        let measured = Measured {
            clock_hz,
            uptime_ms: ms(Instant::now().as_micros()),
            slept_ms: ms(slept_us()),
            frames: counted.frames,
            rows: counted.rows,
            size,
            stages: Stage::ALL.map(|stage| clock.of(stage)),
        };
        words.put(&measured, turn);
    }
}
