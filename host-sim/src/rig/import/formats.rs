//! The kinds of files that tools for calibration write.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail, ensure};
use haarline_rig::Lens;
use nalgebra::{Matrix3, Matrix4, Vector3};
use serde_json::{Map, Value};

use super::calibration::{Calibration, Camera, Raw, Rectified, radial};
use super::document::{Document, numbers};

type Tree = Map<String, Value>;

/// Matrices by their names in small letters without anything between.
struct Matrices(BTreeMap<String, Vec<f64>>);

/// What kind of file a document is, by the names in it; OpenCV's without a sign of another.
#[must_use]
pub fn kind(document: &Document) -> &'static str {
    match document {
        Document::Lines(lines) if lines.contains_key("cam0") => "a Middlebury calib.txt",
        Document::Lines(_) => "a KITTI calibration",
        Document::Tree(tree) if is_ros(tree) => ROS,
        Document::Tree(tree) if tree.contains_key("T_BS") => EUROC,
        Document::Tree(tree) if tree.contains_key("cam0") => "a Kalibr camchain",
        Document::Tree(tree) if is_image_list(tree) => "a list of pictures",
        Document::Tree(_) => "a file of OpenCV's",
    }
}

const ROS: &str = "a ROS camera_info file";
const EUROC: &str = "an EuRoC sensor.yaml";

/// The calibration that the files together tell.
///
/// # Errors
/// Names the kind of file, and what is missing or not read.
pub fn calibration(documents: &[Document]) -> Result<Calibration> {
    if let [first, second] = documents {
        let kinds = [kind(first), kind(second)];
        ensure!(kinds[0] == kinds[1], "the first is {}, the second {}: give files of one kind", kinds[0], kinds[1]);
        ensure!(first != second, "both files tell the same: give the left camera's and the right one's");
    }
    match documents {
        [Document::Lines(lines)] if lines.contains_key("cam0") => middlebury(lines),
        [Document::Lines(lines)] => kitti(lines),
        [Document::Tree(tree)] if kind(&documents[0]) == "a Kalibr camchain" => kalibr(tree),
        [one] if [ROS, EUROC].contains(&kind(one)) => {
            bail!("is {} of one camera: give both, the left one first", kind(one))
        }
        [Document::Tree(left), Document::Tree(right)] if is_ros(left) => ros(left, right),
        [Document::Tree(left), Document::Tree(right)] if left.contains_key("T_BS") => euroc(left, right),
        [Document::Tree(tree), ..] if is_image_list(tree) => bail!(
            "is a list of pictures: calibrate with it, and give what that wrote (OpenCV's stereo_calib: intrinsics.yml and extrinsics.yml)"
        ),
        [Document::Tree(tree), ..] if !tree.contains_key("cam0") => opencv(documents),
        [one, ..] => bail!("{} tells of both cameras: give it alone", kind(one)),
        [] => bail!("no file"),
    }
}

fn is_ros(tree: &Tree) -> bool {
    tree.contains_key("projection_matrix") && tree.contains_key("camera_matrix")
}

/// The input of OpenCV's `stereo_calib`.
fn is_image_list(tree: &Tree) -> bool {
    ["images", "imagelist"].into_iter().any(|name| tree.contains_key(name))
        && !tree.keys().any(|key| CAMERA.as_flattened().contains(&plain(key).as_str()))
}

/// A name in small letters without anything between.
fn plain(name: &str) -> String {
    name.to_lowercase().replace(['_', '-', ' '], "")
}

fn list(tree: &Tree, name: &str, count: usize) -> Result<Vec<f64>> {
    let value = tree.get(name).with_context(|| format!("{name} is missing"))?;
    let found = numbers(name, value)?;
    ensure!(found.len() == count, "{name}: has {} numbers, where {count} are expected", found.len());
    Ok(found)
}

fn word<'a>(tree: &'a Tree, name: &str) -> Result<&'a str> {
    tree.get(name).and_then(Value::as_str).with_context(|| format!("{name} is missing"))
}

fn size(values: &[f64]) -> Option<[u32; 2]> {
    match values {
        &[width, height] if width >= 1.0 && height >= 1.0 => Some([width as u32, height as u32]),
        _ => None,
    }
}

/// The lens of a model by the name that ROS, Kalibr and EuRoC give it.
fn lens(model: &str, name: &str, coefficients: &[f64]) -> Result<Lens> {
    let counts: &[usize] = match model {
        "none" => return radial(name, &[]),
        "plumb_bob" => &[5, 4],
        "rational_polynomial" => &[8, 12, 14],
        "radtan" | "radial-tangential" | "equidistant" | "fisheye" => &[4],
        other => bail!(
            "the lens model {other} is not read: calibrate with a pinhole model, radial-tangential (plumb_bob, radtan) or equidistant"
        ),
    };
    let count = coefficients.len();
    ensure!(counts.contains(&count), "{name}: has {count} coefficients, where {model} has {}", counts[0]);
    match <[f64; 4]>::try_from(coefficients) {
        Ok(four) if ["equidistant", "fisheye"].contains(&model) => Ok(Lens::Equidistant(four)),
        _ => radial(name, coefficients),
    }
}

