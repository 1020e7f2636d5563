//! A new rig, step by step: what was measured, whether that is well, and what probably is the matter if not.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod report;
#[cfg(target_os = "none")]
mod survey;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on a board with cameras. With the board on a probe:");
    println!("  cargo run -p haarline-firmware --release --target thumbv7em-none-eabihf --bin bringup");
}
