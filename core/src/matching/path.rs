//! Messages between blocks: what a neighbour's labels say about a disparity.

use crate::count;
use crate::matching::label::{Label, Labels};

/// What neighbours pay for disagreeing, in units of the cost.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Penalties {
    /// For each px between the two disparities.
    pub(crate) slope: i32,
    /// At most, however far they are apart: the price of a jump between surfaces.
    pub(crate) jump: i32,
}

/// The labels of a block, each with the cost of the best path through it, 0 for the best label.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Paths<const N: usize> {
    pub(crate) labels: Labels<N>,
    path: [i16; N],
}

impl<const N: usize> Paths<N> {
    /// No labels, so no opinion.
    pub(crate) const EMPTY: Self = Self { labels: Labels::new(0), path: [0; N] };

    /// The labels with the path cost that `path` gives each, less the least of them.
    pub(crate) fn new(labels: Labels<N>, mut path: impl FnMut(usize, Label) -> i32) -> Self {
        let mut paths = Self { labels, path: [0; N] };
        let mut costs = [0; N];
        count::additions(2 * labels.len());
        count::subtractions(2 * labels.len());
        count::comparisons(labels.len());
        for ((i, label), cost) in labels.iter().enumerate().zip(&mut costs) {
            *cost = path(i, label);
        }
        let known = costs.get(..labels.len()).unwrap_or(&[]);
        let least = known.iter().copied().min().unwrap_or(0);
        for (to, &cost) in paths.path.iter_mut().zip(known) {
            *to = i16::try_from(cost - least).unwrap_or(i16::MAX);
        }
        paths
    }

    /// Path cost of a label by its index.
    pub(crate) fn of(&self, index: usize) -> i32 {
        self.path.get(index).copied().map_or(0, i32::from)
    }

    /// The labels with their path costs.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (Label, i32)> + '_ {
        self.labels.iter().zip(self.path.iter().map(|&path| i32::from(path)))
    }

    /// What these labels say against a neighbour's disparity: the least path cost and penalty of
    /// getting there, `0..=jump`; 0 where there are none.
    pub(crate) fn message(&self, disparity: i32, penalties: Penalties) -> i32 {
        count::label_pairs(self.labels.len());
        count::additions(self.labels.len());
        count::subtractions(self.labels.len());
        count::comparisons(3 * self.labels.len());
        count::multiplications(self.labels.len());
        let price = |(label, path): (Label, i32)| {
            path + ((label.disparity - disparity).abs() * penalties.slope).min(penalties.jump)
        };
        self.iter().map(price).min().unwrap_or(0)
    }

    /// The label of the best path, and its path cost; the first of several.
    pub(crate) fn best(&self) -> Option<(Label, i32)> {
        count::comparisons(self.labels.len());
        self.iter().min_by_key(|&(_, path)| path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PENALTIES: Penalties = Penalties { slope: 10, jump: 35 };

    fn paths() -> Paths<4> {
        let mut labels = Labels::new(0);
        labels.push(Label { disparity: 5, cost: 100 });
        labels.push(Label { disparity: 20, cost: 120 });
        Paths::new(labels, |_, label| label.cost)
    }

    #[test]
    fn a_message_grows_with_the_distance_up_to_the_jump() {
        assert_eq!([5, 6, 7, 8, 9, 12].map(|d| paths().message(d, PENALTIES)), [0, 10, 20, 30, 35, 35]);
        assert_eq!([20, 19].map(|d| paths().message(d, PENALTIES)), [20, 30]);
    }

    #[test]
    fn no_labels_have_no_opinion_and_no_best() {
        assert_eq!(Paths::<4>::EMPTY.message(3, PENALTIES), 0);
        assert_eq!(Paths::<4>::EMPTY.best(), None);
        assert_eq!(paths().best().unwrap().0.disparity, 5);
    }
}
