//! Two calibrated cameras: what a calibration file comes down to.

use anyhow::{Result, ensure};
use haarline_rig::Lens;
use nalgebra::{Matrix3, Vector2, Vector3};

/// OpenCV's coefficients: 4, 5, 8, 12 or 14, of which thin prisms and a tilted sensor must be 0; none are no distortion.
///
/// # Errors
/// If there are so many or such that they are not read.
pub fn radial(name: &str, coefficients: &[f64]) -> Result<Lens> {
    let count = coefficients.len();
    ensure!(
        [0, 4, 5, 8, 12, 14].contains(&count),
        "{name}: has {count} coefficients, where OpenCV's model needs 4, 5, 8, 12 or 14"
    );
    ensure!(
        coefficients.iter().skip(8).all(|&c| c == 0.0),
        "{name}: thin prism and tilted sensor (its coefficients from the 9th on) are not read; calibrate without them"
    );
    let mut of_model = [0.0; 8];
    of_model.iter_mut().zip(coefficients).for_each(|(place, &value)| *place = value);
    Ok(Lens::Radial(of_model))
}

/// Where a ray goes that comes from (x, y) at depth 1.
#[must_use]
pub fn bend(lens: &Lens, ray: Vector2<f64>) -> Vector2<f64> {
    lens.bend(ray.into()).into()
}

/// Where a ray comes from that goes to `bent`; `None` where none does.
#[must_use]
pub fn straighten(lens: &Lens, bent: Vector2<f64>) -> Option<Vector2<f64>> {
    let mut ray = bent;
    for _ in 0..100 {
        let wrong = bend(lens, ray) - bent;
        if wrong.norm() < 1e-10 {
            return Some(ray);
        }
        // Newton's step with the differences for the derivative.
        let step = 1e-6;
        let along = |by: Vector2<f64>| (bend(lens, ray + by) - bend(lens, ray - by)) / (2.0 * step);
        let (x, y) = (along(Vector2::new(step, 0.0)), along(Vector2::new(0.0, step)));
        let det = x.x * y.y - y.x * x.y;
        if det <= 1e-6 {
            return None;
        }
        ray -= Vector2::new(wrong.x * y.y - wrong.y * y.x, wrong.y * x.x - wrong.x * x.y) / det;
    }
    None
}

/// A camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// fx, fy, cx, cy, px.
    pub intrinsics: [f64; 4],
    /// Its lens.
    pub lens: Lens,
}

impl Camera {
    /// Of a camera matrix.
    ///
    /// # Errors
    /// If that is none.
    pub fn new(name: &str, matrix: &[f64], lens: Lens) -> Result<Self> {
        ensure!(matrix.len() == 9, "{name}: has {} numbers, where a camera matrix has 9", matrix.len());
        ensure!(
            matrix[6] == 0.0 && matrix[7] == 0.0,
            "{name}: is transposed, as MATLAB has it: [fx 0 cx; 0 fy cy; 0 0 1] is expected, row by row"
        );
        ensure!(
            matrix[0] > 0.0 && matrix[4] > 0.0 && matrix[1].abs() < 1e-6 * matrix[0] && matrix[8] == 1.0,
            "{name}: is no camera matrix [fx 0 cx; 0 fy cy; 0 0 1]"
        );
        Ok(Self { intrinsics: [matrix[0], matrix[4], matrix[2], matrix[5]], lens })
    }

    /// Where a direction is seen, px.
    #[must_use]
    pub fn project(&self, direction: Vector3<f64>) -> Option<Vector2<f64>> {
        let [fx, fy, cx, cy] = self.intrinsics;
        if direction.z <= 0.0 {
            return None;
        }
        let bent = bend(&self.lens, direction.xy() / direction.z);
        Some(Vector2::new(fx * bent.x + cx, fy * bent.y + cy))
    }

    /// The direction that a pixel sees.
    #[must_use]
    pub fn direction(&self, pixel: Vector2<f64>) -> Option<Vector3<f64>> {
        let [fx, fy, cx, cy] = self.intrinsics;
        let ray = straighten(&self.lens, Vector2::new((pixel.x - cx) / fx, (pixel.y - cy) / fy))?;
        Some(Vector3::new(ray.x, ray.y, 1.0))
    }

    /// The camera of a picture whose sides are `by` times smaller, by averages.
    #[must_use]
    pub fn shrunk(&self, by: f64) -> Self {
        let [fx, fy, cx, cy] = self.intrinsics;
        let middle = |c: f64| (c + 0.5) / by - 0.5;
        Self { intrinsics: [fx / by, fy / by, middle(cx), middle(cy)], lens: self.lens }
    }
}

