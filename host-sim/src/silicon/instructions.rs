//! Instructions of a method on the same pairs, counted in QEMU.

use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};
use haarline::Wiring;
use haarline::wiring::{First, Kind};

use super::run::config;
use crate::StereoPair;
use crate::stereo::method::MethodKind;
use crate::twin::footage::Footage;
use crate::twin::machine::Machine;
use crate::twin::{Report, Request, elf};

/// Longest that a pair may take.
const LIMIT: Duration = Duration::from_secs(600);

/// Instructions of all stages but the packets, for a pair through the program `elf` on an emulated Cortex-M7, or the M33 if it is
/// built for that.
///
/// # Errors
/// If QEMU is missing or the program fails.
pub fn count(elf: &Path, method: MethodKind, pair: &StereoPair) -> Result<u64> {
    let wiring = Wiring::new(Kind::SideBySide, First::Left);
    let footage = Footage::record(std::slice::from_ref(pair), wiring)?;
    let (config, height) = (config(pair), pair.height());
    let request = Request { config, height, recorded: 1, frames: 1, keep: 0, method, wiring, fault: None, plan: None };
    let folder = tempfile::tempdir().context("a folder for the run")?;
    let program = elf::read(elf)?;
    let built = elf::machine(&program).with_context(|| elf.display().to_string())?;
    let machine = if built == Machine::An386 { Machine::An500 } else { built };
    fs::write(folder.path().join("twin.elf"), &program).context("a folder for the run")?;
    fs::write(folder.path().join("raw.bin"), &footage.raw).context("a folder for the run")?;
    machine.run(folder.path(), "twin.elf", &request.arguments(), LIMIT)?;
    let stages = Report::read(&folder.path().join("report.txt"))?.stages()?;
    let own = stages.into_iter().filter(|(stage, _)| !matches!(stage.name(), "unpack" | "packets"));
    Ok(own.map(|(_, count)| count).sum())
}
