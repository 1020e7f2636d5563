//! The host side of Haarline: recorded frames through the same core as on the chip, then scores and
//! pictures.
//!
//! - [`input`]: images, recordings, dumps of a camera port, row packets, rig descriptions;
//!   [`synthetic`] renders a scene with known truth;
//! - [`stereo`]: the registry of the methods, a frame through one of them, its disparities, depth and obstacles;
//!   [`play`]: a recording through one;
//! - [`rig`]: a rig aligned from its own frames;
//! - [`output`]: files and pictures;
//! - [`score`]: scenes with truth, how right a map is, what the parts of a method bring; frames made worse on purpose;
//!   [`study`]: the paper's experiments;
//! - [`twin`]: the firmware application in QEMU; [`silicon`]: the methods on a bare board;
//! - [`command`]: the commands of the `haarline` tool.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "floating point meets pixels at every step here, and nothing of it runs on the chip"
)]

pub mod command;
pub mod input;
pub mod output;
pub mod play;
pub mod power;
pub mod rig;
pub mod score;
pub mod silicon;
pub mod stereo;
pub mod study;
pub mod synthetic;
pub mod twin;

pub use input::frame::{Frame, StereoPair};
pub use stereo::disparity_map::DisparityMap;
pub use stereo::geometry::Geometry;
pub use stereo::method::MethodKind;
