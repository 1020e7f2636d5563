//! The texture test: whether a block shows anything that noise alone would not.
//!
//! A wall without grey-level difference matches everywhere, so its blocks would inherit what their
//! neighbours say: the foreground's disparity. Two signs together tell such a block: its features are
//! no stronger than the frame's noise explains, and it fits its match no better than two patches of
//! independent noise would, averaged over it and the blocks around it.

use crate::front_end::noise::{Noise, SmoothingLevel};
use crate::front_end::reading::Reading;

/// Mismatch of a block that shows no texture at all, percent.
pub(crate) const NO_EVIDENCE: u8 = 100;

/// The thresholds that the frame's noise asks for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Texture {
    /// Mean feature that noise explains, 1/16.
    floor: u32,
    /// Mean mismatch from which on a block at the floor is blank, percent.
    blank_mismatch: u16,
}

impl Texture {
    /// No block is blank.
    pub(crate) const OFF: Self = Self { floor: 0, blank_mismatch: u8::MAX as u16 + 1 };

    pub(crate) fn of(noise: Noise, reading: Reading) -> Self {
        // Independent noise gives 70 percent, a little less after the best of a few was picked.
        // Smoothed noise leaves real matches with little evidence of their own: be lenient there.
        let blank_mismatch = match noise.level {
            SmoothingLevel::Off => 50,
            SmoothingLevel::Light => 63,
            SmoothingLevel::Medium | SmoothingLevel::Strong => 72,
        };
        Self { floor: noise.feature_floor(reading), blank_mismatch }
    }

    /// Whether features that sum up to `energy` over `pixels` are within what noise explains.
    pub(crate) fn is_at_floor(self, energy: i32, pixels: u32) -> bool {
        energy.unsigned_abs() * 16 <= self.floor * pixels
    }

    /// The same for a single pixel, which scatters more: half as much again is allowed.
    pub(crate) fn pixel_is_at_floor(self, feature: i32) -> bool {
        feature.unsigned_abs() * 32 <= self.floor * 3
    }

    /// Whether a block at the floor is blank, given the mean mismatch around it.
    pub(crate) fn is_blank(self, mismatch_sum: u16, blocks: u16) -> bool {
        mismatch_sum >= self.blank_mismatch * blocks
    }
}

/// How badly a match fits, percent: its SAD over `energy`, the features' magnitudes in both windows.
///
/// 0 is a perfect match, about 70 two patches of independent noise.
pub(crate) fn mismatch(sad: i32, energy: i32, pixels: i32) -> u8 {
    // Half a grey level in the mean is less than quantisation leaves.
    if energy < pixels {
        return NO_EVIDENCE;
    }
    u8::try_from(sad * 100 / energy).unwrap_or(u8::MAX)
}
