//! The rig that this was built for: `SETUP` and `SECTORS`, written by `build.rs`.

include!(concat!(env!("OUT_DIR"), "/rig.rs"));
