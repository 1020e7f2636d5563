//! Who belongs together: contours of the left view and contours of the right one.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "columns and places are below 1280"
)]

use crate::Config;
use crate::front_end::contour_line::Edge;

/// Marks that there is nobody.
const NOBODY: u32 = u32::MAX;
/// Percent of the least cost which the second least must exceed.
const UNIQUENESS: u32 = 120;

/// A left contour and a right one of which each is the other's best.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pair {
    pub(crate) left: Edge,
    pub(crate) right: Edge,
    /// What the pair costs.
    pub(crate) cost: u32,
    /// What the second cheapest costs, if there is one.
    pub(crate) second: Option<u32>,
}

/// Compares every left contour with the right ones that resemble it within the search range, and takes those pairs in which
/// each is the other's best.
///
/// A left contour takes the right one of the least cost, if no second one comes near. Both lines must be in the order of
/// their columns.
///
/// - `cost_of`: what the costs of the right contours' columns are for a left one's column, below 2^16.
#[inline(always)]
pub(crate) fn pair<const WORDS: usize, F: Fn(usize) -> u32>(
    config: &Config,
    left: &[Edge],
    right: &[Edge],
    cost_of: impl Fn(usize) -> F,
    mut take: impl FnMut(Pair),
) {
    // Of each left contour the cheapest partner and the second cost, of each right one the cheapest suitor: cost and place.
    let mut choices = [[[0; 2]; 2]; WORDS];
    let mut suitors = [[0; 2]; WORDS];
    let (choices, suitors) = (choices.as_flattened_mut(), &mut suitors.as_flattened_mut()[..right.len()]);
    suitors.fill(NOBODY);
    let least = i32::from(config.min_disparity);
    let most = least + i32::from(config.num_disparities);
    let mut start = 0;
    for ((i, edge), choice) in (0..).zip(left).zip(choices.iter_mut()) {
        let column = edge.column() as i32;
        // Both lines are in order, so nobody looks further left than this again.
        let (first, end) = ((column - most + 1).max(0), (column - least + 1).max(0));
        while right.get(start).is_some_and(|other| other.is_before(first)) {
            start += 1;
        }
        let resembling = edge.resembling();
        let (weakest, span) = (*resembling.start(), *resembling.end() - *resembling.start());
        let cost = cost_of(edge.column());
        let (mut best, mut second) = (NOBODY, NOBODY);
        let candidates = right[start..].iter().zip(&mut suitors[start..]);
        for (j, (other, suitor)) in (start as u32..).zip(candidates) {
            if !other.is_before(end) {
                break;
            }
            if other.kind().wrapping_sub(weakest) > span {
                continue;
            }
            crate::count::evaluations(1);
            let cost = cost(other.column()) << 16;
            *suitor = (*suitor).min(cost | i);
            let key = cost | j;
            if key < best {
                (second, best) = (best, key);
            } else {
                second = second.min(key);
            }
        }
        *choice = [best, second];
    }
    for ((i, &edge), &[best, second]) in (0..).zip(left).zip(&*choices) {
        let (cost, other) = (best >> 16, second >> 16);
        let Some(suitor) = suitors.get((best & 0xffff) as usize).filter(|_| best != NOBODY) else { continue };
        let second = (second != NOBODY).then_some(other);
        if suitor & 0xffff == i && second.is_none_or(|second| 100 * second > UNIQUENESS * cost) {
            take(Pair { left: edge, right: right[(best & 0xffff) as usize], cost, second });
        }
    }
}
