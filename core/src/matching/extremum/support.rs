//! The samples of one support along one parameter, and what a wavelet says of them.

/// Fraction bits of means of costs.
const MEAN_BITS: u32 = 8;
/// The hyperbolic kernel's weights are this over the distance in steps.
const HYPERBOLIC: i64 = 1 << 10;

/// An odd wavelet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kernel {
    /// `psi(i) = sign(i)`: additions and subtractions only (eq. 8).
    Haar,
    /// `psi(i) = 1 / i` (eq. 3), in fixed point.
    Hyperbolic,
}

impl Kernel {
    fn weight(self, distance: i64) -> i64 {
        match self {
            Self::Haar => 1,
            Self::Hyperbolic => HYPERBOLIC / distance,
        }
    }
}

/// Sum of costs with the sum of their weights.
///
/// At most 127 costs of a side, of 31 bits each and weights up to 2^10: below 2^48, and 2^56 as a mean.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    costs: i64,
    weights: i64,
}

impl Sum {
    fn add(&mut self, cost: i64, weight: i64) {
        self.costs += if weight == 1 { cost } else { cost * weight };
        self.weights += weight;
    }

    /// The mean, with [`MEAN_BITS`] fraction bits; `None` of nothing.
    fn mean(self) -> Option<i64> {
        (self.weights > 0).then(|| (self.costs << MEAN_BITS) / self.weights)
    }
}

/// What a support's samples say. Costs here have 8 fraction bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Response {
    /// `G`, the mean of the samples after the point minus that of those before it.
    pub(super) direction: i64,
    /// By how much the outer samples exceed the inner ones: the height of a minimum.
    pub(super) height: i64,
    /// The least and the greatest cost.
    pub(super) range: [i64; 2],
}

/// Takes a support of `half` samples on each side; `sample` gives the cost at so many steps from the point, 0
/// being the point itself.
///
/// Samples without a cost are left out. A side without any is replaced by the point itself, so that a search at
/// the border of its domain finds back in. The outer samples are the further half of each side, the inner ones
/// the nearer half; with one sample on each side the inner one is the point itself.
///
/// `None` if there is nothing to compare.
pub(super) fn respond(half: u8, kernel: Kernel, mut sample: impl FnMut(i64) -> Option<i32>) -> Option<Response> {
    let mut sides = [Sum::default(); 2];
    let (mut outer, mut inner) = (Sum::default(), Sum::default());
    let mut range = [i64::MAX, i64::MIN];
    let half = i64::from(half);
    for distance in 1..=half {
        for (side, sign) in sides.iter_mut().zip([-1, 1]) {
            let Some(cost) = sample(sign * distance).map(i64::from) else { continue };
            side.add(cost, kernel.weight(distance));
            range = [range[0].min(cost), range[1].max(cost)];
            // The middle one of an odd number belongs to neither.
            if 2 * distance > half + 1 || half == 1 {
                outer.add(cost, 1);
            } else if 2 * distance < half + 1 {
                inner.add(cost, 1);
            }
        }
    }
    if sides.iter().any(|side| side.weights == 0) || half == 1 {
        let cost = i64::from(sample(0)?);
        range = [range[0].min(cost), range[1].max(cost)];
        inner.add(cost, 1);
        for side in sides.iter_mut().filter(|side| side.weights == 0) {
            side.add(cost, 1);
        }
    }
    let [before, after] = sides.map(Sum::mean);
    let height = outer.mean().zip(inner.mean()).map_or(0, |(outer, inner)| outer - inner);
    Some(Response { direction: after? - before?, height, range: range.map(|cost| cost << MEAN_BITS) })
}
