//! Counts executed instructions.
//!
//! QEMU with `-icount shift=6,sleep=off` lets each instruction take 64 ns of its virtual time, and
//! the machine's timer ticks every 40 ns of it. So 8 ticks are 5 instructions.

use core::cell::Cell;
use core::sync::atomic::{Ordering, compiler_fence};

/// Base of the CMSDK dual timer, of which the first one is used.
const TIMER: usize = 0x4000_2000;
/// Its value, which counts down.
const VALUE: *const u32 = (TIMER + 0x4) as *const u32;
const CONTROL: *mut u32 = (TIMER + 0x8) as *mut u32;
/// Enabled, free running, no interrupt, no prescaler, 32 bits.
const FREE_RUNNING: u32 = 1 << 7 | 1 << 1;

/// Spans that the marker's own cost is taken from.
const TRIALS: u32 = 1000;

/// A stopwatch of instructions. It can be paused; each span between `go` and `halt` costs a few
/// instructions of its own, which are subtracted.
pub struct Clock {
    since: Cell<u32>,
    ticks: Cell<u32>,
    spans: Cell<u32>,
    /// What an empty span shows.
    own: u32,
}

impl Clock {
    /// Starts the timer, and measures what the measuring costs.
    pub fn new() -> Self {
        start_timer();
        let mut clock = Self { since: Cell::new(0), ticks: Cell::new(0), spans: Cell::new(0), own: 0 };
        for _ in 0..TRIALS {
            clock.go();
            clock.halt();
        }
        clock.own = (clock.take() + TRIALS / 2) / TRIALS;
        clock
    }

    /// Instructions that each span costs, subtracted by [`take`](Self::take).
    pub fn own(&self) -> u32 {
        self.own
    }

    /// Begins a span.
    #[inline(never)]
    pub fn go(&self) {
        self.since.set(read_timer());
    }

    /// Ends the span.
    #[inline(never)]
    pub fn halt(&self) {
        let now = read_timer();
        self.ticks.set(self.ticks.get() + self.since.get().wrapping_sub(now));
        self.spans.set(self.spans.get() + 1);
    }

    /// Instructions of all spans since the last call.
    pub fn take(&self) -> u32 {
        let ticks = u64::from(self.ticks.take());
        let instructions = u32::try_from((ticks * 5 + 4) / 8).unwrap_or(u32::MAX);
        instructions.saturating_sub(self.spans.take() * self.own)
    }
}

#[expect(unsafe_code, reason = "a register of the machine")]
fn start_timer() {
    // SAFETY: a register of the machine this program is linked for; nothing else uses the timer.
    unsafe { CONTROL.write_volatile(FREE_RUNNING) }
}

#[expect(unsafe_code, reason = "a register of the machine")]
fn read_timer() -> u32 {
    // What is measured stays on its side.
    compiler_fence(Ordering::SeqCst);
    // SAFETY: a register of the machine this program is linked for; reading has no side effect.
    let value = unsafe { VALUE.read_volatile() };
    compiler_fence(Ordering::SeqCst);
    value
}
