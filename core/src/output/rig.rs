//! The rig's geometry: disparity to depth, in integers.

use crate::Disparity;

/// Distance along the optical axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Depth {
    /// Metric depth, mm, rounded to the nearest; `u32::MAX` stands for all beyond.
    Millimetres(u32),
    /// Disparity 0: too far for this rig to tell how far.
    Infinite,
    /// Negative disparity: beyond infinity for parallel cameras, so a toed-in rig or a wrong match.
    BehindInfinity,
    /// No measurement.
    Unknown,
}

/// Focal length, baseline and optical axes of a rectified pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rig {
    /// Focal length, 1/256 px.
    focal_px_q8: u32,
    /// Distance of the cameras, µm.
    baseline_um: u32,
    /// Column and row of the left camera's axis, 1/256 px, where they are known.
    axis_q8: Option<[i32; 2]>,
    /// Column of the right camera's axis less that of the left one, 1/256 px.
    doffs_q8: i32,
}

impl Rig {
    /// A rig of `focal_px_q8` / 256 px focal length and `baseline_um` µm between the cameras;
    /// `None` unless both are positive.
    #[must_use]
    pub const fn new(focal_px_q8: u32, baseline_um: u32) -> Option<Self> {
        if focal_px_q8 == 0 || baseline_um == 0 {
            return None;
        }
        Some(Self { focal_px_q8, baseline_um, axis_q8: None, doffs_q8: 0 })
    }

    /// The same with the optical axes where they are known: column and row of the left one, and the column of the right
    /// one less that of the left one (`cx`, `cy` and `doffs` of Middlebury's calibrations), 1/256 px, within ±2^22.
    #[must_use]
    pub const fn with_axes(self, axis_q8: Option<[i32; 2]>, doffs_q8: i32) -> Self {
        Self { axis_q8, doffs_q8, ..self }
    }

    /// Column and row of the left camera's axis, 1/256 px; the middle of a view of that size where they are not known.
    #[must_use]
    pub fn axis_q8(&self, [width, height]: [u16; 2]) -> [i32; 2] {
        self.axis_q8.unwrap_or([128 * (i32::from(width) - 1), 128 * (i32::from(height) - 1)])
    }

    /// Column of the right camera's axis less that of the left one, 1/256 px.
    #[must_use]
    pub const fn doffs_q8(&self) -> i32 {
        self.doffs_q8
    }

    /// The disparity that cameras with the same axes would show, to which depth is the inverse: with
    /// [`Rig::doffs_q8`] added, to 1/16 px.
    #[must_use]
    #[inline]
    pub fn without_doffs(&self, disparity: Disparity) -> Disparity {
        let Some(bits) = disparity.known() else { return Disparity::UNKNOWN };
        let bits = i32::from(bits) + self.doffs_bits();
        let bits = bits.clamp(i32::from(i16::MIN) + 1, i32::from(i16::MAX));
        Disparity::from_bits(i16::try_from(bits).unwrap_or(0))
    }

    /// [`Rig::doffs_q8`] to 1/16 px.
    pub(crate) const fn doffs_bits(&self) -> i32 {
        (self.doffs_q8 + 8) >> 4
    }

    /// Focal length, 1/256 px.
    #[must_use]
    pub const fn focal_px_q8(&self) -> u32 {
        self.focal_px_q8
    }

    /// Distance of the cameras, µm.
    #[must_use]
    pub const fn baseline_um(&self) -> u32 {
        self.baseline_um
    }

