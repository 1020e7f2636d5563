//! ROS: a camera_info file for each camera.

use anyhow::Result;
use nalgebra::Matrix3;

use super::super::calibration::{Calibration, Camera, Rectified};
use super::{Named, camera_of, check_sizes, lens, list, matrix3, of_rectification, size};

/// A camera_info file.
pub(super) struct CameraInfo {
    camera: Camera,
    size: Vec<f64>,
    projection: Vec<f64>,
    turn: Matrix3<f64>,
}

pub(super) fn camera(file: &Named) -> Result<CameraInfo> {
    camera_of(file, |tree| {
        Ok(CameraInfo {
            camera: Camera::new(
                "camera_matrix",
                &list(tree, "camera_matrix", 9)?,
                lens(tree, "distortion_coefficients")?,
            )?,
            size: [list(tree, "image_width", 1)?, list(tree, "image_height", 1)?].concat(),
            projection: list(tree, "projection_matrix", 12)?,
            turn: matrix3(&list(tree, "rectification_matrix", 9)?),
        })
    })
}

pub(super) fn calibration([left, right]: [CameraInfo; 2]) -> Result<Calibration> {
    check_sizes(&left.size, &right.size)?;
    let rectified = Rectified::of_projections(&left.projection, &right.projection)?;
    let size = size(&left.size);
    let raw = of_rectification(left.camera, right.camera, left.turn, right.turn, rectified.baseline)?;
    Ok(Calibration {
        kind: "ROS camera_info pair",
        size,
        unit_mm: Some(1000.0),
        raw: Some(raw),
        rectified: Some(rectified),
    })
}
