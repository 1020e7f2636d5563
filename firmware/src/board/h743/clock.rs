//! The clocks: the core by one of three operating points, from the crystal, or the chip's own oscillator where no crystal
//! starts; the buses at a half and a quarter of it.

use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllDiv, PllMul, PllPreDiv, PllSource, Sysclk, VoltageScale,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, pac};

use super::start::Revision;
use crate::app::settings::{METHOD, Method};
use crate::board::load::{INSTRUCTIONS, keeps_up};

/// A clock, and the core's voltage that it asks for (RM0433, section 6.6.2).
#[derive(Clone, Copy)]
pub struct OperatingPoint {
    /// The core, MHz.
    mhz: u32,
    /// What the core's PLL makes of 8 MHz is twice that.
    mul: PllMul,
    /// Of that the sensors' clock, and the divisor as a number.
    divq: (PllDiv, u32),
    scale: VoltageScale,
}

/// All of them, the fastest first. The first is for silicon of revisions X and V only. The sensors' clock is 13.15, 13.11 and
/// 13.33 MHz: near the MT9V034's lower limit, for slow lines.
const POINTS: [OperatingPoint; 3] = [
    OperatingPoint { mhz: 480, mul: PllMul::MUL120, divq: (PllDiv::DIV73, 73), scale: VoltageScale::Scale0 },
    OperatingPoint { mhz: 400, mul: PllMul::MUL100, divq: (PllDiv::DIV61, 61), scale: VoltageScale::Scale1 },
    OperatingPoint { mhz: 200, mul: PllMul::MUL50, divq: (PllDiv::DIV30, 30), scale: VoltageScale::Scale3 },
];
/// The one that the program is built for: `HAARLINE_CLOCK_MHZ` while it is built, or the slowest by which the method keeps up
/// with the rig.
const POINT: OperatingPoint = POINTS[match option_env!("HAARLINE_CLOCK_MHZ") {
    None => slowest(),
    Some(text) => match text.as_bytes() {
        b"480" => 0,
        b"400" => 1,
        b"200" => 2,
        _ => panic!("HAARLINE_CLOCK_MHZ: must be 480, 400 or 200"),
    },
}];

/// Cycles that a pixel takes with everything, packets and interrupts too, where an instruction takes one: of `full` measured
/// on the emulated chip (150 with `--profile firmware`, 10 % more without), of `lite` less what it saves in the twin.
pub const CYCLES: u32 = match METHOD {
    Method::Full => 165,
    Method::Lite => 150,
};
/// The core, Hz.
pub const CORE: u32 = POINT.mhz * 1_000_000;
/// What the Nucleo's debugger gives, Hz.
pub const HSE: u32 = 8_000_000;
/// The MT9V034's clock, Hz, the other output of the core's PLL. On slower silicon it may be 13.11 MHz.
pub const SENSORS_HZ: u32 = POINT.pll1_q();
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

impl OperatingPoint {
    const fn pll1_q(self) -> u32 {
        2 * self.mhz * 1_000_000 / self.divq.1
    }
}

/// The number of the slowest point that keeps up where an instruction takes a cycle; the fastest if none does.
const fn slowest() -> usize {
    let mut nth = POINTS.len() - 1;
    while nth > 0 && !keeps_up(INSTRUCTIONS, POINTS[nth].mhz, POINTS[nth].pll1_q()) {
        nth -= 1;
    }
    nth
}

/// The operating point on that silicon.
const fn point(revision: Revision) -> OperatingPoint {
    if POINT.mhz > POINTS[1].mhz && !revision.is_fast() { POINTS[1] } else { POINT }
}

/// The core's clock on that silicon, Hz.
#[must_use]
pub const fn core_hz(revision: Revision) -> u32 {
    point(revision).mhz * 1_000_000
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
    let OperatingPoint { mul, divq: (divq, _), scale, .. } = point(revision);
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
    // A debugger's clocks in sleep would be measured with it.
    config.enable_debug_during_sleep = !cfg!(feature = "measure");
    config
}
