//! Obstacles: the nearest thing in each direction that stands in the way.
//!
//! Works on disparity rows as they come out of a method, and keeps nothing but one row of blocks. Of each
//! 4x4 block one pixel is looked at. It counts if it is certain enough and lies within a band of heights
//! over the ground, so that the ground itself does not count; and it is believed if blocks that adjoin it
//! agree, so that single wrong ones are not. Where nothing is believed the answer is unknown; so it is where something
//! nearer may stand: where many doubtful blocks adjoin and agree on it ([`Settings::doubtful_blocks`]), where it may hide in a
//! gap, or where what is told may be its outline. That a sector is free is told only if it is asked for, and only of one that is
//! measured nearly all over ([`Obstacles::free`]).
//!
//! ```
//! use haarline::obstacle::{Mounting, Obstacles, Sectors, Settings};
//! use haarline::{Disparity, DisparityRow, Rig, blocks_for};
//! let sectors = Sectors { // three of 20 degrees
//!     count: 3,
//!     left_q16: [-37837, -11556, 11556], // tangents of -30, -10 and 10 degrees
//!     right_q16: 37837,
//!     secant_q14: [17436, 16384, 17436],
//! };
//! let level = Mounting { height_mm: 300, sin_pitch_q14: 0, cos_pitch_q14: 1 << 14, lowest_mm: 50, highest_mm: 600 };
//! let rig = Rig::new(200 << 8, 60_000).unwrap(); // 200 px, 60 mm
//! let mut obstacles = Obstacles::<3, { blocks_for(320) }>::new([320, 240], rig, level, sectors, Settings::DEFAULT)?;
//! for y in 0..240 {
//!     obstacles.push(&DisparityRow { y, disparity: &[Disparity::from_px(8); 320], confidence: &[255; 320] });
//! }
//! // A wall at 1.5 m, at the sides a little more.
//! assert!(obstacles.nearest_mm().eq([Some(1596), Some(1500), Some(1596)]));
//! # Ok::<(), haarline::obstacle::ObstacleError>(())
//! ```

mod block;
mod error;
mod finder;
mod free;
mod lane;
mod mounting;
mod sectors;
mod settings;
mod weighing;

pub use error::ObstacleError;
pub use finder::Obstacles;
pub use mounting::Mounting;
pub use sectors::{MAX_SECTORS, Sectors};
pub use settings::Settings;

#[cfg(test)]
mod tests;
