//! The clocks: 480 MHz from the crystal, the buses at 240 and 120 MHz; 400 MHz on silicon that may not run faster, and the
//! chip's own oscillator where no crystal starts.

use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllDiv, PllMul, PllPreDiv, PllSource, Sysclk, VoltageScale,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, pac};

use super::start::Revision;

/// The core, Hz.
pub const CORE: u32 = 480_000_000;
/// It, on silicon that may not run faster.
const SLOW_CORE: u32 = 400_000_000;
/// What the Nucleo's debugger gives, Hz.
pub const HSE: u32 = 8_000_000;
/// The other output of the core's PLL, Hz: the MT9V034's clock, near its lower limit, for slow lines. On slower silicon it is
/// 13.11 MHz.
pub const PLL1_Q: u32 = 2 * CORE / 73;
/// Looks at the crystal until it counts as one that does not start, each some 20 cycles of 64 MHz: 100 ms or more.
const LOOKS: u32 = 400_000;

/// Where the clocks come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The crystal, here the debugger's clock.
    Crystal,
    /// The chip's own oscillator.
    Internal,
}

/// Tries the crystal. The HAL would wait for it for ever.
#[must_use]
pub fn find_source() -> Source {
    // In this order: the bypass can be written only while it is off.
    pac::RCC.cr().modify(|w| w.set_hsebyp(true));
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    let mut looks = 0;
    while looks < LOOKS && !pac::RCC.cr().read().hserdy() {
        looks += 1;
    }
    if pac::RCC.cr().read().hserdy() {
        return Source::Crystal;
    }
    pac::RCC.cr().modify(|w| w.set_hseon(false));
    Source::Internal
}

/// The core's clock on that silicon, Hz.
#[must_use]
pub const fn core_hz(revision: Revision) -> u32 {
    if revision.is_fast() { CORE } else { SLOW_CORE }
}

/// The set-up of the HAL.
#[must_use]
pub fn config(source: Source, revision: Revision) -> Config {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    // 8 MHz either way.
    let (input, prediv) = match source {
        Source::Crystal => (PllSource::HSE, PllPreDiv::DIV1),
        Source::Internal => (PllSource::HSI, PllPreDiv::DIV8),
    };
    if source == Source::Crystal {
        rcc.hse = Some(Hse { freq: Hertz(HSE), mode: HseMode::Bypass });
    }
    let (mul, divq, scale) = if revision.is_fast() {
        (PllMul::MUL120, PllDiv::DIV73, VoltageScale::Scale0)
    } else {
        (PllMul::MUL100, PllDiv::DIV61, VoltageScale::Scale1)
    };
    rcc.pll1 =
        Some(Pll { source: input, prediv, mul, fracn: None, divp: Some(PllDiv::DIV2), divq: Some(divq), divr: None });
    rcc.sys = Sysclk::PLL1_P;
    rcc.d1c_pre = AHBPrescaler::DIV1;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    rcc.voltage_scale = scale;
    config
}
