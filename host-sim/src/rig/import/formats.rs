//! The kinds of files that tools for calibration write.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail, ensure};
use haarline_rig::Lens;
use nalgebra::{Matrix3, Matrix4, Vector3};
use serde_json::{Map, Value};

use super::calibration::{Calibration, Camera, Raw, Rectified, radial};
use super::document::{Document, numbers};

type Tree = Map<String, Value>;

/// Cameras so near to each other are one, whatever the unit of length.
const SAME_PLACE: f64 = 1e-6;

/// A file and its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// What the user calls it.
    pub name: String,
    /// Its content.
    pub document: Document,
}

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Both rectified cameras.
    Middlebury,
    /// Projections of rectified cameras.
    Kitti,
    /// A chain of cameras.
    Kalibr,
    /// One camera of a pair.
    Ros,
    /// One camera on a body.
    Euroc,
    /// Matrices of a pair, or some of them.
    OpenCv,
    /// One camera alone.
    OpenCvCamera,
    /// Names of pictures.
    ImageList,
}

impl Kind {
    /// What `document` is, if that is known.
    #[must_use]
    pub fn of(document: &Document) -> Option<Self> {
        let tree = match document {
            Document::Lines(lines) if lines.contains_key("cam0") => return Some(Self::Middlebury),
            Document::Lines(_) => return Some(Self::Kitti),
            Document::Tree(tree) => tree,
        };
        let has = |name: &str| tree.contains_key(name);
        if has("cam0") || has("T_cn_cnm1") {
            Some(Self::Kalibr)
        } else if has("projection_matrix") || has("camera_matrix") && has("distortion_model") {
            Some(Self::Ros)
        } else if has("T_BS") || has("sensor_type") {
            Some(Self::Euroc)
        } else if Matrices::of([document]).has_any() {
            Some(Self::OpenCv)
        } else if has("camera_matrix") || has("Camera_Matrix") || has("cameraMatrix") {
            Some(Self::OpenCvCamera)
        } else {
            tree.iter().any(|(key, value)| names_images(key, value)).then_some(Self::ImageList)
        }
    }

    /// Whether cameras of a rig are told.
    #[must_use]
    pub const fn is_of_rig(self) -> bool {
        !matches!(self, Self::OpenCvCamera | Self::ImageList)
    }

    /// For the user.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Middlebury => "a Middlebury calib.txt",
            Self::Kitti => "a KITTI calibration",
            Self::Kalibr => "a Kalibr camchain",
            Self::Ros => "a ROS camera_info file",
            Self::Euroc => "an EuRoC sensor.yaml",
            Self::OpenCv => "an OpenCV stereo calibration",
            Self::OpenCvCamera => "an OpenCV calibration of one camera",
            Self::ImageList => "an OpenCV image list",
        }
    }
}

/// Whether a value is OpenCV's list of the images to calibrate with.
fn names_images(key: &str, value: &Value) -> bool {
    let is_image = |word: &str| {
        let word = word.trim_matches(['"', '\'']).to_lowercase();
        [".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm"].iter().any(|ending| word.ends_with(ending))
    };
    match value {
        Value::String(text) => ["imagelist", "images"].contains(&key) && text.split_whitespace().any(is_image),
        Value::Array(items) => items.iter().any(|item| item.as_str().is_some_and(is_image)),
        _ => false,
    }
}

/// What is said of a file that is none of those that are read.
const UNKNOWN: &str = "is no calibration that is known: no K1 and K2, no cam0, no camera_matrix, no T_BS, no P2; OpenCV's stereo \
     calibration, ROS camera_info, Kalibr's camchain, EuRoC's sensor.yaml, Middlebury's and KITTI's calib.txt are read";

