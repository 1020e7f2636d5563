//! A pair of frames through a method of the core, and what comes of it: disparities, depth, obstacles.

pub mod disparity_map;
pub mod frame_check;
pub mod geometry;
pub mod method;
pub mod obstacles;
pub mod pipeline;
pub mod smoothing;
