//! The rig that this was built for: `PLAN`, written by `build.rs`.

include!(concat!(env!("OUT_DIR"), "/rig.rs"));

/// Bearing sectors of the rig.
pub const SECTORS: usize = PLAN.sectors;
