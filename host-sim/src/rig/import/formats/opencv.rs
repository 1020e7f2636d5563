//! OpenCV's stereo calibration, by the names that common tools give to its matrices.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail, ensure};
use nalgebra::Vector3;
use serde_json::Value;

use super::super::calibration::{Calibration, Camera, Raw, Rectified, radial};
use super::super::document::{Document, numbers};
use super::{Tree, check_order, check_rotation, matrix3, of_rectification, size};

/// Whether one of the matrices is there that such a calibration is read from.
pub(in super::super) fn is_stereo(document: &Document) -> bool {
    Matrices::of([document]).has_any()
}

/// A matrix, as a file has it.
struct Matrix {
    /// What the file calls it.
    key: String,
    /// Its numbers, or what is wrong with them.
    values: Result<Vec<f64>, String>,
}

/// The matrices of each file, by their names in small letters without anything between.
struct Matrices(Vec<BTreeMap<String, Matrix>>);

impl Matrices {
    fn of<'a>(documents: impl IntoIterator<Item = &'a Document>) -> Self {
        let of_tree = |document: &Document| {
            let mut found = BTreeMap::new();
            if let Document::Tree(tree) = document {
                collect("", tree, &mut found);
            }
            found
        };
        Self(documents.into_iter().map(of_tree).collect())
    }

    /// Whether there is one of those that OpenCV's stereo calibration is read from.
    fn has_any(&self) -> bool {
        let names = [&CAMERA[0][..], &CAMERA[1], &DISTORTION[0], &DISTORTION[1], &ROTATION, &TRANSLATION, &RECTIFIED];
        names.concat().iter().any(|&name| self.0.iter().any(|file| file.contains_key(name)))
    }

    /// The matrix under one of its names; `told` is what it is called in refusals of two of them.
    fn get(&self, told: &str, names: &[&str]) -> Result<Option<(&str, &[f64])>> {
        let mut found = self.0.iter().filter_map(|file| names.iter().find_map(|&name| file.get(name)));
        let Some(first) = found.next() else { return Ok(None) };
        if let Some(other) = found.find(|other| other.values != first.values) {
            let also = if other.key == first.key { String::new() } else { format!(" ({}, {})", first.key, other.key) };
            bail!("each file tells another {told}{also}: give the files of one calibration");
        }
        match &first.values {
            Ok(values) => Ok(Some((&first.key, values))),
            Err(wrong) => bail!("{wrong}"),
        }
    }

    /// The same of `count` numbers.
    fn find(&self, told: &str, names: &[&str], count: usize) -> Result<Option<(&str, &[f64])>> {
        let found = self.get(told, names)?;
        if let Some((key, values)) = found {
            ensure!(values.len() == count, "{key}: has {} numbers, where {count} are expected", values.len());
        }
        Ok(found)
    }
}

fn collect(prefix: &str, tree: &Tree, found: &mut BTreeMap<String, Matrix>) {
    for (key, value) in tree {
        let name = format!("{prefix}{}", key.to_lowercase().replace(['_', '-', ' '], ""));
        let values = match value {
            Value::Object(inner) if !inner.contains_key("data") => {
                collect(&name, inner, found);
                continue;
            }
            Value::String(word) => Err(format!("{key}: {word:?} is no matrix of numbers")),
            Value::Null | Value::Bool(_) => Err(format!("{key}: is no matrix of numbers")),
            // What is no number among words that nobody asks for is not told.
            _ => numbers(key, value).map_err(|error| error.to_string()),
        };
        found.insert(name, Matrix { key: key.clone(), values });
    }
}

/// Names that common tools give to the matrices of the left and the right camera.
const CAMERA: [[&str; 10]; 2] = [
    [
        "k1",
        "m1",
        "cameramatrix1",
        "cameramatrixleft",
        "cameramatrixl",
        "leftcameramatrix",
        "leftk",
        "kleft",
        "kl",
        "mtxl",
    ],
    [
        "k2",
        "m2",
        "cameramatrix2",
        "cameramatrixright",
        "cameramatrixr",
        "rightcameramatrix",
        "rightk",
        "kright",
        "kr",
        "mtxr",
    ],
];
const DISTORTION: [[&str; 10]; 2] = [
    ["d1", "distcoeffs1", "distcoeffsleft", "distcoeffsl", "leftdistcoeffs", "leftd", "dleft", "dl", "distl", "dist1"],
    [
        "d2",
        "distcoeffs2",
        "distcoeffsright",
        "distcoeffsr",
        "rightdistcoeffs",
        "rightd",
        "dright",
        "dr",
        "distr",
        "dist2",
    ],
];

