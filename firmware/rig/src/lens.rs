//! Lenses of the two cameras, and the tables that straighten their views.

use haarline::rectify::{NODE_PX, node_count};
use haarline::{Correction, LensTable};

use crate::{Description, RigError};

/// Disparities, px, that a roll may be off at the upper and lower border.
const LEAST_SHEAR_PX: f64 = 0.25;

/// How a lens bends rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lens {
    /// OpenCV's model: k1, k2, p1, p2, k3 and of the rational one k4, k5, k6.
    Radial([f64; 8]),
    /// OpenCV's fisheye, Kalibr's equidistant model: k1 to k4.
    Equidistant([f64; 4]),
}

impl Lens {
    /// Where a ray goes that comes from (x, y) at depth 1.
    #[must_use]
    pub fn bend(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let squared = x * x + y * y;
        match self {
            Self::Radial([k1, k2, p1, p2, k3, k4, k5, k6]) => {
                let above = 1.0 + squared * (k1 + squared * (k2 + squared * k3));
                let below = 1.0 + squared * (k4 + squared * (k5 + squared * k6));
                let (by, product) = (above / below, 2.0 * x * y);
                [
                    x * by + p1 * product + p2 * (squared + 2.0 * x * x),
                    y * by + p2 * product + p1 * (squared + 2.0 * y * y),
                ]
            }
            Self::Equidistant(k) => {
                let radius = squared.sqrt();
                if radius < 1e-9 {
                    return [x, y];
                }
                let angle = radius.atan();
                let square = angle * angle;
                let bent = angle * (1.0 + square * (k[0] + square * (k[1] + square * (k[2] + square * k[3]))));
                [x * bent / radius, y * bent / radius]
            }
        }
    }
}

/// A camera as it was calibrated, and how it is turned to look along the rig's common axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraModel {
    /// fx, fy, cx, cy, px.
    pub intrinsics: [f64; 4],
    /// Its lens.
    pub lens: Lens,
    /// Rotation from the camera's coordinates into the rectified ones: a vector along its axis, as long as its angle in radians.
    pub turn: [f64; 3],
}

impl CameraModel {
    /// The camera of pictures whose sides are `by` times smaller, by averages.
    #[must_use]
    pub fn shrunk(&self, by: f64) -> Self {
        let [fx, fy, cx, cy] = self.intrinsics;
        let middle = |c: f64| (c + 0.5) / by - 0.5;
        Self { intrinsics: [fx / by, fy / by, middle(cx), middle(cy)], ..*self }
    }

    /// Where the camera sees a direction of the rectified coordinates, px; `None` behind it.
    #[must_use]
    pub fn project(&self, direction: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y, z] = rotate(self.turn.map(|by| -by), direction);
        if z <= 1e-3 {
            return None;
        }
        let bent = self.lens.bend([x / z, y / z]);
        let [fx, fy, cx, cy] = self.intrinsics;
        Some([fx * bent[0] + cx, fy * bent[1] + cy])
    }
}

/// Rodrigues' rotation.
fn rotate(by: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    let angle = by.iter().map(|part| part * part).sum::<f64>().sqrt();
    if angle < 1e-12 {
        return v;
    }
    let [a, b, c] = by.map(|part| part / angle);
    let (sin, cos) = angle.sin_cos();
    let dot = (a * v[0] + b * v[1] + c * v[2]) * (1.0 - cos);
    let cross = [b * v[2] - c * v[1], c * v[0] - a * v[2], a * v[1] - b * v[0]];
    [
        v[0] * cos + cross[0] * sin + a * dot,
        v[1] * cos + cross[1] * sin + b * dot,
        v[2] * cos + cross[2] * sin + c * dot,
    ]
}

