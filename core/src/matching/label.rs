//! Labels: the disparities of a block that were evaluated, with their costs.

use crate::count;

/// The `N` cheapest labels that a block evaluated, in no order.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Labels<const N: usize> {
    /// Disparity of step 0, px.
    origin: i16,
    len: u8,
    step: [u8; N],
    cost: [i16; N],
}

/// One label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Label {
    /// Whole disparity, px.
    pub(crate) disparity: i32,
    /// What it costs.
    pub(crate) cost: i32,
}

impl<const N: usize> Labels<N> {
    /// No labels yet, for disparities from `origin` px to 255 more.
    pub(crate) const fn new(origin: i16) -> Self {
        const { assert!(N <= u8::MAX as usize) }
        Self { origin, len: 0, step: [0; N], cost: [0; N] }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = Label> + '_ {
        let label = |(&step, &cost): (&u8, &i16)| Label {
            disparity: i32::from(self.origin) + i32::from(step),
            cost: cost.into(),
        };
        self.step.iter().zip(&self.cost).take(self.len()).map(label)
    }

    pub(crate) const fn len(&self) -> usize {
        self.len as usize
    }

    /// What a disparity cost, if it is known.
    pub(crate) fn cost_of(&self, disparity: i32) -> Option<i32> {
        self.iter().find(|label| label.disparity == disparity).map(|label| label.cost)
    }

    /// The least cost of those more than `distance` away from a disparity.
    pub(crate) fn least_cost_beyond(&self, disparity: i32, distance: i32) -> Option<i32> {
        count::subtractions(self.len());
        count::comparisons(3 * self.len());
        self.iter().filter(|label| (label.disparity - disparity).abs() > distance).map(|label| label.cost).min()
    }

    /// Adds a new label; if the list is full the costliest goes.
    pub(crate) fn push(&mut self, label: Label) {
        let step = u8::try_from(label.disparity - i32::from(self.origin));
        let (Ok(step), Ok(cost)) = (step, i16::try_from(label.cost)) else { return };
        let mut slot = self.len();
        if slot < N {
            self.len += 1;
        } else {
            count::comparisons(N);
            let costliest = self.cost.iter().enumerate().max_by_key(|(_, cost)| **cost);
            slot = match costliest {
                Some((slot, &worst)) if worst > cost => slot,
                _ => return,
            };
        }
        if let (Some(s), Some(c)) = (self.step.get_mut(slot), self.cost.get_mut(slot)) {
            (*s, *c) = (step, cost);
        }
    }

    /// The cost of a disparity, known or evaluated now; then it becomes a label.
    pub(crate) fn cost_or(&mut self, disparity: i32, evaluate: impl FnOnce() -> Option<i32>) -> Option<i32> {
        self.cost_of(disparity).or_else(|| {
            let cost = evaluate()?;
            self.push(Label { disparity, cost });
            Some(cost)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_list_keeps_the_cheapest() {
        let mut labels = Labels::<3>::new(-2);
        for (disparity, cost) in [(-1, 30), (2, 10), (3, 50), (4, 20), (5, 60)] {
            labels.push(Label { disparity, cost });
        }
        assert_eq!(labels.len(), 3);
        assert_eq!([-1, 2, 3, 4, 5].map(|d| labels.cost_of(d)), [Some(30), Some(10), None, Some(20), None]);
        assert_eq!(labels.least_cost_beyond(2, 1), Some(20));
    }
}
