//! Tells whether the target has the DSP extension of Armv7-M and Armv8-M, whose instructions work on four bytes at once:
//! `cfg(dsp)`. The compiler does not tell it to programs.

use std::env;

/// Cores of Armv8-M whose DSP extension is there by default.
const CORES: [&str; 4] = ["cortex-m33", "cortex-m35p", "cortex-m55", "cortex-m85"];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(dsp)");
    let target = env::var("TARGET").unwrap_or_default();
    let flags = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    let asked = flags.contains("+dsp") || CORES.iter().any(|core| flags.contains(&format!("target-cpu={core}")));
    let refused = flags.contains("-dsp");
    if target.starts_with("thumbv7em") || (target.starts_with("thumbv8m.main") && asked && !refused) {
        println!("cargo:rustc-cfg=dsp");
    }
}
