//! The guard below the stack: a part of the memory that nobody may touch, so that a stack that is too deep ends in a fault
//! that says so, and not in other variables.

use cortex_m::peripheral::{MPU, SCB};

use crate::stack;

/// The MPU's region that is used, of the highest priority.
const REGION: u32 = 15;
/// `MPU_CTRL`: on, with the default map for all else, and off in the fault's own handler.
const ON: u32 = 1 | 1 << 2;
/// `MPU_RASR`: no access, no execution, on.
const NOBODY: u32 = 1 << 28 | (stack::GUARD.trailing_zeros() - 1) << 1 | 1;
/// `MMFSR` in `CFSR`: a data access, or one of the core's own to the stack; and whether the address is known.
const STACKED: u32 = 1 << 4;
const ACCESS: u32 = 1 << 1;

/// Sets it up.
#[expect(unsafe_code, reason = "registers of the core")]
pub fn set(mpu: &mut MPU) {
    let Ok(bottom) = u32::try_from(stack::guard()) else { return };
    // SAFETY: takes away access to memory that only a stack too deep would touch.
    unsafe {
        mpu.rnr.write(REGION);
        mpu.rbar.write(bottom);
        mpu.rasr.write(NOBODY);
        mpu.ctrl.write(ON);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Whether the fault that is being handled is one of the guard.
#[must_use]
pub fn was_touched(scb: &SCB) -> bool {
    let status = scb.cfsr.read();
    let address = usize::try_from(scb.mmfar.read()).unwrap_or(0);
    let bottom = stack::guard();
    status & STACKED != 0 || status & ACCESS != 0 && (bottom..bottom + stack::GUARD).contains(&address)
}