/// The coefficients of a lens under that name.
fn coefficients(tree: &Tree, name: &str) -> Result<Vec<f64>> {
    numbers(name, tree.get(name).with_context(|| format!("{name} is missing"))?)
}

/// The left camera's place, as the right one sees it, must be on its left.
fn check_order(translation: &Vector3<f64>) -> Result<()> {
    ensure!(translation.norm() > 0.0, "the two cameras are in the same place");
    ensure!(
        translation.x.abs() > translation.y.abs().max(translation.z.abs()),
        "the cameras do not stand side by side: the translation is {:.3}, {:.3}, {:.3}",
        translation.x,
        translation.y,
        translation.z
    );
    ensure!(translation.x < 0.0, "left and right are exchanged: give the left camera's file first");
    Ok(())
}

fn matrix3(values: &[f64]) -> Matrix3<f64> {
    Matrix3::from_row_slice(values)
}

fn check_rotation(name: &str, rotation: &Matrix3<f64>) -> Result<()> {
    let wrong = (rotation * rotation.transpose() - Matrix3::identity()).norm();
    ensure!(wrong < 1e-3 && rotation.determinant() > 0.0, "{name}: is no rotation matrix");
    Ok(())
}

impl Matrices {
    fn add(&mut self, prefix: &str, tree: &Tree) {
        for (key, value) in tree {
            let name = format!("{prefix}{}", plain(key));
            match value {
                Value::Object(inner) if !inner.contains_key("data") => self.add(&name, inner),
                // What is no number is told where it is asked for.
                _ => _ = self.0.insert(name, numbers(key, value).unwrap_or_else(|_| vec![f64::NAN])),
            }
        }
    }

