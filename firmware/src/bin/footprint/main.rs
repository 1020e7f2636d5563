//! One method alone in QEMU, to tell what it takes: `firmware/checks/footprint.py` builds, runs and reads it. Which one it is tells
//! `HAARLINE_FOOTPRINT` to the build.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated Cortex-M (QEMU): firmware/checks/footprint.py");
}
