//! Writes the rig that the programs are built for as Rust constants, and gives the linker each program's
//! memory map. Here and not in `.cargo/config.toml`, because a
//! `RUSTFLAGS` from outside would replace what stands there and link an empty program.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(footprint, values(\"null\", \"lite\", \"full\", \"block\", \"sgm\"))");
    println!("cargo:rustc-check-cfg=cfg(sensor, values(\"hm01b0\", \"mt9v034\"))");
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
    let rig = Rig::read(&package);
    let source = rig.source + &counted(&package, rig.width, rig.num_disparities);
    fs::write(out.join("rig.rs"), source).expect("cargo's folder can be written in");
    println!("cargo:rustc-cfg=sensor=\"{}\"", rig.sensor);

    let board = Board::chosen(&package);
    println!("cargo:rustc-env=HAARLINE_CHIP={}", board.chip);
    println!("cargo:rustc-env=HAARLINE_COMPILER={}", compiler());
    // cortex-m-rt's `link.x` includes `memory.x`, which the linker looks for in the workspace's root first.
    fs::copy(&board.memory, out.join("memory.x")).expect("the board's memory map can be read");
    println!("cargo:rerun-if-changed={}", board.memory.display());
    println!("cargo:rustc-link-search={}", out.display());
    for program in ["firmware", "selftest", "bringup", "bench", "profile"] {
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

/// What the twin counted on noisy frames of about that size, as constants.
fn counted(package: &Path, width: u16, disparities: u16) -> String {
    let file = package.join("../host-sim/src/power/plan/counts.csv");
    println!("cargo:rerun-if-changed={}", file.display());
    let text = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    // method, scene, input, width, height, disparities, instructions, packets
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let number =
        |cell: &str| cell.parse::<f64>().unwrap_or_else(|_| panic!("{}: {cell:?} is no number", file.display()));
    let of = |method: &str| {
        let own = || lines.iter().filter(|line| line.len() == 8 && line[0] == method && line[2] == "noisy");
        let far = |line: &[&str]| {
            let away = |cell: &str, wanted: u16| (number(cell) / f64::from(wanted)).ln().abs();
            2.0 * away(line[3], width) + away(line[5], disparities)
        };
        let nearest = own().map(|line| far(line)).fold(f64::INFINITY, f64::min);
        let near = own().filter(|line| far(line) <= nearest).map(|line| number(line[6]) + number(line[7]));
        let most = near.fold(0.0, f64::max);
        assert!(most > 0.0, "{}: nothing was counted of {method}", file.display());
        format!(
            "/// Instructions of a pixel of `{method}`, of its packets too.\npub const INSTRUCTIONS_{}: u32 = {most:.0};\n",
            method.to_uppercase()
        )
    };
    of("full") + &of("lite")
}

/// The compiler, as it says itself.
fn compiler() -> String {
    let rustc = env::var_os("RUSTC").expect("cargo sets it");
    let said = Command::new(rustc).arg("--version").output().map(|output| output.stdout).unwrap_or_default();
    String::from_utf8_lossy(&said).trim().to_owned()
}

/// What `board.toml` in a board's folder says.
struct Board {
    /// The chip, as probe-rs names it.
    chip: String,
    /// The file with its memory map.
    memory: PathBuf,
}

impl Board {
    /// The one whose feature is chosen.
    fn chosen(package: &Path) -> Self {
        let boards = package.join("src/board");
        let folders = fs::read_dir(&boards).expect("the boards have a folder").filter_map(Result::ok);
        let is_chosen = |folder: &fs::DirEntry| {
            let name = folder.file_name().to_string_lossy().to_uppercase().replace('-', "_");
            folder.path().is_dir() && env::var_os(format!("CARGO_FEATURE_BOARD_{name}")).is_some()
        };
        let Some(folder) = folders.into_iter().find(is_chosen).map(|folder| folder.path()) else {
            // The emulated machines have no board; nothing is linked by this.
            return Self { chip: String::new(), memory: package.join("../memory.x") };
        };
        let file = folder.join("board.toml");
        println!("cargo:rerun-if-changed={}", file.display());
        let text = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let field = |name: &str| {
            let lines = text.lines().filter_map(|line| line.split_once('='));
            let value = lines.into_iter().find(|(key, _)| key.trim() == name).map(|(_, value)| value);
            let value = value.unwrap_or_else(|| panic!("{}: {name} is missing", file.display()));
            value.trim().trim_matches('"').to_owned()
        };
        Self { chip: field("chip"), memory: folder.join(field("memory")) }
    }
}

/// What the programs are built for.
struct Rig {
    /// Its constants.
    source: String,
    /// The sensors that its wiring asks for: the module that drives them.
    sensor: &'static str,
    /// Columns of a view.
    width: u16,
    num_disparities: u16,
}

impl Rig {
    /// The rig in `HAARLINE_RIG`, a path from the root of the workspace; without it that of `haarline rig new`.
    fn read(package: &Path) -> Self {
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
        let rig = haarline_rig::Description::parse(&text).and_then(|description| {
            let sensor = if description.wiring.kind.name() == "pairs14" { "mt9v034" } else { "hm01b0" };
            let (width, num_disparities) = (description.width, description.num_disparities);
            Ok(Self { source: description.to_rust()?, sensor, width, num_disparities })
        });
        rig.unwrap_or_else(|error| panic!("HAARLINE_RIG {name}: {error}"))
    }
}
