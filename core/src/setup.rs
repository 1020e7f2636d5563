//! All that a program must know of its cameras, in integers: what a rig description comes down to.

use crate::output::obstacle::{Mounting, Sectors};
use crate::{Config, Rectification, Rig, Wiring};

/// A rig as the chip sees it. `SECTORS` is the capacity for bearing sectors.
///
/// The host computes it from a rig description, and firmware has it as a constant, so that both work with
/// the same numbers to the last bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setup<const SECTORS: usize> {
    /// Width of a row and range of the search.
    pub config: Config,
    /// Rows of a view.
    pub height: u16,
    /// How the cameras share the port.
    pub wiring: Wiring,
    /// What is put right of the views and of disparities.
    pub rectification: Rectification,
    /// Focal length and baseline.
    pub rig: Rig,
    /// How the cameras stand over the ground, and what is in the way.
    pub mounting: Mounting,
    /// The directions in which obstacles are looked for.
    pub sectors: Sectors<SECTORS>,
    /// The same directions and how far the rig sees, for whoever is told of obstacles.
    pub reach: Reach,
}

/// Where and how far a rig sees, in round figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reach {
    /// Angle of each sector, degrees.
    pub sector_deg: u8,
    /// Bearing of the first sector's middle, degrees clockwise from straight ahead.
    pub first_deg: i16,
    /// Least distance that the search covers, cm.
    pub nearest_cm: u16,
    /// Greatest distance of which anything is told, cm; less than 65534.
    pub farthest_cm: u16,
}
