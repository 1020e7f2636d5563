//! Calibrations as other tools write them, turned into a rig description.
//!
//! [`document`] reads YAML, XML, JSON and lines, [`formats`] finds the two cameras in them, [`calibration`] is what
//! they have in common, [`pinhole`] the nearest rig without lens tables, [`lenses`] the one with them.

pub mod calibration;
pub mod document;
pub mod formats;
pub mod lenses;
pub mod pinhole;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};

use calibration::{Calibration, Camera, Raw};
use haarline_rig::CameraModel;
use pinhole::Pinhole;

/// Rows and columns, px, up to which what lenses and turns do is left alone.
const MOST_LEFT: f64 = 0.1;

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
    /// Columns and rows of a view, px.
    pub size: [u32; 2],
    /// Columns and rows of the calibrated pictures that fill no pixel of the smaller frames.
    pub cut: [u32; 2],
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
    let documents = files.iter().map(|path| document::read(path)).collect::<Result<Vec<_>>>()?;
    ensure!(files.len() <= 2, "{} files: one or two are read, of two the left camera's first", files.len());
    let names = files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    let calibration = formats::calibration(&documents).with_context(|| names.clone())?;
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
            "the distance of the cameras is {:.4}: tell by --unit-mm how many mm a unit is (the side of a square?)",
            rig.baseline
        )
    })?;
    Ok(Imported {
        kind: calibration.kind,
        size: small,
        cut: size.map(|px| px % options.shrink),
        rig,
        baseline_mm: rig.baseline * unit_mm,
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
pub fn kind_of(path: &Path) -> Option<&'static str> {
    let document = document::read(path).ok()?;
    match formats::kind(&document) {
        "a file of OpenCV's" => formats::calibration(&[document]).ok().map(|calibration| calibration.kind),
        kind => Some(kind),
    }
}
