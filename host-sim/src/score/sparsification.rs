//! Whether the confidence tells good answers from bad ones: the sparsification curve.

/// Answers by confidence, and how many of them are bad.
///
/// The sparsification curve tells `bad(k)`, the percentage of bad answers among the `k` most
/// confident ones. Answers of equal confidence have no order, so where `k` ends within such a group
/// its bad answers count by their expected number: `k` may be fractional, and the result depends on
/// no order of pixels.
#[derive(Debug, Clone)]
pub struct Sparsification {
    /// Answers and bad answers of each confidence.
    groups: [(u64, u64); 256],
}

impl Default for Sparsification {
    fn default() -> Self {
        Self { groups: [(0, 0); 256] }
    }
}

impl Sparsification {
    /// Counts an answer.
    pub fn add(&mut self, confidence: u8, is_bad: bool) {
        let (answers, bad) = &mut self.groups[usize::from(confidence)];
        *answers += 1;
        *bad += u64::from(is_bad);
    }

    /// How many answers there are.
    #[must_use]
    pub fn answered(&self) -> u64 {
        self.groups.iter().map(|(answers, _)| answers).sum()
    }

    /// How many answers there are of each confidence, and how many bad ones of them.
    #[must_use]
    pub fn by_confidence(&self) -> &[(u64, u64); 256] {
        &self.groups
    }

    /// Groups of equal confidence that are not empty, the most confident first.
    fn best_first(&self) -> impl Iterator<Item = (f64, f64)> {
        self.groups.iter().rev().filter(|group| group.0 > 0).map(|&(answers, bad)| (answers as f64, bad as f64))
    }

    /// `bad(count)` in percent: of the `count` most confident answers, or of all if there are not as
    /// many. `None` without an answer or for a count of 0.
    #[must_use]
    pub fn bad_at(&self, count: f64) -> Option<f64> {
        let count = count.min(self.answered() as f64);
        let (mut left, mut bad) = (count, 0.0);
        for (answers, bad_answers) in self.best_first() {
            let taken = answers.min(left);
            bad += bad_answers * taken / answers;
            left -= taken;
        }
        (count > 0.0).then(|| 100.0 * bad / count)
    }

    /// The area under the curve: the mean of `bad(s * answered)` over the kept share `s` from 0 to
    /// 1, in percent, so between 0 and 100. A confidence that tells nothing gives `bad2` itself, a
    /// perfect one the least that is possible for that `bad2`; less is better. `None` without an
    /// answer.
    ///
    /// The integral is exact. Within a group that begins after `n0` answers with `b0` bad ones and has the bad
    /// rate `r`, the curve is `(b0 + r (n - n0)) / n = r + (b0 - r n0) / n`, and its integral
    /// `r (n1 - n0) + (b0 - r n0) ln(n1 / n0)`.
    #[must_use]
    pub fn area(&self) -> Option<f64> {
        let (mut kept, mut bad, mut area) = (0.0, 0.0, 0.0);
        for (answers, bad_answers) in self.best_first() {
            let rate = bad_answers / answers;
            area += bad_answers;
            if kept > 0.0 {
                area += (bad - rate * kept) * ((kept + answers) / kept).ln();
            }
            kept += answers;
            bad += bad_answers;
        }
        (kept > 0.0).then(|| 100.0 * area / kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn ties_in_confidence_count_by_their_expected_number() {
        let mut curve = Sparsification::default();
        curve.add(200, false);
        for is_bad in [true, false, false, true] {
            curve.add(100, is_bad);
        }
        assert_eq!(curve.bad_at(1.0), Some(0.0));
        assert_eq!(curve.bad_at(2.0), Some(25.0));
        assert_eq!(curve.bad_at(2.5), Some(30.0));
        assert_eq!(curve.bad_at(5.0), Some(40.0));
        assert_eq!(curve.bad_at(99.0), Some(40.0));
        assert_eq!(curve.bad_at(0.0), None);
    }

    #[test]
    fn area_is_the_mean_of_the_curve() {
        let mut uninformed = Sparsification::default();
        (0..100).for_each(|i| uninformed.add(7, i % 4 == 0));
        assert_eq!(uninformed.area(), Some(25.0));

        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut curve = Sparsification::default();
        for _ in 0..1000 {
            let confidence = rng.random_range(0..9);
            curve.add(confidence, rng.random_range(0..12) > confidence);
        }
        let steps = 200_000;
        let numeric = (0..steps).map(|i| curve.bad_at((f64::from(i) + 0.5) / f64::from(steps) * 1000.0).unwrap());
        let mean = numeric.sum::<f64>() / f64::from(steps);
        assert!((curve.area().unwrap() - mean).abs() < 1e-3, "{:?} {mean}", curve.area());
    }
}
