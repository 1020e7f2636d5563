//! Which parts of a method take part: for ablations.

/// The parts of a method that can be left out to see what they bring. A product takes
/// [`Parts::ALL`]. The parts are those of [`Full`](crate::Full); [`Lite`](crate::Lite) has no agreement,
/// never tries all disparities, and without seeds it finds nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// Hypotheses from contour seeds. Without: from neighbours, and all disparities in the first
    /// block row.
    pub seeds: bool,
    /// The walk of the extremum search from the best hypothesis.
    pub extremum: bool,
    /// The agreement of neighbours. Without: each block's greedy choice stands.
    pub agreement: bool,
    /// Pre-smoothing by the noise level.
    pub smoothing: bool,
    /// The texture test.
    pub texture: bool,
    /// Instead of hypotheses every block tries all disparities.
    pub exhaustive: bool,
}

impl Parts {
    /// Everything, and hypotheses instead of all disparities.
    pub const ALL: Self =
        Self { seeds: true, extremum: true, agreement: true, smoothing: true, texture: true, exhaustive: false };
}

impl Default for Parts {
    fn default() -> Self {
        Self::ALL
    }
}
