//! Rigs: aligned from their own frames, imported from calibrations.

pub mod align;
pub mod align_picture;
pub mod description_file;
pub mod import;
pub mod warp;