/// The calibration that the files together tell.
///
/// # Errors
/// Names the file or files, what is missing or not read.
pub fn calibration(files: &[Named]) -> Result<Calibration> {
    let kinds = files.iter().map(|file| known(file).with_context(|| file.name.clone())).collect::<Result<Vec<_>>>()?;
    if let ([one, other], &[first, second]) = (files, &*kinds) {
        ensure!(
            first == second,
            "{} is {}, but {} is {}: give the files of one calibration",
            one.name,
            first.words(),
            other.name,
            second.words()
        );
        ensure!(
            one.document != other.document,
            "{} and {} have the same content: give one where it tells of both cameras, else the left and the right camera's",
            one.name,
            other.name
        );
    }
    let names = || files.iter().map(|file| file.name.as_str()).collect::<Vec<_>>().join(", ");
    match (kinds.first(), files) {
        (Some(Kind::Ros), [left, right]) => ros([ros_camera(left)?, ros_camera(right)?]).with_context(names),
        (Some(Kind::Euroc), [left, right]) => euroc([sensor(left)?, sensor(right)?]).with_context(names),
        (Some(kind @ (Kind::Ros | Kind::Euroc)), [file]) => {
            bail!("{}: is {} of one camera: give both, the left one first", file.name, kind.words())
        }
        (Some(Kind::OpenCv), _) => opencv(&Matrices::of(files.iter().map(|file| &file.document))).with_context(names),
        (Some(kind), [_, _]) => {
            bail!("{}: each is {}, which tells of both cameras: give one of them", names(), kind.words())
        }
        (Some(Kind::Middlebury), [Named { document: Document::Lines(lines), .. }]) => {
            middlebury(lines).with_context(names)
        }
        (_, [Named { document: Document::Lines(lines), .. }]) => kitti(lines).with_context(names),
        (_, [Named { document: Document::Tree(tree), .. }]) => kalibr(tree).with_context(names),
        _ => bail!("{} files: one or two are read, of two the left camera's first", files.len()),
    }
}

/// The kind of a file that may be part of a calibration of two cameras.
fn known(file: &Named) -> Result<Kind> {
    match Kind::of(&file.document).context(UNKNOWN)? {
        Kind::ImageList => bail!(
            "is an OpenCV image list, no calibration: calibrate with its images first, then give the file with M1 D1 M2 D2 R T"
        ),
        Kind::OpenCvCamera => bail!(
            "is an OpenCV calibration of one camera, which does not tell how two of them stand: give the file of a stereo \
             calibration, with M1 D1 M2 D2 R T"
        ),
        kind => Ok(kind),
    }
}

