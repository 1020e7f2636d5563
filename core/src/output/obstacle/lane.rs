//! What a row of the left view sees: which disparities lie in the band of heights, which columns in which
//! sector, and how far away a disparity is over the ground.
//!
//! A pixel `v` = (y - middle) / focal length below the axis of a camera pitched up by p, at depth Z, lies
//! Z (sin p - v cos p) higher than the camera and Z (cos p + v sin p) ahead of it, and Z is focal length x
//! baseline / disparity. Times the focal length both are linear in y, with sin p and cos p as the only figures
//! that are not whole: no table of rows is needed.

use super::free::Reach;
use super::{Mounting, ObstacleError, Sectors};
use crate::Rig;

/// The left camera and where it stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Camera {
    width: u16,
    height: u16,
    rig: Rig,
    mounting: Mounting,
}

impl Camera {
    /// Bounds under which no product here leaves 63 bits.
    const MAX_HEIGHT: u16 = 4096;
    const MAX_FOCAL_PX_Q8: u32 = 1 << 22;
    const MAX_BASELINE_UM: u32 = 1 << 24;

    pub(super) fn new([width, height]: [u16; 2], rig: Rig, mounting: Mounting) -> Result<Self, ObstacleError> {
        if width < crate::Config::MIN_WIDTH || height > Self::MAX_HEIGHT {
            return Err(ObstacleError::Size);
        }
        if rig.focal_px_q8() > Self::MAX_FOCAL_PX_Q8 || rig.baseline_um() > Self::MAX_BASELINE_UM {
            return Err(ObstacleError::Rig);
        }
        Ok(Self { width, height, rig, mounting })
    }

    pub(super) const fn rig(&self) -> &Rig {
        &self.rig
    }

    pub(super) fn width(&self) -> usize {
        self.width.into()
    }

    /// What row `y` sees; `None` where that lies behind the camera, or outside the view.
    pub(super) fn lane(&self, y: u32, doubt: u8) -> Option<Lane> {
        let y = u16::try_from(y).ok().filter(|&y| y < self.height)?;
        let Mounting { height_mm, sin_pitch_q14, cos_pitch_q14, lowest_mm, highest_mm } = self.mounting;
        let (sin, cos) = (i64::from(sin_pitch_q14), i64::from(cos_pitch_q14));
        let focal = i64::from(self.rig.focal_px_q8());
        // 1/256 px below the axis, below 2^23. The products are below 2^37.
        let [column_q8, row_q8] = self.rig.axis_q8([self.width, self.height]).map(i64::from);
        let below_q8 = (i64::from(y) << 8) - row_q8;
        let rise_q22 = focal * sin - below_q8 * cos;
        let ahead_q22 = focal * cos + below_q8 * sin;
        if ahead_q22 <= 0 {
            return None;
        }
        let baseline = i64::from(self.rig.baseline_um());
        let rise = baseline * rise_q22;
        let above_lowest = at_least(lowest_mm - height_mm, rise, i64::from(doubt));
        let below_highest = at_least(height_mm - highest_mm, -rise, 0);
        let (least, most) = (above_lowest.0.max(below_highest.0), above_lowest.1.min(below_highest.1));
        let narrow = |bits: i64| i32::try_from(bits.clamp(0, i64::from(i16::MAX))).unwrap_or(0);
        // None has 0, and what lies beyond what it can have is nothing.
        let is_empty = least > i64::from(i16::MAX) || most < 1;
        Some(Lane {
            twice_middle: (column_q8 + 64) >> 7,
            least,
            most,
            within: if is_empty { [1, 0] } else { [narrow(least.max(1)), narrow(most)] },
            ahead_q22,
            // Below 2^24 * 2^37 / 2^22.
            ahead: u64::try_from((baseline * ahead_q22) >> 22).unwrap_or(0),
        })
    }
}

