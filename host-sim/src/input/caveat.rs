//! What is to be said about an input that is read all the same.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::io::{self, Write as _};
use std::sync::{Mutex, PoisonError};

/// Something about an input that its user should know.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Caveat {
    /// A JPEG without its end marker.
    NoEnd,
    /// Samples of 16 bits of which so many are used.
    FewBits(u32),
    /// The views lie side by side, but their size fits views one above the other.
    RatherTopBottom,
    /// The views lie one above the other, but their size fits views side by side.
    RatherSideBySide,
    /// A recording that is cut off or damaged somewhere.
    #[cfg(feature = "mcap")]
    CutOff,
}

impl Caveat {
    fn words(self) -> String {
        match self {
            Self::NoEnd => "the JPEG has no end marker, but all of its pixels; some cameras write it so".to_owned(),
            Self::FewBits(bits) => {
                format!("its 16-bit samples have no more than {bits} bits, and are scaled as such, alike in both views")
            }
            #[cfg(feature = "mcap")]
            Self::CutOff => "is cut off or damaged; what is whole is read, what else it had is not counted".to_owned(),
            Self::RatherTopBottom => {
                "each half is a narrow view; if one view lies above the other, it is --layout top-bottom".to_owned()
            }
            Self::RatherSideBySide => {
                "each half is a very wide view; if the views lie side by side, it is --layout side-by-side".to_owned()
            }
        }
    }
}

/// Tells it on the standard error, each only once: a recording has it in every frame.
pub fn tell(caveat: Caveat, input: &dyn Display) {
    static TOLD: Mutex<BTreeSet<Caveat>> = Mutex::new(BTreeSet::new());
    if TOLD.lock().unwrap_or_else(PoisonError::into_inner).insert(caveat) {
        // Nowhere is left to tell if this fails, too.
        let _ = writeln!(io::stderr(), "warning: {input}: {}", caveat.words());
    }
}
