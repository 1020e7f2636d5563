//! What is kept of a row: `exposure` and `noise` judge it, `view` smooths it and makes features of it by the
//! filters of `haar`, a `ring` keeps the newest ones, and `contour` finds what the views are matched by.

pub(crate) mod camera_view;
pub mod contour;
pub mod curvature;
pub(crate) mod exposure;
pub mod haar;
pub(crate) mod noise;
pub mod reading;
pub(crate) mod ring;
pub mod scales;
pub(crate) mod view;
