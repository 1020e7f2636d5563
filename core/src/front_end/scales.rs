//! The scales at which contours are looked for.

use crate::ConfigError;

/// Half-supports of Haar wavelets, 1 to 16 px: a set of them.
///
/// The half-support is the paper's scale: pixels on either side of an edge. A larger one passes over fine
/// detail and lets large objects stand out.
///
/// # Examples
/// ```
/// use haarline::{ConfigError, Scales};
/// let scales = Scales::new(&[4, 2]).unwrap();
/// assert_eq!(scales.iter().collect::<Vec<_>>(), [2, 4]);
/// assert_eq!(Scales::new(&[17]), Err(ConfigError::HalfSupport));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Scales(u16);

impl Scales {
    /// None.
    pub const NONE: Self = Self(0);
    /// The finest, of one pixel on either side.
    pub const FINEST: Self = Self(1);
    /// Two pixels on either side.
    pub(crate) const SECOND: Self = Self(1 << 1);
    /// Greatest half-support, px.
    pub const MAX_HALF_SUPPORT: u8 = 16;

    /// Those of `half_supports`, px; the order and repetitions do not matter.
    ///
    /// # Errors
    /// If one is not 1 to 16.
    pub const fn new(half_supports: &[u8]) -> Result<Self, ConfigError> {
        let (mut set, mut rest) = (0, half_supports);
        while let [first, others @ ..] = rest {
            if *first == 0 || *first > Self::MAX_HALF_SUPPORT {
                return Err(ConfigError::HalfSupport);
            }
            set |= 1 << (*first - 1);
            rest = others;
        }
        Ok(Self(set))
    }

    /// From the finest to the coarsest, px.
    pub fn iter(self) -> impl Iterator<Item = u8> {
        (1..=Self::MAX_HALF_SUPPORT).filter(move |s| self.0 >> (s - 1) & 1 == 1)
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The greatest half-support, px; 0 if there is none.
    #[must_use]
    pub fn greatest(self) -> u8 {
        self.iter().last().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_supports_are_1_to_16() {
        for half_support in 0..=u8::MAX {
            let scales = Scales::new(&[half_support]);
            if (1..=16).contains(&half_support) {
                assert!(scales.is_ok_and(|s| s.iter().eq([half_support]) && s.greatest() == half_support));
            } else {
                assert_eq!(scales, Err(ConfigError::HalfSupport), "{half_support}");
            }
        }
        assert!(Scales::NONE.is_empty() && Scales::NONE.greatest() == 0);
    }
}
