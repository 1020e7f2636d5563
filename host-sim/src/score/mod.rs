//! The scorer: how much of a map is answered, and how much of that is wrong.
//!
//! Scored are the pixels of a [`Region`], as a rule those whose truth is known, which both cameras see and
//! which lie in column `num_disparities` or right of it. An answer is wrong at N px if it is off by
//! *more* than N px. Everything is counted in whole numbers of 1/256 px, so nothing is rounded
//! before the last division.

pub mod ablation;
pub mod baselines;
pub mod confidence_classes;
pub mod degrade;
pub mod evaluation;
pub mod evaluations;
pub(crate) mod evidence;
pub mod map_file;
pub mod obstacle_score;
pub mod report;
pub mod scene;
pub mod sparsification;
pub mod split;
pub mod sure;

use haarline::Disparity;
use serde::Serialize;

use crate::DisparityMap;
use crate::score::confidence_classes::ConfidenceClasses;
use crate::score::scene::{Region, Truth};
use crate::score::sparsification::Sparsification;

/// Steps of 1/256 px in a step of [`Disparity`].
const Q8_PER_STEP: i32 = 1 << (8 - Disparity::FRAC_BITS);

/// Least confidence of an answer given by default. Less is a guess: shown only where it is asked for.
pub const LEAST_DEFAULT_CONFIDENCE: u8 = 16;

/// The scores of a map.
///
/// All are percentages but `epe`. A figure is `None` where it is undefined (what is wrong among no
/// answers at all) or, of OpenCV's published ones, unknown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Score {
    /// Answered share of the scored pixels.
    pub density: f64,
    /// Share of the answered pixels that are off by more than 1 px.
    pub bad1: Option<f64>,
    /// Share of the answered pixels that are off by more than 2 px.
    pub bad2: Option<f64>,
    /// Share of the scored pixels that are off by more than half a pixel or not answered.
    pub tot05: Option<f64>,
    /// Share of the scored pixels that are off by more than 1 px or not answered.
    pub tot1: f64,
    /// Share of the scored pixels that are off by more than 2 px or not answered.
    pub tot2: f64,
    /// Share of the scored pixels that are off by more than a tenth of the true disparity, which is a tenth of
    /// the depth, or not answered.
    pub off10: Option<f64>,
    /// Mean absolute error of the answered pixels, px.
    pub epe: Option<f64>,
    /// `bad2` of the most confident answers only, as many as StereoBM gives
    /// ([`Sparsification::bad_at`]).
    pub bad2_at_bm_density: Option<f64>,
    /// Area under the sparsification curve ([`Sparsification::area`]).
    pub auc: Option<f64>,
}

/// A figure of [`Score`]: its key, the same in JSON and options, and how to get it.
pub type Figure = (&'static str, fn(&Score) -> Option<f64>);

impl Score {
    /// All figures, in the order in which they are shown.
    pub const FIGURES: [Figure; 10] = [
        ("density", |score| Some(score.density)),
        ("bad1", |score| score.bad1),
        ("bad2", |score| score.bad2),
        ("tot05", |score| score.tot05),
        ("tot1", |score| Some(score.tot1)),
        ("tot2", |score| Some(score.tot2)),
        ("off10", |score| score.off10),
        ("epe", |score| score.epe),
        ("bad2_at_bm_density", |score| score.bad2_at_bm_density),
        ("auc", |score| score.auc),
    ];

    /// The figure of that key; `None` if it is undefined, or if there is no such key.
    #[must_use]
    pub fn figure(&self, key: &str) -> Option<f64> {
        Self::FIGURES.iter().find(|figure| figure.0 == key)?.1(self)
    }

    /// Scores all answers of `map` in [`Region::Scored`]; `None` if no pixel is scored. `reference_density` is
    /// the density, in percent of the scored pixels, at which [`Score::bad2_at_bm_density`] is taken.
    ///
    /// # Panics
    /// If map and truth differ in size.
    #[must_use]
    pub fn of(map: &DisparityMap, truth: &Truth, reference_density: Option<f64>) -> Option<Self> {
        Tally::of(map, truth, Region::Scored, 0).score(reference_density)
    }

    /// The plain mean of each figure over the scenes in which it is defined; `None` of no score.
    #[must_use]
    pub fn mean<'a>(scores: impl IntoIterator<Item = &'a Self> + Clone) -> Option<Self> {
        let mean = |(_, figure): Figure| {
            let (mut sum, mut count) = (0.0, 0_u32);
            for value in scores.clone().into_iter().filter_map(figure) {
                sum += value;
                count += 1;
            }
            (count > 0).then(|| sum / f64::from(count))
        };
        let [density, bad1, bad2, tot05, tot1, tot2, off10, epe, bad2_at_bm_density, auc] = Self::FIGURES.map(mean);
        let (density, tot1, tot2) = (density?, tot1?, tot2?);
        Some(Self { density, bad1, bad2, tot05, tot1, tot2, off10, epe, bad2_at_bm_density, auc })
    }
}

