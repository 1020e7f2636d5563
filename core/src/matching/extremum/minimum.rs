//! A minimum over whole steps: the walk with the shortest support, and the parabola at its end.

/// A minimum of a cost over whole steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Minimum {
    /// Where it is.
    pub at: i32,
    /// The cost there.
    pub cost: i32,
    /// The cost one step before; `None` outside the range.
    pub before: Option<i32>,
    /// The cost one step after; `None` outside the range.
    pub after: Option<i32>,
}

impl Minimum {
    /// Fraction of a step by which the extremum lies after `at`, in 1/16, by a parabola through the
    /// three costs; within +-8, and 0 where `at` is not the least of three.
    #[must_use]
    pub fn refine_subpixel(&self) -> i32 {
        match (self.before, self.after) {
            (Some(before), Some(after)) if self.cost <= before && self.cost <= after => {
                parabola(before, self.cost, after)
            }
            _ => 0,
        }
    }
}

/// Vertex of the parabola through three equally spaced costs, in 1/16 step after the middle one.
///
/// Within +-8 where the middle one is the least; 0 where the three lie on a line.
#[must_use]
pub const fn parabola(before: i32, middle: i32, after: i32) -> i32 {
    let curvature = before + after - 2 * middle;
    if curvature <= 0 { 0 } else { (before - after) * 8 / curvature }
}

/// Walks from `start` to a minimum of `cost` with the shortest support, two samples, at most `steps`
/// steps far.
///
/// Evaluates `cost` at both sides of every point it visits, so the result carries what a sub-pixel
/// refinement needs. `cost` gives `None` outside its range; a step never leads there. On a plateau it
/// stays.
///
/// # Examples
/// ```
/// use haarline::extremum::descend;
/// let cost = |c: i32| (0..10).contains(&c).then_some((c - 6) * (c - 6));
/// assert_eq!(descend(4, 4, 9, cost).at, 6);
/// assert_eq!(descend(4, 4, 1, cost).at, 5);
/// ```
pub fn descend(start: i32, start_cost: i32, steps: u8, mut cost: impl FnMut(i32) -> Option<i32>) -> Minimum {
    let (mut at, mut here) = (start, start_cost);
    for left in (0..=steps).rev() {
        let (before, after) = (cost(at - 1), cost(at + 1));
        // The sign of G = after - before says where to go; out of range counts as uphill.
        let (next, there) =
            if before.unwrap_or(i32::MAX) <= after.unwrap_or(i32::MAX) { (at - 1, before) } else { (at + 1, after) };
        match there {
            Some(there) if there < here && left > 0 => (at, here) = (next, there),
            _ => return Minimum { at, cost: here, before, after },
        }
    }
    Minimum { at, cost: here, before: None, after: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_parabola_is_found_to_a_sixteenth() {
        for vertex in -8..=8 {
            let cost = |at: i32| (16 * at - vertex).pow(2);
            let minimum = Minimum { at: 0, cost: cost(0), before: Some(cost(-1)), after: Some(cost(1)) };
            assert_eq!(minimum.refine_subpixel(), vertex);
        }
    }

    #[test]
    fn a_plateau_and_a_single_point_end_the_walk() {
        assert_eq!(descend(5, 7, 9, |_| Some(7)).at, 5);
        let alone = descend(5, 7, 9, |c| (c == 5).then_some(7));
        assert_eq!(alone, Minimum { at: 5, cost: 7, before: None, after: None });
    }

    proptest! {
        #[test]
        fn the_walk_stays_in_range_and_never_climbs(
            costs in prop::collection::vec(0i32..3000, 1..40), start in 0usize..40, steps in 0u8..20,
        ) {
            let start = start % costs.len();
            let from = i32::try_from(start).unwrap();
            let found = descend(from, costs[start], steps, |c| costs.get(usize::try_from(c).ok()?).copied());
            prop_assert!((found.at - from).unsigned_abs() <= u32::from(steps));
            prop_assert_eq!(found.cost, costs[usize::try_from(found.at).unwrap()]);
            prop_assert!(found.cost <= costs[start]);
            prop_assert!((-8..=8).contains(&found.refine_subpixel()));
        }
    }
}
