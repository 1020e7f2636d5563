//! Obstacles judged both ways: a missed one is a crash, a phantom a brake.
//!
//! The same finder looks at the answers of a method and at the true disparities of what both cameras see. A scene
//! without a rig is looked at as if by level cameras for which everything is in the way, so that distances are those of
//! its disparities to scale. That an obstacle is found counts in the sectors beside its own, too, whose border its edge may
//! have crossed by a pixel; what is told too far there is what stands beside it.

use std::collections::BTreeMap;

use anyhow::Result;
use haarline::obstacle::Settings;
use haarline_rig::{Description, template};
use serde::Serialize;

use crate::DisparityMap;
use crate::score::scene::Scene;
use crate::stereo::obstacles::ObstacleFinder;

/// A distance is found if it is within so much of the true one.
const FOUND: f64 = 0.15;
/// And told too far from so much more on.
const TOO_FAR: f64 = 0.25;
/// Share of a scene's pixels whose truth must be known for it to be judged.
const LEAST_TRUTH: f64 = 0.5;

/// What became of obstacles. A frame's obstacle is its nearest one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// How many there are.
    pub obstacles: u64,
    /// Told within 15 percent of where they are.
    pub found: u64,
    /// Not told of at all: no data in its sectors.
    pub missed: u64,
    /// Told more than 25 percent too far, in one of its sectors and nowhere nearer.
    pub too_far: u64,
    /// Told more than 15 percent too near, there or beside.
    pub too_near: u64,
}

impl Counts {
    /// Adds those of another frame.
    pub fn add(&mut self, other: &Self) {
        self.obstacles += other.obstacles;
        self.found += other.found;
        self.missed += other.missed;
        self.too_far += other.too_far;
        self.too_near += other.too_near;
    }

    /// One obstacle at `truth`, what is told in the sectors that it stands in, and around it.
    fn judge(&mut self, truth: f64, told: impl Iterator<Item = f64>, around: impl Iterator<Item = f64> + Clone) {
        self.obstacles += 1;
        let nearest = told.reduce(f64::min);
        let is_found = around.clone().any(|mm| (mm / truth - 1.0).abs() <= FOUND);
        let is_near = around.into_iter().any(|mm| mm < truth * (1.0 - FOUND));
        self.found += u64::from(is_found);
        self.missed += u64::from(!is_found && !is_near && nearest.is_none());
        self.too_far += u64::from(!is_found && !is_near && nearest.is_some_and(|mm| mm > truth * (1.0 + TOO_FAR)));
        self.too_near += u64::from(!is_found && is_near);
    }
}

/// Obstacles of a scene, or of many.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ObstacleScore {
    /// Scenes judged.
    pub frames: u64,
    /// Of these, frames of which nothing is told, since the input is not as it should be.
    pub silent: u64,
    /// Scenes whose truth is too sparse to be judged.
    pub sparse: u64,
    /// The nearest obstacle of each frame.
    pub nearest: Counts,
    /// The nearest obstacle of each sector.
    pub sectors: Counts,
    /// Those of [`ObstacleScore::nearest`] by range.
    pub by_range: BTreeMap<Range, Counts>,
    /// Frames with a sector in which something is told that is nearer than all that is there, less 15 percent.
    pub phantom_frames: u64,
    /// Such sectors.
    pub phantom_sectors: u64,
}

/// Where an obstacle is, in steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Range {
    /// From so many cm on, by the scene's rig.
    Metres(u32),
    /// From so many px of disparity on, where there is no rig.
    Disparity(u32),
}

impl Serialize for Range {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.name())
    }
}

impl Range {
    /// Least distances, cm.
    const CM: [u32; 6] = [0, 70, 110, 160, 220, 330];
    /// Least disparities, px.
    const PX: [u32; 5] = [0, 4, 8, 16, 32];

    /// As it is told.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Metres(cm) => format!("from {:.1} m", f64::from(cm) / 100.0),
            Self::Disparity(px) => format!("from {px} px"),
        }
    }

    fn of(rig: &Description, has_rig: bool, mm: f64) -> Self {
        let step = |steps: &[u32], value: f64| steps.iter().rev().copied().find(|&s| f64::from(s) <= value);
        if has_rig {
            Self::Metres(step(&Self::CM, mm / 10.0).unwrap_or(0))
        } else {
            Self::Disparity(step(&Self::PX, rig.focal_px * rig.baseline_mm / mm).unwrap_or(0))
        }
    }
}

