//! Arguments that several commands have in common, and what all of them tell on the way.

mod benchmark;
mod depth_options;
mod fill;
mod frames;
mod json_output;
mod layout;
mod messages;
mod method;
mod min_confidence;
mod picture_range;
mod rig;
mod search_range;
mod wiring;

pub(super) use benchmark::{Benchmark, read_scenes, scene_folders};
pub(super) use depth_options::DepthOptions;
pub(super) use fill::FillArg;
pub(super) use frames::{FrameArgs, readable};
pub(super) use json_output::JsonOutput;
pub(super) use layout::LayoutArgs;
pub(super) use messages::{bent_words, progress, quoted, warn_input, warn_skipped};
pub(super) use method::MethodOptions;
pub(super) use min_confidence::MinConfidence;
pub(super) use picture_range::RangeArg;
pub(super) use rig::RigArg;
pub(super) use search_range::SearchRange;
pub(super) use wiring::WiringArgs;
