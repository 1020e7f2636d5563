//! The host side of Haarline: recorded frames through the same core as on the chip, then scores and
//! pictures.
//!
//! - in: [`image_file`] and [`frame`] read images, [`recording`] finds the frames of a recording,
//!   [`raw_dump`] those in a camera port's bytes, [`rig_file`] reads what the cameras are like, [`split`] halves a set of scenes, [`scene`] reads a benchmark scene's folder, [`synthetic`] renders a scene with known truth, [`degrade`] makes
//!   frames worse on purpose, [`noise`] estimates how bad they are;
//! - through: [`method`] is the registry of the stereo methods, [`pipeline`] runs one over a frame,
//!   [`playback`] over a recording;
//! - out: [`contour_picture`], [`disparity_map`], [`geometry`] (its depth), [`obstacles`], [`output`] (files and pictures),
//!   [`packet_stream`] (maps from a chip's row packets);
//! - judged: [`score`], [`sparsification`] and [`confidence_classes`], [`baselines`] (OpenCV's figures), [`evaluation`] of many
//!   scenes, [`ablation`] (what the parts of a method bring), [`report`];
//! - on the chip: [`twin`] runs the firmware application in QEMU;
//! - [`command`]: the commands of the `haarline` tool.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "floating point meets pixels at every step here, and nothing of it runs on the chip"
)]

pub mod ablation;
pub mod baselines;
pub mod command;
pub mod confidence_classes;
pub mod contour_picture;
pub mod degrade;
pub mod disparity_map;
pub mod evaluation;
pub mod frame;
pub mod geometry;
pub mod image_file;
pub mod method;
pub mod noise;
pub mod obstacles;
pub mod output;
pub mod packet_stream;
pub mod pipeline;
pub mod playback;
pub mod raw_dump;
pub mod recording;
pub mod report;
pub mod rig_file;
pub mod scene;
pub mod score;
pub mod sparsification;
pub mod split;
pub mod study;
pub mod synthetic;
pub mod twin;

pub use disparity_map::DisparityMap;
pub use frame::{Frame, StereoPair};
pub use geometry::Geometry;
pub use method::MethodKind;
