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
    /// A half-support must be 1 to 16 px.
    HalfSupport,
    /// No scale is given, of neither direction.
    NoScale,
    /// A wavelet of that half-support is longer than the row.
    SupportOverWidth {
        /// The half-support, px.
        half_support: u8,
    },
    /// A wavelet along the columns of that half-support needs more rows than the method was built for.
    SupportCapacity {
        /// Greatest half-support along the columns that this instance has rows for; 0 is none.
        max_half_support: u8,
    },
    /// The decimated transform has half-supports of 1, 2, 4, 8 and 16 px only, along rows only.
    DecimatedScale,
    /// The width of a template must be odd, 3 to 9 px.
    TemplateWidth,
    /// The row offset is out of its range or more than the pairing was built for.
    RowOffset {
        /// Greatest magnitude this instance can hold, rows.
        max_rows: u8,
    },
    /// The column offset must be -128 to 128 px.
    ColumnOffset,
    /// The lens tables are those of views of another size.
    LensSize,
    /// Rectification needs more rows than its ring holds.
    RingRows {
        /// Rows of both views that must wait.
        needed: u16,
        /// Rows that there are.
        rows: u16,
    },
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
            Self::HalfSupport => f.write_str("a half-support must be 1 to 16 px"),
            Self::NoScale => f.write_str("no scale is given; give at least one half-support, 1 to 16 px"),
            Self::SupportOverWidth { half_support } => {
                write!(f, "a wavelet of half-support {half_support} is longer than the row; take a smaller one")
            }
            Self::SupportCapacity { max_half_support } => {
                write!(f, "this instance has rows for a half-support of {max_half_support} along the columns")
            }
            Self::DecimatedScale => {
                f.write_str("the decimated transform has half-supports of 1, 2, 4, 8 and 16 px, along rows only")
            }
            Self::TemplateWidth => f.write_str("the width of a template must be odd, 3 to 9 px"),
            Self::RowOffset { max_rows } => write!(f, "the row offset must be -{max_rows} to {max_rows} rows"),
            Self::ColumnOffset => f.write_str("the column offset must be -128 to 128 px"),
            Self::LensSize => f.write_str("the lens tables are those of views of another size"),
            Self::RingRows { needed, rows } => {
                write!(f, "rectification needs {needed} rows of both views, and its ring holds {rows}")
            }
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