impl ObstacleScore {
    /// Looks for obstacles in `map` and in the truth. Of a frame that is not `input_ok` nothing is told.
    ///
    /// # Errors
    /// If the scene's focal length and baseline are out of a rig's range.
    ///
    /// # Panics
    /// If map and truth differ in size.
    pub fn of(scene: &Scene, map: &DisparityMap, sure_from: u8, input_ok: bool) -> Result<Self> {
        let truth = &scene.truth;
        assert!(truth.fits(map), "map and truth differ in size");
        let known = truth.disparity_q8.iter().filter(|q8| **q8 != 0).count();
        if (known as f64) < LEAST_TRUTH * truth.disparity_q8.len() as f64 {
            return Ok(Self { sparse: 1, ..Self::default() });
        }
        let rig = rig_of(scene)?;
        let settings = Settings { min_confidence: sure_from, ..Settings::DEFAULT };
        let mut finder = ObstacleFinder::with_settings(&rig, settings)?;
        let mm = |found: Vec<Option<u32>>| found.into_iter().map(|mm| mm.map(f64::from)).collect::<Vec<_>>();
        let told = if input_ok { mm(finder.find(map)) } else { vec![None; finder.setup().sectors.count] };
        let mut visible = truth.to_map();
        for (index, seen) in truth.seen_by_both.iter().enumerate() {
            if !seen {
                visible.disparity[index] = haarline::Disparity::UNKNOWN;
                visible.confidence[index] = 0;
            }
        }
        let there = mm(finder.find(&visible));
        let real = nearest_real(scene, &rig, there.len());
        let mut score = Self { frames: 1, silent: u64::from(!input_ok), ..Self::default() };
        score.judge(&told, &there, |mm| Range::of(&rig, scene.rig.is_some(), mm));
        score.count_phantoms(&told, &real);
        Ok(score)
    }

    fn judge(&mut self, told: &[Option<f64>], there: &[Option<f64>], range: impl Fn(f64) -> Range) {
        for (sector, truth) in there.iter().enumerate() {
            if let Some(truth) = truth {
                self.sectors.judge(*truth, told[sector].into_iter(), beside(sector, told));
            }
        }
        let Some(nearest) = there.iter().flatten().copied().reduce(f64::min) else { return };
        let is_its = |truth: &Option<f64>| truth.is_some_and(|mm| mm <= nearest * (1.0 + FOUND));
        let its = (0..there.len()).filter(|&sector| is_its(&there[sector]));
        let around = its.clone().flat_map(|sector| beside(sector, told));
        let mut counts = Counts::default();
        counts.judge(nearest, its.filter_map(|sector| told[sector]), around);
        self.nearest.add(&counts);
        self.by_range.entry(range(nearest)).or_default().add(&counts);
    }

    fn count_phantoms(&mut self, told: &[Option<f64>], real: &[Option<f64>]) {
        for (sector, told) in told.iter().enumerate() {
            let Some(told) = told else { continue };
            let nearest = beside(sector, real).reduce(f64::min);
            self.phantom_sectors += u64::from(nearest.is_none_or(|real| *told < real * (1.0 - FOUND)));
        }
        self.phantom_frames += u64::from(self.phantom_sectors > 0);
    }

    /// Adds those of another scene.
    pub fn add(&mut self, other: &Self) {
        self.frames += other.frames;
        self.silent += other.silent;
        self.sparse += other.sparse;
        self.nearest.add(&other.nearest);
        self.sectors.add(&other.sectors);
        for (range, counts) in &other.by_range {
            self.by_range.entry(*range).or_default().add(counts);
        }
        self.phantom_frames += other.phantom_frames;
        self.phantom_sectors += other.phantom_sectors;
    }
}

/// What is known in a sector and in those beside it.
fn beside(sector: usize, values: &[Option<f64>]) -> impl Iterator<Item = f64> + Clone {
    let (from, to) = (sector.saturating_sub(1), (sector + 2).min(values.len()));
    values[from..to].iter().filter_map(|value| *value)
}

