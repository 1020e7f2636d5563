//! From a port's bytes to pairs of rows: `wiring` takes the two views apart, `framing` finds every row's
//! place in its frame, `rectify` brings the rows of a `scanline` together.

pub mod counters;
pub mod framing;
pub mod rectify;
pub mod scanline;
pub mod wiring;
