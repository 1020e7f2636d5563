//! Studies: the paper's experiments, repeated and measured.
//!
//! A study is a function from a [`Setup`] to an [`Outcome`], and knows nothing of files; [`outcome`]
//! says what it may hold.

pub mod outcome;
pub mod same_points;

pub use outcome::{Outcome, Part, Plot, Table};
pub use same_points::{PointScore, SamePoints};

use indicatif::ProgressBar;

use crate::scene::Scene;

/// What every study is given.
pub struct Setup<'a> {
    /// Seed of everything random; the same seed gives the same bytes.
    pub seed: u64,
    /// Scenes with known truth, for the studies on frames; never empty.
    pub scenes: &'a [Scene],
    /// Where they come from, as the page shall say it.
    pub scenes_name: &'a str,
    /// Told of every step; the study sets its length.
    pub progress: &'a ProgressBar,
}
