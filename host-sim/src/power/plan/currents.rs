//! What chips, sensors and supply take: one file, in which each figure has its source or says that it has none.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, anyhow, ensure};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use crate::input::whole_file;
use crate::twin::cycles::Core;

/// The project's own.
const OWN: &str = include_str!("currents.toml");

/// A board that is planned for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Board {
    /// STM32H743, as on the NUCLEO-H743ZI2
    H743,
    /// STM32U575, as on the NUCLEO-U575ZI-Q
    U575,
    /// STM32F407: planned only, there is no program for it
    F407,
}

impl Board {
    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::H743 => "h743",
            Self::U575 => "u575",
            Self::F407 => "f407",
        }
    }
}

/// An image sensor that is planned with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum SensorModel {
    /// Global shutter, seven bits of each on one port
    Mt9v034,
    /// The low-power one, four bits of each on one port
    Hm01b0,
}

impl SensorModel {
    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mt9v034 => "mt9v034",
            Self::Hm01b0 => "hm01b0",
        }
    }
}

/// A current, and where it is from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Current {
    /// Milliamperes.
    pub ma: f64,
    /// The document, its revision and the table in it; all of them or none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub document: Option<String>,
    /// The same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub revision: Option<String>,
    /// The same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<String>,
    /// Why nobody looked it up, and what it is then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_verified: Option<String>,
}

impl Current {
    /// Where it is from.
    ///
    /// # Errors
    /// If it is negative, or has neither a whole source nor the mark.
    pub fn source(&self) -> Result<String> {
        ensure!(self.ma.is_finite() && self.ma >= 0.0, "a current of {} mA: must be 0 or more", self.ma);
        let parts = [&self.document, &self.revision, &self.table].map(Option::as_deref);
        match (parts, self.not_verified.as_deref()) {
            ([Some(document), Some(revision), Some(table)], None) => Ok(format!("{document} {revision}, {table}")),
            ([None, None, None], Some(why)) if !why.trim().is_empty() => Ok(format!("not verified: {why}")),
            _ => Err(anyhow!(
                "a current of {} mA needs document, revision and table, or not_verified with what it is then",
                self.ma
            )),
        }
    }
}

/// A clock, with the voltage that it asks for.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OperatingPoint {
    /// What the manual calls the voltage.
    pub name: String,
    /// Clock, MHz.
    pub mhz: f64,
    /// While it works.
    pub run: Current,
    /// While it sleeps.
    pub sleep: Current,
}

/// A chip.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chip {
    /// What reports call it.
    pub name: String,
    /// Its processor.
    pub core: Core,
    /// Its supply, V.
    pub volts: f64,
    /// The fastest first.
    pub points: Vec<OperatingPoint>,
}

/// A sensor.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// Its supply, V.
    pub volts: f64,
    /// While it takes pictures.
    pub active: Current,
    /// Between frames, where it sleeps then.
    #[serde(default)]
    pub standby: Option<Current>,
}

/// What makes the chip's voltage from the battery's.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Supply {
    /// What comes out for what goes in, 0 to 1.
    pub efficiency: f64,
    /// A document, or nothing.
    #[serde(default)]
    pub document: Option<String>,
    /// Why nobody looked it up.
    #[serde(default)]
    pub not_verified: Option<String>,
}

/// All of them.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Currents {
    h743: Chip,
    u575: Chip,
    f407: Chip,
    sensors: BTreeMap<String, Sensor>,
    /// From the battery to the chip.
    pub supply: Supply,
}

impl Currents {
    /// The project's own.
    ///
    /// # Errors
    /// If the file that is built in is damaged.
    pub fn own() -> Result<Self> {
        Self::parse(OWN).context("the project's currents")
    }

