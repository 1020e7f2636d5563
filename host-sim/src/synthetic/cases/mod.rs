//! Cases: families of scenes that are rendered anew from a seed, with exact truth, each for a question that
//! recorded scenes do not answer.

mod obstacles;
mod planes;
mod repetitive;
mod walls;

use clap::ValueEnum;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{Rendering, Scene};
use crate::score::scene::Truth;

/// Columns of every scene here.
const WIDTH: usize = 320;
/// The lens's blur of every scene here, px.
const BLUR: f64 = 0.5;

/// Which family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Family {
    /// Slanted, textured planes: how exact is an answer? (the mean error, epe)
    Planes,
    /// Plain fences of period 8 to 30 px that fill the view: the views cannot tell one bar from the next
    Fences,
    /// Slats without texture before a textured garden
    Slats,
    /// Ribs and, before them, a stand and a post that hides a strip of them from the right view
    Strips,
    /// Walls without texture between textured things: the demo's room, panels and discs; only the walls are scored
    Walls,
    /// Textured posts, boxes and walls at 0.5 to 3 m on the ground, seen by the rig of haarline rig new
    Obstacles,
    /// The same, but dark, saturated or blank: what stands there may stay unknown, but is never told farther
    DimObstacles,
    /// Plain fences of period 31 to 60 px: few bars are to be seen, and what noise makes lies between them
    WideFences,
}

/// A scene of a family.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Its name: that of its folder.
    pub name: String,
    /// What to render.
    pub scene: Scene,
    /// What is scored of it.
    pub scored: Scored,
    /// Whether it is seen by the rig of [`haarline_rig::template`].
    pub has_rig: bool,
}

/// Which of the pixels that both cameras see are scored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scored {
    /// All.
    All,
    /// Those without texture.
    Blank,
}

impl Case {
    fn new(name: String, scene: Scene) -> Self {
        Self { name, scene, scored: Scored::All, has_rig: false }
    }

    /// The truth of what is scored.
    #[must_use]
    pub fn truth(&self, rendering: &Rendering) -> Truth {
        match self.scored {
            Scored::All => rendering.truth.clone(),
            Scored::Blank => rendering.blank_truth(),
        }
    }
}

impl Family {
    /// The name on the command line and in `meta.json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Planes => "planes",
            Self::Fences => "fences",
            Self::Slats => "slats",
            Self::Strips => "strips",
            Self::Walls => "walls",
            Self::Obstacles => "obstacles",
            Self::DimObstacles => "dim-obstacles",
            Self::WideFences => "wide-fences",
        }
    }

    /// Its scenes. The same seed gives the same ones, on every machine.
    #[must_use]
    pub fn cases(self, seed: u64) -> Vec<Case> {
        match self {
            Self::Planes => planes::cases(seed),
            Self::Fences => repetitive::fences(seed),
            Self::Slats => repetitive::slats(seed),
            Self::Strips => repetitive::strips(seed),
            Self::Walls => walls::cases(seed),
            Self::Obstacles => obstacles::textured(seed),
            Self::DimObstacles => obstacles::dim(seed),
            Self::WideFences => repetitive::wide_fences(seed),
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
            assert_eq!(family.to_possible_value().map(|value| value.get_name() == family.name()), Some(true));
            assert_eq!(cases, family.cases(0));
            assert_ne!(cases, family.cases(1));
            for case in cases.iter().step_by(5) {
                let (truth, layer) = case.scene.truth();
                let most = truth.scored().map(|(_, q8)| q8).max().unwrap();
                assert!(most <= (case.scene.num_disparities - 1) * 256, "{}: {most}", case.name);
                let is_scored =
                    |index: &usize| case.scored == Scored::All || case.scene.layers[layer[*index]].texture.is_blank();
                let scored = truth.scored().filter(|(index, _)| is_scored(index)).count();
                assert!(scored > 3_000, "{}: {scored}", case.name);
            }
        }
    }
}
