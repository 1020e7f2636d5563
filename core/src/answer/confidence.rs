//! Confidence: what an answer is worth, by classes.
//!
//! 0 is unknown; what is less than [`MEASURED`] is a guess, less than [`FRINGE`] doubtful, less than [`SURE`] sure but for
//! where its surface ends.

/// From this confidence on an answer is measured; less is a guess: hidden in the right view, or nothing to see.
pub const MEASURED: u8 = 16;

/// From this confidence on an answer is sure but for where its surface ends: it lies beside a contour, where hardly
/// anything else is to be seen, or at the border of a surface before a farther one.
pub const FRINGE: u8 = 56;

/// From this confidence on an answer is sure. Only sure ones make an obstacle.
pub const SURE: u8 = 64;
