//! The application in QEMU, on a Cortex-M4F, M7 or M33: rows come from a file of the host, results go into
//! one, and executed instructions are counted. `haarline twin` builds, runs and reads it.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
mod fault;
#[cfg(target_os = "none")]
mod file;
#[cfg(target_os = "none")]
mod methods;
#[cfg(target_os = "none")]
mod obstacles;
#[cfg(target_os = "none")]
mod options;
#[cfg(target_os = "none")]
mod report;
#[cfg(target_os = "none")]
mod sink;
#[cfg(target_os = "none")]
mod source;
#[cfg(target_os = "none")]
mod tables;
#[cfg(target_os = "none")]
mod time;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated Cortex-M (QEMU): haarline twin LEFT RIGHT");
}
