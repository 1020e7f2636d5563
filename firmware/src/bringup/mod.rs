//! What the program `bringup` concludes from what it measures: a verdict on each step, with the likely cause.

pub mod lines;
pub mod signals;
