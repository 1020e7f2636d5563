//! Rig descriptions in files.

use std::path::Path;

use anyhow::{Result, anyhow, bail, ensure};
use haarline_rig::Description;

use super::frame::Shrink;
use super::whole_file;
use crate::rig::import;

/// Reads the description in `path`.
///
/// # Errors
/// Names the file and what is wrong in it.
pub fn read(path: &Path) -> Result<Description> {
    let name = path.display();
    ensure!(!path.is_dir(), "{name}: is a folder, where a rig description is expected");
    let text = whole_file::text(path)?;
    Description::parse(&text).map_err(|error| match import::kind_of(path) {
        Some(kind) if kind.is_of_rig() => {
            let kind = kind.words();
            anyhow!("{name}: this is {kind}; haarline rig import {name} -o rig.toml makes a rig description of it")
        }
        Some(kind) => anyhow!("{name}: this is {}, where a rig description is expected", kind.words()),
        None => anyhow!("{name}: {error}"),
    })
}

/// The rig of views that are shrunk. The column offset is rounded to whole pixels of these, the search reaches as far.
#[must_use]
pub fn shrunk(rig: &Description, shrink: Shrink) -> Description {
    let k = shrink.factor() as i32;
    let side = |side: u16| shrink.of(side.into()) as u16;
    let whole = |px: i32| (f64::from(px) / f64::from(k)).round() as i32;
    let (first, end) = (i32::from(rig.min_disparity), rig.max_disparity() + 1);
    let min_disparity = first.div_euclid(k);
    Description {
        width: side(rig.width),
        height: side(rig.height),
        focal_px: rig.focal_px / f64::from(k),
        row_offset: rig.row_offset / f64::from(k),
        column_offset: whole(rig.column_offset.into()) as i16,
        principal: rig.principal.map(|at| at.map(|px| (px + 0.5) / f64::from(k) - 0.5)),
        doffs: rig.doffs / f64::from(k),
        cameras: rig.cameras.map(|cameras| cameras.map(|camera| camera.shrunk(f64::from(k)))),
        correction: rig.correction.iter().map(|row| row.iter().map(|px| px / f64::from(k)).collect()).collect(),
        min_disparity: min_disparity as i16,
        num_disparities: ((end + k - 1).div_euclid(k) - min_disparity) as u16,
        ..rig.clone()
    }
}

/// Refuses views of another size than the rig's.
///
/// # Errors
/// Names both sizes.
pub fn check_size(description: &Description, [width, height]: [usize; 2]) -> Result<()> {
    let rig = [description.width, description.height].map(usize::from);
    ensure!(
        rig == [width, height],
        "--rig: its width and height are {}x{} px, but the views are {width}x{height} px{}",
        rig[0],
        rig[1],
        advice(rig, [width, height])
    );
    Ok(())
}

/// What to do about views of `views` px where those of a rig are of `rig` px.
fn advice(rig: [usize; 2], views: [usize; 2]) -> String {
    let times = |larger: [usize; 2], smaller| (2..=8).find(|k| larger.map(|px| px / k) == smaller);
    if let Some(k) = times(rig, views) {
        format!("; they are {k} times smaller: haarline rig import --shrink {k} makes a rig for them")
    } else if let Some(k) = times(views, rig) {
        format!(
            "; they are {k} times larger: haarline rig import without --shrink, or with a smaller one, makes a rig for them"
        )
    } else if rig == [views[1], views[0]] {
        "; they are turned by 90 degrees".to_owned()
    } else {
        "; the rig is that of other views: calibrate or import it at their size".to_owned()
    }
}

/// Refuses shrunk views of another size than those of the rig, which was described as `rig` and is `shrunk` as they are.
///
/// # Errors
/// Names the sizes before and after.
pub fn check_shrunk_size(rig: &Description, shrunk: &Description, shrink: Shrink, size: [usize; 2]) -> Result<()> {
    let [width, height] = [shrunk.width, shrunk.height].map(usize::from);
    if shrink == Shrink::NONE || [width, height] == size {
        return check_size(shrunk, size);
    }
    let k = shrink.factor();
    let advice = advice([width, height], size);
    bail!(
        "--rig: its width and height are {}x{} px, with --shrink {k} {width}x{height} px, but the views are {}x{} px after \
         --shrink {k}{advice}",
        rig.width,
        rig.height,
        size[0],
        size[1]
    )
}
