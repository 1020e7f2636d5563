//! Why obstacles cannot be looked for.

use core::fmt;

/// Why obstacles cannot be looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ObstacleError {
    /// The size must be 32 px or more, and at most 4096 rows.
    Size,
    /// The width is over this instance's capacity.
    Capacity {
        /// Greatest width this instance can hold, px.
        max_width: u16,
    },
    /// The focal length must be at most 16384 px, and the baseline at most 16 m.
    Rig,
    /// A height is over 20 m, the band of heights is empty, or the pitch is no angle within ±90 degrees.
    Mounting,
    /// No sector, more than there is room for, borders that do not rise, or an angle of more than 86 degrees.
    Sectors,
}

impl fmt::Display for ObstacleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size => f.write_str("the views must be 32 px wide or more, and at most 4096 rows high"),
            Self::Capacity { max_width } => write!(f, "the width is over this instance's capacity of {max_width} px"),
            Self::Rig => f.write_str("the focal length must be at most 16384 px, and the baseline at most 16 m"),
            Self::Mounting => {
                f.write_str("heights must be within 20 m, the lowest under the highest, the pitch under 90 degrees")
            }
            Self::Sectors => {
                f.write_str("the sectors must be 1 to the capacity, with borders that rise, within 86 degrees")
            }
        }
    }
}

impl core::error::Error for ObstacleError {}
