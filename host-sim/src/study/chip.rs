//! What a pixel costs: instructions on the emulated chip.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result};
use haarline::wiring::{First, Kind};
use haarline::{Config, Stage, Wiring};

use crate::StereoPair;
use crate::score::degrade::Degradation;
use crate::score::scene::Scene;
use crate::stereo::method::MethodKind;
use crate::twin::footage::Footage;
use crate::twin::machine::Machine;
use crate::twin::{Report, Request, elf};

/// Seconds until a run on the emulated chip is given up.
const LIMIT: Duration = Duration::from_secs(600);

/// Executed instructions of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instructions {
    /// Of all stages but the packets.
    pub total: f64,
    /// Of making the packets.
    pub packets: f64,
}

/// An emulated Cortex-M, and the program that runs there.
#[derive(Debug, Clone)]
pub struct Chip {
    /// The machine: what the program is built for.
    pub machine: Machine,
    program: Vec<u8>,
    path: PathBuf,
}

impl Chip {
    /// Most scenes that are counted: a mean of four is within a percent or two of that of all.
    pub const MOST_SCENES: usize = 4;

    /// The chip with that program, as `cargo twin` or `cargo twin-m33` builds it.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn read(path: &Path) -> Result<Self> {
        let program = elf::read(path)?;
        let machine = elf::machine(&program).with_context(|| path.display().to_string())?;
        Ok(Self { machine, program, path: path.to_owned() })
    }

    /// Executed instructions of a pixel, all stages, mean over up to [`Self::MOST_SCENES`] scenes that lie as far apart in the
    /// list as can be.
    ///
    /// # Errors
    /// If the program fails or is given views that are too wide for it.
    pub fn instructions(&self, method: MethodKind, scenes: &[Scene], degradation: &Degradation) -> Result<f64> {
        let step = scenes.len().div_ceil(Self::MOST_SCENES).max(1);
        let scenes: Vec<&Scene> = scenes.iter().step_by(step).collect();
        let mut sum = 0.0;
        for scene in &scenes {
            let counted = self.count(method, scene, degradation);
            sum += counted.with_context(|| format!("{} on {}", scene.name, self.path.display()))?;
        }
        Ok(sum / scenes.len().max(1) as f64)
    }

    fn count(&self, method: MethodKind, scene: &Scene, degradation: &Degradation) -> Result<f64> {
        let mut pair = scene.pair.clone();
        degradation.apply(&scene.name, &mut pair);
        Ok(self.count_pair(method, &pair, scene.config())?.total)
    }

    /// Executed instructions of a pixel of that pair.
    ///
    /// # Errors
    /// If the program fails or is given views that are too wide for it.
    pub fn count_pair(&self, method: MethodKind, pair: &StereoPair, config: Config) -> Result<Instructions> {
        let wiring = Wiring::new(Kind::SideBySide, First::Left);
        let footage = Footage::record(std::slice::from_ref(pair), wiring)?;
        let height = pair.height();
        let request =
            Request { config, height, recorded: 1, frames: 1, keep: 1, method, wiring, fault: None, plan: None };
        request.check()?;
        let folder = tempfile::tempdir().context("a folder for the run")?;
        let file = |name: &str| folder.path().join(name);
        fs::write(file("twin.elf"), &self.program).context("a folder for the run")?;
        fs::write(file("raw.bin"), &footage.raw).context("a folder for the run")?;
        self.machine.run(folder.path(), "twin.elf", &request.arguments(), LIMIT)?;
        let report = Report::read(&file("report.txt"))?;
        let pixels = report.get("worked_rows")? as f64 * f64::from(config.width);
        let of = |name: &str| Ok::<_, anyhow::Error>(report.get(name)? as f64 / pixels.max(1.0));
        Ok(Instructions { total: of("total")?, packets: of(Stage::Packets.name())? })
    }
}
