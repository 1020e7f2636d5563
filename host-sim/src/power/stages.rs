//! What each stage of the pipeline takes: its cycles, as the chip counted them, times the power of the running program.
//!
//! The meter cannot see a stage: decoupling capacitors smear what is shorter than about a millisecond.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Result, anyhow, ensure};
use haarline::Stage;
use haarline_link::measured::{Measured, Unreadable, WORDS};
use serde::{Deserialize, Serialize};

use crate::input::whole_file;

/// What the chip counted while the current was recorded, as JSON.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Log {
    /// Clock, Hz.
    pub clock_hz: f64,
    /// How long it counted, s.
    pub seconds: f64,
    /// Frames in that time.
    pub frames: f64,
    /// Size of a frame, px.
    pub width: u32,
    /// The same.
    pub height: u32,
    /// Cycles of each stage in that time.
    pub stage_cycles: BTreeMap<String, f64>,
}

/// The share of a stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageEnergy {
    /// Its name.
    pub stage: String,
    /// Cycles a pixel.
    pub cycles_per_pixel: f64,
    /// Energy of a frame, mJ.
    pub mj_per_frame: f64,
    /// Energy of a pixel, nJ.
    pub nj_per_pixel: f64,
}

impl Log {
    /// Reads one.
    ///
    /// # Errors
    /// Names the file and what is wrong in it.
    pub fn read(path: &Path) -> Result<Self> {
        let name = path.display();
        let text = whole_file::text(path)?;
        let log = if text.trim_start().starts_with('{') {
            serde_json::from_str::<Self>(&text).map_err(|error| {
                anyhow!(
                    "{name}: needs clock_hz, seconds, frames, width, height and stage_cycles (a number for each stage): {error}"
                )
            })?
        } else {
            Self::fetched(&text).map_err(|error| anyhow!("{name}: {error}"))?
        };
        let is_right =
            [log.clock_hz, log.seconds, log.frames, log.width.into(), log.height.into()].iter().all(|&n| n > 0.0)
                && log.stage_cycles.values().all(|&cycles| cycles >= 0.0);
        ensure!(is_right, "{name}: its clock, seconds, frames and size must be positive, its cycles not negative");
        let busy = log.stage_cycles.values().sum::<f64>() / log.clock_hz;
        ensure!(
            busy <= 1.001 * log.seconds,
            "{name}: its cycles take {busy:.3} s of {} s: are clock and seconds right?",
            log.seconds
        );
        Ok(log)
    }

    /// What a probe fetched from the program's memory: hexadecimal words, in lines with or without an address before them.
    fn fetched(text: &str) -> Result<Self> {
        let words = text.split_whitespace().filter(|word| !word.ends_with(':'));
        let words = words.map(|word| u32::from_str_radix(word.trim_start_matches("0x"), 16));
        let words: Vec<u32> = words.collect::<Result<_, _>>().map_err(|_| {
            anyhow!("is neither JSON nor the hexadecimal words of `probe-rs read b32`, {WORDS} of them from HAARLINE_MEASURED on")
        })?;
        let Measured { clock_hz, uptime_ms, frames, size: [width, height], stages, .. } = Measured::of(&words)
            .map_err(|error| match error {
                Unreadable::Short => anyhow!("has {} words, where {WORDS} are needed", words.len()),
                Unreadable::Other => {
                    anyhow!("its words do not begin with those of HAARLINE_MEASURED: is the address right?")
                }
                Unreadable::Version(version) => anyhow!("is of version {version}, from another program"),
                Unreadable::Torn => anyhow!("was read while the program wrote it: read it again"),
            })?;
        Ok(Self {
            clock_hz: clock_hz.into(),
            seconds: f64::from(uptime_ms) / 1e3,
            frames: frames.into(),
            width: width.into(),
            height: height.into(),
            stage_cycles: Stage::ALL
                .iter()
                .map(|stage| stage.name().to_owned())
                .zip(stages.map(|n| n as f64))
                .collect(),
        })
    }

    /// Frames a second.
    #[must_use]
    pub fn frames_per_second(&self) -> f64 {
        self.frames / self.seconds
    }

    /// The energy of each stage, where the running program takes `watts`.
    #[must_use]
    pub fn energies(&self, watts: f64) -> Vec<StageEnergy> {
        let pixels = f64::from(self.width) * f64::from(self.height);
        let energy = |(stage, cycles): (&String, &f64)| {
            let joules = watts * cycles / self.clock_hz / self.frames;
            StageEnergy {
                stage: stage.clone(),
                cycles_per_pixel: cycles / self.frames / pixels,
                mj_per_frame: 1e3 * joules,
                nj_per_pixel: 1e9 * joules / pixels,
            }
        };
        self.stage_cycles.iter().map(energy).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_takes_its_cycles_times_the_power() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.json");
        let text = r#"{"clock_hz": 1e8, "seconds": 10, "frames": 50, "width": 100, "height": 10,
            "stage_cycles": {"seeds": 1e8, "search": 3e8}}"#;
        std::fs::write(&path, text).unwrap();
        let log = Log::read(&path).unwrap();
        assert_eq!(log.frames_per_second(), 5.0);
        let search = &log.energies(0.2)[0];
        assert_eq!((search.stage.as_str(), search.cycles_per_pixel), ("search", 6000.0));
        assert!(
            (search.mj_per_frame - 12.0).abs() < 1e-9 && (search.nj_per_pixel - 12_000.0).abs() < 1e-6,
            "{search:?}"
        );
        for (wrong, told) in [("\"seconds\": 10", "positive"), ("\"seconds\": 10, \"x\": 1", "stage_cycles")] {
            let number = if told == "positive" { "\"seconds\": -1" } else { wrong };
            std::fs::write(&path, text.replace("\"seconds\": 10", number)).unwrap();
            assert!(Log::read(&path).unwrap_err().to_string().contains(told));
        }
        let counted = Measured {
            clock_hz: 100_000_000,
            uptime_ms: 10_000,
            slept_ms: 0,
            frames: 50,
            rows: 500,
            size: [100, 10],
            stages: [40_000_000; Stage::COUNT],
        };
        let words = counted.words(3).map(|word| format!("{word:08x}"));
        std::fs::write(&path, format!("20000100: {}\n", words.join(" "))).unwrap();
        let log = Log::read(&path).unwrap();
        assert_eq!((log.frames_per_second(), log.stage_cycles["seeds"]), (5.0, 4e7));
        for (wrong, told) in [
            (words[1..].join(" "), "where 30 are needed"),
            (format!("00000000 {}", words[1..].join(" ")), "is the address right"),
            (format!("{} 00000009", words[..WORDS - 1].join(" ")), "read it again"),
            ("no words".to_owned(), "probe-rs read b32"),
        ] {
            std::fs::write(&path, wrong).unwrap();
            let error = Log::read(&path).unwrap_err().to_string();
            assert!(error.contains(told), "{error}");
        }
        std::fs::write(&path, text.replace("3e8", "3e9")).unwrap();
        assert!(Log::read(&path).unwrap_err().to_string().contains("31.000 s of 10 s"));
    }
}