/// What a map scores in a region: with all its answers, and with those given by default alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapScore {
    /// Of all answers, guesses included.
    #[serde(flatten)]
    pub all: Score,
    /// Of the answers with a confidence of [`LEAST_DEFAULT_CONFIDENCE`] or more, others counting as unanswered.
    pub default_answers: Score,
    /// What each confidence is worth.
    pub confidence_classes: ConfidenceClasses,
}

impl MapScore {
    /// Scores `map` in `region`; `None` if no pixel lies in it. For `reference_density` see [`Score::of`].
    ///
    /// # Panics
    /// If map and truth differ in size.
    #[must_use]
    pub fn of(map: &DisparityMap, truth: &Truth, region: Region, reference_density: Option<f64>) -> Option<Self> {
        let all = Tally::of(map, truth, region, 0);
        let default_answers = Tally::of(map, truth, region, LEAST_DEFAULT_CONFIDENCE);
        Some(Self {
            all: all.score(reference_density)?,
            default_answers: default_answers.score(reference_density)?,
            confidence_classes: ConfidenceClasses::of(&all.sparsification, all.scored),
        })
    }

    /// The plain mean over scenes; `None` of no score.
    #[must_use]
    pub fn mean<'a>(scores: impl Iterator<Item = &'a Self> + Clone) -> Option<Self> {
        Some(Self {
            all: Score::mean(scores.clone().map(|score| &score.all))?,
            default_answers: Score::mean(scores.clone().map(|score| &score.default_answers))?,
            confidence_classes: ConfidenceClasses::mean(scores.map(|score| &score.confidence_classes)),
        })
    }
}

/// Counts over the scored pixels of a map.
#[derive(Debug, Clone, Default)]
struct Tally {
    scored: u64,
    over05: u64,
    over1: u64,
    over2: u64,
    over_tenth: u64,
    /// Sum of the absolute errors, 1/256 px.
    error_q8: u64,
    sparsification: Sparsification,
}

impl Tally {
    /// Counts in `region`; answers of less than `least_confidence` are none.
    fn of(map: &DisparityMap, truth: &Truth, region: Region, least_confidence: u8) -> Self {
        assert!(truth.fits(map), "map and truth differ in size");
        let mut tally = Self::default();
        for (index, true_q8) in truth.pixels(region) {
            tally.scored += 1;
            let confidence = map.confidence[index];
            let error = error_q8(map.disparity[index], true_q8).filter(|_| confidence >= least_confidence);
            if let Some(error) = error {
                tally.over05 += u64::from(error > 128);
                tally.over1 += u64::from(error > 256);
                tally.over2 += u64::from(error > 512);
                tally.over_tenth += u64::from(10 * error > u32::from(true_q8));
                tally.error_q8 += u64::from(error);
                tally.sparsification.add(confidence, error > 512);
            }
        }
        tally
    }

