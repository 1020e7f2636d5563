//! The directions of which each is told apart.

/// Most sectors that anybody asks for: those of MAVLink's `OBSTACLE_DISTANCE`.
pub const MAX_SECTORS: usize = 72;

/// Bearing sectors from left to right, each beginning where the one before it ends. A bearing is the angle
/// in the ground plane, clockwise from straight ahead. `N` is the capacity; what lies beyond `count` does not
/// count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sectors<const N: usize> {
    /// How many there are, 1 to `N`.
    pub count: usize,
    /// Tangent of each one's left border, 1/65536, rising, within ±16.
    pub left_q16: [i32; N],
    /// Tangent of the last one's right border, 1/65536, within ±16.
    pub right_q16: i32,
    /// 1 / cosine of each one's middle, 1/16384, 1 to 16: what makes a range of a distance ahead.
    pub secant_q14: [u32; N],
}

impl<const N: usize> Sectors<N> {
    const MAX_TANGENT: i32 = 16 << 16;
    const SECANTS: core::ops::RangeInclusive<u32> = 1 << 14..=16 << 14;

    /// Tangents of the right borders.
    pub(super) fn right_borders(&self) -> impl Iterator<Item = i32> {
        let used = self.left_q16.get(1..self.count).unwrap_or(&[]);
        used.iter().copied().chain([self.right_q16])
    }

    pub(super) fn is_valid(&self) -> bool {
        if !(1..=N).contains(&self.count) {
            return false;
        }
        let fits = |tangent: i32| tangent.unsigned_abs() <= Self::MAX_TANGENT.unsigned_abs();
        let borders = self.left_q16.iter().zip(self.right_borders());
        let secants = self.secant_q14.iter().take(self.count);
        borders.into_iter().all(|(&left, right)| fits(left) && fits(right) && left < right)
            && secants.into_iter().all(|secant| Self::SECANTS.contains(secant))
    }
}
