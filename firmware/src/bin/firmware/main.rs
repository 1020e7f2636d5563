//! The board's program: two cameras in, disparity rows out.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;
// Nobody fetches a log while a current is measured.
#[cfg(all(target_os = "none", feature = "measure"))]
#[path = "../../quiet_log.rs"]
mod quiet_log;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an STM32H743. With the board on a probe:");
    println!("  cargo run -p haarline-firmware --release --target thumbv7em-none-eabihf");
    println!("Or on an STM32U575, built by `cargo fw-u575`.");
}
