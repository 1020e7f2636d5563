//! Contours: the extrema of the Haar response along a line, the only source of candidates.

/// A contour point: an extremum of the sliding Haar response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Contour {
    /// Column of the extremum, 1/16 px; the edge lies half a pixel before it.
    pub column: i16,
    /// Haar response there: positive from dark to bright. Its magnitude is the strength.
    pub response: i16,
}
