//! What a method is told once, before the first row.

use crate::error::ConfigError;

/// Size of a row and range of the search, for every method.
///
/// # Examples
/// ```
/// use haarline::{Config, ConfigError};
/// let config = Config { num_disparities: 48, ..Config::for_width(320) };
/// assert_eq!(config.check(), Ok(()));
/// assert_eq!(Config { num_disparities: 0, ..config }.check(), Err(ConfigError::NumDisparities));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Config {
    /// Pixels in a row, [`Config::MIN_WIDTH`]`..=`[`Config::MAX_WIDTH`].
    pub width: u16,
    /// Least disparity searched, px, -128..=128.
    pub min_disparity: i16,
    /// How many whole disparities are searched from `min_disparity` on, `1..=256`, at most `width`.
    pub num_disparities: u16,
}

impl Config {
    /// Least width of a row, px.
    pub const MIN_WIDTH: u16 = 32;
    /// Greatest width of a row, px.
    pub const MAX_WIDTH: u16 = 1280;
    /// Greatest number of disparities.
    pub const MAX_DISPARITIES: u16 = 256;
    /// Greatest magnitude of the least disparity, px.
    pub const MAX_MIN_DISPARITY: i16 = 128;

    /// The default search for rows of `width` px: from 0, over a quarter of the width rounded up
    /// to 16, at most 256.
    #[must_use]
    pub const fn for_width(width: u16) -> Self {
        let quarter = width.div_ceil(4).next_multiple_of(16);
        let num_disparities = if quarter > Self::MAX_DISPARITIES { Self::MAX_DISPARITIES } else { quarter };
        Self { width, min_disparity: 0, num_disparities }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// Names the first field that is out of its range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        if self.width < Self::MIN_WIDTH || self.width > Self::MAX_WIDTH {
            return Err(ConfigError::Width);
        }
        if self.num_disparities == 0 || self.num_disparities > Self::MAX_DISPARITIES {
            return Err(ConfigError::NumDisparities);
        }
        if self.num_disparities > self.width {
            return Err(ConfigError::DisparitiesOverWidth);
        }
        if self.min_disparity < -Self::MAX_MIN_DISPARITY || self.min_disparity > Self::MAX_MIN_DISPARITY {
            return Err(ConfigError::MinDisparity);
        }
        Ok(())
    }

    /// Whether a whole disparity lies within the search range.
    pub(crate) fn contains(&self, disparity: i32) -> bool {
        let from = i32::from(self.min_disparity);
        (from..from + i32::from(self.num_disparities)).contains(&disparity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_field_is_held_to_its_range() {
        let valid = Config { width: 320, min_disparity: 0, num_disparities: 64 };
        let cases = [
            (Config { width: 31, ..valid }, Err(ConfigError::Width)),
            (Config { width: 32, num_disparities: 32, ..valid }, Ok(())),
            (Config { width: 1280, ..valid }, Ok(())),
            (Config { width: 1281, ..valid }, Err(ConfigError::Width)),
            (Config { num_disparities: 0, ..valid }, Err(ConfigError::NumDisparities)),
            (Config { num_disparities: 1, ..valid }, Ok(())),
            (Config { num_disparities: 256, ..valid }, Ok(())),
            (Config { num_disparities: 257, ..valid }, Err(ConfigError::NumDisparities)),
            (Config { width: 200, num_disparities: 200, ..valid }, Ok(())),
            (Config { width: 200, num_disparities: 201, ..valid }, Err(ConfigError::DisparitiesOverWidth)),
            (Config { min_disparity: -129, ..valid }, Err(ConfigError::MinDisparity)),
            (Config { min_disparity: -128, ..valid }, Ok(())),
            (Config { min_disparity: 128, ..valid }, Ok(())),
            (Config { min_disparity: 129, ..valid }, Err(ConfigError::MinDisparity)),
        ];
        for (config, expected) in cases {
            assert_eq!(config.check(), expected, "{config:?}");
        }
    }

    #[test]
    fn the_default_search_is_valid_at_every_width() {
        for width in Config::MIN_WIDTH..=Config::MAX_WIDTH {
            assert_eq!(Config::for_width(width).check(), Ok(()), "{width}");
        }
        let searched = [32, 64, 65, 320, 322, 1024, 1280].map(|width| Config::for_width(width).num_disparities);
        assert_eq!(searched, [16, 16, 32, 80, 96, 256, 256]);
    }

    #[test]
    fn the_search_range_has_both_its_ends_and_no_more() {
        let config = Config { width: 64, min_disparity: -3, num_disparities: 5 };
        let found = [-4, -3, 0, 1, 2].map(|disparity| config.contains(disparity));
        assert_eq!(found, [false, true, true, true, false]);
    }
}
