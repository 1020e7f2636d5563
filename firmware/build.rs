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
    println!("cargo:rustc-check-cfg=cfg(machine, values(\"mps2\", \"an505\"))");
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
    let core = Core::of_target();
    let board = Board::chosen(&package);
    let rig = Rig::read(&package, board.rig.as_deref());
    let source = rig.source + &counted(&package, core, rig.width, rig.num_disparities);
    fs::write(out.join("rig.rs"), source).expect("cargo's folder can be written in");
    println!("cargo:rustc-cfg=sensor=\"{}\"", rig.sensor);

    println!("cargo:rustc-env=HAARLINE_CHIP={}", board.chip);
    println!("cargo:rustc-env=HAARLINE_COMPILER={}", compiler());
    let scripts = package.join("memory");
    println!("cargo:rerun-if-changed={}", scripts.display());
    println!("cargo:rerun-if-changed={}", board.memory.display());
    let sections = scripts.join("cortex_m.x");
    let default = package.join("../memory.x");
    let is_default = board.memory.canonicalize().ok() == default.canonicalize().ok();
    for program in ["firmware", "selftest", "bringup", "bench", "profile"] {
        if is_default {
            // It includes `memory.x`, which the linker finds in the workspace's root.
            println!("cargo:rustc-link-arg-bin={program}=-Tlink.x");
        } else {
            println!("cargo:rustc-link-arg-bin={program}=-T{}", board.memory.display());
            println!("cargo:rustc-link-arg-bin={program}=-T{}", sections.display());
            println!("cargo:rustc-link-arg-bin={program}=-Tdevice.x");
        }
        println!("cargo:rustc-link-arg-bin={program}=-Tdefmt.x");
    }

    // The emulated machines.
    println!("cargo:rustc-cfg=machine=\"{}\"", core.machine());
    let machine = scripts.join(core.machine()).with_extension("x");
    for program in ["twin", "footprint"] {
        println!("cargo:rustc-link-arg-bin={program}=-T{}", machine.display());
        println!("cargo:rustc-link-arg-bin={program}=-T{}", sections.display());
        println!("cargo:rustc-link-arg-bin={program}=-Tdefmt.x");
    }
}

/// What is built for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Core {
    /// A Cortex-M4 or M7.
    M4,
    /// A Cortex-M33 with its DSP extension.
    M33,
}

impl Core {
    fn of_target() -> Self {
        let target = env::var("TARGET").unwrap_or_default();
        if !target.starts_with("thumbv8m.main") {
            return Self::M4;
        }
        // Without it everything would work, three times as slow.
        let flags = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
        assert!(
            flags.contains("target-cpu=cortex-m33"),
            "{target} needs -C target-cpu=cortex-m33 as .cargo/config.toml has it: a RUSTFLAGS from outside replaces that"
        );
        Self::M33
    }

    /// What the twin counted of its program.
    const fn counts(self) -> &'static str {
        match self {
            Self::M4 => "counts.csv",
            Self::M33 => "counts_m33.csv",
        }
    }

    /// The emulated machine's linker script.
    const fn machine(self) -> &'static str {
        match self {
            Self::M4 => "mps2",
            Self::M33 => "an505",
        }
    }
}

/// What the twin counted on noisy frames of about that size, as constants.
fn counted(package: &Path, core: Core, width: u16, disparities: u16) -> String {
    let file = package.join("../host-sim/src/power/plan").join(core.counts());
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
    /// The file with the rig that it is built for where no other is named.
    rig: Option<PathBuf>,
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
            return Self { chip: String::new(), memory: package.join("../memory.x"), rig: None };
        };
        let file = folder.join("board.toml");
        println!("cargo:rerun-if-changed={}", file.display());
        let text = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let field = |name: &str| {
            let lines = text.lines().filter_map(|line| line.split_once('='));
            let value = lines.into_iter().find(|(key, _)| key.trim() == name).map(|(_, value)| value);
            value.map(|value| value.trim().trim_matches('"').to_owned())
        };
        let needed = |name: &str| field(name).unwrap_or_else(|| panic!("{}: {name} is missing", file.display()));
        Self {
            chip: needed("chip"),
            memory: folder.join(needed("memory")),
            rig: field("rig").map(|name| folder.join(name)),
        }
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
    /// The rig in `HAARLINE_RIG`, a path from the root of the workspace; without it the board's own, or that of `haarline rig new`.
    fn read(package: &Path, own: Option<&Path>) -> Self {
        println!("cargo:rerun-if-env-changed=HAARLINE_RIG");
        let named = env::var_os("HAARLINE_RIG").map(|path| package.join("..").join(path));
        let (name, text) = match named.or_else(|| own.map(Path::to_owned)) {
            None => ("the default rig".to_owned(), haarline_rig::template()),
            Some(path) => {
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
