//! The method `wavelet-block`: block matching whose disparities an extremum search finds.

use crate::answer::confidence::Merit;
use crate::count;
use crate::matching::block::{Block, BlockRows, JUMP};
use crate::matching::cost::{BlockCost, ROWS};
use crate::matching::extremum::{FRAC_BITS, Method, Minimum, Settings, descend};
use crate::matching::label::{Label, Labels};
use crate::matching::search::{Bias, Decided, best_hypothesis};
use crate::method::block_row::decide_row;
use crate::method::matcher::{Matcher, Stage};
use crate::method::pipeline::Pipeline;
use crate::stage::{StageClock, Untimed};
use crate::{Config, ConfigError, Parts, Reading};

/// Columns of a block's window.
const WIDTH: usize = 8;
/// What a start pays for leaving its neighbours, grey levels over the window.
const BIAS: Bias = Bias { near: 50, far: 200 };
/// Least height of an extremum that is registered at once, the paper's A_1: grey levels over the window.
const LEAST_HEIGHT: i32 = 5;
/// Support of the first start where none is, the paper's s_1: costs, half of them on each side.
const FIRST_SUPPORT: u8 = 8;
/// Most steps of a search, the paper's limit of iterations.
const LIMIT: u16 = 12;
/// Most disparities that a block evaluates: the starts, the supports around them and around every step.
const LABELS: usize = 64;

/// StereoBM's steps, blocks, comparison and disparity, but for the exhaustive search: the paper's
/// wavelet-modified block matching (section 5).
///
/// Each 4x4 block starts its search at the best of at most four disparities: the nearest contour seeds'
/// and those of the blocks left and above, since neighbours have similar disparities. Where the cost
/// rises from there on both sides the extremum is registered. Elsewhere the [extremum
/// search](crate::extremum) goes on with a long support, then with short ones, and the better of its
/// end and the start's nearest minimum is taken.
///
/// At most 64 costs a block, whatever the range; see [`Reading`] for what is compared.
///
/// # Examples
/// ```
/// use haarline::{Config, Reading, StereoMethod, WaveletBlock, blocks_for};
/// let config = Config { num_disparities: 48, ..Config::for_width(320) };
/// let method = WaveletBlock::<{ blocks_for(320) }>::with_reading(config, Reading::Intensity)?;
/// assert_eq!(method.config(), &config);
/// # Ok::<(), haarline::ConfigError>(())
/// ```
pub type WaveletBlock<const BLOCKS: usize, C = Untimed> = Pipeline<Descent, ROWS, BLOCKS, C>;

/// The matcher of [`WaveletBlock`].
#[derive(Debug, Clone, Default)]
pub struct Descent {
    reading: Reading,
}

impl<const BLOCKS: usize> WaveletBlock<BLOCKS> {
    /// Builds the method of that reading; [`Pipeline::new`] takes the default one.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn with_reading(config: Config, reading: Reading) -> Result<Self, ConfigError> {
        let mut method = Self::with_parts(config, Parts::ALL)?;
        method.matcher.reading = reading;
        Ok(method)
    }
}

impl<const BLOCKS: usize> Matcher<ROWS, BLOCKS> for Descent {
    fn reading(&self) -> Reading {
        self.reading
    }

    fn clear(&mut self) {}

    fn decide(&mut self, stage: &Stage<'_, ROWS, BLOCKS>, blocks: &mut BlockRows<BLOCKS>, clock: &impl StageClock) {
        decide_row(stage, blocks, clock, |cost, index, decided| match_block(stage, cost, index, decided));
    }

