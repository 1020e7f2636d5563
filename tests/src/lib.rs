//! Reference stereo methods to compare with. They run on the host and on the chip.
#![no_std]

pub mod ncc;
pub mod sgm;
mod simd;
pub mod ssd;
pub mod stereo_bm;

pub use ncc::Ncc;
pub use sgm::Sgm;
pub use ssd::Ssd;
pub use stereo_bm::{BlockSettings, StereoBm};
