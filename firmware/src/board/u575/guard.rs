//! The limit of the stack, a register of Armv8-M: a stack that is too deep ends in a fault that says so, and not in other
//! variables.

use cortex_m::peripheral::SCB;
use cortex_m::register::msplim;

use crate::stack;

/// `STKOF` in `CFSR`: the stack went below its limit.
const OVERFLOW: u32 = 1 << 20;
/// `STKOFHFNMIGN` in `CCR`: no limit for the handler of that fault, which has no other stack.
const NOT_FOR_FAULTS: u32 = 1 << 10;

/// Sets it, above what a guard on other chips takes, so that both have stacks alike.
#[expect(unsafe_code, reason = "registers of the core")]
pub fn set(scb: &mut SCB) {
    let Ok(limit) = u32::try_from(stack::guard() + stack::GUARD) else { return };
    // SAFETY: below it only a stack too deep would come.
    unsafe {
        scb.ccr.modify(|ccr| ccr | NOT_FOR_FAULTS);
        msplim::write(limit);
    }
}

/// Whether the fault that is being handled is one of the limit.
#[must_use]
pub fn was_touched(scb: &SCB) -> bool {
    scb.cfsr.read() & OVERFLOW != 0
}
