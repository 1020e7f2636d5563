//! What the program was built for. `build.rs` writes it from environment variables, so that one
//! program fits one rig.

use haarline::wiring::{First, Kind, Skew};
use haarline::{Config, Wiring};

use crate::hm01b0::WINDOW;

include!(concat!(env!("OUT_DIR"), "/settings.rs"));

/// The search.
pub const CONFIG: Config = Config { width: WIDTH, min_disparity: MIN_DISPARITY, num_disparities: NUM_DISPARITIES };
/// The multiplexer takes a pixel of each sensor in turn.
pub const WIRING: Wiring = Wiring { kind: Kind::PixelInterleaved, first: FIRST, skew: Skew::None };
/// Frames a second.
pub const FRAME_RATE: u32 = 30;
/// Length of a sensor's line, clocks of 4 MHz: 125 us, so that a frame takes most of its thirtieth second
/// and the row packets leave as evenly as can be.
pub const LINE_LENGTH: u16 = 500;

const _: () = assert!(WIDTH <= WINDOW[0] && WIDTH % 2 == 0, "HAARLINE_SIZE: at most 324 px wide, and even");
const _: () = assert!(HEIGHT <= WINDOW[1] as u32, "HAARLINE_SIZE: at most 244 rows");
