//! What is said of a pixel: a `disparity` and its `confidence`, or unknown. Blocks pass the tests of `texture`,
//! `boundary` and `consistency`, single points that of `linkage`.

pub(crate) mod answer_row;
pub(crate) mod boundary;
pub(crate) mod cell;
pub(crate) mod cell_row;
pub(crate) mod confidence;
pub(crate) mod consistency;
pub mod disparity;
pub(crate) mod evidence;
pub(crate) mod linkage;
pub(crate) mod median;
pub(crate) mod repetition;
pub(crate) mod texture;
