//! The clocks: the core and its buses by one of three operating points, from the chip's own oscillator of 16 MHz, which is good
//! to 1 percent. No crystal is asked for.

use embassy_stm32::Config;
use embassy_stm32::rcc::{Pll, PllDiv, PllMul, PllPreDiv, PllSource, Sysclk, VoltageScale};

use super::start::Revision;
use crate::board::load::{INSTRUCTIONS, keeps_up};

/// A clock, and the core's voltage that it asks for (RM0456, section 10.5.4).
#[derive(Clone, Copy)]
pub struct OperatingPoint {
    /// The core, MHz.
    mhz: u32,
    /// What the PLL makes of 4 MHz, and by what that is divided for the core.
    mul: PllMul,
    divr: PllDiv,
    /// The core's clocks of one of the sensors: even, so that both halves of it are alike.
    sensors: u32,
    /// The row packets' port: a rate of which the clock gives an exact one.
    baud: u32,
    range: VoltageScale,
}

/// All of them, the fastest first. A slower one would be too slow for the camera interface, which takes a pixel clock of 0.4 of
/// the core's at most. The sensors' clock is 13.33 or 13.5 MHz: near the MT9V034's lower limit, for slow lines.
const POINTS: [OperatingPoint; 3] = [
    OperatingPoint {
        mhz: 160,
        mul: PllMul::MUL80,
        divr: PllDiv::DIV2,
        sensors: 12,
        baud: 8_000_000,
        range: VoltageScale::RANGE1,
    },
    OperatingPoint {
        mhz: 108,
        mul: PllMul::MUL54,
        divr: PllDiv::DIV2,
        sensors: 8,
        baud: 8_000_000,
        range: VoltageScale::RANGE2,
    },
    OperatingPoint {
        mhz: 54,
        mul: PllMul::MUL54,
        divr: PllDiv::DIV4,
        sensors: 4,
        baud: 4_000_000,
        range: VoltageScale::RANGE3,
    },
];
/// The one that the program is built for: `HAARLINE_CLOCK_MHZ` while it is built, or the slowest by which the method keeps up
/// with the rig.
const POINT: OperatingPoint = POINTS[match option_env!("HAARLINE_CLOCK_MHZ") {
    None => slowest(),
    Some(text) => match text.as_bytes() {
        b"160" => 0,
        b"108" => 1,
        b"54" => 2,
        _ => panic!("HAARLINE_CLOCK_MHZ: must be 160, 108 or 54"),
    },
}];

/// Cycles that a pixel takes with everything: 1.1 an instruction, by the model of `haarline power plan`. No board was measured.
pub const CYCLES: u32 = INSTRUCTIONS * 11 / 10;
/// The core, Hz.
pub const CORE: u32 = POINT.mhz * 1_000_000;
/// The sensors' clock, Hz.
pub const SENSORS_HZ: u32 = POINT.sensors_hz();
/// Baud rate of the row packets.
pub const ROWS_BAUD: u32 = POINT.baud;

impl OperatingPoint {
    const fn sensors_hz(self) -> u32 {
        self.mhz * 1_000_000 / self.sensors
    }
}

/// The number of the slowest point that keeps up; the fastest if none does.
const fn slowest() -> usize {
    let mut nth = POINTS.len() - 1;
    while nth > 0 && !keeps_up(CYCLES, POINTS[nth].mhz, POINTS[nth].sensors_hz()) {
        nth -= 1;
    }
    nth
}

/// The core's clock, Hz, on every silicon.
#[must_use]
pub const fn core_hz(_: Revision) -> u32 {
    CORE
}

/// The set-up of the HAL.
#[must_use]
pub fn config() -> Config {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    let OperatingPoint { mul, divr, range, .. } = POINT;
    rcc.hsi = true;
    (rcc.hsi48, rcc.msik) = (None, None);
    rcc.pll1 =
        Some(Pll { source: PllSource::HSI, prediv: PllPreDiv::DIV4, mul, divp: None, divq: None, divr: Some(divr) });
    rcc.sys = Sysclk::PLL1_R;
    rcc.voltage_range = range;
    // Nothing analog is in use, and its supply would be waited for.
    config.enable_independent_analog_supply = false;
    // A debugger's clocks would be measured with the chip.
    config.enable_debug_during_sleep = !cfg!(feature = "measure");
    config
}
