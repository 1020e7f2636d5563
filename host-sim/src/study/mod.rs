//! Studies: the paper's experiments, repeated and measured.
//!
//! A study is a function from a [`Setup`] to an [`Outcome`], and knows nothing of files; [`outcome`]
//! says what it may hold. [`STUDIES`] is the registry of them, [`page`] shows them, [`plot`] draws for them and
//! [`rendered`] has scenes for those who are given none.

pub mod alignment;
pub mod block;
pub mod chip;
pub mod confidence;
pub mod detail;
pub mod envelope;
pub mod noise;
pub mod outcome;
pub mod page;
pub mod plot;
pub mod rendered;
pub mod rigs;
pub mod same_points;
pub mod scaled;
pub mod schwefel;

pub use chip::{Chip, Instructions};
pub use outcome::{Outcome, Part, Plot, Table};
pub use same_points::{PointScore, SamePoints};

use anyhow::Result;
use indicatif::ProgressBar;

use crate::score::scene::Scene;

/// All studies, in the order of the page.
pub const STUDIES: &[Study] = &[
    Study {
        name: "envelope",
        about: "Fig. 1: templates around the extrema of a row, and their dispersion",
        run: envelope::run,
    },
    Study { name: "detail", about: "Fig. 2: what a longer Haar support leaves of fine structures", run: detail::run },
    Study { name: "noise", about: "Fig. 4: the extremum search against noise, and what it takes", run: noise::run },
    Study { name: "schwefel", about: "The global minimum from random starts", run: schwefel::run },
    Study { name: "alignment", about: "Two views aligned by the search in two dimensions", run: alignment::run },
    Study {
        name: "block",
        about: "Table 1: block matching against its wavelet-modified form and the other methods",
        run: block::run,
    },
    Study {
        name: "confidence",
        about: "What a confidence is worth: wrong answers by class, and what the tests of evidence bring",
        run: confidence::run,
    },
    Study {
        name: "rigs",
        about: "Section 5 at work: random rigs aligned from one frame each, row offset, roll and scale",
        run: rigs::run,
    },
];

/// A study by its name.
#[derive(Debug, Clone, Copy)]
pub struct Study {
    /// Its name on the command line; begins the names of its files.
    pub name: &'static str,
    /// What it is about, in one line.
    pub about: &'static str,
    /// Does it.
    pub run: fn(&Setup<'_>) -> Result<Outcome>,
}

/// What every study is given.
pub struct Setup<'a> {
    /// Seed of everything random; the same seed gives the same bytes.
    pub seed: u64,
    /// Scenes with known truth, for the studies on frames; never empty.
    pub scenes: &'a [Scene],
    /// Where they come from, as the page shall say it.
    pub scenes_name: &'a str,
    /// Where instructions are counted; `None` leaves them out.
    pub chip: Option<&'a Chip>,
    /// Told of every step; the study sets its length.
    pub progress: &'a ProgressBar,
}
