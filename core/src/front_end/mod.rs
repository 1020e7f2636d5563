//! What is kept of a row: `exposure` and `noise` judge some pixels of it (`sampling`), a `camera_view` smooths it and makes
//! features of it, gradients or by `intensity`, and a `contour_line` is what sparse methods match the views by.

pub(crate) mod camera_view;
pub mod contour;
pub(crate) mod contour_line;
pub mod curvature;
pub(crate) mod exposure;
pub mod haar;
pub(crate) mod intensity;
pub(crate) mod noise;
pub mod reading;
pub(crate) mod sampling;
pub mod scales;