/// A file's content as a tree; the kinds of one camera each are nothing else.
fn tree(file: &Named) -> Result<&Tree> {
    match &file.document {
        Document::Tree(tree) => Ok(tree),
        Document::Lines(_) => bail!("has lines where YAML is expected"),
    }
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

/// The lens of a model by the name that ROS, Kalibr and EuRoC give it, whose coefficients are under `key`.
fn lens(tree: &Tree, key: &str) -> Result<Lens> {
    let model = word(tree, "distortion_model")?;
    let needed = match model {
        "none" => return radial(key, &[]),
        "radtan" | "radial-tangential" | "equidistant" | "fisheye" => 4,
        "plumb_bob" => 5,
        "rational_polynomial" => 8,
        other => bail!(
            "the lens model {other} is not read: calibrate with a pinhole model, radial-tangential (plumb_bob, radtan) or equidistant"
        ),
    };
    let found = numbers(key, tree.get(key).with_context(|| format!("{key} is missing"))?)?;
    // Some drivers write plumb_bob's four without the fifth, which is 0 then.
    let is_short = model == "plumb_bob" && found.len() == 4;
    ensure!(found.len() == needed || is_short, "{key}: has {} coefficients, where {model} needs {needed}", found.len());
    match <[f64; 4]>::try_from(&*found) {
        Ok(four) if ["equidistant", "fisheye"].contains(&model) => Ok(Lens::Equidistant(four)),
        _ => radial(key, &found),
    }
}

/// The left camera's place, as the right one sees it, must be on its left.
fn check_order(translation: &Vector3<f64>, advice: &str) -> Result<()> {
    ensure!(
        translation.norm() > SAME_PLACE,
        "the two cameras are in the same place, the translation between them is zero: are they one camera, given twice?"
    );
    ensure!(
        translation.x.abs() > translation.y.abs().max(translation.z.abs()),
        "the cameras do not stand side by side, as they must: the translation is {:.3}, {:.3}, {:.3}, where the first is to be \
         the greatest",
        translation.x,
        translation.y,
        translation.z
    );
    ensure!(translation.x < 0.0, "left and right are exchanged: {advice}");
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
fn opencv(matrices: &Matrices) -> Result<Calibration> {
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

/// The cameras of which a rectification is known: how each was turned, and their distance then.
fn of_rectification(left: Camera, right: Camera, r1: Matrix3<f64>, r2: Matrix3<f64>, baseline: f64) -> Result<Raw> {
    check_rotation("the left camera's rectification", &r1)?;
    check_rotation("the right camera's rectification", &r2)?;
    let rotation = r2.transpose() * r1;
    let translation = -r2.transpose() * Vector3::new(baseline, 0.0, 0.0);
    Ok(Raw { left, right, rotation, translation })
}

/// A camera_info file.
struct RosCamera {
    camera: Camera,
    size: Vec<f64>,
    projection: Vec<f64>,
    turn: Matrix3<f64>,
}

fn ros_camera(file: &Named) -> Result<RosCamera> {
    let read = || -> Result<RosCamera> {
        let tree = tree(file)?;
        Ok(RosCamera {
            camera: Camera::new(
                "camera_matrix",
                &list(tree, "camera_matrix", 9)?,
                lens(tree, "distortion_coefficients")?,
            )?,
            size: [list(tree, "image_width", 1)?, list(tree, "image_height", 1)?].concat(),
            projection: list(tree, "projection_matrix", 12)?,
            turn: matrix3(&list(tree, "rectification_matrix", 9)?),
        })
    };
    read().with_context(|| file.name.clone())
}

fn check_sizes(left: &[f64], right: &[f64]) -> Result<()> {
    ensure!(
        left == right,
        "the images are of different size, {}x{} and {}x{} px: calibrate both cameras at one size",
        left[0],
        left[1],
        right[0],
        right[1]
    );
    Ok(())
}

fn ros([left, right]: [RosCamera; 2]) -> Result<Calibration> {
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

/// A pinhole camera as Kalibr and EuRoC write it.
fn pinhole(tree: &Tree, coefficients: &str) -> Result<Camera> {
    let model = word(tree, "camera_model")?;
    ensure!(model == "pinhole", "the camera model {model} is not read: calibrate with pinhole");
    let k = list(tree, "intrinsics", 4)?;
    Camera::new("intrinsics", &[k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0], lens(tree, coefficients)?)
}

fn matrix4(tree: &Tree, name: &str) -> Result<Matrix4<f64>> {
    Ok(Matrix4::from_row_slice(&list(tree, name, 16)?))
}

/// The raw cameras from the left one's coordinates in the right one's.
fn of_transform(left: Camera, right: Camera, transform: &Matrix4<f64>) -> Result<Raw> {
    let rotation = transform.fixed_view::<3, 3>(0, 0).into_owned();
    let translation = transform.fixed_view::<3, 1>(0, 3).into_owned();
    check_rotation("the rotation between the cameras", &rotation)?;
    check_order(&translation, "give the left camera's file first")?;
    Ok(Raw { left, right, rotation, translation })
}

fn kalibr(tree: &Tree) -> Result<Calibration> {
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

/// A sensor.yaml.
struct Sensor {
    camera: Camera,
    size: Vec<f64>,
    to_body: Matrix4<f64>,
}

fn sensor(file: &Named) -> Result<Sensor> {
    let read = || -> Result<Sensor> {
        let tree = tree(file)?;
        Ok(Sensor {
            to_body: matrix4(tree, "T_BS")?,
            size: list(tree, "resolution", 2)?,
            camera: pinhole(tree, "distortion_coefficients")?,
        })
    };
    read().with_context(|| file.name.clone())
}

fn euroc([left, right]: [Sensor; 2]) -> Result<Calibration> {
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
