//! Names of wirings on command lines.

use super::{First, Kind, Skew};

/// Gives an enum its names: all its values, the name of each, and the value of a name.
macro_rules! named {
    ($type:ident, $($variant:ident: $name:literal),+) => {
        impl $type {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// Its name on a command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }

            /// The one of this name.
            #[must_use]
            pub fn from_name(name: &str) -> Option<Self> {
                match name {
                    $($name => Some(Self::$variant),)+
                    _ => None,
                }
            }
        }
    };
}

named!(
    Kind,
    PixelInterleaved: "pixel",
    LineInterleaved: "line",
    SideBySide: "side-by-side",
    Nibbles: "nibble",
    Pairs16: "pairs16",
    Pairs14: "pairs14"
);
named!(First, Left: "left", Right: "right");
named!(Skew, None: "none", Left: "left", Right: "right");
