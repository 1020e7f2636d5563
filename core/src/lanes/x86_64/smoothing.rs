//! Smoothing, eight values at once.

use super::quad::Quad;
use crate::lanes::smoothing::Side;

/// What lies before and after eight values; what is on another surface is like the value itself.
struct Neighbours {
    before: Quad,
    after: Quad,
    /// Set where both are on the same one.
    both: Quad,
}

impl Neighbours {
    #[inline(always)]
    fn of(same: Quad, here: Quad, before: Quad, after: Quad) -> Self {
        let is_same = |other: Quad| same.not_less_halves(other.difference_of_halves(here));
        let (is_before, is_after) = (is_same(before), is_same(after));
        Self {
            before: before.where_or(is_before, here),
            after: after.where_or(is_after, here),
            both: is_before.and(is_after),
        }
    }

    #[inline(always)]
    fn slope(&self) -> Quad {
        let Self { before, after, both } = *self;
        after.halved_difference_halves(before).where_or(both, after.sub_halves(before))
    }
}

/// [`blend_pair`](crate::lanes::smoothing::blend_pair) of four pairs.
#[inline(always)]
pub(crate) fn blend(same: Quad, here: Quad, before: Quad, after: Quad) -> (Quad, Quad) {
    let neighbours = Neighbours::of(same, here, before, after);
    let mean = neighbours.before.halved_sum_halves(neighbours.after).halved_sum_halves(here);
    (mean.where_or(neighbours.both, here), neighbours.slope())
}

/// [`blend_pair_widely`](crate::lanes::smoothing) of four pairs.
#[inline(always)]
fn blend_widely(same: Quad, here: Quad, before: Quad, after: Quad) -> (Quad, Quad) {
    let neighbours = Neighbours::of(same, here, before, after);
    let sides = neighbours.before.halved_sum_halves(neighbours.after);
    let mean = sides.halved_sum_halves(sides.halved_sum_halves(here));
    (mean.where_or(neighbours.both, here), neighbours.slope())
}

/// Four pairs, a pair before those that came last: what lies before them, themselves, what lies after.
#[inline(always)]
fn around(came_before: Quad, came: Quad) -> [Quad; 3] {
    [came.after::<6, 10>(came_before), came.after::<4, 12>(came_before), came.after::<2, 14>(came_before)]
}

/// Smooths as many fours of pairs from the third pair on as there are, as [`Values::smooth`](crate::lanes::smoothing::Values) does;
/// the first pair that is left.
///
/// - `raw`: the pair before the first two as they came; `smooth`: those before, smoothed once.
#[inline(always)]
pub(crate) fn smooth_by_fours(
    values: &mut [[u16; 2]],
    slopes: &mut [[i16; 2]],
    same: u32,
    [raw, smooth]: [&mut Side; 2],
) -> usize {
    let same = Quad::splat(same);
    let [mut came, mut once] = [*raw, *smooth].map(|Side { before, here }| Quad::of([0, 0, before, here]));
    let mut pair = 2;
    while let Some(four) = values.get(pair..).and_then(<[_]>::first_chunk::<4>) {
        let next = Quad::read(four);
        let [before, here, after] = around(came, next);
        let next_once = blend(same, here, before, after).0;
        let [before, here, after] = around(once, next_once);
        let (value, slope) = blend_widely(same, here, before, after);
        let done = values.get_mut(pair - 2..).and_then(<[_]>::first_chunk_mut::<4>);
        if let Some((values, slopes)) = done.zip(slopes.get_mut(pair - 2..).and_then(<[_]>::first_chunk_mut::<4>)) {
            value.write(values);
            slope.write(slopes);
        }
        (came, once) = (next, next_once);
        pair += 4;
    }
    for (pairs, quad) in [(raw, came), (smooth, once)] {
        let [.., before, here] = quad.words();
        *pairs = Side { before, here };
    }
    pair
}
