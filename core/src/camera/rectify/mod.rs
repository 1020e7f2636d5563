//! Rectification: brings together the rows and columns of two cameras that are a little off, as they stream in.
//!
//! [`Ramp`] says where a row of the left view lies in the right one, [`Rectifier`] is the stage that makes
//! rectified pairs of the rows that come, [`Rectified`] puts a method behind it; [`Paired`] does so for whole offsets.

mod paired;
mod ramp;
mod rectified;
mod stage;

pub use paired::{Offset, Paired};
pub use ramp::Ramp;
pub use rectified::Rectified;
pub use stage::{RectifiedRow, Rectifier};
