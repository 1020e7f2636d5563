//! What is kept of a row: a `camera_pair` takes those of both views, judges `exposure` and `noise` of some of their pixels
//! (`sampling`), and knows which did not come (`missing_rows`); a `camera_view` smooths a view and makes features of it,
//! gradients or by `intensity`; a `contour_line` is what sparse methods match the views by.

pub(crate) mod camera_pair;
pub(crate) mod camera_view;
pub mod contour;
pub(crate) mod contour_line;
pub mod curvature;
pub(crate) mod exposure;
pub mod haar;
pub(crate) mod intensity;
mod missing_rows;
pub(crate) mod noise;
pub mod reading;
pub(crate) mod sampling;
pub mod scales;
