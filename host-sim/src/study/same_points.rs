//! Two maps at the same points: which of two methods is right where both answer.

use crate::DisparityMap;
use crate::score::error_q8;
use crate::score::scene::Truth;

/// What one of the two got wrong at the points that both answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointScore {
    /// Share of the points that are off by more than 1 px, percent.
    pub bad1: f64,
    /// Share of the points that are off by more than 2 px, percent.
    pub bad2: f64,
    /// Mean absolute error: the location error, px.
    pub error_px: f64,
}

/// Two maps compared at the scored points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SamePoints {
    /// Points that both answer.
    pub both: u64,
    /// The first and the second map there; `None` if there is no such point.
    pub scores: Option<[PointScore; 2]>,
    /// Points that only the first answers.
    pub first_only: u64,
    /// The first map there; `None` if there is no such point.
    pub first_only_score: Option<PointScore>,
}

/// Errors added up.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    points: u64,
    over1: u64,
    over2: u64,
    error_q8: u64,
}

impl Sum {
    fn add(&mut self, error_q8: u32) {
        self.points += 1;
        self.over1 += u64::from(error_q8 > 256);
        self.over2 += u64::from(error_q8 > 512);
        self.error_q8 += u64::from(error_q8);
    }

    fn score(self) -> Option<PointScore> {
        let mean = |sum: u64| sum as f64 / self.points as f64;
        (self.points > 0).then(|| PointScore {
            bad1: 100.0 * mean(self.over1),
            bad2: 100.0 * mean(self.over2),
            error_px: mean(self.error_q8) / 256.0,
        })
    }
}

impl SamePoints {
    /// Compares `first` and `second` at the points that [`Truth::is_scored`] names.
    ///
    /// # Panics
    /// If a map and the truth differ in size.
    #[must_use]
    pub fn of(truth: &Truth, first: &DisparityMap, second: &DisparityMap) -> Self {
        assert!(truth.fits(first) && truth.fits(second), "maps and truth differ in size");
        let (mut both, mut alone) = ([Sum::default(); 2], Sum::default());
        for (index, true_q8) in truth.scored() {
            let errors = [first, second].map(|map| error_q8(map.disparity[index], true_q8));
            match errors {
                [Some(a), Some(b)] => {
                    both[0].add(a);
                    both[1].add(b);
                }
                [Some(a), None] => alone.add(a),
                [None, _] => {}
            }
        }
        let scores = both[0].score().zip(both[1].score()).map(<[PointScore; 2]>::from);
        Self { both: both[0].points, scores, first_only: alone.points, first_only_score: alone.score() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::Disparity;

    #[test]
    fn points_of_one_map_alone_do_not_count_for_both() {
        const NONE: i16 = i16::MIN;
        let map = |bits: [i16; 6]| {
            let disparity = bits.map(Disparity::from_bits).to_vec();
            DisparityMap { width: 6, height: 1, disparity, confidence: vec![1; 6] }
        };
        // Truth 10 px; column 0 is not scored, column 5 is seen by one camera only.
        let seen_by_both = vec![true, true, true, true, true, false];
        let truth = Truth { width: 6, disparity_q8: vec![2560; 6], seen_by_both, first_column: 1 };
        let (first, second) = (map([0, 160, 184, 200, NONE, 0]), map([0, 193, 160, NONE, 160, 0]));
        let found = SamePoints::of(&truth, &first, &second);
        let [a, b] = found.scores.unwrap();
        assert_eq!((found.both, found.first_only), (2, 1));
        assert_eq!(a, PointScore { bad1: 50.0, bad2: 0.0, error_px: 0.75 });
        assert_eq!(b, PointScore { bad1: 50.0, bad2: 50.0, error_px: 33.0 / 32.0 });
        assert_eq!(found.first_only_score, Some(PointScore { bad1: 100.0, bad2: 100.0, error_px: 2.5 }));
        let nothing = SamePoints::of(&truth, &map([NONE; 6]), &second);
        assert_eq!((nothing.both, nothing.scores, nothing.first_only_score), (0, None, None));
    }
}
