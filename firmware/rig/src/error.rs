//! Why a description is refused.

use std::fmt;

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
