//! The rig description that comes nearest to two calibrated cameras without lens tables: offset, roll and scale of the
//! rows, one disparity at infinity.

use anyhow::{Context, Result, ensure};
use nalgebra::{Matrix3, Vector2, Vector3};

use super::calibration::{Raw, Rectified};

/// Points across and down at which the cameras are looked at.
const GRID: [u32; 2] = [24, 18];

/// A rig without lens tables, and how wrong that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    /// Row offset in the middle, px.
    pub row_offset: f64,
    /// Roll of the right camera, degrees.
    pub roll_deg: f64,
    /// How much higher the right view is, percent.
    pub scale_percent: f64,
    /// Whole columns by which the right view is shifted.
    pub column_offset: i16,
    /// What is left of the disparity at infinity, px.
    pub doffs: f64,
    /// Mean focal length, px.
    pub focal_px: f64,
    /// Distance of the cameras, in the file's unit.
    pub baseline: f64,
    /// The left camera's axis, px.
    pub axis: [f64; 2],
    /// Rows and columns by which lenses and turns still miss: the root mean square and the greatest, px.
    pub row_residual: [f64; 2],
    /// The same of disparities.
    pub column_residual: [f64; 2],
}

impl Pinhole {
    /// The rectified views of one with lens tables, their sides `by` times smaller.
    #[must_use]
    pub fn shrunk(&self, by: f64) -> Self {
        Self { focal_px: self.focal_px / by, axis: self.axis.map(|c| (c + 0.5) / by - 0.5), ..*self }
    }
}

/// Of views that are rectified already nothing is missed.
#[must_use]
pub fn of_rectified(rectified: &Rectified) -> Pinhole {
    Pinhole {
        row_offset: 0.0,
        roll_deg: 0.0,
        scale_percent: 0.0,
        column_offset: 0,
        doffs: rectified.doffs,
        focal_px: rectified.focal_px,
        baseline: rectified.baseline,
        axis: rectified.axis,
        row_residual: [0.0; 2],
        column_residual: [0.0; 2],
    }
}

/// The nearest rig to raw views of `size` px.
///
/// Over a grid of the left view's points, infinitely far and at a disparity of a tenth of the width, the right view's
/// rows are fitted by least squares.
///
/// # Errors
/// If the cameras do not see the same.
pub fn of_raw(raw: &Raw, size: [u32; 2]) -> Result<Pinhole> {
    let [width, height] = size.map(f64::from);
    let middle = [(width - 1.0) / 2.0, (height - 1.0) / 2.0];
    let focal_px = (raw.left.intrinsics[0] + raw.right.intrinsics[0]) / 2.0;
    let baseline = raw.translation.norm();
    // Depths in baselines.
    let near = focal_px / (0.1 * width);
    let (mut rows, mut disparities) = (Vec::new(), Vec::new());
    for index in 0..GRID[0] * GRID[1] {
        let place = |i: u32, count: u32, size: f64| (f64::from(i) + 0.5) / f64::from(count) * size - 0.5;
        let left = Vector2::new(place(index % GRID[0], GRID[0], width), place(index / GRID[0], GRID[1], height));
        let Some(direction) = raw.left.direction(left) else { continue };
        for depth in [None, Some(near * baseline)] {
            let point = raw.rotation * direction + depth.map_or(Vector3::zeros(), |depth| raw.translation / depth);
            let Some(right) = raw.right.project(point) else { continue };
            if !(0.0..width).contains(&right.x) || !(0.0..height).contains(&right.y) {
                continue;
            }
            rows.push((right.x - middle[0], left.y - middle[1], right.y - left.y));
            if depth.is_none() {
                disparities.push(left.x - right.x);
            }
        }
    }
    ensure!(
        rows.len() >= (GRID[0] * GRID[1]) as usize / 4 && !disparities.is_empty(),
        "the two cameras do not see the same: only {} of {} points of the left view are in the right one",
        rows.len(),
        2 * GRID[0] * GRID[1]
    );
    let [offset, roll, scale] = plane(&rows).context("the rows cannot be fitted")?;
    let residuals = rows.iter().map(|&(x, y, dy)| dy - offset - roll * x - scale * y);
    let at_infinity = disparities.iter().sum::<f64>() / disparities.len() as f64;
    // Taking columns away makes every disparity greater by as many.
    let column_offset = (-at_infinity).round();
    let angle = roll.atan();
    Ok(Pinhole {
        row_offset: offset,
        roll_deg: angle.to_degrees(),
        scale_percent: 100.0 * ((1.0 + scale) * angle.cos() - 1.0),
        column_offset: column_offset as i16,
        doffs: -at_infinity - column_offset,
        focal_px,
        baseline,
        axis: [raw.left.intrinsics[2], raw.left.intrinsics[3]],
        row_residual: spread(residuals),
        column_residual: spread(disparities.iter().map(|d| d - at_infinity)),
    })
}

/// The least-squares plane `z = a + b x + c y`.
fn plane(points: &[(f64, f64, f64)]) -> Option<[f64; 3]> {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for &(x, y, z) in points {
        let row = Vector3::new(1.0, x, y);
        matrix += row * row.transpose();
        right += row * z;
    }
    let solved = matrix.cholesky()?.solve(&right);
    Some([solved.x, solved.y, solved.z])
}

/// Root mean square and greatest magnitude.
fn spread(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = values.clone().count().max(1) as f64;
    let square = values.clone().map(|value| value * value).sum::<f64>() / count;
    [square.sqrt(), values.map(f64::abs).fold(0.0, f64::max)]
}
