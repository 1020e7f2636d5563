//! The methods, all behind the interface `stereo`: `full`, `lite` and `wavelet_block` are each a `matcher` in
//! the `pipeline` for blocks, `contour_stereo` and `envelope` measure points in the `sparse` one.

mod block_row;
pub mod contour_stereo;
pub(crate) mod deciding;
pub mod envelope;
pub mod full;
pub mod lite;
mod matcher;
pub mod parts;
pub mod pipeline;
mod sparse;
pub mod stereo;
pub mod tile_pipeline;
pub mod wavelet_block;
