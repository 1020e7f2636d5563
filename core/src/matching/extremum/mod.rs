//! The Haar extremum search (section 4 of the paper, eq. 5 to 9): the only place where a minimum along a
//! cost is looked for.
//!
//! Choosing the best out of a list of candidates (hypotheses, labels, contours) is a comparison and done
//! where the list is; looking for a minimum along a cost is done here.
//!
//! The direction is a Haar wavelet over the cost itself: the costs after the present point minus those
//! before it, so that noise averages out over the support. The search goes against it until its sign
//! changes; the last two points bracket the extremum, and a new start with a shorter support refines it.
//!
//! - [`Settings`] name the paper's parameters, [`Search`] is the search in `N` parameters, [`Method`] the
//!   proposed one and those it is compared with, [`Found`] what it reports;
//! - [`descend`] is the search in whole steps with its shortest support, two samples: the walk that ends each
//!   block's search. [`parabola`] gives the fraction of a step.

mod minimum;
mod search;
mod settings;
mod support;
mod walk;

pub use minimum::{Minimum, descend, parabola};
pub use search::{Found, Method};
pub use settings::{Search, Settings, SettingsError};

/// Fraction bits of a coordinate: whole steps are multiples of `1 << FRAC_BITS`.
pub const FRAC_BITS: u32 = 16;
