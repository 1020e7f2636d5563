//! Who belongs together: contours of the left view and contours of the right one.

use crate::Config;
use crate::count;
use crate::front_end::contour::Contour;

/// Marks a contour without a partner.
const NOBODY: u16 = u16::MAX;

/// Which right contour a left one takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Choice {
    /// Index of the right contour.
    partner: u16,
    /// What the pair costs.
    pub(crate) cost: u16,
    /// What the second cheapest costs; `u16::MAX` where there is none.
    pub(crate) second: u16,
}

/// The preferences of the contours of one line: scratch of one search.
pub(crate) struct Pairing<const BLOCKS: usize> {
    /// For each left contour the right one that it likes best.
    choice: [[Choice; 2]; BLOCKS],
    /// For each right contour the least cost so far, and the index of the left one it comes from.
    suitor: [[(u16, u16); 2]; BLOCKS],
}

impl<const BLOCKS: usize> Pairing<BLOCKS> {
    /// Compares every left contour with the right ones that resemble it within the search range.
    ///
    /// A left contour takes the right one of the least cost, if no second one comes within `uniqueness`
    /// percent of that cost. Both lines must be in the order of their columns.
    pub(crate) fn of(
        config: &Config,
        left: &[Contour],
        right: &[Contour],
        uniqueness: u32,
        cost: impl Fn(Contour, Contour) -> Option<u16>,
    ) -> Self {
        let nobody = Choice { partner: NOBODY, cost: u16::MAX, second: u16::MAX };
        let mut pairing = Self { choice: [[nobody; 2]; BLOCKS], suitor: [[(u16::MAX, NOBODY); 2]; BLOCKS] };
        let least = 16 * i32::from(config.min_disparity) - 8;
        let most = 16 * (i32::from(config.min_disparity) + i32::from(config.num_disparities));
        let suitors = pairing.suitor.as_flattened_mut();
        let (mut start, mut compared) = (0, 0);
        for ((i, contour), choice) in (0u16..).zip(left).zip(pairing.choice.as_flattened_mut()) {
            let column = i32::from(contour.column);
            // Both lines are in order, so nobody looks further left than this again.
            while right.get(start).is_some_and(|c| column - i32::from(c.column) >= most) {
                start += 1;
            }
            let mut best = nobody;
            let in_range = |c: &&Contour| column - i32::from(c.column) >= least;
            let candidates = right.get(start..).unwrap_or(&[]).iter().take_while(in_range);
            for (j, candidate) in (start..).zip(candidates).inspect(|_| compared += 1) {
                if !contour.resembles(*candidate) {
                    continue;
                }
                let Some(cost) = cost(*contour, *candidate) else { continue };
                if cost < best.cost {
                    best = Choice { partner: u16::try_from(j).unwrap_or(NOBODY), cost, second: best.cost };
                } else {
                    best.second = best.second.min(cost);
                }
                if let Some(suitor) = suitors.get_mut(j)
                    && cost < suitor.0
                {
                    *suitor = (cost, i);
                }
            }
            let is_unique =
                best.second == u16::MAX || 100 * u32::from(best.second) > (100 + uniqueness) * u32::from(best.cost);
            *choice = if is_unique { best } else { nobody };
        }
        // Range, polarity and the two strengths of each pair; its cost with the best two and the suitor's.
        count::additions(4 * compared);
        count::subtractions(compared);
        count::comparisons(6 * compared + left.len());
        count::multiplications(2 * left.len());
        pairing
    }

    /// The pairs in which each is the other's best, from left to right: left index, right index, cost.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (usize, usize, Choice)> {
        let choices = (0u16..).zip(self.choice.as_flattened());
        choices.filter_map(|(i, &choice)| {
            let partner = usize::from(choice.partner);
            let &(_, suitor) = self.suitor.as_flattened().get(partner)?;
            (suitor == i).then_some((usize::from(i), partner, choice))
        })
    }
}
