//! Why a configuration or a row is refused.

use core::fmt;

/// Why a configuration is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ConfigError {
    /// `width` must be 32 to 1280 px.
    Width,
    /// `width` is more than the method was built for.
    Capacity {
        /// Greatest width this instance can hold, px.
        max_width: u16,
    },
    /// `num_disparities` is more than the method was built for.
    DisparityCapacity {
        /// Greatest number of disparities this instance can search.
        max_disparities: u16,
    },
    /// `num_disparities` must be 1 to 256.
    NumDisparities,
    /// `num_disparities` must not exceed `width`.
    DisparitiesOverWidth,
    /// `min_disparity` must be -128 to 128 px.
    MinDisparity,
    /// The row offset is out of its range or more than the pairing was built for.
    RowOffset {
        /// Greatest magnitude this instance can hold, rows.
        max_rows: u8,
    },
    /// The column offset must be -128 to 128 px.
    ColumnOffset,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Width => f.write_str("the width must be 32 to 1280 px"),
            Self::Capacity { max_width } => write!(f, "the width is over this instance's capacity of {max_width} px"),
            Self::DisparityCapacity { max_disparities } => {
                write!(f, "the number of disparities is over this instance's capacity of {max_disparities}")
            }
            Self::NumDisparities => f.write_str("the number of disparities must be 1 to 256"),
            Self::DisparitiesOverWidth => f.write_str("the number of disparities must not exceed the width"),
            Self::MinDisparity => f.write_str("the least disparity must be -128 to 128 px"),
            Self::RowOffset { max_rows } => write!(f, "the row offset must be -{max_rows} to {max_rows} rows"),
            Self::ColumnOffset => f.write_str("the column offset must be -128 to 128 px"),
        }
    }
}

impl core::error::Error for ConfigError {}

/// Why a row is refused. The frame goes on: the row may be pushed again or reported missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RowError {
    /// Both views of a row must have the configured width.
    Width {
        /// Configured width, px.
        expected: u16,
        /// Width of the first view that differs, px.
        found: usize,
    },
}

impl fmt::Display for RowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Width { expected, found } => write!(f, "a row of {found} px where {expected} px were configured"),
        }
    }
}

impl core::error::Error for RowError {}
