//! The executor of thread mode, which knows how long it slept.
#![expect(unsafe_code, reason = "an executor that is driven by hand, and a register of the core")]

use core::cell::Cell;

use cortex_m::asm::wfe;
use cortex_m::peripheral::SCB;
use critical_section::Mutex;
use embassy_executor::{Spawner, raw};
use embassy_time::Instant;
use static_cell::StaticCell;

/// The context by which the executor's wake-ups become an event, as in `embassy_executor::Executor`.
const THREAD: *mut () = usize::MAX as *mut ();
/// `SCR.SEVONPEND` (ARMv7-M, B3.2.7): an interrupt that becomes pending is an event, also while it is masked.
const SEVONPEND: u32 = 1 << 4;

static EXECUTOR: StaticCell<raw::Executor> = StaticCell::new();
static SLEPT_US: Mutex<Cell<u64>> = Mutex::new(Cell::new(0));

/// How long nobody had anything to do so far, us.
#[must_use]
pub fn slept_us() -> u64 {
    critical_section::with(|cs| SLEPT_US.borrow(cs).get())
}

/// Runs the tasks that `init` spawns, for ever. May be called once.
///
/// It sleeps with interrupts masked: what ends a sleep is served right after it, and does not count as sleep.
pub fn run(scb: &mut SCB, init: impl FnOnce(Spawner)) -> ! {
    // SAFETY: only lets masked interrupts wake the core.
    unsafe { scb.scr.modify(|scr| scr | SEVONPEND) };
    let executor = EXECUTOR.init(raw::Executor::new(THREAD));
    init(executor.spawner());
    loop {
        // SAFETY: from here only, never from within itself.
        unsafe { executor.poll() };
        critical_section::with(|cs| {
            let asleep = Instant::now();
            wfe();
            let slept = SLEPT_US.borrow(cs);
            slept.set(slept.get() + asleep.elapsed().as_micros());
        });
    }
}
