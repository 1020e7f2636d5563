//! The program: where it lies, and how much memory it takes.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SymbolKind, elf};
use serde::Serialize;

use super::machine::Machine;
use crate::input::whole_file;

/// Names a built program for all runs, where `--elf` does not.
const VARIABLE: &str = "HAARLINE_TWIN";

/// The secure side's code on the machine `an505`; the others' begins at 0.
const AN505_CODE: u64 = 0x1000_0000;

/// No program of a chip's is longer.
const MAX_BYTES: u64 = 256 << 20;

/// Reads a program.
///
/// # Errors
/// If it cannot be read.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    whole_file::bytes(path, MAX_BYTES)
}

/// The program that the environment names, or one that is built for `machine`.
///
/// # Errors
/// If none is named, and as [`build`].
pub fn find(machine: Machine) -> Result<PathBuf> {
    env::var_os(VARIABLE).filter(|name| !name.is_empty()).map_or_else(|| build(machine), |name| Ok(name.into()))
}

/// The machine that a program is built for, of two the first one: where its code lies tells.
///
/// # Errors
/// If it is no ELF file.
pub fn machine(program: &[u8]) -> Result<Machine> {
    let entry = object::File::parse(program).context("no ELF program")?.entry();
    Ok(if entry >= AN505_CODE { Machine::An505 } else { Machine::An386 })
}

/// Builds the program in the workspace around the current folder and tells where it lies.
///
/// # Errors
/// If there is no such workspace, cargo or the compiler's target is missing, or the build fails.
pub fn build(machine: Machine) -> Result<PathBuf> {
    let target = machine.target();
    let here = env::current_dir().context("the current folder")?;
    let root = here.ancestors().find(|folder| folder.join("firmware/src/bin/twin/main.rs").is_file());
    let root = root.with_context(|| {
        format!(
            "{} is not in Haarline's source folder, where the program for the emulated chip is built: go there, or build it \
             there by `cargo twin` and name it by --elf or {VARIABLE} (target/{target}/firmware/twin)",
            here.display()
        )
    })?;
    ensure!(
        has_target(root, target),
        "Rust's target {target} is missing: rustup target add {target} (or name a built program by --elf)"
    );
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root).args(["build", "--quiet", "-p", "haarline-firmware", "--bin", "twin"]);
    // Without a board's interrupt table.
    cargo.args(["--no-default-features", "--features", "twin"]);
    cargo.args(["--profile", "firmware", "--target", target, "--message-format", "json-render-diagnostics"]);
    let output = cargo.stderr(Stdio::inherit()).output();
    let output = output.context("cargo cannot be run: install Rust from https://rustup.rs, or use --elf")?;
    ensure!(output.status.success(), "the program for the emulated chip does not build, see above");
    let messages = String::from_utf8_lossy(&output.stdout);
    let mut built = messages.lines().filter_map(executable);
    built.next_back().context("cargo tells of no program that it built")
}

fn has_target(root: &Path, target: &str) -> bool {
    let mut rustc = Command::new(env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    let output = rustc.current_dir(root).args(["--print", "target-libdir", "--target", target]).output();
    output.is_ok_and(|output| Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir())
}

/// The program that a message of cargo's names.
fn executable(message: &str) -> Option<PathBuf> {
    let message: serde_json::Value = serde_json::from_str(message).ok()?;
    (message["target"]["name"] == "twin").then(|| message["executable"].as_str().map(PathBuf::from))?
}

/// Bytes of memory, as the program's sections and symbols tell.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Memory {
    /// All static memory, that of the other methods, too.
    pub static_ram: u64,
    /// State of the method that ran.
    pub method_ram: u64,
    /// The two rings of rows.
    pub ring_ram: u64,
    /// All of the program, with its constants.
    pub flash: u64,
    /// Functions of the core, of all its methods; what the compiler put into others is not counted.
    pub core_flash: u64,
}

/// Reads a program's memory; `method` is the name of the one that ran.
///
/// # Errors
/// If it is no ELF file.
pub fn memory(program: &[u8], method: &str) -> Result<Memory> {
    let file = object::File::parse(program).context("no ELF program")?;
    let mut memory = Memory { static_ram: 0, method_ram: 0, ring_ram: 0, flash: 0, core_flash: 0 };
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags, .. } = section.flags() else { bail!("no ELF program") };
        if sh_flags.0 & elf::SHF_ALLOC.0 == 0 {
            continue;
        }
        let is_writable = sh_flags.0 & elf::SHF_WRITE.0 != 0;
        let has_bytes = section.file_range().is_some_and(|(_, size)| size > 0);
        memory.static_ram += if is_writable { section.size() } else { 0 };
        memory.flash += if has_bytes { section.size() } else { 0 };
    }
    let own = format!("METHOD_{}", method.to_uppercase().replace('-', "_"));
    for symbol in file.symbols() {
        let name = format!("{:#}", rustc_demangle::demangle(symbol.name().unwrap_or_default()));
        let last = name.rsplit("::").next().unwrap_or_default();
        match symbol.kind() {
            SymbolKind::Data if last == own => memory.method_ram += symbol.size(),
            SymbolKind::Data if last.ends_with("_RING") => memory.ring_ram += symbol.size(),
            SymbolKind::Text if is_of_core(&name) => memory.core_flash += symbol.size(),
            _ => {}
        }
    }
    Ok(memory)
}

/// Whether a function is the core's: its own, or one that it implements for a trait.
fn is_of_core(name: &str) -> bool {
    name.starts_with("haarline::") || name.starts_with("<haarline::")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cargos_message_names_the_program() {
        let message = r#"{"reason":"compiler-artifact","target":{"name":"twin"},"executable":"/a/b/twin"}"#;
        assert_eq!(executable(message), Some(PathBuf::from("/a/b/twin")));
        assert_eq!(executable(&message.replace("\"twin\"}", "\"core\"}")), None);
        assert_eq!(executable("{}"), None);
    }

    #[test]
    fn what_is_no_program_is_refused() {
        assert!(memory(b"P5 no program", "lite").is_err());
        assert!(machine(b"P5 no program").is_err());
    }

    #[test]
    fn functions_of_the_firmware_are_not_the_cores() {
        assert!(is_of_core("haarline::noise::Noise::of"));
        assert!(is_of_core("<haarline::pipeline::Pipeline<M,_,_,C> as haarline::stereo::StereoMethod>::push"));
        assert!(!is_of_core("haarline_firmware::vision::hand_over"));
        assert!(!is_of_core("haarline_tests::stereo_bm::StereoBm<_,_,_,C>::enter"));
    }
}
