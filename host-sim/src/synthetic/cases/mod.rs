//! Cases: families of scenes that are rendered anew from a seed, with exact truth, each for a question that
//! recorded scenes do not answer.

mod planes;

use clap::ValueEnum;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::Scene;

/// Which family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Family {
    /// Slanted, textured planes: how exact is an answer? (the mean error, epe)
    Planes,
}

/// A scene of a family.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Its name: that of its folder.
    pub name: String,
    /// What to render.
    pub scene: Scene,
}

impl Family {
    /// The name on the command line and in `meta.json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Planes => "planes",
        }
    }

    /// Its scenes. The same seed gives the same ones, on every machine.
    #[must_use]
    pub fn cases(self, seed: u64) -> Vec<Case> {
        match self {
            Self::Planes => planes::cases(seed),
        }
    }
}

/// A generator for the figures of one case.
fn generator(seed: u64, family: Family, index: usize) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed ^ (family as u64 + 1) << 48 ^ (index as u64) << 32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_lies_within_its_search_and_the_seed_decides() {
        for &family in Family::value_variants() {
            let cases = family.cases(0);
            assert_eq!(cases, family.cases(0));
            assert_ne!(cases, family.cases(1));
            for Case { name, scene } in cases {
                let (truth, _) = scene.truth();
                let most = truth.scored().map(|(_, q8)| q8).max().unwrap();
                assert!(most <= (scene.num_disparities - 1) * 256, "{name}: {most}");
                assert!(truth.scored().count() > 10_000, "{name}");
            }
        }
    }
}
