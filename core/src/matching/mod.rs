//! Which disparity it is: `pairing` of contours gives each `seed`, `search` tries a `block` by its `cost` at a
//! few of them and walks to the `extremum`, and over a `path` neighbours agree on what it keeps, each a `label`.

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
