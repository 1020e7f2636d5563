//! The command line as a user calls it: files in, files, figures and error lines out. What comes out is read
//! back by readers of this test's own.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "Samples of small images, in range by construction."
)]

mod align;
mod bad_input;
mod bad_scenes;
mod bad_views;
mod bench;
mod cases;
mod contours;
mod corruption;
mod degradation;
mod demo;
mod depth;
mod encodings;
mod eval;
mod files;
mod layouts;
#[cfg(feature = "mcap")]
mod mcap;
mod overwrite;
mod pipe;
mod play;
mod power;
mod power_plan;
mod receive;
mod record;
mod rig;
mod rig_check;
mod rig_correct;
mod rig_import;
mod scene;
mod study;
mod tool;
mod twin;
