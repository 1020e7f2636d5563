//! Rectification: brings together the rows and columns of two cameras that are a little off, as they stream in.
//!
//! [`Ramp`] says where a row of the left view lies in the right one, [`LensTable`] where a camera saw what a rectified view
//! shows, [`Rectification`] is all that is put right of a rig. [`Rectifier`] is the stage that makes
//! rectified pairs of the rows that come, [`Rectified`] puts a method behind it; [`Paired`] does so for whole offsets.

mod lens;
mod lens_rows;
mod paired;
mod plan;
mod ramp;
mod rectification;
mod rectified;
mod ring;
mod stage;

pub use lens::{LensTable, NODE_PX, node_count};
pub use paired::{Offset, Paired};
pub use ramp::Ramp;
pub use rectification::Rectification;
pub use rectified::Rectified;
pub use stage::{RectifiedRow, Rectifier};
