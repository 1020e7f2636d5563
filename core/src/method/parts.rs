//! Which parts of a method take part: for ablations.

use crate::Reading;

/// The parts of a method that can be left out or replaced to see what they bring. A product takes
/// [`Parts::ALL`]. The parts are those of [`Full`](crate::Full); [`Lite`](crate::Lite) has no agreement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// Where the hypotheses come from that no neighbour has.
    pub seeds: Seeds,
    /// What is compared.
    pub reading: Reading,
    /// The step of the extremum search from the best hypothesis.
    pub extremum: bool,
    /// The agreement of neighbours. Without: each cell takes its least cost.
    pub agreement: bool,
    /// Pre-smoothing by the noise level.
    pub smoothing: bool,
    /// The tests of evidence: without them confidence is the margin's alone.
    pub texture: bool,
}

/// Two hypotheses for each tile besides its neighbours' labels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seeds {
    /// The nearest contours that both views see.
    Contours,
    /// Random disparities, from this seed.
    Random(u32),
    /// A regular grid over the search range, moved on from tile to tile.
    Grid,
    /// None at all; the first tile of a frame begins in the middle of the range.
    None,
}

impl Parts {
    /// Everything.
    pub const ALL: Self = Self {
        seeds: Seeds::Contours,
        reading: Reading::Haar,
        extremum: true,
        agreement: true,
        smoothing: true,
        texture: true,
    };
}

impl Default for Parts {
    fn default() -> Self {
        Self::ALL
    }
}
