//! Alignment of a rig from ordinary frames: how far its right camera looks past its left one.
//!
//! Without target and calibration: rows stream in, several passes over the same frame or over consecutive ones,
//! and an [`Estimate`] of row offset, roll and vertical scale comes out, with what it is worth.
//!
//! - `gradient`: both gradients of a smoothed row, which gain and offset of a camera hardly change;
//! - `blocks`: for every block of 8 x 8 px and every row offset the least difference over the disparities;
//! - `cells`: those of the first pass, by place; their minimum over row offset and roll is looked for by the
//!   paper's two-dimensional extremum search (section 5);
//! - `line`: those of later passes, each about what the pass before found: a plane through the blocks' offsets;
//! - `order`: whether the views are swapped;
//! - `places`: the offsets by part of the view;
//! - `agreement`: whether blocks and frames say the same;
//! - `aligner`: the passes.

mod agreement;
mod aligner;
mod blocks;
mod cells;
mod estimate;
mod gradient;
mod line;
mod order;
mod places;

pub use aligner::{Aligner, Settings};
pub use estimate::{Estimate, Order, Verdict};
