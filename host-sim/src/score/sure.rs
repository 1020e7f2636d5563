//! What a confidence is worth: how many answers are sure, and how many of these are wrong.
//!
//! An answer is *sure* from a confidence of [`haarline::confidence::SURE`] on. It is wrong if it is off by more than 2 px, and *near* if it
//! is more than 2 px too great, so that things seem nearer than they are.

use haarline::Disparity;
use serde::Serialize;

use super::{Q8_PER_STEP, error_q8};
use crate::DisparityMap;
use crate::score::scene::Truth;

/// What the sure answers of a map are worth. All are percentages; `None` is undefined.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SureScore {
    /// Sure share of the scored pixels.
    pub sure_density: f64,
    /// Share of the sure ones that are wrong.
    pub sure_bad2: Option<f64>,
    /// Share of the scored pixels that are sure and wrong.
    pub sure_wrong: f64,
    /// Share of the scored pixels that are sure and near.
    pub sure_near: f64,
    /// The same of the pixels that the right view does not see, whose truth is known, in any column: sure and wrong.
    pub hidden_sure_wrong: Option<f64>,
    /// Sure and near.
    pub hidden_sure_near: Option<f64>,
}

/// A figure of [`SureScore`]: its key, the same in JSON and tables, and how to get it.
pub type SureFigure = (&'static str, fn(&SureScore) -> Option<f64>);

impl SureScore {
    /// All figures, in the order in which they are shown.
    pub const FIGURES: [SureFigure; 6] = [
        ("sure_density", |sure| Some(sure.sure_density)),
        ("sure_bad2", |sure| sure.sure_bad2),
        ("sure_wrong", |sure| Some(sure.sure_wrong)),
        ("sure_near", |sure| Some(sure.sure_near)),
        ("hidden_sure_wrong", |sure| sure.hidden_sure_wrong),
        ("hidden_sure_near", |sure| sure.hidden_sure_near),
    ];

    /// The score of `map`, whose answers are sure from confidence `sure_from` on.
    ///
    /// # Panics
    /// If map and truth differ in size.
    #[must_use]
    pub fn of(map: &DisparityMap, truth: &Truth, sure_from: u8) -> Self {
        assert!(truth.fits(map), "map and truth differ in size");
        let (mut scored, mut hidden) = (Tally::default(), Tally::default());
        for (index, &true_q8) in truth.disparity_q8.iter().enumerate().filter(|(_, q8)| **q8 != 0) {
            let is_hidden = !truth.seen_by_both[index];
            if is_hidden || truth.is_scored(index) {
                let tally = if is_hidden { &mut hidden } else { &mut scored };
                tally.add(map.disparity[index], map.confidence[index] >= sure_from, true_q8);
            }
        }
        let of_hidden = |count: u64| (hidden.pixels > 0).then(|| percent(count, hidden.pixels));
        Self {
            sure_density: percent(scored.sure, scored.pixels),
            sure_bad2: (scored.sure > 0).then(|| percent(scored.wrong, scored.sure)),
            sure_wrong: percent(scored.wrong, scored.pixels),
            sure_near: percent(scored.near, scored.pixels),
            hidden_sure_wrong: of_hidden(hidden.wrong),
            hidden_sure_near: of_hidden(hidden.near),
        }
    }

    /// The plain mean of each figure over the scenes in which it is defined.
    #[must_use]
    pub fn mean<'a>(scores: impl Iterator<Item = &'a Self> + Clone) -> Self {
        Self::combine(scores, |values| values.iter().sum::<f64>() / values.len() as f64)
    }

    /// The worst of each figure: the least density, the most of everything else.
    #[must_use]
    pub fn worst<'a>(scores: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let most = Self::combine(scores.clone(), |values| values.iter().copied().fold(f64::MIN, f64::max));
        let densities = scores.map(|sure| sure.sure_density);
        Self { sure_density: densities.reduce(f64::min).unwrap_or(0.0), ..most }
    }

    fn combine<'a>(scores: impl Iterator<Item = &'a Self> + Clone, combine: impl Fn(&[f64]) -> f64) -> Self {
        let [sure_density, sure_bad2, sure_wrong, sure_near, hidden_sure_wrong, hidden_sure_near] =
            Self::FIGURES.map(|(_, figure)| {
                let values: Vec<f64> = scores.clone().filter_map(figure).collect();
                (!values.is_empty()).then(|| combine(&values))
            });
        Self {
            sure_density: sure_density.unwrap_or(0.0),
            sure_bad2,
            sure_wrong: sure_wrong.unwrap_or(0.0),
            sure_near: sure_near.unwrap_or(0.0),
            hidden_sure_wrong,
            hidden_sure_near,
        }
    }
}

#[derive(Debug, Default)]
struct Tally {
    pixels: u64,
    sure: u64,
    wrong: u64,
    near: u64,
}

impl Tally {
    fn add(&mut self, answer: Disparity, is_sure: bool, true_q8: u16) {
        self.pixels += 1;
        if let Some(bits) = answer.known().filter(|_| is_sure) {
            self.sure += 1;
            self.wrong += u64::from(error_q8(answer, true_q8).is_some_and(|error| error > 512));
            self.near += u64::from(i32::from(bits) * Q8_PER_STEP - i32::from(true_q8) > 512);
        }
    }
}

fn percent(count: u64, of: u64) -> f64 {
    100.0 * count as f64 / of.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_sure_answers_count_and_near_ones_are_told_apart() {
        let px = |px: i16| Disparity::from_bits(px * 16);
        let truth = Truth {
            width: 10,
            disparity_q8: vec![10 * 256; 10],
            seen_by_both: (0..10).map(|x| x < 8).collect(),
            first_column: 2,
        };
        // Columns 2 to 7 are scored: right, 2 off exactly, near, far, near but not sure, unknown; 8 and 9 are hidden.
        let answers = [px(3), px(3), px(10), px(12), px(13), px(7), px(20), Disparity::UNKNOWN, px(13), px(10)];
        let confidence = vec![200, 200, 64, 64, 64, 64, 63, 0, 255, 255];
        let map = DisparityMap { width: 10, height: 1, disparity: answers.to_vec(), confidence };
        let sure = SureScore::of(&map, &truth, 64);
        let close = |value: f64, wanted: f64| assert!((value - wanted).abs() < 1e-9, "{value} for {wanted}: {sure:?}");
        close(sure.sure_density, 400.0 / 6.0);
        close(sure.sure_bad2.unwrap(), 50.0);
        close(sure.sure_wrong, 200.0 / 6.0);
        close(sure.sure_near, 100.0 / 6.0);
        close(sure.hidden_sure_wrong.unwrap(), 50.0);
        close(sure.hidden_sure_near.unwrap(), 50.0);
        assert_eq!(SureScore::of(&map, &truth, 65).sure_bad2, None);
    }

    #[test]
    fn the_worst_scene_is_that_of_most_wrong_and_least_sure() {
        let score = |sure_density, sure_bad2| SureScore { sure_density, sure_bad2, ..SureScore::default() };
        let scores = [score(80.0, Some(1.0)), score(10.0, None), score(60.0, Some(3.0))];
        let (mean, worst) = (SureScore::mean(scores.iter()), SureScore::worst(scores.iter()));
        assert_eq!((mean.sure_density, mean.sure_bad2), (50.0, Some(2.0)));
        assert_eq!((worst.sure_density, worst.sure_bad2), (10.0, Some(3.0)));
    }
}
