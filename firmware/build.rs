//! Gives the linker each program's memory map. Here and not in `.cargo/config.toml`, because a
//! `RUSTFLAGS` from outside would replace what stands there and link an empty program.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let package = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    println!("cargo:rustc-link-arg-bins=--nmagic");

    // The board: cortex-m-rt's `link.x` includes `memory.x`.
    let memory = package.join("../memory.x");
    fs::copy(&memory, out.join("memory.x")).expect("memory.x lies at the root of the workspace");
    println!("cargo:rerun-if-changed={}", memory.display());
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg-bin=firmware=-Tlink.x");

    // The emulated machines: a linker script of their own, and what defmt needs.
    let machine = package.join("memory/mps2.x");
    println!("cargo:rerun-if-changed={}", machine.display());
    println!("cargo:rustc-link-arg-bin=twin=-T{}", machine.display());
    println!("cargo:rustc-link-arg-bin=twin=-Tdefmt.x");
}
