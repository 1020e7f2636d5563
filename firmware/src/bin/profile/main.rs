//! Every method on a built-in pair for 3 s, then 1 s of sleep, in a loop: segments that even a multimeter shows, in the order
//! full, lite, wavelet-block, contour, envelope, block, sgm. No log, no cameras; the phase pins tell work from sleep.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
#[path = "../../quiet_log.rs"]
mod quiet_log;

#[cfg(not(target_os = "none"))]
fn main() {
    const TARGET: &str = "thumbv7em-none-eabihf";
    println!(
        "This program runs on an STM32H743 whose current is measured. Build it, flash it, detach the probe, power-cycle:"
    );
    println!("  cargo build -p haarline-firmware --release --target {TARGET} --features measure --bin profile");
    println!("  probe-rs download --chip STM32H743ZITx target/{TARGET}/release/profile");
    println!("(STM32U575: cargo fw-u575 --features measure --bin profile)");
    println!("Or see where its cycles go:");
    println!(
        "  probe-rs profile --chip STM32H743ZITx --duration 28 --flash --reset target/{TARGET}/release/profile flat pcsr"
    );
}