    /// The matrix under one of its names; `told` is what it is called in refusals.
    fn find(&self, told: &str, names: &[&str], counts: &[usize]) -> Result<Option<&[f64]>> {
        let Some(found) = names.iter().find_map(|&name| self.0.get(name)) else { return Ok(None) };
        ensure!(found.iter().all(|value| value.is_finite()), "{told}: holds something that is no number");
        ensure!(
            counts.is_empty() || counts.contains(&found.len()),
            "{told}: has {} numbers, where {} are expected",
            found.len(),
            counts[0]
        );
        Ok(Some(found))
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

/// OpenCV's stereo calibration: K1 D1 K2 D2 R T, or K1 D1 R1 P1 K2 D2 R2 P2, or P1 P2 of rectified views; in one file or two.
fn opencv(documents: &[Document]) -> Result<Calibration> {
    let mut matrices = Matrices(BTreeMap::new());
    for document in documents {
        match document {
            Document::Tree(tree) => matrices.add("", tree),
            Document::Lines(_) => bail!("Middlebury's and KITTI's files are given alone"),
        }
    }
    let [k1, k2] = [0, 1].map(|side| matrices.find(["K1", "K2"][side], &CAMERA[side], &[9]));
    let [d1, d2] = [0, 1].map(|side| matrices.find(["D1", "D2"][side], &DISTORTION[side], &[]));
    let rotation = matrices.find("R", &["r", "rotation", "rotationmatrix", "rot"], &[9])?;
    let translation = matrices.find("T", &["t", "translation", "translationvector", "trans"], &[3])?;
    let [p1, p2] = ["p1", "p2"].map(|name| matrices.find(name, &[name], &[12]));
    let rectified = match (p1?, p2?) {
        (Some(p1), Some(p2)) => Some(Rectified::of_projections(p1, p2)?),
        _ => None,
    };
    let raw = match (k1?, k2?) {
        (Some(k1), Some(k2)) => {
            let camera = |name: &str, k: &[f64], d: Result<Option<&[f64]>>| -> Result<Camera> {
                Camera::new(name, k, radial("the distortion", d?.unwrap_or(&[]))?)
            };
            match (&d1, &d2) {
                (Ok(Some(_)), Ok(None)) => bail!("D2 is missing: distortion is told of one camera only"),
                (Ok(None), Ok(Some(_))) => bail!("D1 is missing: distortion is told of one camera only"),
                _ => {}
            }
            let (left, right) = (camera("K1", k1, d1)?, camera("K2", k2, d2)?);
            match (rotation, translation) {
                (Some(rotation), Some(translation)) => {
                    let (rotation, translation) = (matrix3(rotation), Vector3::from_column_slice(translation));
                    check_rotation("R", &rotation)?;
                    check_order(&translation)?;
                    Some(Raw { left, right, rotation, translation })
                }
                _ => {
                    let [r1, r2] = ["r1", "r2"].map(|name| matrices.find(name, &[name], &[9]));
                    let (Some(r1), Some(r2), Some(rectified)) = (r1?, r2?, &rectified) else {
                        bail!(
                            "is an OpenCV calibration without R and T, and without R1, P1, R2, P2 in their place: give the file with them, too"
                        );
                    };
                    Some(of_rectification(left, right, matrix3(r1), matrix3(r2), rectified.baseline)?)
                }
            }
        }
        (None, None) if rectified.is_some() => None,
        (None, None) => bail!(
            "is no calibration that is known: no K1 and K2, no cam0, no camera_matrix, no T_BS, no P2; OpenCV's stereo calibration, \
             ROS camera_info, Kalibr's camchain, EuRoC's sensor.yaml, Middlebury's and KITTI's calib.txt are read"
        ),
        (one, _) => bail!("K{} is missing: the file tells of one camera only", if one.is_none() { 1 } else { 2 }),
    };
    let named =
        ["size", "imagesize", "imgsize", "resolution", "imageshape"].iter().find_map(|&name| matrices.0.get(name));
    let sides = ["imagewidth", "imageheight"].map(|name| matrices.0.get(name).and_then(|value| value.first().copied()));
    let sides = match sides {
        [Some(width), Some(height)] => size(&[width, height]),
        _ => None,
    };
    let size = named.and_then(|values| size(values)).or(sides);
    Ok(Calibration { kind: "OpenCV stereo calibration", size, unit_mm: None, raw, rectified })
}

/// The cameras of which a rectification is known: how each was turned, and their distance then.
fn of_rectification(left: Camera, right: Camera, r1: Matrix3<f64>, r2: Matrix3<f64>, baseline: f64) -> Result<Raw> {
    check_rotation("the left camera's rectification", &r1)?;
    check_rotation("the right camera's rectification", &r2)?;
    let rotation = r2.transpose() * r1;
    let translation = -r2.transpose() * Vector3::new(baseline, 0.0, 0.0);
    Ok(Raw { left, right, rotation, translation })
}

fn ros(left: &Tree, right: &Tree) -> Result<Calibration> {
    let camera = |tree: &Tree| -> Result<Camera> {
        let (name, model) = ("distortion_coefficients", word(tree, "distortion_model")?);
        Camera::new("camera_matrix", &list(tree, "camera_matrix", 9)?, lens(model, name, &coefficients(tree, name)?)?)
    };
    let sides = |tree: &Tree| -> Result<Vec<f64>> {
        Ok([list(tree, "image_width", 1)?, list(tree, "image_height", 1)?].concat())
    };
    ensure!(sides(left)? == sides(right)?, "the two camera_info files tell of images of different size");
    let projections = [left, right].map(|tree| list(tree, "projection_matrix", 12));
    let [left_projection, right_projection] = projections;
    let rectified = Rectified::of_projections(&left_projection?, &right_projection?)?;
    let turns = [left, right].map(|tree| list(tree, "rectification_matrix", 9).map(|values| matrix3(&values)));
    let [r1, r2] = turns;
    let (one, other) = (camera(left).context(LEFT)?, camera(right).context(RIGHT)?);
    let raw = of_rectification(one, other, r1?, r2?, rectified.baseline)?;
    let size = size(&sides(left)?);
    Ok(Calibration {
        kind: "ROS camera_info pair",
        size,
        unit_mm: Some(1000.0),
        raw: Some(raw),
        rectified: Some(rectified),
    })
}

/// A pinhole camera as Kalibr and EuRoC write it.
fn pinhole(tree: &Tree, name: &str) -> Result<Camera> {
    let model = word(tree, "camera_model")?;
    ensure!(model == "pinhole", "the camera model {model} is not read: calibrate with pinhole");
    let k = list(tree, "intrinsics", 4)?;
    let distortion = word(tree, "distortion_model")?;
    let found = if distortion == "none" { Vec::new() } else { coefficients(tree, name)? };
    Camera::new("intrinsics", &[k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0], lens(distortion, name, &found)?)
}

fn matrix4(tree: &Tree, name: &str) -> Result<Matrix4<f64>> {
    Ok(Matrix4::from_row_slice(&list(tree, name, 16)?))
}

/// Whose file of two it is.
const LEFT: &str = "the left camera";
const RIGHT: &str = "the right camera";

/// The raw cameras from the left one's coordinates in the right one's.
fn of_transform(left: Camera, right: Camera, transform: &Matrix4<f64>) -> Result<Raw> {
    let rotation = transform.fixed_view::<3, 3>(0, 0).into_owned();
    let translation = transform.fixed_view::<3, 1>(0, 3).into_owned();
    check_rotation("the rotation between the cameras", &rotation)?;
    check_order(&translation)?;
    Ok(Raw { left, right, rotation, translation })
}

fn kalibr(tree: &Tree) -> Result<Calibration> {
    let camera = |name: &str| tree.get(name).and_then(Value::as_object);
    let cam0 = camera("cam0").context("cam0 is no camera")?;
    let cam1 = camera("cam1").context("is a Kalibr camchain of one camera: cam1 is missing")?;
    let transform = matrix4(cam1, "T_cn_cnm1")?;
    let [first, second] =
        [("cam0", cam0), ("cam1", cam1)].map(|(name, tree)| pinhole(tree, "distortion_coeffs").context(name));
    let (first, second) = (first?, second?);
    // The chain's order is not always from left to right.
    let raw = if transform[(0, 3)] > 0.0 {
        let back = transform.try_inverse().context("T_cn_cnm1: cannot be inverted")?;
        of_transform(second, first, &back)?
    } else {
        of_transform(first, second, &transform)?
    };
    let kind =
        if transform[(0, 3)] > 0.0 { "Kalibr camchain, whose cam1 is the left camera" } else { "Kalibr camchain" };
    let size = size(&list(cam0, "resolution", 2)?);
    Ok(Calibration { kind, size, unit_mm: Some(1000.0), raw: Some(raw), rectified: None })
}

fn euroc(left: &Tree, right: &Tree) -> Result<Calibration> {
    let [to_left, to_right] = [left, right].map(|tree| matrix4(tree, "T_BS"));
    let back = to_right?.try_inverse().context("T_BS: cannot be inverted")?;
    let [one, other] = [left, right].map(|tree| list(tree, "resolution", 2));
    let (one, other) = (one?, other?);
    ensure!(one == other, "the two sensor.yaml tell of images of different size");
    let cameras = [left, right].map(|tree| pinhole(tree, "distortion_coefficients"));
    let [first, second] = cameras;
    let raw = of_transform(first.context(LEFT)?, second.context(RIGHT)?, &(back * to_left?))?;
    Ok(Calibration {
        kind: "EuRoC sensor.yaml pair",
        size: size(&one),
        unit_mm: Some(1000.0),
        raw: Some(raw),
        rectified: None,
    })
}

fn values(lines: &BTreeMap<String, String>, name: &str, count: usize) -> Result<Vec<f64>> {
    let text = lines.get(name).with_context(|| format!("{name} is missing"))?;
    let words = text.split(|c: char| c.is_whitespace() || "[];,".contains(c)).filter(|word| !word.is_empty());
    let number = |word: &str| word.parse().ok().filter(|value: &f64| value.is_finite());
    let found: Option<Vec<f64>> = words.map(number).collect();
    let found = found.with_context(|| format!("{name} = {text}: holds something that is no number"))?;
    ensure!(found.len() == count, "{name}: has {} numbers, where {count} are expected", found.len());
    Ok(found)
}

fn middlebury(lines: &BTreeMap<String, String>) -> Result<Calibration> {
    let (cam0, cam1) = (values(lines, "cam0", 9)?, values(lines, "cam1", 9)?);
    let one = |name: &str| values(lines, name, 1).map(|values| values[0]);
    let (baseline, doffs) = (one("baseline")?, one("doffs")?);
    ensure!(cam0[0] > 0.0 && baseline > 0.0, "cam0 and baseline must be positive");
    ensure!(
        (cam1[2] - cam0[2] - doffs).abs() < 0.5,
        "doffs = {doffs}: is not the distance of the axes in cam0 and cam1, {}",
        cam1[2] - cam0[2]
    );
    let rectified = Rectified { focal_px: cam0[0], baseline, axis: [cam0[2], cam0[5]], doffs };
    let size = size(&[one("width")?, one("height")?]);
    Ok(Calibration { kind: "Middlebury calib.txt", size, unit_mm: Some(1.0), raw: None, rectified: Some(rectified) })
}

fn kitti(lines: &BTreeMap<String, String>) -> Result<Calibration> {
    let pairs = [
        ["P_rect_02", "P_rect_03", "S_rect_02"],
        ["P_rect_00", "P_rect_01", "S_rect_00"],
        ["P2", "P3", ""],
        ["P0", "P1", ""],
    ];
    let found = pairs.iter().find(|[left, right, _]| lines.contains_key(*left) && lines.contains_key(*right));
    let [left, right, sides] =
        found.context("has no pair of projections: P2 and P3, P0 and P1, or P_rect_02 and P_rect_03")?;
    let rectified = Rectified::of_projections(&values(lines, left, 12)?, &values(lines, right, 12)?)?;
    let size = if sides.is_empty() { None } else { size(&values(lines, sides, 2)?) };
    Ok(Calibration { kind: "KITTI calibration", size, unit_mm: Some(1000.0), raw: None, rectified: Some(rectified) })
}