/// Cameras as they were: raw views.
#[derive(Debug, Clone, PartialEq)]
pub struct Raw {
    /// The left one.
    pub left: Camera,
    /// The right one.
    pub right: Camera,
    /// Rotation of the left camera's coordinates into the right one's.
    pub rotation: Matrix3<f64>,
    /// Translation after it: the left camera in the right one's coordinates; in the file's unit.
    pub translation: Vector3<f64>,
}

/// Views that are rectified already.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectified {
    /// Focal length, px.
    pub focal_px: f64,
    /// Distance of the cameras, in the file's unit.
    pub baseline: f64,
    /// The left camera's axis, px.
    pub axis: [f64; 2],
    /// Column of the right camera's axis less that of the left one, px.
    pub doffs: f64,
}

/// What a file tells; one of the two at least.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// What kind of file it was, for the user.
    pub kind: &'static str,
    /// Columns and rows of a view, if told.
    pub size: Option<[u32; 2]>,
    /// Millimetres of a unit of length, if the kind tells it.
    pub unit_mm: Option<f64>,
    /// The cameras as they were.
    pub raw: Option<Raw>,
    /// The rectified views.
    pub rectified: Option<Rectified>,
}

impl Rectified {
    /// Of the projections of both views (3 x 4).
    ///
    /// # Errors
    /// If they are not those of rectified views in this order.
    pub fn of_projections(left: &[f64], right: &[f64]) -> Result<Self> {
        ensure!(left.len() == 12 && right.len() == 12, "a projection matrix has 12 numbers");
        let (fl, fr) = (left[0], right[0]);
        ensure!(
            fl > 0.0 && (fl - fr).abs() < 1e-3 * fl,
            "the focal lengths of the projections differ: {fl} and {fr} px"
        );
        ensure!(
            (left[6] - right[6]).abs() < 0.01,
            "the rows of the projections' axes differ: {} and {}; these are no rectified views side by side",
            left[6],
            right[6]
        );
        // Each tells where its camera is against a common one.
        let baseline = (left[3] - right[3]) / fl;
        ensure!(
            baseline != 0.0,
            "the projections tell no distance between the cameras: both are of one camera, or each camera was calibrated \
             alone; a stereo calibration is needed"
        );
        ensure!(baseline > 0.0, "left and right are exchanged: the first camera stands on the right of the second one");
        Ok(Self { focal_px: fl, baseline, axis: [left[2], left[6]], doffs: right[2] - left[2] })
    }

    /// The same for pictures whose sides are `by` times smaller.
    #[must_use]
    pub fn shrunk(&self, by: f64) -> Self {
        Self {
            focal_px: self.focal_px / by,
            axis: self.axis.map(|c| (c + 0.5) / by - 0.5),
            doffs: self.doffs / by,
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lenses_straighten_what_they_bend() {
        let lenses = [
            radial("D", &[-0.3, 0.1, 0.001, -0.002, 0.02]).unwrap(),
            radial("D", &[0.2, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap(),
            Lens::Equidistant([0.01, -0.002, 0.0003, 0.0]),
        ];
        for lens in lenses {
            for ray in [[0.0, 0.0], [0.5, -0.3], [-0.6, 0.45]] {
                let ray = Vector2::from(ray);
                assert!((straighten(&lens, bend(&lens, ray)).unwrap() - ray).norm() < 1e-8, "{lens:?} {ray}");
            }
        }
        assert!(
            radial("D", &[0.1; 14]).is_err() && [2, 3].iter().all(|&count| radial("D", &[0.1; 3][..count]).is_err())
        );
    }

    #[test]
    fn a_bent_ray_is_opencvs() {
        // cv2.projectPoints of (0.3, -0.2, 1) with fx 300, fy 310, cx 160, cy 120.
        let lens = radial("D", &[-0.3, 0.1, 0.001, -0.002, 0.05]).unwrap();
        let camera = Camera { intrinsics: [300.0, 310.0, 160.0, 120.0], lens };
        let seen = camera.project(Vector3::new(0.3, -0.2, 1.0)).unwrap();
        assert!((seen - Vector2::new(OPENCV[0], OPENCV[1])).norm() < 1e-4, "{seen}");
    }

    const OPENCV: [f64; 2] = [246.429_986_5, 60.445_909_3];
}
