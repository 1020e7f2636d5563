//! The methods on a bare board without cameras, on pairs that the host sends: `haarline silicon` talks to it, compares every row
//! with its own, and makes a table of what each method costs.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod port;
#[cfg(target_os = "none")]
mod work;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an STM32H743. With the board on a probe, and then on its serial port:");
    println!("  cargo run -p haarline-firmware --release --target thumbv7em-none-eabihf --bin bench");
    println!("  haarline silicon --port /dev/ttyACM0 SCENES");
    println!("Or on an STM32U575, built by `cargo fw-u575`.");
}
