//! How accurate the methods are, stored beside what they cost.

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use super::counting::METHODS;
use super::counts::Input;
use crate::score::degrade::Degradation;
use crate::score::evaluation::{Evaluator, Mean, Source};
use crate::score::scene::Scene;
use crate::stereo::method::MethodKind;

/// The stored figures, as `haarline power count` makes them.
const STORED: &str = include_str!("accuracy.csv");

/// Mean figures of a method over scenes, as `haarline eval` tells them: a line of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// The method's name.
    pub method: String,
    /// What was done to the scenes.
    pub input: Input,
    /// How many they are.
    pub scenes: usize,
    /// Answered pixels, %.
    pub density: f64,
    /// Answers off by more than 2 px, % of the answered.
    pub bad2: f64,
    /// Off by more than 2 px or unanswered, % of the scored.
    pub tot2: f64,
}

impl Accuracy {
    /// Scores every method of the chip on the scenes, clean and noisy.
    ///
    /// # Errors
    /// If a scene's configuration is refused.
    pub fn measure(scenes: &[Scene], done: impl Fn() + Sync) -> Result<Vec<Self>> {
        let mut found = Vec::new();
        for method in METHODS {
            for (input, noise) in [(Input::Clean, 0.0), (Input::Noisy, Input::NOISE)] {
                let build = |config| method.build(config);
                let degradation = Degradation { noise, ..Degradation::default() };
                let evaluator = Evaluator { degradation, ..Evaluator::of(Source::Method(&build)) };
                let scores = evaluator.run(scenes, &done)?;
                let mean = Mean::of(scores.iter()).context("no scene")?.score.all;
                let hundredths = |value: f64| (100.0 * value).round() / 100.0;
                found.push(Self {
                    method: method.name().to_owned(),
                    input,
                    scenes: scenes.len(),
                    density: hundredths(mean.density),
                    bad2: hundredths(mean.bad2.unwrap_or(100.0)),
                    tot2: hundredths(mean.tot2),
                });
            }
        }
        Ok(found)
    }

    /// The stored figures.
    ///
    /// # Errors
    /// If the file that they are stored in is damaged.
    pub fn stored() -> Result<Vec<Self>> {
        let mut reader = csv::Reader::from_reader(STORED.as_bytes());
        reader.deserialize().collect::<Result<_, _>>().context("the stored accuracy")
    }

    /// As a file.
    ///
    /// # Errors
    /// None that is known of.
    pub fn encode(all: &[Self]) -> Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        all.iter().try_for_each(|one| writer.serialize(one))?;
        Ok(writer.into_inner()?)
    }

    /// That of a method, if it was scored.
    #[must_use]
    pub fn of(all: &[Self], method: MethodKind, input: Input) -> Option<&Self> {
        all.iter().find(|one| one.method == method.name() && one.input == input)
    }
}
