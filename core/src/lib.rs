//! Stereo depth on a microcontroller: camera lines in, disparity rows out.
#![no_std]

pub mod config;
pub mod disparity;
pub mod error;
pub mod rig;
pub mod scanline;
pub mod stereo;

pub use config::Config;
pub use disparity::{Disparity, DisparityRow};
pub use error::{ConfigError, RowError};
pub use rig::{Depth, Rig};
pub use scanline::ScanlinePair;
pub use stereo::StereoMethod;
