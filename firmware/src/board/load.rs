//! Whether a clock is fast enough for the rig, by counted instructions: what a board's clock is chosen by.

use super::pair;
use super::this::RAW_ROWS;
use crate::app::settings::{FRAME_RATE, HEIGHT, METHOD, Method, WIDTH};
use crate::rig::{INSTRUCTIONS_FULL, INSTRUCTIONS_LITE};

/// Instructions of a pixel: of the method and its packets, as the twin counts them on noisy frames, and of the program around, as
/// measured on the emulated chip.
pub const INSTRUCTIONS: u32 = 30
    + match METHOD {
        Method::Full => INSTRUCTIONS_FULL,
        Method::Lite => INSTRUCTIONS_LITE,
    };
#[expect(clippy::cast_possible_truncation, reason = "a few")]
const ROWS: u32 = RAW_ROWS as u32;

/// Whether a core of `mhz` that takes so many cycles for a pixel works on rows as fast as they come from sensors with a clock of
/// `sensors_hz`, but for what the ring holds, and on a frame within nine tenths of its time.
#[must_use]
pub const fn keeps_up(cycles: u32, mhz: u32, sensors_hz: u32) -> bool {
    // Times of a row, 1/16 us.
    let (work, line) = (16 * WIDTH as u32 * cycles / mhz, 16 * pair::line_us(sensors_hz));
    let waiting = if work <= line { 0 } else { HEIGHT * (work - line) / work };
    waiting + 4 <= ROWS && HEIGHT * (work / 16) < 900_000 / FRAME_RATE
}
