//! From reset to the first task: what comes between, comes to an end.

use core::sync::atomic::{AtomicBool, AtomicU16, Ordering};

use embassy_stm32::{Peripherals, pac};
use static_cell::ConstStaticCell;

use super::clock::{self, Source};
use super::guard;
use crate::board::cycles::CycleClock;

static CLOCK: ConstStaticCell<CycleClock> = ConstStaticCell::new(CycleClock::new());
/// What was found: for whoever tells of it later.
static REVISION: AtomicU16 = AtomicU16::new(0);
static HAS_CRYSTAL: AtomicBool = AtomicBool::new(false);

/// The chip as it was started.
pub struct Started {
    /// What is behind its pins.
    pub peripherals: Peripherals,
    /// The core.
    pub core: cortex_m::Peripherals,
    /// Counts cycles.
    pub clock: &'static CycleClock,
}

/// Starts clocks, cycle counter, instruction cache and the guard of the stack, and says of what is not as it should be. May be
/// called once.
///
/// The data cache stays off: the pipeline lives in DTCM, which has none, and DMA's memory must not be cached.
#[must_use]
pub fn start() -> Started {
    let revision = Revision::read();
    let source = clock::find_source();
    REVISION.store(revision.0, Ordering::Relaxed);
    HAS_CRYSTAL.store(source == Source::Crystal, Ordering::Relaxed);
    let peripherals = embassy_stm32::init(clock::config(source, revision));
    // While a debugger halts the core the watchdog waits, too.
    pac::DBGMCU.apb4fzr1().modify(|w| w.set_iwdg1(true));
    let Some(mut core) = cortex_m::Peripherals::take() else { defmt::panic!("the core's peripherals are gone") };
    core.SCB.enable_icache();
    guard::set(&mut core.MPU);
    let clock = CLOCK.take();
    clock.start(&mut core.DCB, &mut core.DWT);
    if source == Source::Internal {
        defmt::error!(
            "the crystal does not start: running by the chip's own oscillator, frames and baud rates are off by up to 1 percent"
        );
    }
    if !revision.is_fast() {
        defmt::warn!(
            "chip of revision {=u16:#06x}: {=u32} MHz at most",
            revision.0,
            clock::core_hz(revision) / 1_000_000
        );
    }
    Started { peripherals, core, clock }
}

/// The revision of the silicon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Revision(pub u16);

impl Revision {
    /// That of this chip (`DBGMCU_IDCODE`).
    #[must_use]
    pub fn read() -> Self {
        Self(pac::DBGMCU.idc().read().rev_id())
    }

    /// Whether it may run at 480 MHz: X and V may, Z and Y may not (RM0433, `REV_ID`).
    #[must_use]
    pub const fn is_fast(self) -> bool {
        self.0 >= 0x2000
    }

    /// Its letter.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self.0 {
            0x1001 => "Z",
            0x1003 => "Y",
            0x2001 => "X",
            0x2003 => "V",
            _ => "unknown",
        }
    }
}

/// The revision of the chip as it was started.
#[must_use]
pub fn revision() -> Revision {
    Revision(REVISION.load(Ordering::Relaxed))
}

/// Where the clocks come from.
#[must_use]
pub fn source() -> Source {
    if HAS_CRYSTAL.load(Ordering::Relaxed) { Source::Crystal } else { Source::Internal }
}

/// The same in words.
///
/// # Errors
/// What is wrong with it.
pub fn told_source() -> Result<&'static str, &'static str> {
    match source() {
        Source::Crystal => Ok(" from the crystal's input, 8 MHz"),
        Source::Internal => Err(
            ", but no 8 MHz at the crystal's input: the debugger's part was cut off, or its solder bridges are open",
        ),
    }
}