    fn finish(&mut self, _: &Stage<'_, ROWS, BLOCKS>, _: &mut BlockRows<BLOCKS>) {}
}

fn match_block<const BLOCKS: usize>(
    stage: &Stage<'_, ROWS, BLOCKS>,
    cost: &BlockCost<'_, WIDTH>,
    index: usize,
    decided: Decided,
) -> Option<Block> {
    let mut labels = Labels::<LABELS>::new(stage.config.min_disparity);
    let start = best_start(stage, cost, index, decided, &mut labels)?;
    let found = if stage.parts.extremum {
        let price = |end: &Minimum| end.cost + decided.penalty(end.at, BIAS);
        let first = i32::from(stage.config.min_disparity);
        let domain = [first, first + i32::from(stage.config.num_disparities) - 1];
        find_extremum(start, price, domain, |disparity| labels.cost_or(disparity, || cost.of(index, disparity)))?
    } else {
        Minimum { at: start.disparity, cost: start.cost, before: None, after: None }
    };
    let mut block = cost.examine(stage.texture, index, found.at, found.cost)?;
    block.fraction = i8::try_from(found.refine_subpixel()).unwrap_or(0);
    let margin = labels.least_cost_beyond(found.at, JUMP).map(|rival| rival - found.cost);
    block.merit = Merit::new(found.cost, margin);
    Some(block)
}

/// The nearest minimum where it is registered, or else the better one of it and of a search with a long
/// support, by `price`.
fn find_extremum(
    start: Label,
    price: impl Fn(&Minimum) -> i32,
    domain: [i32; 2],
    mut cost: impl FnMut(i32) -> Option<i32>,
) -> Option<Minimum> {
    let mut costs = |disparity| {
        // Its part of a direction and of a height, and the comparisons with the range's ends.
        count::additions(2);
        count::comparisons(2);
        cost(disparity)
    };
    let nearest = descend(start.disparity, start.cost, 1, &mut costs);
    if is_registered(&nearest) {
        return Some(nearest);
    }
    let Some(farther) = search(start.disparity, domain, &mut costs) else { return Some(nearest) };
    Some(if price(&farther) < price(&nearest) { farther } else { nearest })
}

/// The proposed search from `start` over the whole disparities of `domain`; `None` if that is shorter than
/// the first support.
fn search(start: i32, domain: [i32; 2], mut costs: impl FnMut(i32) -> Option<i32>) -> Option<Minimum> {
    let whole = |disparity: i32| disparity << FRAC_BITS;
    let nearest = |coordinate: i32| (coordinate + whole(1) / 2) >> FRAC_BITS;
    let settings = Settings {
        start: [whole(start)],
        first_support: FIRST_SUPPORT,
        support_increment: 0,
        least_height: LEAST_HEIGHT,
        limit: LIMIT,
        ..Settings::new([whole(domain[0])], [whole(domain[1])])
    };
    let found = settings.build().ok()?.run(Method::Proposed, |&[coordinate]| costs(nearest(coordinate)));
    // A step and the zero of a direction take that many each.
    count::multiplications(4 * usize::from(found.iterations));
    count::subtractions(3 * usize::from(found.iterations));
    let at = nearest(found.at[0]);
    let here = costs(at)?;
    Some(descend(at, here, 1, costs))
}

/// Where the search begins.
fn best_start<const BLOCKS: usize>(
    stage: &Stage<'_, ROWS, BLOCKS>,
    cost: &BlockCost<'_, WIDTH>,
    index: usize,
    decided: Decided,
    labels: &mut Labels<LABELS>,
) -> Option<Label> {
    let (left, right) =
        if matches!(stage.parts.seeds, crate::Seeds::Contours) { stage.seeds.nearest(index) } else { (None, None) };
    let starts = [left, right, decided.above, decided.left].into_iter().flatten();
    best_hypothesis(cost, index, starts, decided, BIAS, labels)
}

/// Whether both ends of the bracket are known and high enough.
fn is_registered(minimum: &Minimum) -> bool {
    let rises = |end: Option<i32>| end.is_some_and(|end| end - minimum.cost >= LEAST_HEIGHT);
    rises(minimum.before) && rises(minimum.after)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the search finds from `start` where the costs are `cost`, and how often it asked for one.
    fn found(start: i32, cost: impl Fn(i32) -> i32) -> (Minimum, usize) {
        let mut asked = 0;
        let start = Label { disparity: start, cost: cost(start) };
        let found = find_extremum(
            start,
            |end| end.cost,
            [0, 63],
            |disparity| {
                asked += 1;
                (0..64).contains(&disparity).then(|| cost(disparity))
            },
        );
        (found.unwrap(), asked)
    }

    #[test]
    fn a_registered_extremum_takes_no_more_than_its_bracket() {
        let (minimum, asked) = found(20, |d| 30 * (d - 20).abs());
        assert_eq!((minimum.at, minimum.before, minimum.after, asked), (20, Some(30), Some(30), 2));
    }

    #[test]
    fn a_shallow_minimum_beside_a_deep_one_is_left_by_the_long_support() {
        let valley = |d: i32| (d - 24).abs() * 20 - i32::from(d == 20) * 22;
        let (minimum, _) = found(20, valley);
        assert_eq!((minimum.at, minimum.cost), (24, 0));
    }

    #[test]
    fn the_end_that_is_no_better_is_not_taken_and_a_plateau_ends_the_search() {
        assert_eq!(found(20, |_| 7).0.at, 20);
        // The long support points away from a narrow minimum.
        let narrow = |d: i32| {
            if d == 20 {
                0
            } else if d == 21 {
                4
            } else {
                500 - 3 * d
            }
        };
        assert_eq!(found(20, narrow).0.at, 20);
    }

    #[test]
    fn no_search_asks_for_more_labels_than_there_is_room_for() {
        for start in 0..64 {
            for slope in [-9, -3, 0, 3, 9] {
                let mut seen = [false; 64];
                let cost = |d: i32| 1000 + slope * d + (d * 37) % 11;
                let begin = Label { disparity: start, cost: cost(start) };
                find_extremum(
                    begin,
                    |end| end.cost,
                    [0, 63],
                    |disparity| {
                        let known = seen.get_mut(usize::try_from(disparity).ok()?)?;
                        *known = true;
                        Some(cost(disparity))
                    },
                );
                let evaluated = seen.iter().filter(|&&seen| seen).count();
                assert!(evaluated + 4 <= LABELS, "{evaluated} from {start}, slope {slope}");
            }
        }
    }
}
