//! Rigs: aligned from their own frames, imported from calibrations.

pub mod align;
pub mod align_picture;
pub mod correction;
pub mod description_file;
pub mod import;
pub mod planes;
pub mod warp;
