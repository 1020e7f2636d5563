//! Power as the field's current meters record it: energy by phase and by segment, of a recording of any length.
//!
//! [`current_file`] reads what a PPK2 or a Joulescope exports, sample by sample; [`measurement`] adds it up: in all, by
//! [`phase`], and in short [`blocks`], in which [`segments`] are found; other recordings are taken
//! off; [`stages`] share what the running program takes; [`page`] shows it.
//!
//! A sample holds until the next one. Lost samples are jumps in time: a short one is shared by its neighbours, a longer one
//! is lost time, of which no energy is told.

pub mod blocks;
pub mod current_file;
mod decimal;
mod lines;
pub mod measurement;
pub mod page;
pub mod phase;
pub mod plan;
pub mod segments;
pub mod stages;
mod time;
