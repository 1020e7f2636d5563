//! The lines of Middlebury's and KITTI's calib.txt: rectified cameras.

use std::collections::BTreeMap;

use anyhow::{Context, Result, ensure};

use super::super::calibration::{Calibration, Rectified};
use super::size;

fn values(lines: &BTreeMap<String, String>, name: &str, count: usize) -> Result<Vec<f64>> {
    let text = lines.get(name).with_context(|| format!("{name} is missing"))?;
    let words = text.split(|c: char| c.is_whitespace() || "[];,".contains(c)).filter(|word| !word.is_empty());
    let number = |word: &str| word.parse().ok().filter(|value: &f64| value.is_finite());
    let found: Option<Vec<f64>> = words.map(number).collect();
    let found = found.with_context(|| format!("{name} = {text}: holds something that is no number"))?;
    ensure!(found.len() == count, "{name}: has {} numbers, where {count} are expected", found.len());
    Ok(found)
}

pub(super) fn middlebury(lines: &BTreeMap<String, String>) -> Result<Calibration> {
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

pub(super) fn kitti(lines: &BTreeMap<String, String>) -> Result<Calibration> {
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
