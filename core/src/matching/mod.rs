//! Which disparity it is. A `tile_seed` from contours that both views see, the search of a `tile` of a `tile_row` among a few
//! labels, then, unless it is `settled`, the `agreement` of neighbours on them, or cells `alone`; or a `block_search`, by the
//! `extremum` search along the cost of each block. For points: `pairing` of contours.

pub(crate) mod agreement;
pub(crate) mod alone;
pub(crate) mod block_search;
pub mod extremum;
pub(crate) mod pairing;
pub(crate) mod path;
pub(crate) mod settled;
pub(crate) mod tile;
pub(crate) mod tile_row;
pub(crate) mod tile_seed;
