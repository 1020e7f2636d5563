//! The rectified views of two calibrated cameras with lenses: turned to each other, focal length and vertical centre chosen so
//! that few rows must wait.

use anyhow::{Result, ensure};
use haarline_rig::{CameraModel, Description, Lens, template};
use nalgebra::{Matrix3, Rotation3, Vector2, Vector3};

use super::calibration::{Camera, Raw};
use super::pinhole::Pinhole;

/// Share of both views that the cameras must have seen: all of both where some focal length allows it, since rows that one of
/// them did not see have no answer.
const LEAST_INSIDE: [f64; 2] = [1.0, 0.99];
/// Focal lengths that are tried, of the mean one, percent.
const FOCAL_PERCENT: std::ops::RangeInclusive<u32> = 50..=160;
/// Vertical centres that are tried, px from the middle one.
const CENTRES: [f64; 7] = [0.0, 2.0, -2.0, 4.0, -4.0, 8.0, -8.0];
/// Rows that a percent of focal length must save.
const ROWS_A_PERCENT: f64 = 1.0;
/// Distance of the points that are looked at, px across and down.
const GRID: [u32; 2] = [12, 4];

/// The rig, and both cameras' lenses and turns.
///
/// # Errors
/// If the lenses are of two models, or the cameras do not see the same.
pub fn of_raw(raw: &Raw, size: [u32; 2], residuals: &Pinhole) -> Result<(Pinhole, [CameraModel; 2])> {
    let model = |lens: &Lens| match lens {
        Lens::Radial(_) => "radial-tangential",
        Lens::Equidistant(_) => "equidistant",
    };
    let (left, right) = (model(&raw.left.lens), model(&raw.right.lens));
    ensure!(
        left == right,
        "the left camera's lens is {left}, the right one's {right}: calibrate both cameras with one model"
    );
    let turns = turns(raw)?;
    let cameras = [(&raw.left, turns[0]), (&raw.right, turns[1])];
    let models = cameras.map(|(camera, turn)| CameraModel {
        intrinsics: camera.intrinsics,
        lens: camera.lens,
        turn: Rotation3::from_matrix_unchecked(turn).scaled_axis().into(),
    });
    let middle = size.map(|px| (f64::from(px) - 1.0) / 2.0);
    // Where both look in the middle, at depth 1.
    let looks = cameras.map(|(camera, turn)| look(camera, turn, middle));
    let look = (looks[0] + looks[1]) / 2.0;
    let mean_focal =
        (raw.left.intrinsics[..2].iter().sum::<f64>() + raw.right.intrinsics[..2].iter().sum::<f64>()) / 4.0;
    let mut base = haarline_rig::Description::parse(&template())?;
    (base.width, base.height) = (size[0] as u16, size[1] as u16);
    base.cameras = Some(models);
    let candidate = |percent: u32, centre: f64| {
        let focal_px = mean_focal * f64::from(percent) / 100.0;
        let axis = [middle[0] - focal_px * look.x, middle[1] - focal_px * look.y + centre];
        Description { focal_px, principal: axis.map(Some), ..base.clone() }
    };
    let find = |inside: f64| {
        let mut focal = FOCAL_PERCENT.clone();
        focal.find(|&percent| survey(&candidate(percent, 0.0)).0 >= inside).map(|percent| (percent, inside))
    };
    let least = LEAST_INSIDE.into_iter().find_map(find);
    ensure!(
        least.is_some(),
        "the two cameras do not see the same: no focal length up to {} times their own fills both views; is the size that of \
         the calibrated pictures?",
        f64::from(*FOCAL_PERCENT.end()) / 100.0
    );
    let (least, least_inside) = least.unwrap_or((100, 0.0));
    let mut best: Option<(f64, Description)> = None;
    for percent in (least..=least + 20).step_by(2) {
        for centre in CENTRES {
            let description = candidate(percent, centre);
            let (inside, rows) = survey(&description);
            let cost = f64::from(rows) + ROWS_A_PERCENT * f64::from(percent - least) + 0.01 * centre.abs();
            if inside >= least_inside && best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, description));
            }
        }
    }
    let chosen = best.map_or_else(|| candidate(least, 0.0), |(_, description)| description);
    let rig = Pinhole {
        row_offset: 0.0,
        roll_deg: 0.0,
        scale_percent: 0.0,
        column_offset: 0,
        doffs: 0.0,
        focal_px: chosen.focal_px,
        axis: chosen.middle(),
        ..*residuals
    };
    Ok((rig, models))
}

/// Rotations of both cameras' coordinates into common ones, whose x axis leads from one to the other.
fn turns(raw: &Raw) -> Result<[Matrix3<f64>; 2]> {
    let back = raw.rotation.transpose();
    let x = (-(back * raw.translation)).normalize();
    let ahead = Vector3::z() + back * Vector3::z();
    let y = ahead.cross(&x);
    ensure!(y.norm() > 0.1, "the cameras look along the line between them");
    let y = y.normalize();
    let left = Matrix3::from_rows(&[x.transpose(), y.transpose(), x.cross(&y).transpose()]);
    Ok([left, left * back])
}

/// Where a camera looks in the middle of its view, in common coordinates at depth 1.
fn look(camera: &Camera, turn: Matrix3<f64>, middle: [f64; 2]) -> Vector2<f64> {
    let direction = camera.direction(Vector2::from(middle)).unwrap_or_else(Vector3::z);
    let turned = turn * direction;
    turned.xy() / turned.z
}

/// Share of both views that the cameras saw, and rows that must wait, nearly.
fn survey(rig: &Description) -> (f64, u32) {
    let (width, height) = (u32::from(rig.width), u32::from(rig.height));
    let last = f64::from(height) - 1.0;
    let (mut inside, mut count) = (0_u32, 0_u32);
    let (mut ready, mut rows) = (0.0_f64, [0.0_f64; 2]);
    for y in (0..height).step_by(GRID[1] as usize) {
        let mut reach = [[f64::MAX, f64::MIN]; 2];
        for (view, x) in
            (0..2).flat_map(|view| (0..=width / GRID[0]).map(move |i| (view, (i * GRID[0]).min(width - 1))))
        {
            count += 1;
            let Some([u, v]) = rig.seen_at(view, [x.into(), y.into()]) else { continue };
            inside += u32::from((-0.5..f64::from(width) - 0.5).contains(&u) && (-0.5..last + 0.5).contains(&v));
            reach[view] = [reach[view][0].min(v), reach[view][1].max(v)];
        }
        ready = reach.iter().map(|reach| (reach[1].floor() + 1.0).clamp(0.0, last) + 1.0).fold(ready, f64::max);
        for (rows, reach) in rows.iter_mut().zip(reach) {
            *rows = rows.max(ready - reach[0].floor().clamp(0.0, last));
        }
    }
    (f64::from(inside) / f64::from(count), (rows[0] + rows[1]) as u32)
}
