//! What becomes of a row of disparities: depth by the geometry of the `rig`, the nearest `obstacle` in every
//! direction, a `packet` for a wire; `fill` guesses what is unknown, a `correction` takes away what lenses leave.
//! `frame_figures` tells what all of it is worth, `row_watch` whether the rig has bent.

pub mod correction;
pub mod fill;
pub mod frame_figures;
pub mod obstacle;
#[cfg(feature = "packet")]
pub mod packet;
pub mod rig;
pub mod row_watch;
