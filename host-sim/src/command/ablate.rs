//! `haarline ablate`: what each part of `full` brings, on scenes with known truth.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use serde::Serialize;

use super::shared::{Benchmark, JsonOutput, progress};
use super::{natural_number, number};
use crate::score::ablation::{self, Ablation, Repeated, Trial, Variant};
use crate::{output, score::evaluation};

/// Arguments of `haarline ablate`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    benchmark: Benchmark,
    /// Levels of Gaussian noise added to both views, a table for each: standard deviations, grey levels
    #[arg(
        long,
        value_name = "SIGMA,...",
        default_value = "0,10",
        value_delimiter = ',',
        allow_hyphen_values = true,
        value_parser = number
    )]
    noise: Vec<f64>,
    /// Seed of the noise
    #[arg(long, value_name = "S", default_value_t = 0, allow_hyphen_values = true, value_parser = natural_number)]
    seed: u64,
    /// With how many seeds contours are compared with random disparities and a regular grid, 0 to 100
    #[arg(long, value_name = "N", default_value_t = 5, allow_hyphen_values = true, value_parser = natural_number)]
    repeats: u64,
    #[command(flatten)]
    json: JsonOutput,
    /// Writes the tables as CSV
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

#[derive(Serialize)]
struct Json<'a> {
    seed: u64,
    scenes: usize,
    baselines: Option<&'a Path>,
    trials: &'a [Trial],
    /// Where hypotheses come from, at equal numbers.
    hypotheses: &'a [Repeated],
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        for (index, noise) in self.noise.iter().enumerate() {
            ensure!((0.0..=255.0).contains(noise), "--noise {noise}: must be 0 to 255");
            ensure!(!self.noise[..index].contains(noise), "--noise {noise}: is given twice");
        }
        ensure!(self.repeats <= 100, "--repeats {}: must be 0 to 100", self.repeats);
        let folders = self.benchmark.folders()?;
        self.check_outputs(&folders)?;
        let scenes = evaluation::load(&folders)?;
        let baselines = self.benchmark.read_baselines()?;
        let ablation = Ablation { scenes: &scenes, baselines: baselines.as_ref(), seed: self.seed };
        let trials = self.try_all(&ablation)?;
        let hypotheses = self.repeat_all(&ablation)?;
        let baselines = baselines.as_ref().map(|baselines| baselines.path.as_path());
        let json = Json { seed: self.seed, scenes: scenes.len(), baselines, trials: &trials, hypotheses: &hypotheses };
        self.deliver(&json)
    }

    fn check_outputs(&self, folders: &[PathBuf]) -> Result<()> {
        let mut claims = self.benchmark.claims(folders);
        for (option, path) in [("--json", self.json.file()), ("--csv", self.csv.as_deref())] {
            path.map_or(Ok(()), |path| claims.write(option, path))?;
        }
        Ok(())
    }

    fn try_all(&self, ablation: &Ablation<'_>) -> Result<Vec<Trial>> {
        let bar = progress(self.noise.len() * Variant::ALL.len() * ablation.scenes.len(), "scenes")?;
        let all = self.noise.iter().flat_map(|&noise| Variant::ALL.map(|variant| (variant, noise)));
        let trials = all.map(|(variant, noise)| ablation.try_out(variant, noise, || bar.inc(1))).collect();
        bar.finish_and_clear();
        trials
    }

    fn repeat_all(&self, ablation: &Ablation<'_>) -> Result<Vec<Repeated>> {
        if self.repeats == 0 {
            return Ok(Vec::new());
        }
        let runs: u64 = self.noise.iter().map(|&noise| ablation::repeats(noise, self.repeats)).sum();
        let bar = progress(runs as usize * ablation.scenes.len(), "scenes")?;
        let all = self.noise.iter().flat_map(|&noise| Variant::SOURCES.map(|source| (source, noise)));
        let done = || bar.inc(1);
        let found = all.map(|(source, noise)| ablation.repeat(source, noise, self.repeats, &done)).collect();
        bar.finish_and_clear();
        found
    }

    fn deliver(&self, json: &Json<'_>) -> Result<()> {
        if let Some(path) = &self.csv {
            output::write(path, &ablation::encode_csv(json.trials)?)?;
        }
        let text = || {
            let sources =
                if json.hypotheses.is_empty() { String::new() } else { ablation::sources_text(json.hypotheses) };
            ablation::text(json.trials, json.scenes, &self.benchmark.scenes, self.seed) + &sources
        };
        self.json.deliver(|| Ok(serde_json::to_string_pretty(json)? + "\n"), text)
    }
}
