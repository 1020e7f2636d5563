//! How much of a sector is measured to be free up to a distance.

use super::lane::Lane;

/// What the rays of a row meet up to the distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Reach {
    /// Disparity of a point at the distance, 1/16 px.
    pub(super) bits: i64,
    /// Whether they run within the band of heights there; else they cross it before.
    pub(super) is_within: bool,
}

impl Reach {
    /// Whether a sure disparity of `bits` leaves the way free: it lies beyond the distance, in spite of its doubt, or is
    /// not in the band.
    pub(super) fn is_clear(&self, lane: &Lane, bits: i32, doubt: u8) -> bool {
        let is_beyond = i64::from(bits) + i64::from(doubt) <= self.bits;
        is_beyond || (!self.is_within && bits > 0 && !lane.holds(bits))
    }
}

/// Samples of a sector.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clearance {
    /// Of rays within the band at the distance: all, and those that are sure and clear.
    within: [u16; 2],
    /// The same of rays that cross the band before.
    before: [u16; 2],
}

impl Clearance {
    pub(super) const NONE: Self = Self { within: [0; 2], before: [0; 2] };
    /// Percent of the samples that must be clear.
    const LEAST_PERCENT: u32 = 80;

    /// A sample: none is not sure.
    pub(super) fn add(&mut self, reach: &Reach, sure_and_clear: Option<bool>) {
        let [all, clear] = if reach.is_within { &mut self.within } else { &mut self.before };
        *all = all.saturating_add(1);
        *clear = clear.saturating_add(u16::from(sure_and_clear == Some(true)));
    }

    pub(super) fn is_free(&self) -> bool {
        let is_clear = |[all, clear]: [u16; 2]| 100 * u32::from(clear) >= Self::LEAST_PERCENT * u32::from(all);
        self.within[0] > 0 && is_clear(self.within) && is_clear(self.before)
    }
}
