//! The choice among the costs of one pixel.

use haarline::Config;

/// Confidence of a winner with an equal: a guess, as those of the core's methods below 16.
const GUESS: u8 = 12;
/// Confidence of a winner without any rival. What decides is a margin alone, which says nothing of repetition and of what is
/// hidden: so nothing is sure, which would be 64 and more, or close to it.
const MOST_DOUBTFUL: u8 = 55;

/// The least cost of a pixel, and the least of the costs that speak against it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Winner {
    /// Position of the least cost; of equal ones the first.
    pub index: usize,
    /// Least cost.
    pub(super) cost: u32,
    /// Least cost more than one position away; none where there are no such positions.
    pub(super) rival: Option<u32>,
    /// Costs one position before and after it; none at both ends of the search.
    pub(super) beside: Option<[u32; 2]>,
}

impl Winner {
    /// Finds the least cost and its rival. `costs` must not be empty.
    pub fn find<C: Copy + Into<u32>>(costs: &[C]) -> Self {
        if costs.len() <= FEW {
            return Self::find_in_few(costs);
        }
        let (mut group, mut cost) = (0, u32::MAX);
        let mut leasts = [u32::MAX; Config::MAX_DISPARITIES as usize / GROUP];
        for (number, (least, costs)) in leasts.iter_mut().zip(costs.chunks(GROUP)).enumerate() {
            *least = least_of(costs);
            if *least < cost {
                (group, cost) = (number, *least);
            }
        }
        let start = group * GROUP;
        let index = start + costs[start..].iter().position(|&other| other.into() == cost).unwrap_or(0);
        let rival = rival(costs, index, &leasts[..costs.len().div_ceil(GROUP)]);
        Self { index, cost, rival, beside: beside(costs, index) }
    }

    /// The same without groups.
    fn find_in_few<C: Copy + Into<u32>>(costs: &[C]) -> Self {
        let (mut index, mut cost) = (0, u32::MAX);
        for (candidate, &other) in costs.iter().enumerate() {
            let other = other.into();
            if other < cost {
                (index, cost) = (candidate, other);
            }
        }
        let below = &costs[..index.saturating_sub(1)];
        let above = costs.get(index + 2..).unwrap_or(&[]);
        let rival = below.iter().chain(above).map(|&other| other.into()).min();
        Self { index, cost, rival, beside: beside(costs, index) }
    }

    /// Whether the rival's cost is more than `ratio` percent over the least cost.
    pub fn is_unique(&self, ratio: u8) -> bool {
        self.rival.is_none_or(|rival| rival > self.cost + self.cost * u32::from(ratio) / 100)
    }

    /// How far the least cost lies below its rival, in 43rds of the rival's cost, rounded down: `GUESS` for an equal
    /// rival, `MOST_DOUBTFUL` for a perfect match without an equal and for a winner without rivals.
    pub fn confidence(&self) -> u8 {
        let Some(rival) = self.rival else { return MOST_DOUBTFUL };
        let lead = rival.saturating_sub(self.cost);
        let margin = (u32::from(MOST_DOUBTFUL - GUESS) * lead).checked_div(rival).unwrap_or(0);
        u8::try_from(margin).map_or(MOST_DOUBTFUL, |margin| GUESS + margin)
    }

    /// Where between the positions the cost, below 2^23, is least, 1/256 of a position, -128..=128, positive
    /// towards position 0 (greater disparity).
    ///
    /// The two lines of equal and opposite slope through the three costs meet there. At both ends
    /// of the search the one neighbour counts for both, which leaves the position as it is.
    pub fn refine(&self) -> i32 {
        let Some([before, after]) = self.beside else { return 0 };
        let [before, after, cost] = [before, after, self.cost].map(u32::cast_signed);
        let slope = before + after - 2 * cost + (after - before).abs();
        ((after - before) * 256).checked_div(slope).unwrap_or(0)
    }
}

/// The costs on either side of `index`, if there are two.
fn beside<C: Copy + Into<u32>>(costs: &[C], index: usize) -> Option<[u32; 2]> {
    Some([costs[index.checked_sub(1)?], *costs.get(index + 1)?].map(Into::into))
}

/// Costs whose least is found at once: a rival is looked for again only in the winner's group and the one beside it.
const GROUP: usize = 8;
/// Costs that are too few for groups to pay.
const FEW: usize = 3 * GROUP;

