//! The methods, all behind the interface `stereo`: `full` and `lite` are the `tile_pipeline` with and without agreement,
//! `wavelet_block` is the one with an extremum search for each tile, `contour_stereo` and `envelope` measure points in the
//! `sparse` one.

pub(crate) mod capacity;
pub mod contour_stereo;
pub(crate) mod deciding;
pub mod envelope;
pub mod full;
pub mod lite;
pub mod parts;
mod sparse;
pub mod stereo;
pub mod tile_pipeline;
pub mod wavelet_block;
