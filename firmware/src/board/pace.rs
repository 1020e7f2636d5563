//! Whether the pipeline keeps up with the sensors of the rig that the program is built for.

use super::pair::LINE_US;
use super::this::RAW_ROWS;
use super::this::clock::{CORE, CYCLES};
use crate::app::settings::{FRAME_RATE, HEIGHT, WIDTH};

/// Time of a row, 1/16 us.
const ROW: u32 = 16 * WIDTH as u32 * CYCLES / (CORE / 1_000_000);
/// Rows that wait at the end of a frame.
const WAITING: u32 = if ROW <= 16 * LINE_US { 0 } else { HEIGHT * (ROW - 16 * LINE_US) / ROW };
/// Places of the ring that are not for waiting rows.
const SPARE: u32 = 4;

#[expect(clippy::cast_possible_truncation, reason = "a few")]
const _: () = assert!(
    WAITING + SPARE <= RAW_ROWS as u32,
    "HAARLINE_RIG: lines come faster than the method takes them, and more than the ring holds would wait: lower frame_rate_hz, or width and height (docs/board.md tells what fits)"
);
const _: () = assert!(
    HEIGHT * (ROW / 16) < 1_000_000 / FRAME_RATE,
    "HAARLINE_RIG: the method takes longer for a frame than frame_rate_hz allows: lower it, or width and height"
);
