//! Stereo depth on a microcontroller: camera lines in, disparity rows out.
//!
//! Without heap and floating point; memory grows with the width of the picture, not with its height.
//!
//! # Start here
//!
//! 1. Choose a method: [`Full`] is the most accurate one, [`Lite`] the cheapest. [`Config`] tells both the width of a row and
//!    the disparities to search.
//! 2. Push rows: [`StereoMethod::push`] takes a [`ScanlinePair`] of rectified rows and hands out [`DisparityRow`]s a few rows
//!    later; [`StereoMethod::finish`] hands out the last ones of a frame.
//! 3. Use what comes out: a [`Rig`] turns a [`Disparity`] into a [`Depth`] in mm, [`Obstacles`] finds the nearest obstacle in
//!    each direction, [`fill_holes`] guesses what is unknown.
//!
//! Where the rows come from: [`Wiring`] takes a camera port's bytes apart, [`framing`] puts lines into frames, [`Paired`] takes
//! an offset of the cameras away. All of it behind another HAL, from raw bytes to obstacles: `examples/another_hal.rs`. What
//! the methods are made of, to study or to build another one: [`haar`], [`contour`], [`extremum`], [`tile_pipeline`].
//!
//! ```
//! use haarline::{Config, Depth, Full, Rig, ScanlinePair, StereoMethod, blocks_for};
//! let mut stereo = Full::<{ blocks_for(320) }>::new(Config { num_disparities: 48, ..Config::for_width(320) })?;
//! let rig = Rig::new(200 << 8, 60_000).unwrap(); // 200 px focal length, 60 mm between the cameras
//! let mut nearest = None;
//! let mut look = |row: haarline::DisparityRow<'_>| {
//!     for (&disparity, &confidence) in row.disparity.iter().zip(row.confidence) {
//!         // Less than 16 is a guess.
//!         if let (16.., Depth::Millimetres(mm)) = (confidence, rig.depth(disparity)) {
//!             nearest = Some(nearest.map_or(mm, |least: u32| least.min(mm)));
//!         }
//!     }
//! };
//! for y in 0..240u32 {
//!     // From the cameras; here a wall that the right one sees 8 px further left.
//!     let wall = |x: u32| (((x / 3).wrapping_mul(2_654_435_761) ^ (y / 3).wrapping_mul(40_503)) >> 16) as u8;
//!     let (mut left, mut right) = ([0; 320], [0; 320]);
//!     for ((x, left), right) in (0..).zip(&mut left).zip(&mut right) {
//!         (*left, *right) = (wall(x), wall(x + 8));
//!     }
//!     stereo.push(ScanlinePair { left: &left, right: &right }, &mut look).unwrap();
//! }
//! stereo.finish(&mut look); // the last rows of the frame
//! assert!(nearest.is_some_and(|mm| mm.abs_diff(1500) < 50)); // 200 px * 60 mm / 8 px
//! # Ok::<(), haarline::ConfigError>(())
//! ```
#![no_std]

// A camera line passes `camera`, `front_end`, `matching`, `answer` and `output`, in this order; a `method` takes
// it from the front end to the answer.
mod answer;
mod camera;
mod front_end;
mod lanes;
mod matching;
mod method;
mod output;
#[cfg(test)]
mod random;

// Before them, once for a rig.
pub mod align;

// What all of them know.
pub mod config;
pub mod count;
pub mod error;
pub mod setup;
pub mod stage;

// The folders are for those who read this; those who use it need not know them.
pub use answer::{confidence, disparity};
pub use camera::{counters, framing, rectify, scanline, wiring};
pub use front_end::{contour, curvature, haar, reading, scales};
pub use matching::extremum;
pub use method::capacity::blocks_for;
pub use method::tile_pipeline;
pub use method::{contour_stereo, envelope, full, lite, parts, stereo, wavelet_block};
#[cfg(feature = "packet")]
pub use output::packet;
pub use output::{correction, fill, frame_figures, obstacle, rig, row_watch};

pub use config::Config;
pub use contour_stereo::{ContourSettings, ContourStereo};
pub use correction::Correction;
pub use counters::Counters;
pub use disparity::{Disparity, DisparityRow};
pub use envelope::{EnvelopeSettings, EnvelopeStereo};
pub use error::{ConfigError, RowError};
pub use fill::fill_holes;
pub use full::Full;
pub use lite::Lite;
pub use obstacle::Obstacles;
pub use parts::{Parts, Seeds};
pub use reading::Reading;
pub use rectify::{LensTable, Offset, Paired, Ramp, Rectification, Rectified, RectifiedRow, Rectifier};
pub use rig::{Depth, Rig};
pub use scales::Scales;
pub use scanline::ScanlinePair;
pub use setup::Setup;
pub use stage::{Stage, StageClock, Untimed};
pub use stereo::StereoMethod;
pub use wavelet_block::WaveletBlock;
pub use wiring::Wiring;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
