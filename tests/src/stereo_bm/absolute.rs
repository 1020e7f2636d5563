//! Sums of absolute differences: StereoBM's SAD.

use haarline::Config;

use super::sums::{Place, Step, Sums};
use super::winner::Winner;
use crate::simd::sad::{GROUP, Labels, descend, first_of_group, least_of_group, place, slide};
use crate::simd::{at_most_halves, min_unsigned_halves};

/// The sums of a window that moves down and to the right, by running sums: down within each cost column, then along
/// the row. The least ones are found on the way.
#[derive(Debug, Clone)]
pub struct AbsoluteSums<const WIDTH: usize, const DISPARITIES: usize> {
    /// Over the window's rows, by cost column.
    columns: [Labels<DISPARITIES>; WIDTH],
    /// Over the whole window.
    window: Labels<DISPARITIES>,
    /// The least sums of each group's even places in the lower halves, of its odd ones in the upper.
    leasts: [u32; Config::MAX_DISPARITIES as usize / GROUP],
}

impl<const WIDTH: usize, const DISPARITIES: usize> AbsoluteSums<WIDTH, DISPARITIES> {
    /// A column of nothing.
    const NOTHING: &Labels<DISPARITIES> = &Labels::EMPTY;

    /// The winner where all groups are whole.
    #[inline(always)]
    fn winner_of_groups(&mut self, searched: usize) -> Winner {
        let leasts = &mut self.leasts[..searched / GROUP];
        let least = least_of_all(leasts);
        let group = leasts.iter().position(|&group| at_most_halves(group, least) != 0).unwrap_or(0);
        let index = GROUP * group + first_of_group(&self.window, group, least);

        // A rival is another: these do not count while it is looked for.
        let (low, high) = (index.saturating_sub(1), (index + 1).min(searched - 1));
        let places = [low, index, high].map(|label| place(label, searched));
        let around = places.map(|place| self.window.0[place]);
        places.iter().for_each(|&place| self.window.0[place] = u16::MAX);
        // Sliding on makes them anew.
        leasts[low / GROUP] = least_of_group(&self.window, low / GROUP);
        if high / GROUP > low / GROUP {
            leasts[high / GROUP] = least_of_group(&self.window, high / GROUP);
        }
        let rival = least_of_all(leasts);
        places.iter().zip(around).for_each(|(&place, sum)| self.window.0[place] = sum);

        let [before, cost, after] = around.map(u32::from);
        let beside = (low < index && index < high).then_some([before, after]);
        Winner { index, cost, rival: Some(rival & 0xffff), beside }
    }

    /// The same for any number of labels.
    #[cold]
    #[inline(never)]
    fn winner_of_any(&self, searched: usize) -> Winner {
        let mut costs = [0; Config::MAX_DISPARITIES as usize];
        for (label, cost) in costs[..searched].iter_mut().enumerate() {
            *cost = self.window.0[place(label, searched)];
        }
        Winner::find(&costs[..searched])
    }
}

impl<const WIDTH: usize, const DISPARITIES: usize> Sums for AbsoluteSums<WIDTH, DISPARITIES> {
    const DISPARITIES: usize = DISPARITIES;

    fn new() -> Self {
        Self {
            columns: [Labels::EMPTY; WIDTH],
            window: Labels::EMPTY,
            leasts: [0; Config::MAX_DISPARITIES as usize / GROUP],
        }
    }

    fn reset(&mut self) {
        self.columns.fill(Labels::EMPTY);
    }

    #[inline(always)]
    fn enter(&mut self, column: usize, left: Step<u8>, right: Step<&[u8]>, _: u8) {
        // Two differences, and both to the sum.
        descend(&mut self.columns[column], left, right);
    }

    fn begin(&mut self, _: usize) {
        self.window = Labels::EMPTY;
    }

    fn add(&mut self, entering: Place, searched: usize) {
        let columns = Step { entering: &self.columns[entering.column], leaving: Self::NOTHING };
        slide(&mut self.window, columns, searched, &mut self.leasts);
    }

    #[inline(always)]
    fn slide(&mut self, columns: Step<Place>, searched: usize) {
        let columns =
            Step { entering: &self.columns[columns.entering.column], leaving: &self.columns[columns.leaving.column] };
        slide(&mut self.window, columns, searched, &mut self.leasts);
    }

    #[inline(always)]
    fn winner(&mut self, searched: usize) -> Winner {
        if searched.is_multiple_of(GROUP) { self.winner_of_groups(searched) } else { self.winner_of_any(searched) }
    }
}

/// The least of all, in both halves.
#[inline(always)]
fn least_of_all(leasts: &[u32]) -> u32 {
    let least = leasts.iter().fold(u32::MAX, |least, &group| min_unsigned_halves(least, group));
    min_unsigned_halves(least, least.rotate_right(16))
}
