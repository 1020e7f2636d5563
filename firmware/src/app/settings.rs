//! What the program was built for: the rig of `HAARLINE_RIG`, and two variables of the build.

use haarline::{Config, Wiring};

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
