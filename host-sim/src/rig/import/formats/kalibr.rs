//! Kalibr: a chain of cameras.

use anyhow::{Context, Result, ensure};
use nalgebra::Matrix4;
use serde_json::Value;

use super::super::calibration::{Calibration, Camera, Raw};
use super::{Tree, check_order, check_rotation, check_sizes, lens, list, size, word};

/// A pinhole camera as Kalibr and EuRoC write it.
pub(super) fn pinhole(tree: &Tree, coefficients: &str) -> Result<Camera> {
    let model = word(tree, "camera_model")?;
    ensure!(model == "pinhole", "the camera model {model} is not read: calibrate with pinhole");
    let k = list(tree, "intrinsics", 4)?;
    Camera::new("intrinsics", &[k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0], lens(tree, coefficients)?)
}

pub(super) fn matrix4(tree: &Tree, name: &str) -> Result<Matrix4<f64>> {
    Ok(Matrix4::from_row_slice(&list(tree, name, 16)?))
}

/// The raw cameras from the left one's coordinates in the right one's.
pub(super) fn of_transform(left: Camera, right: Camera, transform: &Matrix4<f64>) -> Result<Raw> {
    let rotation = transform.fixed_view::<3, 3>(0, 0).into_owned();
    let translation = transform.fixed_view::<3, 1>(0, 3).into_owned();
    check_rotation("the rotation between the cameras", &rotation)?;
    check_order(&translation, "give the left camera's file first")?;
    Ok(Raw { left, right, rotation, translation })
}

pub(super) fn calibration(tree: &Tree) -> Result<Calibration> {
    let camera = |name: &str| tree.get(name).and_then(Value::as_object);
    let cam0 = camera("cam0").context("cam0 is no camera")?;
    let cam1 = camera("cam1").context("is a Kalibr camchain of one camera: cam1 is missing")?;
    let transform = matrix4(cam1, "T_cn_cnm1").context("cam1")?;
    let first = pinhole(cam0, "distortion_coeffs").context("cam0")?;
    let second = pinhole(cam1, "distortion_coeffs").context("cam1")?;
    // The chain's order is not always from left to right.
    let raw = if transform[(0, 3)] > 0.0 {
        let back = transform.try_inverse().context("T_cn_cnm1: cannot be inverted")?;
        of_transform(second, first, &back)?
    } else {
        of_transform(first, second, &transform)?
    };
    let kind =
        if transform[(0, 3)] > 0.0 { "Kalibr camchain, whose cam1 is the left camera" } else { "Kalibr camchain" };
    let sizes = [list(cam0, "resolution", 2).context("cam0")?, list(cam1, "resolution", 2).context("cam1")?];
    check_sizes(&sizes[0], &sizes[1]).context("cam0 and cam1")?;
    let size = size(&sizes[0]);
    Ok(Calibration { kind, size, unit_mm: Some(1000.0), raw: Some(raw), rectified: None })
}