fn least_of<C: Copy + Into<u32>>(costs: &[C]) -> u32 {
    let least = |least: u32, &cost: &C| least.min(cost.into());
    // Of known length it needs no loop.
    match costs.as_array::<GROUP>() {
        Some(group) => group.iter().fold(u32::MAX, least),
        None => costs.iter().fold(u32::MAX, least),
    }
}

/// Least cost more than one position from `index`, by the `leasts` of the groups.
fn rival<C: Copy + Into<u32>>(costs: &[C], index: usize, leasts: &[u32]) -> Option<u32> {
    let (below, above) = (index.saturating_sub(1), (index + 2).min(costs.len()));
    if below == 0 && above == costs.len() {
        return None;
    }
    let (full, next) = (below / GROUP, above.div_ceil(GROUP));
    let beside = costs[full * GROUP..below].iter().chain(&costs[above..(next * GROUP).min(costs.len()).max(above)]);
    let beside = beside.fold(u32::MAX, |least, &cost| least.min(cost.into()));
    let groups = leasts[..full].iter().chain(leasts.get(next..).unwrap_or(&[]));
    Some(groups.fold(beside, |least, &other| least.min(other)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_give_what_a_plain_search_gives() {
        let mut state = 1_u32;
        for length in 1..=100 {
            for _ in 0..50 {
                let costs = [(); 100].map(|()| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    state >> 26
                });
                let costs = &costs[..length];
                let (index, &cost) = costs.iter().enumerate().min_by_key(|&(_, cost)| cost).unwrap();
                let others = costs.iter().enumerate().filter(|&(other, _)| other.abs_diff(index) > 1);
                let rival = others.map(|(_, &cost)| cost).min();
                assert_eq!(
                    Winner::find(costs),
                    Winner { index, cost, rival, beside: beside(costs, index) },
                    "{costs:?}"
                );
            }
        }
    }

    #[test]
    fn the_first_of_equal_costs_wins() {
        assert_eq!(Winner::find(&[5_u16, 3, 9, 3]), Winner { index: 1, cost: 3, rival: Some(3), beside: Some([5, 9]) });
    }

    #[test]
    fn neighbours_are_no_rivals() {
        assert_eq!(
            Winner::find(&[9_u16, 3, 2, 3, 8]),
            Winner { index: 2, cost: 2, rival: Some(8), beside: Some([3, 3]) }
        );
        assert_eq!(Winner::find(&[2_u16, 3]), Winner { index: 0, cost: 2, rival: None, beside: None });
    }

    #[test]
    fn the_greatest_possible_cost_still_has_a_winner() {
        assert_eq!(
            Winner::find(&[u16::MAX; 4]),
            Winner { index: 0, cost: u16::MAX.into(), rival: Some(u16::MAX.into()), beside: None }
        );
    }

    #[test]
    fn a_rival_at_the_ratio_is_no_unique_winner() {
        let winner = Winner::find(&[100_u16, 200, 115]);
        assert!(!winner.is_unique(15));
        assert!(winner.is_unique(14));
    }

    #[test]
    fn confidence_spans_equal_to_perfect_and_is_never_sure() {
        assert_eq!(Winner::find(&[0_u16, 9, 0]).confidence(), 12);
        assert_eq!(Winner::find(&[7_u16, 9, 7]).confidence(), 12);
        assert_eq!(Winner::find(&[50_u16, 90, 100]).confidence(), 12 + 21);
        assert_eq!(Winner::find(&[0_u16, 90, 1]).confidence(), 55);
        assert_eq!(Winner::find(&[5_u16]).confidence(), 55);
        assert_eq!(Winner::find(&[0_u32, 90, u32::from(u16::MAX)]).confidence(), 55);
    }

    #[test]
    fn refinement_points_to_the_cheaper_neighbour() {
        for (costs, offset) in [([8, 2, 8], 0), ([8, 2, 2], -128), ([2, 1, 2], 0), ([4, 2, 8], 128 * 4 / 6)] {
            let offset_seen =
                Winner { index: 1, cost: costs[1], rival: None, beside: Some([costs[0], costs[2]]) }.refine();
            assert_eq!(offset_seen, offset, "{costs:?}");
        }
    }

    #[test]
    fn the_ends_of_the_search_are_not_refined() {
        assert_eq!(Winner::find(&[1_u16, 2, 9]).refine(), 0);
        assert_eq!(Winner::find(&[9_u16, 2, 1]).refine(), 0);
        assert_eq!(Winner::find(&[1_u16]).refine(), 0);
    }
}