    fn score(&self, reference_density: Option<f64>) -> Option<Score> {
        let scored = self.scored as f64;
        let answered = self.sparsification.answered();
        let percent = |count: u64| 100.0 * count as f64 / scored;
        let of_answered = |value: f64| (answered > 0).then(|| value / answered as f64);
        let unanswered = self.scored - answered;
        let at_reference = |density| self.sparsification.bad_at(density / 100.0 * scored);
        (self.scored > 0).then(|| Score {
            density: percent(answered),
            bad1: of_answered(100.0 * self.over1 as f64),
            bad2: of_answered(100.0 * self.over2 as f64),
            tot05: Some(percent(self.over05 + unanswered)),
            tot1: percent(self.over1 + unanswered),
            tot2: percent(self.over2 + unanswered),
            off10: Some(percent(self.over_tenth + unanswered)),
            epe: of_answered(self.error_q8 as f64 / 256.0),
            bad2_at_bm_density: reference_density.and_then(at_reference),
            auc: self.sparsification.area(),
        })
    }
}

/// How far an answer is off, 1/256 px; `None` if there is none.
#[must_use]
pub fn error_q8(answer: Disparity, true_q8: u16) -> Option<u32> {
    answer.known().map(|bits| (i32::from(bits) * Q8_PER_STEP).abs_diff(i32::from(true_q8)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn truth(disparity_q8: &[u16], first_column: usize) -> Truth {
        let width = disparity_q8.len();
        Truth { width, disparity_q8: disparity_q8.to_vec(), seen_by_both: vec![true; width], first_column }
    }

    fn map(bits: &[i16], confidence: &[u8]) -> DisparityMap {
        let disparity = bits.iter().map(|&bits| Disparity::from_bits(bits)).collect();
        DisparityMap { width: bits.len(), height: 1, disparity, confidence: confidence.to_vec() }
    }

    const NONE: i16 = i16::MIN;

    #[test]
    fn small_case_by_hand() {
        // Truth 10 px everywhere but in column 5 (unknown) and 6 (occluded); columns 0, 1 do not count.
        let mut truth = truth(&[2560, 2560, 2560, 2560, 2560, 0, 2560, 2560, 2560, 2560], 2);
        truth.seen_by_both[6] = false;
        // Errors of the scored ones, px: 0, exactly 1, 1 1/16, none, exactly 2, 2 1/16.
        let answers = [0, 0, 160, 176, 143, 999, 999, NONE, 192, 127];
        let score = Score::of(&map(&answers, &[0, 0, 90, 90, 40, 0, 0, 0, 40, 10]), &truth, Some(50.0)).unwrap();
        let close = |value: Option<f64>, wanted: f64| assert!((value.unwrap() - wanted).abs() < 1e-9, "{value:?}");
        close(Some(score.density), 500.0 / 6.0);
        close(score.bad1, 60.0);
        close(score.bad2, 20.0);
        close(score.tot05, 500.0 / 6.0);
        close(Some(score.tot1), 400.0 / 6.0);
        close(Some(score.tot2), 200.0 / 6.0);
        close(score.epe, (1.0 + 1.0625 + 2.0 + 2.0625) / 5.0);
        // A tenth of the disparity is 1 px.
        close(score.off10, 400.0 / 6.0);
        close(score.bad2_at_bm_density, 0.0);
    }

    #[test]
    fn a_tenth_of_the_depth_and_half_a_pixel_are_still_right() {
        // 1 px of 10 and of 9 15/16 px; half a pixel and 1/16 more.
        let truth = truth(&[2560, 2544, 25600, 25600], 0);
        let score = Score::of(&map(&[176, 175, 1608, 1609], &[90; 4]), &truth, None).unwrap();
        assert_eq!((score.off10, score.tot05), (Some(25.0), Some(75.0)));
    }

    #[test]
    fn guesses_count_in_all_answers_alone() {
        let truth = truth(&[2560; 4], 0);
        let map = map(&[160, 160, 999, NONE], &[16, 15, 1, 0]);
        let score = MapScore::of(&map, &truth, Region::Scored, None).unwrap();
        assert_eq!((score.all.density, score.all.tot2), (75.0, 50.0));
        assert_eq!((score.default_answers.density, score.default_answers.tot2), (25.0, 75.0));
        assert_eq!(score.default_answers.bad2, Some(0.0));
    }

    #[test]
    fn what_is_left_out_is_scored_apart() {
        let mut truth = truth(&[2560, 2560, 0, 2560, 2560, 2560], 2);
        truth.seen_by_both[1] = false;
        truth.seen_by_both[4] = false;
        let map = map(&[160, NONE, 160, 160, 999, 160], &[90; 6]);
        let figures =
            |region| MapScore::of(&map, &truth, region, None).map(|score| (score.all.density, score.all.tot2));
        assert_eq!(figures(Region::Scored), Some((100.0, 0.0)));
        assert_eq!(figures(Region::Occluded), Some((50.0, 100.0)));
        assert_eq!(figures(Region::LeftBand), Some((100.0, 0.0)));
        truth.seen_by_both = vec![true; 6];
        assert_eq!(MapScore::of(&map, &truth, Region::Occluded, None), None);
    }

    #[test]
    fn nothing_answered_leaves_rates_undefined() {
        let score = Score::of(&map(&[NONE; 3], &[0; 3]), &truth(&[256; 3], 0), Some(10.0)).unwrap();
        assert_eq!((score.density, score.tot2), (0.0, 100.0));
        assert_eq!((score.bad2, score.epe, score.auc, score.bad2_at_bm_density), (None, None, None, None));
        assert_eq!(Score::of(&map(&[0], &[0]), &truth(&[0], 0), None), None);
    }

    #[test]
    fn agrees_with_a_scorer_in_floating_point() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for _ in 0..50 {
            let true_q8: Vec<u16> = (0..300).map(|_| rng.random_range(0..12_u16) * 300).collect();
            let bits: Vec<i16> = true_q8
                .iter()
                .map(|&t| if rng.random_range(0..4) == 0 { NONE } else { (t / 16) as i16 + rng.random_range(-40..40) })
                .collect();
            let score = Score::of(&map(&bits, &[1; 300]), &truth(&true_q8, 20), None).unwrap();
            let scored: Vec<usize> = (20..300).filter(|&i| true_q8[i] > 0).collect();
            let errors: Vec<f64> = scored
                .iter()
                .filter(|&&i| bits[i] != NONE)
                .map(|&i| (f64::from(bits[i]) / 16.0 - f64::from(true_q8[i]) / 256.0).abs())
                .collect();
            let (n, answered) = (scored.len() as f64, errors.len() as f64);
            let over = |limit: f64| errors.iter().filter(|&&error| error > limit).count() as f64;
            let tenth = |&&i: &&usize| {
                bits[i] != NONE
                    && (f64::from(bits[i]) / 16.0 - f64::from(true_q8[i]) / 256.0).abs()
                        > f64::from(true_q8[i]) / 2560.0
            };
            let over_tenth = scored.iter().filter(tenth).count() as f64;
            let wanted = [
                100.0 * answered / n,
                100.0 * over(1.0) / answered,
                100.0 * over(2.0) / answered,
                100.0 * (over(0.5) + n - answered) / n,
                100.0 * (over(1.0) + n - answered) / n,
                100.0 * (over(2.0) + n - answered) / n,
                100.0 * (over_tenth + n - answered) / n,
                errors.iter().sum::<f64>() / answered,
            ];
            for ((name, figure), wanted) in Score::FIGURES.iter().zip(wanted) {
                assert!((figure(&score).unwrap() - wanted).abs() < 1e-9, "{name}: {score:?}, wanted {wanted}");
            }
        }
    }
}
