//! Tells the code which operations on four bytes at once the target has.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(haarline_dsp, haarline_sse2)");
    println!("cargo::rerun-if-changed=build.rs");
    // `target_feature = "dsp"` is not visible to stable code. ARMv7E-M has the extension always; of ARMv8-M Mainline it
    // is an option that Cortex-M33 chips have if they are built for that processor. The unit tests run in QEMU's user mode
    // on ARMv7-A in Thumb state, which has these instructions, too.
    let target = std::env::var("TARGET").unwrap_or_default();
    let flags = std::env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    let is_m33_with_dsp = target.starts_with("thumbv8m.main") && flags.contains("target-cpu=cortex-m33");
    if target.starts_with("thumbv7em") || target.starts_with("thumbv7neon") || is_m33_with_dsp {
        println!("cargo::rustc-cfg=haarline_dsp");
    }
    // A kernel's target for x86-64 may do without.
    let features = std::env::var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    if target.starts_with("x86_64") && features.split(',').any(|feature| feature == "sse2") {
        println!("cargo::rustc-cfg=haarline_sse2");
    }
}
