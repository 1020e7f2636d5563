//! EuRoC: a sensor.yaml for each camera, which tells where it stands on a body.

use anyhow::{Context, Result};
use nalgebra::Matrix4;

use super::super::calibration::{Calibration, Camera};
use super::kalibr::{matrix4, of_transform, pinhole};
use super::{Named, camera_of, check_sizes, list, size};

/// A sensor.yaml.
pub(super) struct Sensor {
    camera: Camera,
    size: Vec<f64>,
    to_body: Matrix4<f64>,
}

pub(super) fn camera(file: &Named) -> Result<Sensor> {
    camera_of(file, |tree| {
        Ok(Sensor {
            to_body: matrix4(tree, "T_BS")?,
            size: list(tree, "resolution", 2)?,
            camera: pinhole(tree, "distortion_coefficients")?,
        })
    })
}

pub(super) fn calibration([left, right]: [Sensor; 2]) -> Result<Calibration> {
    let back = right.to_body.try_inverse().context("T_BS: cannot be inverted")?;
    check_sizes(&left.size, &right.size)?;
    let raw = of_transform(left.camera, right.camera, &(back * left.to_body))?;
    Ok(Calibration {
        kind: "EuRoC sensor.yaml pair",
        size: size(&left.size),
        unit_mm: Some(1000.0),
        raw: Some(raw),
        rectified: None,
    })
}
