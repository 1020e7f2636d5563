//! The application, and what the programs of this package share.
//!
//! Three tasks and two rings of rows between them: `capture` takes what the camera delivers and is
//! never blocked, `vision` runs the stereo method and looks for obstacles, `results` sends the disparity rows
//! off; on a board `autopilot` tells of the obstacles. Boards and the emulated machine differ in the two edges
//! only, `edge::RowSource` and `edge::PacketSink`.
#![cfg_attr(not(test), no_std)]

pub mod hm01b0;
pub mod picture;
pub mod port;
pub mod selftest;

#[cfg(target_os = "none")]
pub mod autopilot;
#[cfg(target_os = "none")]
pub mod capture;
#[cfg(target_os = "none")]
pub mod edge;
#[cfg(all(target_os = "none", feature = "board-h743"))]
pub mod h743;
#[cfg(target_os = "none")]
pub mod lookout;
#[cfg(target_os = "none")]
pub mod results;
#[cfg(target_os = "none")]
pub mod rig;
#[cfg(target_os = "none")]
pub mod ring;
#[cfg(target_os = "none")]
pub mod stack;
#[cfg(target_os = "none")]
pub mod vision;
