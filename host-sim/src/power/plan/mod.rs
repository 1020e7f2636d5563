//! A power budget without hardware: what the emulated chip counted, a model of cycles, and currents from documents.
//!
//! [`counts`] are stored with the program, [`counting`] makes them anew; [`cost`] tells what a pixel takes at any size.
//! [`currents`] has a figure for each chip and sensor with its source or the mark that it has none. [`budget`] puts them
//! together; [`comparison`] does so for all methods and boards.

pub mod accuracy;
pub mod budget;
pub mod check;
pub mod comparison;
pub mod cost;
pub mod counting;
pub mod counts;
pub mod currents;
pub mod full_load;
pub mod joules;
pub mod standby;
