//! Stereo depth on a microcontroller: camera lines in, disparity rows out.
#![no_std]

pub mod config;
pub mod contour;
pub mod count;
pub mod disparity;
pub mod error;
pub mod extremum;
pub mod fill;
pub mod full;
pub mod haar;
pub mod lite;
pub mod parts;
pub mod pipeline;
pub mod rig;
pub mod scanline;
pub mod stereo;

mod block;
mod boundary;
mod confidence;
mod consistency;
mod cost;
mod exposure;
mod label;
mod matcher;
mod noise;
mod path;
mod ring;
mod search;
mod seed;
mod texture;
mod view;

pub use config::Config;
pub use disparity::{Disparity, DisparityRow};
pub use error::{ConfigError, RowError};
pub use fill::fill_holes;
pub use full::Full;
pub use lite::Lite;
pub use parts::Parts;
pub use pipeline::blocks_for;
pub use rig::{Depth, Rig};
pub use scanline::ScanlinePair;
pub use stereo::StereoMethod;
