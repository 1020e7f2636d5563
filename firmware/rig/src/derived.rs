//! What follows from a description, for a user to look at.

use crate::Description;

/// Figures that follow from a description.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derived {
    /// Depth of a disparity of 1 px, m.
    pub one_px_m: f64,
    /// Least depth that the search covers, m.
    pub nearest_m: f64,
    /// Greatest finite depth that whole disparities of the search have, m.
    pub farthest_m: f64,
    /// By how much the depth changes with 1 px of disparity at 1, 2 and 5 m, m.
    pub resolution_m: [f64; 3],
    /// Angles of the view across and down, degrees.
    pub view_deg: [f64; 2],
    /// Distance from which on the ground is in the view, m; none where it never is.
    pub ground_from_m: Option<f64>,
    /// Number of sectors.
    pub sectors: usize,
    /// Bearings of the first and last sector's middle, degrees.
    pub bearings_deg: [i16; 2],
}

impl Derived {
    /// Depths at which the resolution is told, m.
    pub const DEPTHS_M: [f64; 3] = [1.0, 2.0, 5.0];

    /// The figures of a description.
    #[must_use]
    pub fn of(description: &Description) -> Self {
        let one_px_m = description.depth_mm(1.0) / 1000.0;
        let [nearest_m, farthest_m] = description.depths_mm().map(|mm| mm / 1000.0);
        let view_deg = description.view_deg();
        let lowest_ray = (view_deg[1] / 2.0 - description.pitch_deg).to_radians();
        let ground = f64::from(description.camera_height_mm) / 1000.0 / lowest_ray.tan();
        let beyond = i16::from(description.sector_deg) * i16::try_from(description.sector_count() / 2).unwrap_or(0);
        Self {
            one_px_m,
            nearest_m,
            farthest_m,
            // Depth is c / disparity, so it changes by depth^2 / c.
            resolution_m: Self::DEPTHS_M.map(|depth| depth * depth / one_px_m),
            view_deg,
            ground_from_m: (lowest_ray > 0.0).then_some(if lowest_ray < 90_f64.to_radians() { ground } else { 0.0 }),
            sectors: description.sector_count(),
            bearings_deg: [-beyond, beyond],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::template;

    #[test]
    fn the_templates_figures_are_those_of_its_geometry() {
        let mut description = Description::parse(&template()).unwrap();
        let derived = Derived::of(&description);
        assert_eq!((derived.one_px_m, derived.farthest_m, derived.sectors), (12.0, 12.0, 17));
        assert!((derived.nearest_m - 12.0 / 47.0).abs() < 1e-9);
        assert!((derived.resolution_m[1] - 4.0 / 12.0).abs() < 1e-9);
        assert!((derived.view_deg[0] - 77.32).abs() < 0.01 && (derived.view_deg[1] - 61.93).abs() < 0.01);
        // Half a view down is 120 of 200 px: 0.3 m lower is 0.5 m ahead.
        assert!((derived.ground_from_m.unwrap() - 0.5).abs() < 1e-9);
        description.pitch_deg = 31.0;
        assert_eq!(Derived::of(&description).ground_from_m, None);
        description.pitch_deg = -60.0;
        assert_eq!(Derived::of(&description).ground_from_m, Some(0.0));
    }
}
