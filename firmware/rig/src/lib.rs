//! Rig descriptions: what a user writes down of a pair of cameras in `rig.toml`, checked, and turned into
//! the integers that the core works with.
//!
//! The host reads descriptions while it runs, firmware when it is built ([`Description::to_rust`]); both
//! have the same numbers then, and no angle is computed on the chip.

mod derived;
mod description;
mod field;
mod rust;

use std::fmt;

pub use derived::Derived;
pub use description::Description;
pub use field::template;

/// Why a description is refused, and what would be right, in one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RigError(String);

impl fmt::Display for RigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for RigError {}

impl From<String> for RigError {
    fn from(words: String) -> Self {
        Self(words)
    }
}
