//! What each confidence is worth: how many answers have it, and how many of those are wrong.

use serde::Serialize;

use crate::score::sparsification::Sparsification;

/// How many classes there are, of as many confidences each.
pub const CLASSES: usize = 16;

/// Answers of 16 neighbouring confidences.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct ConfidenceClass {
    /// Their share of the scored pixels, percent.
    pub pixels: f64,
    /// The share of them that is off by more than 2 px, percent; `None` where there are none.
    pub wrong: Option<f64>,
}

/// The classes 0 to 15, 16 to 31, and so on up to 255. The first one holds the guesses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(transparent)]
pub struct ConfidenceClasses(pub [ConfidenceClass; CLASSES]);

impl ConfidenceClasses {
    /// Of the answers among `scored` pixels.
    #[must_use]
    pub fn of(answers: &Sparsification, scored: u64) -> Self {
        let mut groups = answers.by_confidence().chunks(256 / CLASSES);
        Self(std::array::from_fn(|_| {
            let group = groups.next().unwrap_or(&[]).iter();
            let (pixels, wrong) = group.fold((0, 0), |(all, bad), group| (all + group.0, bad + group.1));
            let share = |count: u64, of: u64| (of > 0).then(|| 100.0 * count as f64 / of as f64);
            ConfidenceClass { pixels: share(pixels, scored).unwrap_or(0.0), wrong: share(wrong, pixels) }
        }))
    }

    /// The mean over scenes that weigh alike: of the pixels' shares, and of the wrong ones' shares in the
    /// scored pixels, whose quotient is what is wrong in the class.
    #[must_use]
    pub fn mean<'a>(scenes: impl IntoIterator<Item = &'a Self> + Clone) -> Self {
        let count = scenes.clone().into_iter().count().max(1) as f64;
        Self(std::array::from_fn(|class| {
            let classes = || scenes.clone().into_iter().map(move |scene| scene.0[class]);
            let pixels: f64 = classes().map(|class| class.pixels).sum();
            let wrong: f64 = classes().filter_map(|class| Some(class.pixels * class.wrong?)).sum();
            ConfidenceClass { pixels: pixels / count, wrong: (pixels > 0.0).then(|| wrong / pixels) }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn classes(answers: &[(u8, bool)], scored: u64) -> ConfidenceClasses {
        let mut counted = Sparsification::default();
        answers.iter().for_each(|&(confidence, is_bad)| counted.add(confidence, is_bad));
        ConfidenceClasses::of(&counted, scored)
    }

    #[test]
    fn sixteen_confidences_make_a_class() {
        let ConfidenceClasses(found) = classes(&[(0, true), (15, false), (16, false), (255, false)], 8);
        assert_eq!(found[0], ConfidenceClass { pixels: 25.0, wrong: Some(50.0) });
        assert_eq!(found[1], ConfidenceClass { pixels: 12.5, wrong: Some(0.0) });
        assert_eq!(found[2], ConfidenceClass { pixels: 0.0, wrong: None });
        assert_eq!(found[15], ConfidenceClass { pixels: 12.5, wrong: Some(0.0) });
    }

    #[test]
    fn in_the_mean_scenes_weigh_alike_whatever_their_size() {
        let small = classes(&[(200, true)], 2);
        let large = classes(&[(200, false); 10], 100);
        let ConfidenceClasses(mean) = ConfidenceClasses::mean(&[small, large]);
        assert_eq!(mean[12].pixels, 30.0);
        assert!((mean[12].wrong.unwrap() - 100.0 * 50.0 / 60.0).abs() < 1e-9, "{mean:?}");
        assert_eq!(mean[3], ConfidenceClass::default());
    }
}
