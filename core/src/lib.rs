//! Stereo depth on a microcontroller: camera lines in, disparity rows out.
//!
//! Without heap and floating point; memory grows with the width of the picture, not with its height.
//! [`Full`] is the most accurate method, [`Lite`] the cheapest; both are driven by [`StereoMethod`]. How to put them
//! behind another HAL, from raw camera bytes to obstacles, is in `examples/another_hal.rs`.
//!
//! ```
//! use haarline::{Config, Depth, Full, Rig, ScanlinePair, StereoMethod, blocks_for};
//! let mut stereo = Full::<{ blocks_for(320) }>::new(Config { num_disparities: 48, ..Config::for_width(320) })?;
//! let rig = Rig::new(200 << 8, 60_000).unwrap(); // 200 px focal length, 60 mm between the cameras
//! let mut nearest = None;
//! let mut look = |row: haarline::DisparityRow<'_>| {
//!     for &disparity in row.disparity {
//!         if let Depth::Millimetres(mm) = rig.depth(disparity) {
//!             nearest = Some(nearest.map_or(mm, |least: u32| least.min(mm)));
//!         }
//!     }
//! };
//! for _ in 0..240 {
//!     let (left, right) = ([90; 320], [90; 320]); // from the cameras
//!     stereo.push(ScanlinePair { left: &left, right: &right }, &mut look).unwrap();
//! }
//! stereo.finish(&mut look); // the last rows of the frame
//! assert_eq!(nearest, None); // a blank wall is unknown, not far away
//! # Ok::<(), haarline::ConfigError>(())
//! ```
#![no_std]

// A camera line passes `camera`, `front_end`, `matching`, `answer` and `output`, in this order; a `method` takes
// it from the front end to the answer.
mod answer;
pub mod tuning;
mod lanes;
mod camera;
mod front_end;
mod matching;
mod method;
mod output;

// What all of them know.
pub mod config;
pub mod count;
pub mod error;
pub mod setup;
pub mod stage;

// The folders are for those who read this; those who use it need not know them.
pub use answer::disparity;
pub use camera::{counters, framing, rectify, scanline, wiring};
pub use front_end::{contour, curvature, haar, reading, scales};
pub use matching::extremum;
pub use method::tile_pipeline;
pub use method::{contour_stereo, envelope, full, lite, parts, pipeline, stereo, wavelet_block};
#[cfg(feature = "packet")]
pub use output::packet;
pub use output::{fill, obstacle, rig};

pub use config::Config;
pub use contour_stereo::{ContourSettings, ContourStereo};
pub use counters::Counters;
pub use disparity::{Disparity, DisparityRow};
pub use envelope::{EnvelopeSettings, EnvelopeStereo};
pub use error::{ConfigError, RowError};
pub use fill::fill_holes;
pub use full::Full;
pub use lite::Lite;
pub use obstacle::Obstacles;
pub use parts::{Parts, Seeds};
pub use pipeline::blocks_for;
pub use reading::Reading;
pub use rectify::{Offset, Paired};
pub use rig::{Depth, Rig};
pub use scales::Scales;
pub use scanline::ScanlinePair;
pub use setup::Setup;
pub use stage::{Stage, StageClock, Untimed};
pub use stereo::StereoMethod;
pub use wavelet_block::WaveletBlock;
pub use wiring::Wiring;
