//! One start of the search: against the direction until its sign changes (eq. 6 and 8), and what brackets the
//! extremum then (eq. 9).

use super::FRAC_BITS;
use super::settings::Settings;
use super::support::{Kernel, Response, respond};

/// What a start searches with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    /// Samples on each side.
    pub(super) half: u8,
    /// Distance of the samples.
    pub(super) step: i64,
    /// The fixed-point gamma.
    pub(super) gamma: i64,
    /// A step of the walk as short as this ends it.
    pub(super) error: i64,
    /// The wavelet.
    pub(super) kernel: Kernel,
}

/// Where a start ended.
#[derive(Debug, Clone, Copy)]
pub(super) struct End<const N: usize> {
    /// The zero of the direction between the last two points, taken as linear there.
    pub(super) at: [i32; N],
    /// The last two points, the lesser first.
    pub(super) bracket: [[i32; 2]; N],
    /// Height of the extremum along the parameter where it is least; costs with 8 fraction bits.
    pub(super) height: i64,
}

/// The cost, and what is counted of it.
pub(super) struct Counted<F, const N: usize> {
    cost: F,
    /// The least cost of this start and where it is.
    pub(super) least: Option<(i32, [i32; N])>,
    pub(super) evaluations: u32,
    pub(super) iterations: u16,
}

impl<const N: usize, F: FnMut(&[i32; N]) -> Option<i32>> Counted<F, N> {
    pub(super) fn new(cost: F) -> Self {
        Self { cost, least: None, evaluations: 0, iterations: 0 }
    }

    pub(super) fn at(&mut self, at: &[i32; N]) -> Option<i32> {
        self.evaluations = self.evaluations.saturating_add(1);
        let cost = (self.cost)(at)?;
        if self.least.is_none_or(|(least, _)| cost < least) {
            self.least = Some((cost, *at));
        }
        Some(cost)
    }

    /// The support along one parameter; what lies outside of the domain is not evaluated.
    fn respond(&mut self, settings: &Settings<N>, at: &[i32; N], parameter: usize, start: &Start) -> Option<Response> {
        let domain = i64::from(settings.lower[parameter])..=i64::from(settings.upper[parameter]);
        respond(start.half, start.kernel, |distance| {
            let coordinate = i64::from(at[parameter]) + distance * start.step;
            if !domain.contains(&coordinate) {
                return None;
            }
            let mut sample = *at;
            sample[parameter] = i32::try_from(coordinate).ok()?;
            self.at(&sample)
        })
    }
}

/// One parameter's part in a walk.
#[derive(Debug, Clone, Copy)]
struct Track {
    /// The point before the present one, with its direction.
    last: Option<(i32, i64)>,
    bracket: [i32; 2],
    height: i64,
    is_done: bool,
}

/// Walks from `from` until the direction has changed its sign along every parameter, or the walk's step is within
/// the error, or the domain ends. A parameter that is done waits for the others.
///
/// Costs are divided by their range in the first support, so that gamma has no unit of cost. `None` if the range is
/// 0: nothing tells a direction.
pub(super) fn walk<const N: usize, F: FnMut(&[i32; N]) -> Option<i32>>(
    settings: &Settings<N>,
    from: [i32; N],
    start: &Start,
    cost: &mut Counted<F, N>,
) -> Option<End<N>> {
    let mut at = from;
    let mut tracks = from.map(|c| Track { last: None, bracket: [c; 2], height: 0, is_done: false });
    let mut range = None;
    while cost.iterations < settings.limit && tracks.iter().any(|track| !track.is_done) {
        cost.iterations += 1;
        let responses: [Option<Response>; N] =
            core::array::from_fn(|j| if tracks[j].is_done { None } else { cost.respond(settings, &at, j, start) });
        let range = *range.get_or_insert_with(|| range_of(&responses));
        // It is never negative; where that is plain to see, so is that no division overflows.
        if range <= 0 {
            return None;
        }
        let domains = settings.lower.into_iter().zip(settings.upper);
        for (((track, at), response), (lower, upper)) in tracks.iter_mut().zip(&mut at).zip(responses).zip(domains) {
            match response {
                _ if track.is_done => {}
                Some(response) => *at = track.advance(*at, response, range, start, [lower, upper]),
                None => track.is_done = true,
            }
        }
    }
    let height = tracks.iter().map(|track| track.height).min().unwrap_or(0);
    Some(End { at, bracket: tracks.map(|track| track.bracket), height })
}

/// The range of all costs of the first supports.
fn range_of(responses: &[Option<Response>]) -> i64 {
    let ranges = responses.iter().flatten().map(|response| response.range);
    let [least, most] = ranges.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or([0, 0]);
    most - least
}

impl Track {
    /// Goes on from `at`; returns where to.
    fn advance(&mut self, at: i32, response: Response, range: i64, start: &Start, domain: [i32; 2]) -> i32 {
        let direction = response.direction;
        self.height = response.height;
        if let Some((last, before)) = self.last
            && direction.signum() != before.signum()
        {
            self.is_done = true;
            self.bracket = [last.min(at), last.max(at)];
            return zero_between((last, before), (at, direction));
        }
        let next = i64::from(at) - stride(direction, range, start);
        let next = next.clamp(domain[0].into(), domain[1].into());
        // Fits, since the domain does.
        let next = i32::try_from(next).unwrap_or(at);
        let moved = i64::from(next) - i64::from(at);
        self.is_done = moved.abs() <= start.error;
        self.bracket = [at.min(next), at.max(next)];
        self.last = Some((at, direction));
        next
    }
}

/// `gamma * G` of eq. 6, with `G` in parts of the range and gamma in parts of half the support.
///
/// The direction is within the range of 2^40 for costs of 32 bits, half the support within 127 steps of 2^31, and
/// gamma within 2^20: the products stay below 2^59.
fn stride(direction: i64, range: i64, start: &Start) -> i64 {
    let part = ((direction << FRAC_BITS) / range).clamp(-(1 << FRAC_BITS), 1 << FRAC_BITS);
    let longest = (start.gamma * i64::from(start.half) * start.step) >> FRAC_BITS;
    (longest * part) >> FRAC_BITS
}

/// Where the direction is zero between two points of different sign, if it is linear there.
fn zero_between((a, before): (i32, i64), (b, after): (i32, i64)) -> i32 {
    let (before, after) = (before.unsigned_abs(), after.unsigned_abs());
    let distance = i64::from(b) - i64::from(a);
    // Both are below 2^41; their sum is not 0, since the first is not.
    let part = i64::try_from((before << FRAC_BITS) / (before + after).max(1)).unwrap_or(0);
    i32::try_from(i64::from(a) + ((distance * part) >> FRAC_BITS)).unwrap_or(b)
}