    /// The user's.
    ///
    /// # Errors
    /// Names the file and what is wrong in it.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(&whole_file::text(path)?).with_context(|| path.display().to_string())
    }

    fn parse(text: &str) -> Result<Self> {
        let currents: Self = toml::from_str(text).map_err(|error| anyhow!("{}", error.message().to_owned()))?;
        for board in Board::value_variants() {
            currents.chip(*board).check().with_context(|| board.name())?;
        }
        for (name, sensor) in &currents.sensors {
            for current in [&sensor.active].into_iter().chain(&sensor.standby) {
                current.source().with_context(|| format!("sensors.{name}"))?;
            }
            ensure!(sensor.volts > 0.0, "sensors.{name}: volts must be more than 0");
        }
        let Supply { efficiency, document, not_verified } = &currents.supply;
        ensure!((f64::MIN_POSITIVE..=1.0).contains(efficiency), "supply: efficiency {efficiency}: must be 0 to 1");
        ensure!(document.is_some() != not_verified.is_some(), "supply: needs document or not_verified");
        Ok(currents)
    }

    /// A board's chip.
    #[must_use]
    pub fn chip(&self, board: Board) -> &Chip {
        match board {
            Board::H743 => &self.h743,
            Board::U575 => &self.u575,
            Board::F407 => &self.f407,
        }
    }

    /// A sensor.
    ///
    /// # Errors
    /// If the file has none of that name.
    pub fn sensor(&self, model: SensorModel) -> Result<&Sensor> {
        let name = model.name();
        self.sensors.get(name).with_context(|| format!("the currents have no sensor {name}"))
    }
}

impl Chip {
    fn check(&self) -> Result<()> {
        ensure!(self.volts > 0.0, "volts must be more than 0");
        ensure!(!self.points.is_empty(), "needs an operating point");
        let is_falling = self.points.windows(2).all(|pair| pair[0].mhz > pair[1].mhz);
        ensure!(is_falling && self.points.iter().all(|point| point.mhz > 0.0), "points: the fastest must come first");
        for OperatingPoint { name, run, sleep, .. } in &self.points {
            run.source().and(sleep.source()).with_context(|| format!("{name}: "))?;
            ensure!(run.ma > 0.0 && run.ma >= sleep.ma, "{name}: run must be more than 0 and no less than sleep");
        }
        Ok(())
    }
}

impl Supply {
    /// Where its efficiency is from.
    #[must_use]
    pub fn source(&self) -> String {
        match (&self.document, &self.not_verified) {
            (Some(document), _) => document.clone(),
            (None, why) => format!("not verified: {}", why.as_deref().unwrap_or_default()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_current_of_ours_has_its_source_or_the_mark() {
        // Told anew from the text, so that a current that no structure reads is found, too.
        let file: toml::Table = toml::from_str(OWN).unwrap();
        let mut found = 0;
        let mut look = vec![toml::Value::Table(file)];
        while let Some(value) = look.pop() {
            match value {
                toml::Value::Table(table) => {
                    if table.contains_key("ma") || table.contains_key("efficiency") {
                        found += 1;
                        let has_source = ["document", "revision", "table"].iter().all(|key| table.contains_key(*key));
                        assert!(has_source != table.contains_key("not_verified"), "{table:?}");
                    }
                    look.extend(table.into_iter().map(|(_, value)| value));
                }
                toml::Value::Array(values) => look.extend(values),
                _ => {}
            }
        }
        assert!(found >= 20, "{found}");
        Currents::own().unwrap();
    }

    #[test]
    fn a_current_without_source_and_mark_is_refused() {
        let sleep = r#"sleep = { ma = 12, not_verified = "from memory of DS8626, sleep mode" }"#;
        let cases = [
            ("sleep = { ma = 12 }", "document, revision and table"),
            (r#"sleep = { ma = 12, document = "DS8626" }"#, "document, revision and table"),
            (r#"sleep = { ma = 12, not_verified = " " }"#, "document, revision and table"),
            (r#"sleep = { ma = 12, document = "a", revision = "1", table = "2", not_verified = "x" }"#, "document"),
            (r#"sleep = { ma = 50, not_verified = "x" }"#, "no less than sleep"),
            (r#"sleep = { ma = -1, not_verified = "x" }"#, "0 or more"),
            (r#"sleep = { ma = 12, not_verified = "x", typical = true }"#, "typical"),
        ];
        for (wrong, told) in cases {
            let error = format!("{:#}", Currents::parse(&OWN.replace(sleep, wrong)).unwrap_err());
            assert!(error.contains(told), "{wrong}: {error}");
        }
        let right = r#"sleep = { ma = 12, document = "DS8626", revision = "Rev 9", table = "Table 23" }"#;
        let read = Currents::parse(&OWN.replace(sleep, right)).unwrap();
        assert_eq!(read.chip(Board::F407).points[0].sleep.source().unwrap(), "DS8626 Rev 9, Table 23");
    }
}
