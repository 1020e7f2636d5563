//! Which disparity it is. For tiles: a `tile_seed` from contours that both views see, the search of a `tile` among a few
//! labels, the `agreement` of neighbours on them. For blocks and points: `pairing` of contours gives each `seed`, `search`
//! tries a `block` by its `cost` at a few of them, each a `label`, and the `extremum` search goes on from the best.

pub(crate) mod agreement;
pub(crate) mod alone;
pub(crate) mod block;
pub(crate) mod cost;
pub mod extremum;
pub(crate) mod label;
pub(crate) mod pairing;
pub(crate) mod path;
pub(crate) mod search;
pub(crate) mod seed;
pub(crate) mod tile;
pub(crate) mod tile_seed;
