//! From reset to the first task.

use core::sync::atomic::{AtomicU16, Ordering};

use embassy_stm32::pac::pwr::vals::Regsel;
use embassy_stm32::{Peripherals, pac};
use static_cell::ConstStaticCell;

use super::{clock, guard};
use crate::board::cycles::CycleClock;

static CLOCK: ConstStaticCell<CycleClock> = ConstStaticCell::new(CycleClock::new());
/// What was found: for whoever tells of it later.
static REVISION: AtomicU16 = AtomicU16::new(0);
/// Looks until a step-down converter counts as one that is not there, each some 10 cycles of 4 MHz: 10 ms or more.
const LOOKS: u32 = 10_000;

/// The chip as it was started.
pub struct Started {
    /// What is behind its pins.
    pub peripherals: Peripherals,
    /// The core.
    pub core: cortex_m::Peripherals,
    /// Counts cycles.
    pub clock: &'static CycleClock,
}

/// Starts clocks, the step-down converter, cycle counter, instruction cache and the limit of the stack, and says of what is not as
/// it should be. May be called once.
#[must_use]
pub fn start() -> Started {
    let revision = Revision::read();
    REVISION.store(revision.0, Ordering::Relaxed);
    let peripherals = embassy_stm32::init(clock::config());
    let is_stepped_down = step_down();
    // While a debugger halts the core the watchdog waits, too.
    pac::DBGMCU.apb1lfzr().modify(|w| w.set_dbg_iwdg_stop(true));
    let Some(mut core) = cortex_m::Peripherals::take() else { defmt::panic!("the core's peripherals are gone") };
    pac::ICACHE.cr().modify(|w| w.set_en(true));
    guard::set(&mut core.SCB);
    let clock = CLOCK.take();
    clock.start(&mut core.DCB, &mut core.DWT);
    if !is_stepped_down {
        defmt::warn!(
            "the chip's step-down converter does not start: it runs by the linear regulator, and takes more power"
        );
    }
    Started { peripherals, core, clock }
}

/// Has the core fed by the step-down converter; whether it is.
fn step_down() -> bool {
    pac::PWR.cr3().modify(|w| w.set_regsel(Regsel::SMPS));
    (0..LOOKS).any(|_| pac::PWR.svmsr().read().regs() == Regsel::SMPS)
}

/// The revision of the silicon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Revision(pub u16);

impl Revision {
    /// That of this chip (`DBGMCU_IDCODE`).
    #[must_use]
    pub fn read() -> Self {
        Self(pac::DBGMCU.idcode().read().rev_id())
    }

    /// Its letter.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self.0 {
            0x2001 => "X",
            0x3001 => "W",
            _ => "unknown",
        }
    }
}

/// The revision of the chip as it was started.
#[must_use]
pub fn revision() -> Revision {
    Revision(REVISION.load(Ordering::Relaxed))
}

/// Where the clocks come from, in words.
///
/// # Errors
/// Never: it is the chip itself.
pub fn told_source() -> Result<&'static str, &'static str> {
    Ok(" from its own oscillator, within 1 percent")
}
