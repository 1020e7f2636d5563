//! What a method makes of the parts of a rendered scene: each layer, and what only the left view sees.

use haarline::confidence::SURE;
use serde::Serialize;

use super::Rendering;
use crate::DisparityMap;
use crate::score::error_q8;

/// What became of the pixels of a part of the scene. All but the pixels are percent of these.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RegionScore {
    /// What it is.
    pub name: &'static str,
    /// How many pixels there are.
    pub pixels: u64,
    /// Answered ones.
    pub answered_percent: f64,
    /// Answered wrong, by more than 2 px.
    pub wrong_percent: f64,
    /// With a sure answer.
    pub sure_percent: f64,
    /// Sure and wrong.
    pub sure_wrong_percent: f64,
}

/// What hides behind something from the right view.
pub const HIDDEN: &str = "hidden strips";

impl RegionScore {
    fn of(name: &'static str, rendering: &Rendering, map: &DisparityMap, holds: impl Fn(usize) -> bool) -> Self {
        let [mut pixels, mut answered, mut wrong, mut sure, mut sure_wrong] = [0_u64; 5];
        let first = rendering.truth.first_column;
        for index in (0..map.disparity.len()).filter(|&index| index % map.width >= first && holds(index)) {
            let error = error_q8(map.disparity[index], rendering.truth.disparity_q8[index]);
            let is_wrong = error.is_some_and(|error| error > 512);
            let is_sure = error.is_some() && map.confidence[index] >= SURE;
            pixels += 1;
            answered += u64::from(error.is_some());
            wrong += u64::from(is_wrong);
            sure += u64::from(is_sure);
            sure_wrong += u64::from(is_sure && is_wrong);
        }
        let percent = |count: u64| 100.0 * count as f64 / pixels.max(1) as f64;
        Self {
            name,
            pixels,
            answered_percent: percent(answered),
            wrong_percent: percent(wrong),
            sure_percent: percent(sure),
            sure_wrong_percent: percent(sure_wrong),
        }
    }

    /// A score for each layer, named by `names`, where both cameras see it, and one for what is hidden.
    ///
    /// # Panics
    /// If map and rendering differ in size.
    #[must_use]
    pub fn all(names: &[&'static str], rendering: &Rendering, map: &DisparityMap) -> Vec<Self> {
        assert!(rendering.truth.fits(map), "map and truth differ in size");
        let seen = &rendering.truth.seen_by_both;
        let of_layer = |(layer, &name): (usize, &&'static str)| {
            Self::of(name, rendering, map, |index| seen[index] && rendering.layer[index] == layer)
        };
        let layers = names.iter().enumerate().map(of_layer);
        layers.chain([Self::of(HIDDEN, rendering, map, |index| !seen[index])]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{Scene, YARD};

    #[test]
    fn every_part_of_the_yard_is_there_and_the_truth_is_right_in_all() {
        let rendering = Scene::yard(0).render();
        let regions = RegionScore::all(&YARD, &rendering, &rendering.truth.to_map());
        assert_eq!(regions.len(), 7);
        for region in &regions {
            assert!(region.pixels > 600, "{region:?}");
            assert_eq!((region.sure_percent, region.wrong_percent), (100.0, 0.0), "{region:?}");
        }
        let columns = 320 - rendering.truth.first_column as u64;
        assert_eq!(regions.iter().map(|region| region.pixels).sum::<u64>(), 240 * columns);
    }
}
