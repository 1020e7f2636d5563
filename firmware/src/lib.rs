//! What the programs of this package share.
#![no_std]

pub mod picture;
#[cfg(target_os = "none")]
pub mod rig;
