//! What the program was built for. `build.rs` writes it from environment variables, so that one
//! program fits one rig.

use haarline::wiring::{First, Kind, Skew};
use haarline::{Config, Wiring};

use crate::hm01b0::{FRAME_LENGTH, WINDOW};

include!(concat!(env!("OUT_DIR"), "/settings.rs"));

/// The search.
pub const CONFIG: Config = Config { width: WIDTH, min_disparity: MIN_DISPARITY, num_disparities: NUM_DISPARITIES };
/// The multiplexer takes a pixel of each sensor in turn.
pub const WIRING: Wiring = Wiring { kind: Kind::PixelInterleaved, first: FIRST, skew: Skew::None };
/// The sensors' pixel clock, Hz: an eighth of their master clock.
const PIXEL_CLOCK: u32 = 1_000_000;
/// Clocks of a line with its blanking, such that a frame takes nearly all of its time: rows then come as
/// evenly as can be, 750 us apart at 5 frames a second.
pub const LINE_LENGTH: u32 = PIXEL_CLOCK / (FRAME_RATE * (FRAME_LENGTH as u32 + 6));

const _: () = assert!(LINE_LENGTH >= 376, "HAARLINE_FRAME_RATE: a line takes 376 clocks at least, so at most 9");
const _: () = assert!(WIDTH <= WINDOW[0] && WIDTH.is_multiple_of(2), "HAARLINE_SIZE: at most 324 px wide, and even");
const _: () = assert!(HEIGHT <= WINDOW[1] as u32, "HAARLINE_SIZE: at most 244 rows");
