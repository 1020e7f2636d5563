//! Reference stereo methods to compare with. They run on the host and on the chip.
#![no_std]

pub mod ncc;
pub mod sgm;
pub mod ssd;
pub mod stereo_bm;
mod word;

pub use ncc::Ncc;
pub use sgm::Sgm;
pub use ssd::Ssd;
pub use stereo_bm::{BlockSettings, StereoBm};
