//! Rig descriptions: what a user writes down of a pair of cameras in `rig.toml`, checked, and turned into
//! the integers that the core works with.
//!
//! The host reads descriptions while it runs. Firmware has the figures of one as a constant
//! ([`Description::to_rust`]), and works the angles out at start-up as the host does, by the same few float
//! operations ([`Plan::setup`]): both have the same numbers then, to the last bit.
#![cfg_attr(not(feature = "description"), no_std)]

mod angle;
mod plan;

#[cfg(feature = "description")]
mod derived;
#[cfg(feature = "description")]
mod description;
#[cfg(feature = "description")]
mod error;
#[cfg(feature = "description")]
mod field;
#[cfg(feature = "description")]
mod lens;
#[cfg(feature = "description")]
mod rust;

pub use plan::Plan;

#[cfg(feature = "description")]
pub use {
    derived::Derived,
    description::Description,
    error::RigError,
    field::{template, with_fields},
    lens::{CameraModel, Lens},
};
