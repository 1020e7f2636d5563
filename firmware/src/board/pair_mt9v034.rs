//! Two MT9V034 with seven data lines each on the port's fourteen, one master clock and one trigger: the reference rig.

use super::this::clock;
use crate::app::settings::{FRAME_RATE, HEIGHT, WIDTH};
use crate::rig::PLAN;
use crate::sensor::mt9v034::{
    Exposure, LEAST_BLANKING, LEAST_LINE, MOST, MOST_BLANKING, Mt9v034, SPARE_LINES, SYSCLK, Setup,
};

/// The sensors.
pub type Model = Mt9v034;
/// The master clock, Hz.
pub const MASTER_HZ: u32 = clock::SENSORS_HZ;
/// Pixels and lines of a frame on the port: those of the picture.
pub const WINDOW: [u16; 2] = [WIDTH, PLAN.height];
/// Bytes that the port takes with a pixel clock.
pub const CLOCK_BYTES: usize = 2;
/// A pulse on their pins starts a frame of both.
pub const IS_TRIGGERED: bool = true;

/// The integration that is left room for, lines: what is fixed, or a quarter of the picture.
const INTEGRATION: u32 = match PLAN.exposure_lines {
    Some(lines) => lines as u32,
    None => HEIGHT / 4,
};
/// Lines of a frame: integration, what the data sheet keeps for itself, picture.
const LINES_A_FRAME: u32 = INTEGRATION + SPARE_LINES as u32 + HEIGHT;
/// The longest line, clocks.
const LONGEST_LINE: u32 = 2 * WIDTH as u32 + MOST_BLANKING as u32;
/// Clocks of a line with its blanking: as slow as the frame rate and the sensor allow, so that rows come evenly.
pub const LINE_LENGTH: u32 = line_length(MASTER_HZ);
/// From one line to the next, us.
pub const LINE_US: u32 = line_us(MASTER_HZ);

const fn line_length(master_hz: u32) -> u32 {
    let fits = master_hz / (FRAME_RATE * LINES_A_FRAME);
    if fits < LONGEST_LINE { fits } else { LONGEST_LINE }
}

/// From one line to the next where that is the sensors' clock, us.
pub const fn line_us(master_hz: u32) -> u32 {
    line_length(master_hz) * 1000 / (master_hz / 1000)
}
/// From the end of the standby to the trigger, us. The data sheet asks for 10 clocks (appendix A), less than one; the rest is
/// for the analog supplies, of which it tells nothing.
pub const WAKE_US: u32 = 100;
/// From the end of the standby to its beginning, us, where the integration is fixed and the frame leaves 1 ms or more.
/// Else there is none: a sensor that controls its exposure may need all of the time, and is asked for it by a bus that sleeps
/// in standby.
pub const AWAKE_US: Option<u32> = match PLAN.exposure_lines {
    None => None,
    Some(_) => {
        let awake = WAKE_US + LINES_A_FRAME * (LINE_US + 1);
        if awake + LEAST_STANDBY_US <= 1_000_000 / FRAME_RATE { Some(awake) } else { None }
    }
};
/// What a standby is worth, us.
const LEAST_STANDBY_US: u32 = 1000;
/// Longest integration that fits between the pictures, lines.
const MOST_LINES: u32 = MASTER_HZ / FRAME_RATE / LINE_LENGTH - HEIGHT - SPARE_LINES as u32;

/// How each sensor is set up, the first one's first.
pub const SETUPS: [Setup; 2] = {
    let exposures = match PLAN.exposure_lines {
        Some(lines) => [Exposure::Fixed(lines); 2],
        None => [Exposure::Own, Exposure::Copied],
    };
    let [first, second] = exposures;
    #[expect(clippy::cast_possible_truncation, reason = "at most 1663, and what is left of 33,000")]
    let (line_length, most_lines) = (LINE_LENGTH as u16, MOST_LINES as u16);
    let size = [WIDTH, PLAN.height];
    [
        Setup { size, line_length, exposure: first, most_lines },
        Setup { size, line_length, exposure: second, most_lines },
    ]
};
/// Whether the second one's exposure is copied from the first.
pub const COPIES: bool = PLAN.exposure_lines.is_none();

const _: () = assert!(
    WIDTH <= MOST[0] && WIDTH.is_multiple_of(2) && PLAN.height <= MOST[1],
    "HAARLINE_RIG: with these sensors a view has 376x240 px at most, and an even width"
);
const _: () = assert!(SYSCLK[0] <= MASTER_HZ && MASTER_HZ <= SYSCLK[1], "the sensors' clock is 13 to 27 MHz");
const _: () = assert!(
    LINE_LENGTH >= LEAST_LINE as u32 && LINE_LENGTH >= 2 * WIDTH as u32 + LEAST_BLANKING as u32,
    "HAARLINE_RIG: integration (exposure_lines) and read-out do not fit a frame: lower frame_rate_hz or exposure_lines"
);
const _: () = match PLAN.exposure_lines {
    None => {}
    Some(lines) => assert!(
        lines >= 1 && lines as u32 <= MOST_LINES,
        "HAARLINE_RIG: exposure_lines is longer than what is left of a frame: lower it or frame_rate_hz"
    ),
};