const ROTATION: [&str; 4] = ["r", "rotation", "rotationmatrix", "rot"];
const TRANSLATION: [&str; 4] = ["t", "translation", "translationvector", "trans"];
/// Turns and projections of rectified views.
const RECTIFIED: [&str; 4] = ["r1", "r2", "p1", "p2"];
const SIZE: [&str; 5] = ["size", "imagesize", "imgsize", "resolution", "imageshape"];

/// OpenCV's stereo calibration: K1 D1 K2 D2 R T, or K1 D1 R1 P1 K2 D2 R2 P2, or P1 P2 of rectified views; in one file or two.
pub(super) fn calibration<'a>(documents: impl IntoIterator<Item = &'a Document>) -> Result<Calibration> {
    let matrices = Matrices::of(documents);
    let [k1, k2] = [0, 1].map(|side| matrices.find(["K1", "K2"][side], &CAMERA[side], 9));
    let [d1, d2] = [0, 1].map(|side| matrices.get(["D1", "D2"][side], &DISTORTION[side]));
    let rotation = matrices.find("R", &ROTATION, 9)?;
    let translation = matrices.find("T", &TRANSLATION, 3)?;
    let [p1, p2] = ["P1", "P2"].map(|name| matrices.find(name, &[&*name.to_lowercase()], 12));
    let rectified = match (p1?, p2?) {
        (Some((_, p1)), Some((_, p2))) => Some(Rectified::of_projections(p1, p2).context("P1, P2")?),
        _ => None,
    };
    let mut kind = "OpenCV stereo calibration";
    let raw = match (k1?, k2?) {
        (Some(k1), Some(k2)) => {
            let camera = |(key, k): (&str, &[f64]), distortion: Option<(&str, &[f64])>| -> Result<Camera> {
                let (name, coefficients) = distortion.unwrap_or(("D", &[]));
                Camera::new(key, k, radial(name, coefficients)?)
            };
            let (d1, d2) = (d1?, d2?);
            match (d1, d2) {
                (Some(_), None) => bail!("D2 is missing: distortion is told of one camera only"),
                (None, Some(_)) => bail!("D1 is missing: distortion is told of one camera only"),
                (None, None) => kind = "OpenCV stereo calibration without distortion (no D1, D2)",
                _ => {}
            }
            let (left, right) = (camera(k1, d1)?, camera(k2, d2)?);
            match (rotation, translation) {
                (Some((key, rotation)), Some((_, translation))) => {
                    let (rotation, translation) = (matrix3(rotation), Vector3::from_column_slice(translation));
                    check_rotation(key, &rotation)?;
                    check_order(
                        &translation,
                        "camera 1 stands on the right of camera 2 by T; calibrate with the left camera as the first one",
                    )?;
                    Some(Raw { left, right, rotation, translation })
                }
                _ => {
                    let [r1, r2] = ["R1", "R2"].map(|name| matrices.find(name, &[&*name.to_lowercase()], 9));
                    let (Some((_, r1)), Some((_, r2)), Some(rectified)) = (r1?, r2?, &rectified) else {
                        bail!(
                            "is an OpenCV calibration without R and T, and without R1, P1, R2, P2 in their place: give the file with them, too"
                        );
                    };
                    Some(of_rectification(left, right, matrix3(r1), matrix3(r2), rectified.baseline)?)
                }
            }
        }
        (None, None) if rectified.is_some() => None,
        (None, None) => bail!("K1 and K2 are missing: give the file with them, too (OpenCV's intrinsics.yml)"),
        (one, _) => bail!("K{} is missing: the file tells of one camera only", if one.is_none() { 1 } else { 2 }),
    };
    let named = match matrices.get("image size", &SIZE) {
        // A size in words of one file is as none: --size tells it.
        Err(_) if matrices.0.len() == 1 => None,
        named => named?,
    };
    let sides = ["imagewidth", "imageheight"].map(|name| matrices.find(name, &[name], 1).unwrap_or_default());
    let sides = match sides {
        [Some((_, width)), Some((_, height))] => size(&[width[0], height[0]]),
        _ => None,
    };
    let size = named.and_then(|(_, values)| size(values)).or(sides);
    Ok(Calibration { kind, size, unit_mm: None, raw, rectified })
}
