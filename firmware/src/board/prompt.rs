//! Where the tasks run that must not wait for the vision task, which takes milliseconds for a row of
//! blocks. They interrupt it; the camera port and DMA interrupt them.
#![expect(unsafe_code, reason = "an interrupt that belongs to the executor alone")]

use embassy_executor::{InterruptExecutor, SendSpawner};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};

/// The executor.
static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// The port UART4 is not in use; its interrupt is the executor's.
#[interrupt]
unsafe fn UART4() {
    // SAFETY: nobody else calls it.
    unsafe { EXECUTOR.on_interrupt() }
}

/// Starts the executor: may be called once.
#[must_use]
pub fn start() -> SendSpawner {
    interrupt::UART4.set_priority(Priority::P6);
    EXECUTOR.start(interrupt::UART4)
}