/// The scene's rig; without one level cameras with the focal length and baseline that are known, or any.
fn rig_of(scene: &Scene) -> Result<Description> {
    if let Some(rig) = &scene.rig {
        return Ok(rig.clone());
    }
    let [width, height] = [scene.pair.width(), scene.pair.height()];
    let known = scene.meta.focal_px.zip(scene.meta.baseline_mm);
    let (focal_px, baseline_mm) = known.unwrap_or((width as f64, 100.0));
    let lines = [
        ("width", width.to_string()),
        ("height", height.to_string()),
        ("focal_px", format!("{focal_px:?}")),
        ("baseline_mm", format!("{baseline_mm:?}")),
        ("num_disparities", scene.meta.num_disparities.to_string()),
        ("camera_height_mm", "0".to_owned()),
        ("lowest_mm", "-10000".to_owned()),
        ("highest_mm", "10000".to_owned()),
    ];
    let line = |line: &str| {
        let change = lines.iter().find(|(name, _)| line.starts_with(&format!("{name} =")));
        change.map_or_else(|| line.to_owned(), |(name, value)| format!("{name} = {value}"))
    };
    Ok(Description::parse(&template().lines().map(line).collect::<Vec<_>>().join("\n"))?)
}

/// Distance over the ground to the nearest pixel in the band of heights, sector by sector, mm, whether it is seen by
/// both cameras or not; the finder wants several that agree, this none.
fn nearest_real(scene: &Scene, rig: &Description, sectors: usize) -> Vec<Option<f64>> {
    let (sin, cos) = rig.pitch_deg.to_radians().sin_cos();
    let [middle_x, middle_y] = [rig.width, rig.height].map(|length| (f64::from(length) - 1.0) / 2.0);
    let band = f64::from(rig.lowest_mm)..=f64::from(rig.highest_mm);
    let mut nearest: Vec<Option<f64>> = vec![None; sectors];
    let truth = &scene.truth;
    for (index, &q8) in truth.disparity_q8.iter().enumerate().filter(|(_, q8)| **q8 != 0) {
        let depth = rig.depth_mm(f64::from(q8) / 256.0);
        let across = ((index % truth.width) as f64 - middle_x) / rig.focal_px;
        let down = ((index / truth.width) as f64 - middle_y) / rig.focal_px;
        let (ahead, rise) = (depth * (cos + down * sin), depth * (sin - down * cos));
        if ahead <= 0.0 || !band.contains(&(f64::from(rig.camera_height_mm) + rise)) {
            continue;
        }
        let lateral = depth * across;
        let sector = lateral.atan2(ahead).to_degrees() / f64::from(rig.sector_deg) + (sectors / 2) as f64;
        if let Some(slot) = nearest.get_mut(sector.round().max(0.0) as usize) {
            let range = lateral.hypot(ahead);
            *slot = Some(slot.map_or(range, |least| least.min(range)));
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(told: &[Option<f64>], there: &[Option<f64>]) -> ObstacleScore {
        let mut score = ObstacleScore { frames: 1, ..ObstacleScore::default() };
        score.judge(told, there, |_| Range::Metres(0));
        score.count_phantoms(told, there);
        score
    }

    #[test]
    fn a_frame_is_found_missed_too_far_or_too_near() {
        let there = [None, None, Some(1000.0), Some(3000.0), Some(3000.0)];
        let of = |told: Option<f64>| {
            let counts = judged(&[None, None, told, None, None], &there).nearest;
            [counts.obstacles, counts.found, counts.missed, counts.too_far, counts.too_near]
        };
        assert_eq!(of(Some(1149.0)), [1, 1, 0, 0, 0]);
        assert_eq!(of(None), [1, 0, 1, 0, 0]);
        assert_eq!(of(Some(1300.0)), [1, 0, 0, 1, 0]);
        assert_eq!(of(Some(1200.0)), [1, 0, 0, 0, 0]);
        assert_eq!(of(Some(800.0)), [1, 0, 0, 0, 1]);
        // The sector beside the post told of it.
        assert_eq!(judged(&[None, Some(1000.0), Some(3000.0), None, None], &there).nearest.found, 1);
        // What stands beside the post is no error of the post's.
        let beside = judged(&[None, Some(3000.0), None, Some(3000.0), None], &there).nearest;
        assert_eq!((beside.missed, beside.too_far), (1, 0));
        let near = judged(&[None, Some(700.0), None, Some(3000.0), None], &there).nearest;
        assert_eq!((near.missed, near.too_near), (0, 1));
    }

    #[test]
    fn a_phantom_is_nearer_than_all_around_it() {
        let there = [Some(3000.0), Some(3000.0), Some(3000.0), Some(1000.0), None];
        let phantoms = |told: [Option<f64>; 5]| judged(&told, &there).phantom_sectors;
        assert_eq!(phantoms([None; 5]), 0);
        assert_eq!(phantoms([Some(2600.0), None, Some(1000.0), Some(900.0), Some(900.0)]), 0);
        assert_eq!(phantoms([Some(2500.0), Some(1000.0), None, Some(800.0), None]), 3);
    }
}
