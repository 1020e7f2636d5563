//! The methods, all behind the interface `stereo`: `full` and `lite` are the `tile_pipeline` with and without agreement,
//! `wavelet_block` is a `matcher` in the `pipeline` for blocks, `contour_stereo` and `envelope` measure points in the
//! `sparse` one.

mod block_row;
pub mod contour_stereo;
pub(crate) mod deciding;
pub mod envelope;
pub mod full;
pub mod lite;
mod matcher;
mod missing_rows;
pub mod parts;
pub mod pipeline;
mod sparse;
pub mod stereo;
pub mod tile_pipeline;
pub mod wavelet_block;
