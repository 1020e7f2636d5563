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

/// Focal length and baseline of a rectified pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rig {
    /// Focal length, 1/256 px.
    focal_px_q8: u32,
    /// Distance of the cameras, µm.
    baseline_um: u32,
}

impl Rig {
    /// A rig of `focal_px_q8` / 256 px focal length and `baseline_um` µm between the cameras;
    /// `None` unless both are positive.
    #[must_use]
    pub const fn new(focal_px_q8: u32, baseline_um: u32) -> Option<Self> {
        if focal_px_q8 == 0 || baseline_um == 0 {
            return None;
        }
        Some(Self { focal_px_q8, baseline_um })
    }

    /// Depth of a point of that disparity: focal length x baseline / disparity.
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
        if bits == 0 {
            return Depth::Infinite;
        }
        if bits < 0 {
            return Depth::BehindInfinity;
        }
        // px_q8 * um * 16 / (256 * 1000 * bits): below 2^64 before the last step, since 2^32 * 2^32
        // would need both at their limit; divide by 16 first: 16 / 256 = 1 / 16.
        let numerator = self.focal_px_q8 as u64 * self.baseline_um as u64;
        let denominator = 16_000 * bits.unsigned_abs() as u64;
        let mm = numerator / denominator + (numerator % denominator >= denominator.div_ceil(2)) as u64;
        #[expect(clippy::cast_possible_truncation, reason = "bounded on the line itself")]
        let mm = if mm > u32::MAX as u64 { u32::MAX } else { mm as u32 };
        Depth::Millimetres(mm)
    }
}
