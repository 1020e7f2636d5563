//! The Haar extremum search: how a disparity walks to the minimum of its cost.
//!
//! Choosing the best out of a list of candidates (hypotheses, labels, contours) is a comparison and done
//! where the list is; looking for a minimum along a cost is done here.
//!
//! The paper's method (section 4, eq. 5 to 9) in one dimension and whole steps. The direction is a
//! Haar wavelet over the cost itself: the sum of the costs after the present point minus the sum of
//! those before it, so that noise averages out over the support. The search goes against it until its
//! sign changes; the last two points bracket the extremum, and a new start with a support that fits
//! the bracket refines it. With its shortest support of two samples this is the walk that ends each
//! block's search ([`descend`]); the methods need no more, [`search`] is the whole of it.

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

/// Direction of the search, `G` of the paper's eq. 8 without its constant factor: the costs of the
/// `support / 2` steps after `at` minus those of as many before it. Steps out of range (`None`) are
/// left out together with their mirror images.
pub fn direction(at: i32, support: u8, cost: &mut impl FnMut(i32) -> Option<i32>) -> i32 {
    (1..=i32::from(support / 2)).filter_map(|i| Some(cost(at + i)? - cost(at - i)?)).sum()
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

/// Looks for the minimum of `cost` from `start` with a long support first, then with a short one.
///
/// The first start walks against [`direction`] over `first_support` samples until its sign changes or
/// the range ends. The second one, with the longest support out of 6, 4 and 2 that is no longer than
/// the first, continues from there; the walk of [`descend`] ends it. At most `limit` steps in all.
///
/// Returns `None` if the cost has no value at `start`.
pub fn search(start: i32, first_support: u8, limit: u16, mut cost: impl FnMut(i32) -> Option<i32>) -> Option<Minimum> {
    cost(start)?;
    let (mut at, mut left) = (start, limit);
    for support in [first_support, first_support.min(6)] {
        let mut last = 0;
        while left > 0 {
            let sign = direction(at, support, &mut cost).signum();
            // Zero or a changed sign: the last two points bracket the extremum.
            if sign == 0 || sign == -last || cost(at - sign).is_none() {
                break;
            }
            (at, last, left) = (at - sign, sign, left - 1);
        }
    }
    let here = cost(at)?;
    Some(descend(at, here, u8::try_from(left).unwrap_or(u8::MAX), cost))
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
    fn a_long_support_passes_over_a_ripple_that_stops_a_short_one() {
        // A valley at 40 with a ripple of period 3 on its slopes.
        let cost = |c: i32| (0..80).contains(&c).then_some((c - 40).abs() * 4 + if c % 3 == 0 { 12 } else { 0 });
        let short = descend(10, cost(10).unwrap(), 200, cost).at;
        let long = search(10, 12, 200, cost).unwrap().at;
        assert!(short < 20, "{short}");
        assert!((39..=41).contains(&long), "{long}");
    }

    #[test]
    fn a_plateau_and_a_single_point_end_the_search() {
        assert_eq!(search(5, 8, 100, |_| Some(7)).unwrap().at, 5);
        let alone = search(5, 8, 100, |c| (c == 5).then_some(7)).unwrap();
        assert_eq!(alone, Minimum { at: 5, cost: 7, before: None, after: None });
        assert_eq!(search(5, 8, 100, |_| None), None);
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