/// Least and greatest disparity, 1/16 px, of a point that lies at least `mm` over the camera, where a point
/// of disparity d lies `rise` / 2^22 µm px / d higher. Both ends are moved inwards by `doubt`.
fn at_least(mm: i32, rise: i64, doubt: i64) -> (i64, i64) {
    // mm 1000 d <= rise / 2^22, and d is in 1/16 px. Below 2^50.
    let per_step = (i64::from(mm.unsigned_abs()) * 1000) << 18;
    let quotient = |up: i64| (rise.saturating_abs() + up * (per_step - 1)) / per_step;
    let (everything, nothing) = ((1, i64::MAX), (1, 0));
    match (mm.signum(), rise >= 0) {
        (-1 | 0, true) => everything,
        (-1, false) => (quotient(1) + doubt, i64::MAX),
        (1, true) => (1, quotient(0) - doubt),
        _ => nothing,
    }
}

/// What a row sees.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lane {
    /// Twice the column of the axis.
    twice_middle: i64,
    /// Disparities within the band of heights, 1/16 px.
    least: i64,
    most: i64,
    /// Those of them that a disparity can have.
    within: [i32; 2],
    /// Focal length x distance ahead / depth, px.
    ahead_q22: i64,
    /// The same x baseline, µm px: distance ahead x disparity.
    ahead: u64,
}

impl Lane {
    /// Whether a point of that disparity, 1/16 px, lies within the band of heights.
    #[inline]
    pub(super) fn holds(&self, bits: i32) -> bool {
        (self.within[0]..=self.within[1]).contains(&bits)
    }

    /// Distance over the ground of a point of disparity `bits` > 0, mm, rounded down.
    pub(super) fn range_mm(&self, bits: u32, secant_q14: u32) -> u32 {
        // Below 2^39 * 2^18. In mm and with the disparity in 1/16 px: 1000 * 2^14 / 16.
        let numerator = self.ahead * u64::from(secant_q14);
        let denominator = u64::from(bits.max(1)) * 1000 * 1024;
        u32::try_from(numerator / denominator).unwrap_or(u32::MAX - 1)
    }

    /// What the rays of this row meet up to a distance of `range_mm` > 0 ahead; `None` where they do not come into the band
    /// of heights up to there.
    pub(super) fn reach(&self, range_mm: u32) -> Option<Reach> {
        // In mm and with the disparity in 1/16 px: 16 / 1000.
        let bits = i64::try_from(self.ahead * 16 / (u64::from(range_mm.max(1)) * 1000)).unwrap_or(i64::MAX).max(1);
        let is_within = (self.least..=self.most).contains(&bits);
        (self.least.max(bits) <= self.most).then_some(Reach { bits, is_within })
    }

    /// Where the tangent of a bearing lies: half pixels right of the middle.
    fn column_of(&self, tangent_q16: i32) -> i64 {
        // Below 2^37 * 2^20.
        (self.ahead_q22 * i64::from(tangent_q16)) >> 37
    }
}

/// Tells the sectors of columns that rise.
#[derive(Debug, Clone)]
pub(super) struct Directions<const N: usize> {
    twice_middle: i32,
    /// Where the first sector begins and each ends, half pixels right of the middle.
    left: i32,
    right: [i32; N],
    count: usize,
    /// The sector of the column asked for last, or the one before it.
    sector: usize,
}

impl<const N: usize> Directions<N> {
    /// As a row sees them.
    pub(super) fn new(lane: &Lane, sectors: &Sectors<N>) -> Self {
        let column = |tangent: i32| i32::try_from(lane.column_of(tangent)).unwrap_or(i32::MAX);
        let mut right = [i32::MAX; N];
        right.iter_mut().zip(sectors.right_borders()).for_each(|(to, tangent)| *to = column(tangent));
        let left = sectors.left_q16.first().map_or(0, |&tangent| column(tangent));
        let twice_middle = i32::try_from(lane.twice_middle).unwrap_or(i32::MAX);
        Self { twice_middle, left, right, count: sectors.count, sector: 0 }
    }

    /// The sector in which the middle of `column` lies; none is outside of all. Each column must lie right of
    /// the one before, or be the first after [`rewind`](Self::rewind).
    #[inline]
    pub(super) fn sector_of(&mut self, column: usize) -> Option<usize> {
        let at = i32::try_from(2 * column).ok()?.saturating_sub(self.twice_middle);
        if at < self.left {
            return None;
        }
        while self.right.get(self.sector).is_some_and(|&right| at >= right) {
            self.sector += 1;
        }
        (self.sector < self.count).then_some(self.sector)
    }

    /// Begins again at the left.
    pub(super) const fn rewind(&mut self) {
        self.sector = 0;
    }
}
