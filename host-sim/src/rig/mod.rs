//! Rigs: aligned from their own frames, imported from calibrations, checked by what they see.

pub mod align;
pub mod align_picture;
pub mod check;
pub mod check_page;
pub mod correction;
pub mod description_file;
pub mod import;
pub mod planes;
pub mod warp;
