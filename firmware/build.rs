//! Writes the rig that the programs are built for as Rust constants, and gives the linker each program's
//! memory map. Here and not in `.cargo/config.toml`, because a
//! `RUSTFLAGS` from outside would replace what stands there and link an empty program.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(footprint, values(\"null\", \"lite\", \"full\", \"block\", \"sgm\"))");
    // The method that the program `footprint` measures.
    println!("cargo:rerun-if-env-changed=HAARLINE_FOOTPRINT");
    let measured = env::var("HAARLINE_FOOTPRINT").unwrap_or_else(|_| "null".to_owned());
    println!("cargo:rustc-cfg=footprint=\"{measured}\"");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let package = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    println!("cargo:rustc-link-arg-bins=--nmagic");
    fs::write(out.join("rig.rs"), rig(&package)).expect("cargo's folder can be written in");

    // The board: cortex-m-rt's `link.x` includes `memory.x`.
    let memory = package.join("../memory.x");
    fs::copy(&memory, out.join("memory.x")).expect("memory.x lies at the root of the workspace");
    println!("cargo:rerun-if-changed={}", memory.display());
    println!("cargo:rustc-link-search={}", out.display());
    for program in ["firmware", "selftest"] {
        println!("cargo:rustc-link-arg-bin={program}=-Tlink.x");
        println!("cargo:rustc-link-arg-bin={program}=-Tdefmt.x");
    }

    // The emulated machines: a linker script of their own, and what defmt needs.
    let machine = package.join("memory/mps2.x");
    println!("cargo:rerun-if-changed={}", machine.display());
    for program in ["twin", "footprint"] {
        println!("cargo:rustc-link-arg-bin={program}=-T{}", machine.display());
        println!("cargo:rustc-link-arg-bin={program}=-Tdefmt.x");
    }
}

/// The constants of the rig in `HAARLINE_RIG`, a path from the root of the workspace; without it that of
/// `haarline rig new`.
fn rig(package: &Path) -> String {
    println!("cargo:rerun-if-env-changed=HAARLINE_RIG");
    let (name, text) = match env::var_os("HAARLINE_RIG") {
        None => ("the default rig".to_owned(), haarline_rig::template()),
        Some(path) => {
            let path = package.join("..").join(path);
            println!("cargo:rerun-if-changed={}", path.display());
            let text = fs::read_to_string(&path);
            (
                path.display().to_string(),
                text.unwrap_or_else(|error| panic!("HAARLINE_RIG {}: {error}", path.display())),
            )
        }
    };
    let source = haarline_rig::Description::parse(&text).and_then(|description| description.to_rust());
    source.unwrap_or_else(|error| panic!("HAARLINE_RIG {name}: {error}"))
}
