//! Stereo depth on a microcontroller: camera lines in, disparity rows out.
//!
//! Without heap and floating point; memory grows with the width of the picture, not with its height.
//! [`Full`] is the most accurate method, [`Lite`] the cheapest; both are driven by [`StereoMethod`].
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

pub mod config;
pub mod contour;
pub mod contour_stereo;
pub mod count;
pub mod counters;
pub mod curvature;
pub mod disparity;
pub mod envelope;
pub mod error;
pub mod extremum;
pub mod fill;
pub mod framing;
pub mod full;
pub mod haar;
pub mod lite;
pub mod obstacle;
#[cfg(feature = "packet")]
pub mod packet;
pub mod parts;
pub mod pipeline;
pub mod reading;
pub mod rectify;
pub mod rig;
pub mod scales;
pub mod scanline;
pub mod setup;
pub mod stage;
pub mod stereo;
pub mod wavelet_block;
pub mod wiring;

mod block;
mod boundary;
mod confidence;
mod consistency;
mod cost;
mod exposure;
mod label;
mod linkage;
mod matcher;
mod noise;
mod pairing;
mod path;
mod ring;
mod search;
mod seed;
mod sparse;
mod texture;
mod view;

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
pub use parts::Parts;
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
