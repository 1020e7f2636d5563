//! The thresholds of block matching.

/// Thresholds of block matching, named and defined as in OpenCV's StereoBM, whose defaults they have.
///
/// # Examples
/// ```
/// use haarline_tests::BlockSettings;
/// let strict = BlockSettings { uniqueness_ratio: 25, ..BlockSettings::default() };
/// assert_eq!(strict.prefilter_cap, 31);
/// assert_eq!(BlockSettings::UNGATED.texture_threshold, 0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlockSettings {
    /// The prefilter's response is cut to plus and minus this, grey levels. `1..=63`; a value outside
    /// is taken as the nearest inside.
    pub prefilter_cap: u8,
    /// Least sum of the prefilter's magnitudes over the window of the left view, grey levels.
    /// 0 switches the gate off.
    pub texture_threshold: u32,
    /// Percent by which the best cost must beat every cost more than one disparity away.
    /// 0 switches the gate off.
    pub uniqueness_ratio: u8,
}

impl BlockSettings {
    /// Least and greatest `prefilter_cap`, grey levels.
    pub const PREFILTER_CAPS: (u8, u8) = (1, 63);

    /// OpenCV's defaults: cap 31, texture 10, uniqueness 15.
    pub const OPENCV: Self = Self { prefilter_cap: 31, texture_threshold: 10, uniqueness_ratio: 15 };

    /// Both gates off: every pixel whose window and search range lie inside the views is answered.
    pub const UNGATED: Self = Self { texture_threshold: 0, uniqueness_ratio: 0, ..Self::OPENCV };

    /// The same with the cap brought into its range.
    pub(super) const fn with_valid_cap(mut self) -> Self {
        let (least, greatest) = Self::PREFILTER_CAPS;
        if self.prefilter_cap < least {
            self.prefilter_cap = least;
        } else if self.prefilter_cap > greatest {
            self.prefilter_cap = greatest;
        }
        self
    }
}

impl Default for BlockSettings {
    fn default() -> Self {
        Self::OPENCV
    }
}
