//! Two HM01B0 on the port's eight lines, with four data lines each or behind a multiplexer: the experimental low-power rig.
//!
//! Both are on one bus: what is written both take, so they start together and stay in phase as far as they are alike.

use embassy_stm32::rcc::{Mco1Source, McoPrescaler};
use haarline::wiring::Kind;

use super::clock::HSE;
use crate::app::settings::{FRAME_RATE, HEIGHT, WIDTH, WIRING};
use crate::rig::PLAN;
pub use crate::sensor::hm01b0::WINDOW;
use crate::sensor::hm01b0::{Clock, Exposure, FRAME_LENGTH, Hm01b0, Lines, Setup};

/// The sensors.
pub type Model = Hm01b0;
/// The master clock: the crystal, or a part of the chip's own oscillator.
pub const MASTER_CLOCK: [(Mco1Source, McoPrescaler); 2] =
    [(Mco1Source::HSE, McoPrescaler::DIV1), (Mco1Source::HSI, McoPrescaler::DIV8)];
/// It, Hz.
pub const MASTER_HZ: u32 = HSE;
/// Bytes that the port takes with a pixel clock.
pub const CLOCK_BYTES: usize = 1;
/// They show frame after frame.
pub const IS_TRIGGERED: bool = false;
/// No trigger, no standby.
pub const WAKE_US: u32 = 0;
/// The same.
pub const AWAKE_US: Option<u32> = None;

/// Data lines of each sensor.
const LINES: Lines = match WIRING.kind {
    Kind::Nibbles => Lines::Four,
    _ => Lines::Eight,
};
/// Lines of a frame.
const LINES_A_FRAME: u32 = FRAME_LENGTH as u32;
/// Least clocks of a line (datasheet, `LINE_LENGTH_PCK`).
const LEAST_LINE_LENGTH: u32 = 376;
/// The slowest pixel clock that the frame rate allows: rows then come as evenly as can be.
const CLOCK: Clock = {
    let most = HSE / (FRAME_RATE * LINES_A_FRAME * LEAST_LINE_LENGTH);
    match most {
        8.. => Clock::Eighth,
        4.. => Clock::Quarter,
        2.. => Clock::Half,
        _ => Clock::Whole,
    }
};
/// Clocks of a line with its blanking, such that frames come at the rig's rate.
pub const LINE_LENGTH: u32 = HSE / CLOCK.divisor() / (FRAME_RATE * LINES_A_FRAME);
/// From one line to the next, us.
pub const LINE_US: u32 = 1_000_000 / (FRAME_RATE * LINES_A_FRAME);

/// The same: their clock is not the core's.
pub const fn line_us(_: u32) -> u32 {
    LINE_US
}

/// How they are set up, both at once.
pub const SETUPS: [Setup; 1] = {
    let exposure = match PLAN.exposure_lines {
        Some(lines) => Exposure::Fixed(lines),
        None => Exposure::Own,
    };
    #[expect(clippy::cast_possible_truncation, reason = "checked below")]
    let line_length = LINE_LENGTH as u16;
    [Setup { lines: LINES, clock: CLOCK, line_length, exposure }]
};
/// Nobody can tell the two apart on one bus.
pub const COPIES: bool = false;

const _: () = assert!(
    matches!(WIRING.kind, Kind::PixelInterleaved | Kind::Nibbles),
    "HAARLINE_RIG: on this board wiring is \"pairs14\" (two MT9V034), or \"nibble\" or \"pixel\" (two HM01B0)"
);
const _: () = assert!(LINE_LENGTH >= LEAST_LINE_LENGTH, "HAARLINE_RIG: frame_rate_hz may be 81 at most");
const _: () = assert!(
    !(matches!(LINES, Lines::Four) && matches!(CLOCK, Clock::Whole)),
    "HAARLINE_RIG: with wiring = \"nibble\" a pixel takes two clocks, so frame_rate_hz may be 40 at most"
);
const _: () = assert!(LINE_LENGTH <= u16::MAX as u32, "HAARLINE_RIG: frame_rate_hz is too low");
const _: () = assert!(
    WIDTH <= WINDOW[0] - 4 && WIDTH.is_multiple_of(2),
    "HAARLINE_RIG: the sensors' pictures have a width of 320 px at most, and an even one"
);
const _: () =
    assert!(HEIGHT <= WINDOW[1] as u32, "HAARLINE_RIG: the sensors' pictures have a height of 244 px at most");
const _: () = match PLAN.exposure_lines {
    None => {}
    Some(lines) => assert!(
        2 <= lines && lines <= FRAME_LENGTH - 2,
        "HAARLINE_RIG: exposure_lines must be 2 to 258 with these sensors, or 0 for their own control"
    ),
};
