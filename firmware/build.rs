//! Writes the rig that the programs are built for as Rust constants, and gives the linker each program's
//! memory map. Here and not in `.cargo/config.toml`, because a
//! `RUSTFLAGS` from outside would replace what stands there and link an empty program.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
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
    fs::write(out.join("settings.rs"), settings()).expect("OUT_DIR can be written");

    // The emulated machines: a linker script of their own, and what defmt needs.
    let machine = package.join("memory/mps2.x");
    println!("cargo:rerun-if-changed={}", machine.display());
    println!("cargo:rustc-link-arg-bin=twin=-T{}", machine.display());
    println!("cargo:rustc-link-arg-bin=twin=-Tdefmt.x");
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

/// What the board's program is built for: environment variables, or what is usual.
fn settings() -> String {
    let get = |name: &str, usual: &str| {
        println!("cargo:rerun-if-env-changed={name}");
        env::var(name).unwrap_or_else(|_| usual.to_owned())
    };
    let number = |name: &str, usual: &str| -> i16 {
        let text = get(name, usual);
        text.parse().unwrap_or_else(|_| panic!("{name}: {text:?} is no number"))
    };
    let size = get("HAARLINE_SIZE", "320x240");
    let (width, height) = size
        .split_once('x')
        .and_then(|(width, height)| Some((width.parse::<u16>().ok()?, height.parse::<u32>().ok()?)))
        .unwrap_or_else(|| panic!("HAARLINE_SIZE: {size:?} must be as 320x240"));
    let first = match get("HAARLINE_FIRST", "left").as_str() {
        "left" => "Left",
        "right" => "Right",
        other => panic!("HAARLINE_FIRST: {other:?} must be left or right"),
    };
    let method = match get("HAARLINE_METHOD", "full").as_str() {
        "full" => "Full",
        "lite" => "Lite",
        other => panic!("HAARLINE_METHOD: {other:?} must be full or lite"),
    };
    let integration = match get("HAARLINE_EXPOSURE", "auto").as_str() {
        "auto" => "None".to_owned(),
        lines => format!("Some({})", lines.parse::<u16>().expect("HAARLINE_EXPOSURE: must be auto or lines, 2 to 258")),
    };
    let rate = number("HAARLINE_FRAME_RATE", "5");
    let (min, num) = (number("HAARLINE_MIN_DISPARITY", "0"), number("HAARLINE_NUM_DISPARITIES", "64"));
    format!(
        "/// Columns of a view.\npub const WIDTH: u16 = {width};
/// Rows of a view.\npub const HEIGHT: u32 = {height};
/// First disparity searched, px.\npub const MIN_DISPARITY: i16 = {min};
/// Disparities searched.\npub const NUM_DISPARITIES: u16 = {num};
/// Frames a second.\npub const FRAME_RATE: u32 = {rate};
/// The sensor that the multiplexer takes first.\npub const FIRST: First = First::{first};
/// Integration time of both sensors, lines; `None`: the first one's own control, copied to the second.
pub const INTEGRATION: Option<u16> = {integration};
/// The stereo method.\npub const METHOD: Method = Method::{method};
/// A stereo method.\n#[derive(Debug, Clone, Copy, PartialEq, Eq)]\npub enum Method {{
    /// The most accurate.\n    Full,\n    /// The cheapest.\n    Lite,\n}}\n"
    )
}
