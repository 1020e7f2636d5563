//! Counts what the stereo methods execute, in a bare loop on QEMU's Cortex-M4F.
//!
//! One frame goes through each method, row by row, nothing else running. Printed are the executed
//! instructions, counted exactly, and a checksum of the answer. `bare.sh` builds and runs it.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
mod digest;
#[cfg(target_os = "none")]
mod frame;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated Cortex-M4F (QEMU). Build and run it with:");
    println!("  firmware/bare.sh [-d DISPARITIES] [LEFT.pgm RIGHT.pgm]");
}
