//! What the program was built for: the rig of `HAARLINE_RIG`, and what this board makes of it.

use haarline::wiring::Kind;
use haarline::{Config, Wiring};

use super::clock::HSE;
use crate::hm01b0::{Clock, FRAME_LENGTH, Lines, WINDOW};
use crate::rig::PLAN;

/// A stereo method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The most accurate.
    Full,
    /// The cheapest.
    Lite,
}

/// The method: `HAARLINE_METHOD` while it is built.
pub const METHOD: Method = match option_env!("HAARLINE_METHOD") {
    None => Method::Full,
    Some(name) => match name.as_bytes() {
        b"full" => Method::Full,
        b"lite" => Method::Lite,
        _ => panic!("HAARLINE_METHOD: must be full or lite"),
    },
};
/// The vehicle that MAVLink messages are of, 1 to 255: `HAARLINE_MAVLINK_SYSTEM` while it is built.
pub const MAVLINK_SYSTEM: u8 = match option_env!("HAARLINE_MAVLINK_SYSTEM") {
    None => 1,
    Some(text) => match u8::from_str_radix(text, 10) {
        Ok(system) if system > 0 => system,
        _ => panic!("HAARLINE_MAVLINK_SYSTEM: must be 1 to 255"),
    },
};
/// The search.
pub const CONFIG: Config = PLAN.config;
/// Columns of a view.
pub const WIDTH: u16 = CONFIG.width;
/// Rows of a view.
pub const HEIGHT: u32 = PLAN.height as u32;
/// Frames a second.
pub const FRAME_RATE: u32 = PLAN.frame_rate_hz as u32;
/// How the sensors share the port.
pub const WIRING: Wiring = PLAN.wiring;
/// Data lines of each sensor.
pub const LINES: Lines = match WIRING.kind {
    Kind::Nibbles => Lines::Four,
    _ => Lines::Eight,
};
/// Lines of a frame and of the pause after it: a trigger that comes within the frame would be lost.
const LINES_A_FRAME: u32 = FRAME_LENGTH as u32 + 6;
/// Least clocks of a line (datasheet, `LINE_LENGTH_PCK`).
const LEAST_LINE_LENGTH: u32 = 376;

/// The slowest pixel clock that the frame rate allows: rows then come as evenly as can be.
pub const CLOCK: Clock = {
    let most = HSE / (FRAME_RATE * LINES_A_FRAME * LEAST_LINE_LENGTH);
    match most {
        8.. => Clock::Eighth,
        4.. => Clock::Quarter,
        2.. => Clock::Half,
        _ => Clock::Whole,
    }
};
/// Clocks of a line with its blanking, such that a frame takes nearly all of its time.
pub const LINE_LENGTH: u32 = HSE / CLOCK.divisor() / (FRAME_RATE * LINES_A_FRAME);
/// From one line to the next, us.
pub const LINE_US: u32 = 1_000_000 / (FRAME_RATE * LINES_A_FRAME);

const _: () = assert!(
    matches!(WIRING.kind, Kind::PixelInterleaved | Kind::Nibbles),
    "HAARLINE_RIG: on this board wiring is \"pixel\" or \"nibble\""
);
const _: () = assert!(LINE_LENGTH >= LEAST_LINE_LENGTH, "HAARLINE_RIG: frame_rate_hz may be 79 at most");
const _: () = assert!(
    !(matches!(LINES, Lines::Four) && matches!(CLOCK, Clock::Whole)),
    "HAARLINE_RIG: with wiring = \"nibble\" a pixel takes two clocks, so frame_rate_hz may be 39 at most"
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
