//! Calibrations as other tools write them, turned into a rig description.
//!
//! [`document`] reads YAML, XML, JSON and lines, [`kind`] tells what a file is, [`formats`] finds the two cameras in them,
//! [`calibration`] is what they have in common, [`pinhole`] the nearest rig without lens tables, [`lenses`] the one with them.

pub mod calibration;
pub mod document;
pub mod formats;
pub mod kind;
pub mod lenses;
pub mod pinhole;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};

use calibration::{Calibration, Camera, Raw};
use formats::Named;
use haarline_rig::CameraModel;
use kind::Kind;
use nalgebra::Rotation3;
use pinhole::Pinhole;

/// Rows and columns, px, up to which what lenses and turns do is left alone.
const MOST_LEFT: f64 = 0.1;
/// Degrees by which one camera of a rig may be turned against the other; more is that of a view stored turned, or of a
/// rotation between other things.
const MOST_TURN_DEG: f64 = 30.0;
/// Distances of the cameras that a rig may have, mm.
const BASELINES_MM: std::ops::RangeInclusive<f64> = 1.0..=10_000.0;

/// What a user tells beside the files.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Columns and rows of the calibrated pictures.
    pub size: Option<[u32; 2]>,
    /// Millimetres of a unit of length.
    pub unit_mm: Option<f64>,
    /// The frames are so many times smaller.
    pub shrink: u32,
    /// The frames are rectified already, by the projections that the file tells.
    pub is_rectified: bool,
}

/// A rig out of calibration files.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// What kind of files they were.
    pub kind: &'static str,
    /// Columns and rows of a calibrated picture, px.
    pub calibrated_size: [u32; 2],
    /// The frames are so many times smaller.
    pub shrink: u32,
    /// Columns and rows of a view, px. Those that fill no pixel of a smaller frame fall away.
    pub size: [u32; 2],
    /// The rig.
    pub rig: Pinhole,
    /// Distance of the cameras, mm.
    pub baseline_mm: f64,
    /// Whether the rig is that of rectified views.
    pub is_rectified: bool,
    /// The left and the right camera where their lenses must be straightened.
    pub cameras: Option<[CameraModel; 2]>,
}

/// Reads `files`, of two the left camera's first.
///
/// # Errors
/// Names the file, its kind and what is missing.
pub fn import(files: &[PathBuf], options: &Options) -> Result<Imported> {
    ensure!(files.len() <= 2, "{} files: one or two are read, of two the left camera's first", files.len());
    if let [one, other] = files {
        let same = one == other || one.canonicalize().ok().is_some_and(|path| other.canonicalize().ok() == Some(path));
        ensure!(
            !same,
            "{} and {} are the same file: give it alone where it tells of both cameras, else the left and the right camera's",
            one.display(),
            other.display()
        );
    }
    let read = |path: &PathBuf| Ok(Named { name: path.display().to_string(), document: document::read(path)? });
    let named = files.iter().map(read).collect::<Result<Vec<_>>>()?;
    let calibration = formats::calibration(&named)?;
    let names = named.iter().map(|file| file.name.as_str()).collect::<Vec<_>>().join(", ");
    of_calibration(&calibration, options).with_context(|| format!("{names}: {}", calibration.kind))
}

fn of_calibration(calibration: &Calibration, options: &Options) -> Result<Imported> {
    if let (Some(told), Some(asked)) = (calibration.size, options.size) {
        ensure!(
            told == asked,
            "--size {}x{}: the file tells {}x{} px; for frames that are smaller give --shrink",
            asked[0],
            asked[1],
            told[0],
            told[1]
        );
    }
    let size = calibration.size.or(options.size).context("tells no image size: add --size WIDTHxHEIGHT")?;
    let by = f64::from(options.shrink);
    let small = size.map(|px| px / options.shrink);
    let (rig, is_rectified, cameras) = match (&calibration.raw, &calibration.rectified) {
        (Some(raw), _) if !options.is_rectified => {
            check_in_view(&raw.left, size)?;
            check_in_view(&raw.right, size)?;
            let turn = Rotation3::from_matrix_unchecked(raw.rotation).angle().to_degrees();
            ensure!(
                turn <= MOST_TURN_DEG,
                "the cameras are turned by {turn:.0} degrees to each other, {MOST_TURN_DEG} are the most: is one view stored \
                 turned, or the rotation not that from the left to the right camera?"
            );
            let shrunk = Raw { left: raw.left.shrunk(by), right: raw.right.shrunk(by), ..raw.clone() };
            let plain = pinhole::of_raw(&shrunk, small)?;
            if plain.row_residual[1].max(plain.column_residual[1]) <= MOST_LEFT {
                (plain, false, None)
            } else {
                // Those of the pictures that were calibrated, so that views shrunk now or later are rectified alike.
                let (rig, cameras) = lenses::of_raw(raw, size, &plain)?;
                (rig.shrunk(by), false, Some(cameras.map(|camera| camera.shrunk(by))))
            }
        }
        (_, Some(rectified)) => (pinhole::of_rectified(&rectified.shrunk(by)), true, None),
        _ => bail!("tells no rectified views (P1, P2): leave --rectified out"),
    };
    let unit_mm = options.unit_mm.or(calibration.unit_mm).or_else(|| unit_of(rig.baseline));
    let unit_mm = unit_mm.with_context(|| {
        format!(
            "the distance of the cameras is {}: tell by --unit-mm how many mm a unit is (the side of a square?)",
            short(rig.baseline)
        )
    })?;
    let baseline_mm = rig.baseline * unit_mm;
    ensure!(
        BASELINES_MM.contains(&baseline_mm),
        "the cameras would be {} mm apart, where 1 to 10000 mm are supported: the file tells {}, a unit is taken for {unit_mm} \
         mm; tell by --unit-mm how many mm it is",
        short(baseline_mm),
        short(rig.baseline)
    );
    Ok(Imported {
        kind: calibration.kind,
        calibrated_size: size,
        shrink: options.shrink,
        size: small,
        rig,
        baseline_mm,
        is_rectified,
        cameras,
    })
}

/// An axis far outside of the picture is that of pictures of another size.
fn check_in_view(camera: &Camera, [width, height]: [u32; 2]) -> Result<()> {
    let [_, _, cx, cy] = camera.intrinsics;
    ensure!(
        (0.2..0.8).contains(&(cx / f64::from(width))) && (0.2..0.8).contains(&(cy / f64::from(height))),
        "the axis at {cx:.0}, {cy:.0} px is not in the middle of {width}x{height} px: the size is that of other pictures"
    );
    Ok(())
}

/// A length with the digits that tell its size.
fn short(length: f64) -> String {
    if (0.01..1e6).contains(&length) { format!("{}", (length * 1e4).round() / 1e4) } else { format!("{length:.1e}") }
}

/// What the unit of a length between two cameras of a rig must be: mm or m, if one alone is likely.
fn unit_of(baseline: f64) -> Option<f64> {
    match baseline {
        20.0..2000.0 => Some(1.0),
        0.02..2.0 => Some(1000.0),
        _ => None,
    }
}

/// What kind of calibration file that is no rig description is, to tell a user who mixed them up.
#[must_use]
pub fn kind_of(path: &Path) -> Option<Kind> {
    Kind::of(&document::read(path).ok()?)
}
