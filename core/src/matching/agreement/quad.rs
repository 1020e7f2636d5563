//! The same for four cells at once.

use super::Penalties;
use crate::lanes::x86_64::quad::Quad;
use crate::lanes::{ONES, splat};

/// [`Penalties`], in all lanes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct QuadPenalties {
    slope: Quad,
    jump: Quad,
}

/// [`Steps`](super::Steps) of four cells.
#[derive(Debug, Clone, Copy)]
pub(crate) struct QuadSteps {
    up: Quad,
    down: Quad,
}

impl QuadSteps {
    /// Less than 255 in the lanes whose neighbours are the labels one less and one more.
    #[inline(always)]
    pub(crate) fn both(self) -> Quad {
        self.up.or(self.down)
    }
}

impl QuadPenalties {
    pub(crate) fn new(penalties: Penalties) -> Self {
        Self { slope: Quad::splat(splat(penalties.slope)), jump: Quad::splat(penalties.jump) }
    }

    /// What each of `labels` pays for not being the same lane of `others`; 255 if it is not beside it.
    #[inline(always)]
    fn price(self, others: Quad, labels: Quad) -> Quad {
        let distance = labels.difference(others);
        let ones = Quad::splat(ONES);
        let is_near = ones.not_less(distance);
        distance.equal(ones).and(self.slope).or(is_near.not_and(Quad::splat(u32::MAX)))
    }

    /// What each of `labels` pays for not being the same lane of `others`.
    #[inline(always)]
    pub(crate) fn of(self, labels: Quad, others: Quad) -> Quad {
        self.price(others, labels).min(self.jump)
    }

    /// What steps between the labels of a tile cost.
    #[inline(always)]
    pub(crate) fn steps(self, labels: Quad) -> QuadSteps {
        let is_next = labels.down::<8>().wrapping_sub(labels).equal(Quad::splat(ONES));
        let up = self.slope.where_or(is_next, Quad::splat(u32::MAX)).or(Quad::splat(0xff00_0000));
        QuadSteps { up, down: up.up::<8>().or(Quad::splat(0xff)) }
    }

    /// What cells whose path sums are `sums` tell those that have the same labels.
    #[inline(always)]
    pub(crate) fn same_labels(self, sums: Quad, steps: QuadSteps) -> Quad {
        let from_above = sums.down::<8>().add(steps.up);
        let from_below = sums.up::<8>().add(steps.down);
        from_above.min(from_below).min(sums.min(self.jump))
    }

    /// What cells whose path sums are `sums` and whose labels are `from` tell those that have the labels `to`.
    #[inline(always)]
    pub(crate) fn other_labels(self, sums: Quad, from: Quad, to: Quad) -> Quad {
        let message = |sums: Quad, from: Quad| sums.add(self.price(from, to));
        let straight = message(sums, from);
        let first = message(sums.rotated::<8, 24>(), from.rotated::<8, 24>());
        let second = message(sums.rotated::<16, 16>(), from.rotated::<16, 16>());
        let third = message(sums.rotated::<24, 8>(), from.rotated::<24, 8>());
        straight.min(first).min(second.min(third)).min(self.jump)
    }
}

/// The paths' sums after cells: their costs and the messages, the least of each 0.
#[inline(always)]
pub(crate) fn extend(costs: Quad, messages: Quad) -> Quad {
    normalised(costs.add(messages))
}

/// The same sums with the least of each word 0.
#[inline(always)]
pub(crate) fn normalised(sums: Quad) -> Quad {
    sums.sub(sums.least_spread())
}
