//! A panic or a fault is logged, then the chip begins anew.

#![expect(unsafe_code, reason = "an exception may come at any time")]

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::ExceptionFrame;

use super::this::{clock, guard};
use crate::stack;

/// Long enough for a probe to fetch the log, cycles: 50 ms.
const FETCH: u32 = clock::CORE / 20;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    defmt::error!("panic: {}", defmt::Display2Format(info));
    cortex_m::asm::delay(FETCH);
    SCB::sys_reset()
}

#[cortex_m_rt::exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    // SAFETY: nobody else runs any more.
    let core = unsafe { cortex_m::Peripherals::steal() };
    if guard::was_touched(&core.SCB) {
        // The frame is none: the core found no room for it.
        defmt::error!("stack overflow: {=usize} B are not enough", stack::size());
    } else {
        defmt::error!("hard fault at {=u32:#010x}, called from {=u32:#010x}", frame.pc(), frame.lr());
    }
    cortex_m::asm::delay(FETCH);
    SCB::sys_reset()
}
