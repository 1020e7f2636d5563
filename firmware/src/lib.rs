//! The application, and what the programs of this package share.
//!
//! `app` is the application: three tasks and two rings of rows between them, which know no chip. `capture` takes
//! what the camera delivers and is never blocked, `vision` runs the stereo method and looks for obstacles,
//! `results` sends the disparity rows off; `autopilot` tells of the obstacles. `sensor` has a file for each image
//! sensor, by its registers. `board` has a folder for each board, with pins, clocks, DMA, interrupts, and what they share. Boards and the
//! emulated machine differ in the two edges only, `app::edge::RowSource` and `app::edge::PacketSink`.
#![cfg_attr(not(test), no_std)]

pub mod app;
#[cfg(all(target_os = "none", feature = "board"))]
pub mod board;
pub mod bringup;
#[cfg(target_os = "none")]
pub mod rig;
pub mod selftest;
pub mod sensor;
#[cfg(target_os = "none")]
pub mod stack;