    /// Depth of a point of that disparity: focal length x baseline / (disparity + [`Rig::doffs_q8`]).
    ///
    /// # Examples
    /// ```
    /// use haarline::{Depth, Disparity, Rig};
    /// let rig = Rig::new(200 << 8, 60_000).unwrap(); // 200 px, 60 mm
    /// assert_eq!(rig.depth(Disparity::from_px(8)), Depth::Millimetres(1500));
    /// assert_eq!(rig.depth(Disparity::from_px(0)), Depth::Infinite);
    /// assert_eq!(rig.depth(Disparity::from_px(-1)), Depth::BehindInfinity);
    /// assert_eq!(rig.depth(Disparity::UNKNOWN), Depth::Unknown);
    /// ```
    #[must_use]
    pub const fn depth(&self, disparity: Disparity) -> Depth {
        let Some(bits) = disparity.known() else { return Depth::Unknown };
        let q8 = 16 * bits as i64 + self.doffs_q8 as i64;
        if q8 == 0 {
            return Depth::Infinite;
        }
        if q8 < 0 {
            return Depth::BehindInfinity;
        }
        // Both are below 2^64: px / 256 x um / 1000, by px / 256.
        let numerator = self.focal_px_q8 as u64 * self.baseline_um as u64;
        let denominator = 1000 * q8.unsigned_abs();
        let mm = numerator / denominator + (numerator % denominator >= denominator.div_ceil(2)) as u64;
        #[expect(clippy::cast_possible_truncation, reason = "bounded on the line itself")]
        let mm = if mm > u32::MAX as u64 { u32::MAX } else { mm as u32 };
        Depth::Millimetres(mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_rig_needs_a_focal_length_and_a_baseline() {
        assert_eq!(Rig::new(0, 60_000), None);
        assert_eq!(Rig::new(200 << 8, 0), None);
        assert!(Rig::new(1, 1).is_some());
    }

    #[test]
    fn depth_is_rounded_to_the_nearest_millimetre_and_half_ones_up() {
        // At 1/16 px, depth is focal length x baseline / 16 000 in these units.
        let depth = |product| Rig::new(product, 1).unwrap().depth(Disparity::from_bits(1));
        for (product, mm) in [(7_999, 0), (8_000, 1), (16_000, 1), (23_999, 1), (24_000, 2), (24_001, 2)] {
            assert_eq!(depth(product), Depth::Millimetres(mm), "{product}");
        }
    }

    #[test]
    fn depth_saturates_where_32_bits_end() {
        let one = Disparity::from_bits(1);
        let depth = |baseline_um| Rig::new(16_000, baseline_um).unwrap().depth(one);
        assert_eq!(depth(u32::MAX - 1), Depth::Millimetres(u32::MAX - 1));
        assert_eq!(depth(u32::MAX), Depth::Millimetres(u32::MAX));
        let extreme = Rig::new(u32::MAX, u32::MAX).unwrap();
        assert_eq!(extreme.depth(one), Depth::Millimetres(u32::MAX));
        assert_eq!(extreme.depth(Disparity::from_bits(i16::MAX)), Depth::Millimetres(u32::MAX));
    }

    #[test]
    fn far_behind_infinity_and_unknown_are_three_things() {
        let depth = |bits| Rig::new(200 << 8, 60_000).unwrap().depth(Disparity::from_bits(bits));
        assert_eq!(depth(0), Depth::Infinite);
        assert_eq!(depth(-1), Depth::BehindInfinity);
        assert_eq!(depth(i16::MIN + 1), Depth::BehindInfinity);
        assert_eq!(depth(i16::MIN), Depth::Unknown);
    }

    #[test]
    fn axes_that_differ_are_added_to_every_disparity() {
        let rig = Rig::new(200 << 8, 60_000).unwrap();
        let apart = rig.with_axes(Some([40_000, 30_000]), 5 << 8);
        assert_eq!(apart.depth(Disparity::from_px(3)), rig.depth(Disparity::from_px(8)));
        assert_eq!(apart.depth(Disparity::from_px(-5)), Depth::Infinite);
        assert_eq!(apart.without_doffs(Disparity::from_px(3)), Disparity::from_px(8));
        assert_eq!(apart.without_doffs(Disparity::UNKNOWN), Disparity::UNKNOWN);
        assert_eq!((rig.axis_q8([320, 240]), apart.axis_q8([320, 240])), ([40_832, 30_592], [40_000, 30_000]));
    }

    proptest! {
        #[test]
        fn depth_is_the_rounded_quotient_of_any_rig_and_disparity(
            focal_px_q8 in 1..=u32::MAX, baseline_um in 1..=u32::MAX, bits in 1..=i16::MAX, shift in 0..32_u32,
        ) {
            let rig = Rig::new((focal_px_q8 >> shift).max(1), baseline_um).unwrap();
            let product = u128::from(rig.focal_px_q8) * u128::from(rig.baseline_um);
            let divisor = 16_000 * u128::from(bits.unsigned_abs());
            let mm = (2 * product + divisor) / (2 * divisor);
            let expected = Depth::Millimetres(u32::try_from(mm).unwrap_or(u32::MAX));
            prop_assert_eq!(rig.depth(Disparity::from_bits(bits)), expected);
        }
    }
}
