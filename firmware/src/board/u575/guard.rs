//! The limit of the stack, a register of Armv8-M: a stack that is too deep ends in a fault that says so, and not in other
//! variables.

use cortex_m::peripheral::SCB;
use cortex_m::register::msplim;

use crate::stack;

/// `STKOF` in `CFSR`: the stack went below its limit.
const OVERFLOW: u32 = 1 << 20;

/// Sets it, above what a guard on other chips takes, so that both have stacks alike.
#[expect(unsafe_code, reason = "a register of the core")]
pub fn set() {
    let Ok(limit) = u32::try_from(stack::guard() + stack::GUARD) else { return };
    // SAFETY: below it only a stack too deep would come.
    unsafe { msplim::write(limit) };
}

/// Whether the fault that is being handled is one of the limit. Its handler may then go below it.
#[must_use]
#[expect(unsafe_code, reason = "a register of the core")]
pub fn was_touched(scb: &SCB) -> bool {
    let is_touched = scb.cfsr.read() & OVERFLOW != 0;
    if is_touched {
        // SAFETY: nobody else runs any more.
        unsafe { msplim::write(0) };
    }
    is_touched
}
