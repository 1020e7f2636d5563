//! Reference stereo methods to compare with. They run on the host and on the chip.
#![no_std]

pub mod stereo_bm;

pub use stereo_bm::{BlockSettings, StereoBm};
