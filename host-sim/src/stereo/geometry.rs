//! The rig's geometry on the host: where a disparity lies in space.

use anyhow::{Result, bail, ensure};
use haarline::{Depth, Disparity, Rig};
use haarline_rig::Description;

use crate::stereo::disparity_map::px;

/// Focal length and baseline of the rectified pair, both positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// Focal length, px.
    pub focal_px: f64,
    /// Distance of the cameras, mm.
    pub baseline_mm: f64,
    /// Column and row of the left camera's axis, px, where they are known.
    pub principal: [Option<f64>; 2],
    /// Column of the right camera's axis less that of the left one, px: added to every disparity.
    pub doffs: f64,
    rig: Rig,
}

impl Geometry {
    /// From the two options of the command line.
    ///
    /// # Errors
    /// If one comes without the other, or is not a positive number the core can hold.
    pub fn from_options(focal_px: Option<f64>, baseline_mm: Option<f64>) -> Result<Option<Self>> {
        match (focal_px, baseline_mm) {
            (None, None) => Ok(None),
            (Some(focal_px), Some(baseline_mm)) => Self::new(focal_px, baseline_mm).map(Some),
            (Some(_), None) => bail!("--focal-px needs --baseline-mm too, the distance of the cameras in mm"),
            (None, Some(_)) => bail!("--baseline-mm needs --focal-px too, the focal length in px"),
        }
    }

    /// From both figures.
    ///
    /// # Errors
    /// If one is not a positive number the core can hold.
    pub fn new(focal_px: f64, baseline_mm: f64) -> Result<Self> {
        // Where a length was told in other units, what follows would be wrong in silence.
        ensure!((10.0..=10_000.0).contains(&focal_px), "--focal-px {focal_px}: must be 10 to 10000 px");
        ensure!((1.0..=10_000.0).contains(&baseline_mm), "--baseline-mm {baseline_mm}: must be 1 to 10000 mm");
        let focal_px_q8 = scaled("--focal-px", focal_px, 256.0)?;
        let baseline_um = scaled("--baseline-mm", baseline_mm, 1000.0)?;
        match Rig::new(focal_px_q8, baseline_um) {
            Some(rig) => Ok(Self { focal_px, baseline_mm, principal: [None; 2], doffs: 0.0, rig }),
            None => bail!("--focal-px {focal_px} and --baseline-mm {baseline_mm}: must be positive"),
        }
    }

    /// That of a rig description.
    ///
    /// # Errors
    /// If a figure is not one the core can hold.
    pub fn of_rig(rig: &Description) -> Result<Self> {
        let core = rig.plan()?.rig;
        Ok(Self { principal: rig.principal, doffs: rig.doffs, rig: core, ..Self::new(rig.focal_px, rig.baseline_mm)? })
    }

    /// Depth as the chip computes it, in whole mm; `None` where it is not finite.
    #[must_use]
    pub fn depth_mm(&self, disparity: Disparity) -> Option<u32> {
        match self.rig.depth(disparity) {
            Depth::Millimetres(mm) => Some(mm),
            Depth::Infinite | Depth::BehindInfinity | Depth::Unknown => None,
        }
    }

    /// Depth of a disparity in px, m; `None` where it is not finite.
    #[must_use]
    pub fn depth_m(&self, disparity_px: f64) -> Option<f64> {
        let disparity_px = disparity_px + self.doffs;
        (disparity_px > 0.0).then(|| self.focal_px * self.baseline_mm / disparity_px / 1000.0)
    }

    /// The point seen in column `x` of row `y` of frames of `size` px: m to the right, down and
    /// forward of the left camera, whose axis goes through the middle of the frame where it is not known.
    #[must_use]
    pub fn point_m(&self, [x, y]: [usize; 2], size: [usize; 2], disparity: Disparity) -> Option<[f32; 3]> {
        let depth = self.depth_m(px(disparity.known()?))?;
        let off_axis = |j: usize, at: usize| {
            let axis = self.principal[j].unwrap_or((size[j] as f64 - 1.0) / 2.0);
            (at as f64 - axis) * depth / self.focal_px
        };
        Some([off_axis(0, x) as f32, off_axis(1, y) as f32, depth as f32])
    }
}

/// `value` in steps of 1 / `scale`, as the core takes it.
fn scaled(option: &str, value: f64, scale: f64) -> Result<u32> {
    ensure!(value.is_finite() && value > 0.0, "{option} {value}: must be a positive number");
    let steps = (value * scale).round();
    let (least, most) = (1.0 / scale, f64::from(u32::MAX) / scale);
    ensure!((1.0..=f64::from(u32::MAX)).contains(&steps), "{option} {value}: must be {least} to {most:.0}");
    Ok(steps as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_given_or_not_positive_is_refused() {
        assert!(Geometry::from_options(None, None).unwrap().is_none());
        let cases = [(Some(200.0), None), (None, Some(60.0)), (Some(0.0), Some(60.0)), (Some(200.0), Some(-1.0))];
        let odd = [(Some(f64::NAN), Some(60.0)), (Some(f64::INFINITY), Some(60.0)), (Some(1e-9), Some(60.0))];
        for (focal_px, baseline_mm) in cases.into_iter().chain(odd) {
            assert!(Geometry::from_options(focal_px, baseline_mm).is_err(), "{focal_px:?} {baseline_mm:?}");
        }
    }

    #[test]
    fn a_point_lies_on_its_ray() {
        let geometry = Geometry::new(200.0, 60.0).unwrap();
        let size = [321, 241];
        assert_eq!(geometry.point_m([160, 120], size, Disparity::from_px(8)), Some([0.0, 0.0, 1.5]));
        assert_eq!(geometry.point_m([260, 20], size, Disparity::from_px(8)), Some([0.75, -0.75, 1.5]));
        assert_eq!(geometry.point_m([0, 0], size, Disparity::from_px(0)), None);
        assert_eq!(geometry.point_m([0, 0], size, Disparity::from_px(-2)), None);
        assert_eq!(geometry.point_m([0, 0], size, Disparity::UNKNOWN), None);
        assert_eq!(geometry.depth_mm(Disparity::from_px(8)), Some(1500));
    }

    #[test]
    fn a_rigs_axis_and_doffs_move_the_point() {
        let text = haarline_rig::with_fields(
            &haarline_rig::template(),
            &[("cx", "140.5".to_owned()), ("cy", "130".to_owned()), ("doffs", "5.0".to_owned())],
        );
        let geometry = Geometry::of_rig(&Description::parse(&text).unwrap()).unwrap();
        let point = geometry.point_m([240, 30], [320, 240], Disparity::from_px(3)).unwrap();
        // 12 px m / 8 px; 99.5 and -100 px of 200 from the axis.
        assert_eq!(point, [0.746_25, -0.75, 1.5]);
        assert_eq!(geometry.depth_mm(Disparity::from_px(3)), Some(1500));
        assert_eq!(geometry.depth_m(-5.0), None);
    }
}
