//! The choice among the costs of one pixel.

/// The least cost of a pixel, and the least of the costs that speak against it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Winner {
    /// Position of the least cost; of equal ones the first.
    pub index: usize,
    /// Least cost.
    cost: u16,
    /// Least cost more than one position away; none where there are no such positions.
    rival: Option<u16>,
}

impl Winner {
    /// Finds the least cost and its rival. `costs` must not be empty.
    pub fn find(costs: &[u16]) -> Self {
        let (mut index, mut cost) = (0, u16::MAX);
        for (candidate, &other) in costs.iter().enumerate() {
            if other < cost {
                (index, cost) = (candidate, other);
            }
        }
        let below = &costs[..index.saturating_sub(1)];
        let above = costs.get(index + 2..).unwrap_or(&[]);
        let rival = below.iter().chain(above).copied().min();
        Self { index, cost, rival }
    }

    /// Whether the rival's cost is more than `ratio` percent over the least cost.
    pub fn is_unique(&self, ratio: u8) -> bool {
        let cost = u32::from(self.cost);
        self.rival.is_none_or(|rival| u32::from(rival) > cost + cost * u32::from(ratio) / 100)
    }

    /// Least cost's distance from its rival, in 255ths of the rival's cost, rounded down: 0 for an
    /// equal rival, 255 for a perfect match without an equal and for a winner without rivals.
    pub fn margin(&self) -> u8 {
        let Some(rival) = self.rival else { return u8::MAX };
        let lead = u32::from(rival.saturating_sub(self.cost));
        let margin = (255 * lead).checked_div(u32::from(rival)).unwrap_or(0);
        u8::try_from(margin).unwrap_or(u8::MAX)
    }

    /// Where between the positions the cost is least, 1/256 of a position, -128..=128, positive
    /// towards position 0 (greater disparity).
    ///
    /// The two lines of equal and opposite slope through the three costs meet there. At both ends
    /// of the search the one neighbour counts for both, which leaves the position as it is.
    pub fn refine(&self, costs: &[u16]) -> i32 {
        let (Some(before), Some(after)) = (self.index.checked_sub(1), costs.get(self.index + 1)) else { return 0 };
        let (before, after, cost) = (i32::from(costs[before]), i32::from(*after), i32::from(self.cost));
        let slope = before + after - 2 * cost + (after - before).abs();
        ((after - before) * 256).checked_div(slope).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_equal_costs_wins() {
        assert_eq!(Winner::find(&[5, 3, 9, 3]), Winner { index: 1, cost: 3, rival: Some(3) });
    }

    #[test]
    fn neighbours_are_no_rivals() {
        assert_eq!(Winner::find(&[9, 3, 2, 3, 8]), Winner { index: 2, cost: 2, rival: Some(8) });
        assert_eq!(Winner::find(&[2, 3]), Winner { index: 0, cost: 2, rival: None });
    }

    #[test]
    fn the_greatest_possible_cost_still_has_a_winner() {
        assert_eq!(Winner::find(&[u16::MAX; 4]), Winner { index: 0, cost: u16::MAX, rival: Some(u16::MAX) });
    }

    #[test]
    fn a_rival_at_the_ratio_is_no_unique_winner() {
        let winner = Winner::find(&[100, 200, 115]);
        assert!(!winner.is_unique(15));
        assert!(winner.is_unique(14));
    }

    #[test]
    fn margin_spans_equal_to_perfect() {
        assert_eq!(Winner::find(&[0, 9, 0]).margin(), 0);
        assert_eq!(Winner::find(&[7, 9, 7]).margin(), 0);
        assert_eq!(Winner::find(&[50, 90, 100]).margin(), 127);
        assert_eq!(Winner::find(&[0, 90, 1]).margin(), 255);
    }

    #[test]
    fn refinement_points_to_the_cheaper_neighbour() {
        for (costs, offset) in [([8, 2, 8], 0), ([8, 2, 2], -128), ([2, 1, 2], 0), ([4, 2, 8], 128 * 4 / 6)] {
            let offset_seen = Winner { index: 1, cost: costs[1], rival: None }.refine(&costs);
            assert_eq!(offset_seen, offset, "{costs:?}");
        }
    }

    #[test]
    fn the_ends_of_the_search_are_not_refined() {
        assert_eq!(Winner::find(&[1, 2, 9]).refine(&[1, 2, 9]), 0);
        assert_eq!(Winner::find(&[9, 2, 1]).refine(&[9, 2, 1]), 0);
        assert_eq!(Winner::find(&[1]).refine(&[1]), 0);
    }
}