impl Description {
    /// Where a camera sees the pixel of a rectified view, px; the left camera is view 0. `None` without lenses, and where it sees nothing.
    ///
    /// Offsets, roll and scale of the right view hold, too.
    #[must_use]
    pub fn seen_at(&self, view: usize, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let camera = self.cameras.as_ref()?.get(view)?;
        let [cx, cy] = self.middle();
        let (mut at, mut axis) = ([x, y], cx);
        if view == 1 {
            let ramp = self.ramp();
            let fraction = |q16: i32| f64::from(q16) / 65_536.0;
            let beside = [self.width, self.height].map(|side| (f64::from(side) - 1.0) / 2.0);
            at[0] += f64::from(self.column_offset);
            at[1] += fraction(ramp.rows_q16)
                + fraction(ramp.roll_q16) * (at[0] - beside[0])
                + fraction(ramp.scale_q16) * (y - beside[1]);
            axis += self.doffs;
        }
        camera.project([(at[0] - axis) / self.focal_px, (at[1] - cy) / self.focal_px, 1.0])
    }

    /// The nodes of the left and the right camera's table; `None` without lenses.
    ///
    /// # Errors
    /// If a lens sees nothing of what the rectified view shows.
    pub fn lens_nodes(&self) -> Result<Option<[Vec<[i16; 2]>; 2]>, RigError> {
        if self.cameras.is_none() {
            return Ok(None);
        }
        Ok(Some([self.nodes_of(0)?, self.nodes_of(1)?]))
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "clamped; nodes are few")]
    fn nodes_of(&self, view: usize) -> Result<Vec<[i16; 2]>, RigError> {
        let [columns, rows] = [self.width, self.height].map(node_count);
        let mut nodes = Vec::with_capacity(columns * rows);
        for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
            let at = [i, j].map(|index| NODE_PX as f64 * (index as f64 - 1.0));
            let seen = self.seen_at(view, at).filter(|seen| seen.iter().all(|place| place.is_finite()));
            let seen = seen.ok_or_else(|| {
                let side = ["left", "right"][view.min(1)];
                RigError::from(format!(
                    "{side}_camera: sees nothing of a rectified view of focal_px = {}; make it longer",
                    self.focal_px
                ))
            })?;
            let most = f64::from(LensTable::MAX_NODE);
            nodes.push([0, 1].map(|k| (64.0 * (seen[k] - at[k])).round().clamp(-most, most) as i16));
        }
        Ok(nodes)
    }

    /// The tables of the left and the right camera. They stay for the program's lifetime: a rig is read once.
    ///
    /// # Errors
    /// As [`Description::lens_nodes`].
    pub fn lens_tables(&self) -> Result<Option<[LensTable; 2]>, RigError> {
        let size = [self.width, self.height];
        let Some(nodes) = self.lens_nodes()? else { return Ok(None) };
        let [left, right] = nodes.map(|nodes| LensTable::new(size, Vec::leak(nodes)));
        let tables = left.zip(right).map(|(left, right)| [left, right]);
        Ok(Some(tables.ok_or_else(|| RigError::from("left_camera, right_camera: make no lens table".to_owned()))?))
    }

    /// The correction of disparities; `None` where there is none.
    #[must_use]
    pub fn correction_table(&self) -> Option<Correction> {
        let (columns, nodes) = self.correction_nodes()?;
        Correction::new(columns, Vec::leak(nodes))
    }

    /// Columns of its nodes, and the nodes, 1/256 px: those of `disparity_correction`, else what a roll leaves.
    #[expect(clippy::cast_possible_truncation, reason = "fields are in range")]
    pub(crate) fn correction_nodes(&self) -> Option<(u16, Vec<i16>)> {
        let shear = self.shear();
        let rows = if self.correction.is_empty() { shear.as_ref().map(|rows| &rows[..])? } else { &self.correction };
        let nodes = rows.iter().flatten().map(|px| (256.0 * px).round() as i16).collect();
        Some((u16::try_from(rows.first()?.len()).ok()?, nodes))
    }

    /// What a roll of the right view adds to disparities above and takes from them below, as rows alone are put right; `None` where
    /// that is little. Lens tables turn views.
    fn shear(&self) -> Option<[Vec<f64>; 2]> {
        let border = self.roll_deg.to_radians().tan() * f64::from(self.height.max(1) - 1) / 2.0;
        let is_seen = self.cameras.is_none() && border.abs() >= LEAST_SHEAR_PX;
        is_seen.then(|| [border, -border].map(|px| vec![px; 2]))
    }

    /// Greatest distance of the tables from what the cameras see, px, and the share of both rectified views that the cameras
    /// saw, percent; `None` without lenses.
    #[must_use]
    pub fn lens_fit(&self) -> Option<[f64; 2]> {
        let tables = self.lens_tables().ok()??;
        let (mut worst, mut inside, mut count) = (0.0_f64, 0.0, 0.0);
        for (view, table) in tables.iter().enumerate() {
            for (y, x) in (0..self.height).step_by(5).flat_map(|y| (0..self.width).step_by(5).map(move |x| (y, x))) {
                let Some(seen) = self.seen_at(view, [x.into(), y.into()]) else { continue };
                let found = table.place_q16([x, y]).map(|q16| f64::from(q16) / 65_536.0);
                count += 1.0;
                let sides = [self.width, self.height].map(f64::from);
                if (0..2).all(|k| (-0.5..sides[k] - 0.5).contains(&seen[k])) {
                    inside += 1.0;
                    worst = worst.max((found[0] - seen[0]).hypot(found[1] - seen[1]));
                }
            }
        }
        Some([worst, 100.0 * inside / f64::max(count, 1.0)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::template;

    const CAMERAS: &str = "left_camera = [200.0, 201.0, 158.0, 121.0]\nleft_lens = [-0.3, 0.1, 0.001, 0.0]\n\
        left_turn = [0.01, -0.02, 0.015]\nright_camera = [199.0, 200.0, 161.0, 118.0]\nright_lens = [-0.28, 0.08, 0.0, 0.001]\nright_turn = [0.0, 0.0, -0.02]\n";

    fn description() -> Description {
        Description::parse(&(template() + CAMERAS)).unwrap()
    }

    #[test]
    fn tables_lie_where_the_cameras_look() {
        let description = description();
        let [worst, inside] = description.lens_fit().unwrap();
        assert!(worst < 0.25, "{worst}");
        assert!(inside > 90.0, "{inside}");
        let table = description.lens_tables().unwrap().unwrap()[1];
        let (found, wanted) = (table.place_q16([160, 128]), description.seen_at(1, [160.0, 128.0]).unwrap());
        for k in 0..2 {
            assert!((f64::from(found[k]) / 65_536.0 - wanted[k]).abs() < 0.02, "{found:?} {wanted:?}");
        }
    }

    #[test]
    fn a_rotation_is_rodrigues() {
        let turned = rotate([0.0, 0.0, std::f64::consts::FRAC_PI_2], [1.0, 2.0, 3.0]);
        assert!((0..3).all(|i| (turned[i] - [-2.0, 1.0, 3.0][i]).abs() < 1e-12), "{turned:?}");
        let back = rotate([-0.1, 0.2, -0.3], rotate([0.1, -0.2, 0.3], [1.0, 2.0, 3.0]));
        assert!((0..3).all(|i| (back[i] - [1.0, 2.0, 3.0][i]).abs() < 1e-12), "{back:?}");
    }

    #[test]
    fn offsets_of_the_right_view_hold_on_top_of_its_lens() {
        let plain = description();
        let moved = Description { row_offset: 2.0, column_offset: 3, ..plain.clone() };
        assert_eq!(plain.seen_at(1, [103.0, 52.0]), moved.seen_at(1, [100.0, 50.0]));
        assert_eq!(plain.seen_at(0, [100.0, 50.0]), moved.seen_at(0, [100.0, 50.0]));
    }
}
