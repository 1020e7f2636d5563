//! The calibrations that tools write: the two cameras in each kind of file.

mod datasets;
mod euroc;
mod kalibr;
pub(super) mod opencv;
mod ros;

use anyhow::{Context, Result, anyhow, bail, ensure};
use haarline_rig::Lens;
use nalgebra::{Matrix3, Vector3};
use serde_json::{Map, Value};

use super::calibration::{Calibration, Camera, Raw, radial};
use super::document::{Document, numbers};
use super::kind::Kind;

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
        (Some(Kind::Ros), [left, right]) => {
            ros::calibration([ros::camera(left)?, ros::camera(right)?]).with_context(names)
        }
        (Some(Kind::Euroc), [left, right]) => {
            euroc::calibration([euroc::camera(left)?, euroc::camera(right)?]).with_context(names)
        }
        (Some(kind @ (Kind::Ros | Kind::Euroc)), [file]) => {
            bail!("{}: is {} of one camera: give both, the left one first", file.name, kind.words())
        }
        (Some(Kind::OpenCv), _) => opencv::calibration(files.iter().map(|file| &file.document)).with_context(names),
        (Some(kind), [_, _]) => {
            bail!("{}: each is {}, which tells of both cameras: give one of them", names(), kind.words())
        }
        (Some(Kind::Middlebury), [Named { document: Document::Lines(lines), .. }]) => {
            datasets::middlebury(lines).with_context(names)
        }
        (_, [Named { document: Document::Lines(lines), .. }]) => datasets::kitti(lines).with_context(names),
        (_, [Named { document: Document::Tree(tree), .. }]) => kalibr::calibration(tree).with_context(names),
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

/// What `read` finds in a file of one camera, whose content is a tree.
///
/// # Errors
/// Those of `read`, with the file's name.
fn camera_of<T>(file: &Named, read: impl FnOnce(&Tree) -> Result<T>) -> Result<T> {
    let found = match &file.document {
        Document::Tree(tree) => read(tree),
        Document::Lines(_) => Err(anyhow!("has lines where YAML is expected")),
    };
    found.with_context(|| file.name.clone())
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

/// The cameras of which a rectification is known: how each was turned, and their distance then.
fn of_rectification(left: Camera, right: Camera, r1: Matrix3<f64>, r2: Matrix3<f64>, baseline: f64) -> Result<Raw> {
    check_rotation("the left camera's rectification", &r1)?;
    check_rotation("the right camera's rectification", &r2)?;
    let rotation = r2.transpose() * r1;
    let translation = -r2.transpose() * Vector3::new(baseline, 0.0, 0.0);
    Ok(Raw { left, right, rotation, translation })
}
