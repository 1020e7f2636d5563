//! What a pixel costs: executed instructions, counted on the emulated chip and stored with the program.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use crate::input::whole_file;
use crate::stereo::method::MethodKind;
use crate::twin::cycles::Core;

/// The stored ones, as `haarline power count` makes them: of the program for the Cortex-M4 and M7, and of that for the M33.
const STORED: &str = include_str!("counts.csv");
const STORED_M33: &str = include_str!("counts_m33.csv");

/// What the cameras see.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Input {
    /// Frames as they were recorded.
    Clean,
    /// The same with Gaussian noise of 10 grey levels.
    Noisy,
    /// Two views of random bytes that have nothing in common.
    Random,
}

impl Input {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Clean, Self::Noisy, Self::Random];
    /// Standard deviation of the noise in [`Self::Noisy`], grey levels.
    pub const NOISE: f64 = 10.0;

    /// What reports call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Noisy => "noisy",
            Self::Random => "random",
        }
    }
}

/// A count: a line of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Count {
    /// The method's name.
    pub method: String,
    /// The scene's name.
    pub scene: String,
    /// What was done to it.
    pub input: Input,
    /// Size of a view, px.
    pub width: u16,
    /// The same.
    pub height: u32,
    /// How many disparities were searched.
    pub disparities: u16,
    /// Executed instructions of a pixel, without the packets.
    pub instructions: f64,
    /// The same of making the packets.
    pub packets: f64,
}

impl Count {
    /// The method, by its name.
    ///
    /// # Errors
    /// If there is none of that name.
    pub fn kind(&self) -> Result<MethodKind> {
        MethodKind::from_str(&self.method, false).ok().with_context(|| format!("there is no method {:?}", self.method))
    }
}

/// The stored counts of the program for that processor.
///
/// # Errors
/// If the file that they are stored in is damaged.
pub fn stored(core: Core) -> Result<Vec<Count>> {
    parse(if core.is_armv8() { STORED_M33 } else { STORED }).context("the stored counts")
}

/// The file that they are stored in.
#[must_use]
pub fn file_name(core: Core) -> &'static str {
    if core.is_armv8() { "counts_m33.csv" } else { "counts.csv" }
}

/// Reads counts.
///
/// # Errors
/// Names the file and what is wrong in it.
pub fn read(path: &Path) -> Result<Vec<Count>> {
    parse(&whole_file::text(path)?).with_context(|| path.display().to_string())
}

fn parse(text: &str) -> Result<Vec<Count>> {
    let counts: Vec<Count> = csv::Reader::from_reader(text.as_bytes()).deserialize().collect::<Result<_, _>>()?;
    ensure!(!counts.is_empty(), "no count in it");
    for count in &counts {
        count.kind()?;
    }
    Ok(counts)
}

/// As a file, sorted.
///
/// # Errors
/// None that is known of.
pub fn encode(counts: &[Count]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    counts.iter().try_for_each(|count| writer.serialize(count))?;
    Ok(writer.into_inner()?)
}
