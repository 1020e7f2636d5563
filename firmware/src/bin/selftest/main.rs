//! Every method on a built-in pair, on a bare board without cameras: its checksum is the host's, and
//! what each stage costs is counted in cycles, in a table to pass on.
//!
//! It goes on for ever, so that `probe-rs profile` can read again and again where the core is; the names it shows
//! are those of the program's symbols, which the release profile keeps.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;

#[cfg(not(target_os = "none"))]
fn main() {
    const TARGET: &str = "thumbv7em-none-eabihf";
    println!("This program runs on an STM32H743. With the board on a probe, for the table:");
    println!("  cargo run -p haarline-firmware --release --target {TARGET} --bin selftest");
    println!("and then, to see where the cycles go (`pcsr` without `flat` in older versions):");
    println!("  probe-rs profile --chip STM32H743ZITx --duration 20 target/{TARGET}/release/selftest flat pcsr");
    println!("Or on an STM32U575, built by `cargo fw-u575`.");
}
