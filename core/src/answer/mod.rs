//! What is said of a pixel: a `disparity` and its `confidence`, or unknown. Cells are rated by their
//! `evidence` and laid into an `answer_row`, single points pass the test of `linkage`.

pub(crate) mod answer_row;
pub(crate) mod cell;
pub(crate) mod cell_row;
pub mod confidence;
pub mod disparity;
pub(crate) mod evidence;
pub(crate) mod linkage;
pub(crate) mod median;
pub(crate) mod merit;
pub(crate) mod neighbourhood;
pub(crate) mod repetition;
pub(crate) mod right_view;
