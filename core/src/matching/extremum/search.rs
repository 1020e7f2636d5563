//! The starts of the search, from the first support to the error wanted.

use super::settings::{Search, Settings};
use super::support::Kernel;
use super::walk::{Counted, End, Start, walk};

/// Supports of all starts but the first, the longest first (step 3 of the paper).
const SUPPORTS: [u8; 3] = [6, 4, 2];

/// Heights `A_1` by which a sample must undercut the end of a start: it is the best of many, and so too good by some
/// standard deviations of the noise.
const UNDERCUT: i64 = 2;

/// How supports are chosen from start to start; all methods walk alike and end alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The proposed method as we read it: the first start with `s_1` samples, then six with the same step `a`, then
    /// half the step at every further start, and fewer samples where six would lie closer than the least step.
    ///
    /// A start's extremum is not registered if one of its samples undercuts it by more than twice `A_1`: the next
    /// start goes on from that better point. A start that shows no height of `A_1`, up or down, lies in the noise: the
    /// first one is repeated with `Delta_s` more samples as long as the domain holds them, and the ends are averaged;
    /// a later one is dropped, and the search ends with what was registered before.
    Proposed,
    /// The proposed method to the letter: `a` stays, `s_k` is the longest of 6, 4 and 2 that is shorter than the one
    /// before and fits the bracket, and the search ends when none does. Its error is a step `a` at best.
    Bracketed,
    /// A basic method: the long Haar support to the end, gamma halved at every start.
    Long,
    /// The basic method: the hyperbolic kernel at the first start, then the long Haar support to the end.
    Hyperbolic,
}

/// What a search found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Found<const N: usize> {
    /// The coordinates, within the domain; the start's where nothing told a direction.
    pub at: [i32; N],
    /// The cost there; `None` where the cost has none.
    pub cost: Option<i32>,
    /// `g_1` and `g_2` (eq. 9), the lesser first: the last two points of the last start that was taken over.
    pub bracket: [[i32; 2]; N],
    /// How many starts there were.
    pub starts: u16,
    /// How many iterations, all starts together.
    pub iterations: u16,
    /// How often the cost was asked for.
    pub evaluations: u32,
    /// Whether an extremum of height `A_1` was found; a constant cost has none.
    pub registered: bool,
}

impl<const N: usize> Search<N> {
    /// Looks for the minimum of `cost`, which gives `None` where it has no value.
    ///
    /// Ends after the limit of iterations at the latest; each asks for at most `s + 1` costs a parameter, and each
    /// start for one more.
    pub fn run(&self, method: Method, cost: impl FnMut(&[i32; N]) -> Option<i32>) -> Found<N> {
        let settings = &self.0;
        let mut cost = Counted::new(cost);
        let (mut at, mut bracket) = (settings.start, settings.start.map(|c| [c; 2]));
        let (mut starts, mut registered) = (0, false);
        let mut next = Some(settings.first(method));
        while let Some(start) = next
            && cost.iterations < settings.limit
        {
            starts += 1;
            cost.least = None;
            let Some(end) = walk(settings, at, &start, &mut cost) else { break };
            let is_in_noise = end.height.abs() < settings.least_height_of_means().max(1);
            let is_proposed = method == Method::Proposed;
            if is_proposed && is_in_noise && registered {
                break;
            }
            at = if is_proposed && is_in_noise && starts > 1 { between(at, end.at) } else { end.at };
            (bracket, registered) = (end.bracket, !is_in_noise && end.height > 0);
            if is_proposed && is_in_noise {
                next = settings.lengthened(&start);
                continue;
            }
            if is_proposed {
                at = settings.better(at, &mut cost);
            }
            next = settings.after(method, &start, &end);
        }
        let here = cost.at(&at);
        let (iterations, evaluations) = (cost.iterations, cost.evaluations);
        Found { at, cost: here, bracket, starts, iterations, evaluations, registered }
    }
}

/// The mean of two starts' ends in noise. The later one counts twice: it had the longer support, and began nearer.
fn between<const N: usize>(earlier: [i32; N], later: [i32; N]) -> [i32; N] {
    core::array::from_fn(|j| {
        let sum = i64::from(earlier[j]) + 2 * i64::from(later[j]);
        i32::try_from(sum.div_euclid(3)).unwrap_or(later[j])
    })
}

impl<const N: usize> Settings<N> {
    fn first(&self, method: Method) -> Start {
        Start {
            half: self.first_support / 2,
            step: self.step.into(),
            gamma: self.gamma.into(),
            error: self.first_error.into(),
            kernel: if method == Method::Hyperbolic { Kernel::Hyperbolic } else { Kernel::Haar },
        }
    }

    /// `A_1` with the 8 fraction bits of means.
    fn least_height_of_means(&self) -> i64 {
        i64::from(self.least_height) << 8
    }

    /// The best sample of the start if it undercuts the cost at `at` by more than twice `A_1`; `at` otherwise.
    fn better<F: FnMut(&[i32; N]) -> Option<i32>>(&self, at: [i32; N], cost: &mut Counted<F, N>) -> [i32; N] {
        let least = cost.least;
        match (least, cost.at(&at)) {
            (Some((least, there)), Some(here))
                if i64::from(here) - i64::from(least) > UNDERCUT * i64::from(self.least_height) =>
            {
                there
            }
            _ => at,
        }
    }

    /// The first start again with a longer support; `None` if that is longer than the domain or not wanted.
    fn lengthened(&self, start: &Start) -> Option<Start> {
        let more = self.support_increment / 2;
        let half = start.half.checked_add(more).filter(|&half| half <= 127 && more > 0)?;
        let is_first = start.half >= self.first_support / 2;
        let length = 2 * i64::from(half) * start.step;
        (is_first && (0..N).all(|j| length <= self.extent(j))).then_some(Start { half, ..*start })
    }

    /// The start after one that ended; `None` if the error is reached.
    fn after(&self, method: Method, start: &Start, end: &End<N>) -> Option<Start> {
        let width = end.bracket.iter().map(|[a, b]| i64::from(*b) - i64::from(*a)).max()?;
        let error = i64::from(self.error);
        let next = Start { error, kernel: Kernel::Haar, ..*start };
        match method {
            Method::Proposed => self.shortened(next),
            Method::Bracketed => {
                let fits = |&s: &u8| i64::from(s) * start.step <= width && s / 2 < start.half;
                SUPPORTS.into_iter().find(fits).map(|support| Start { half: support / 2, ..next })
            }
            Method::Long | Method::Hyperbolic => {
                let gamma = start.gamma / 2;
                (width > error && gamma > 0).then_some(Start { gamma, ..next })
            }
        }
    }

    /// Six samples at the same step after a longer support, else half the support's length; `None` once half of it
    /// is within the error or samples would lie closer than the least step.
    fn shortened(&self, start: Start) -> Option<Start> {
        let half_length = i64::from(start.half) * start.step;
        let length = half_length.min(6 * start.step);
        let fits = |&s: &u8| length / i64::from(s) >= i64::from(self.least_step);
        let support = SUPPORTS.into_iter().find(fits).filter(|_| half_length > i64::from(self.error))?;
        Some(Start { half: support / 2, step: length / i64::from(support), ..start })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::matching::extremum::{FRAC_BITS, SettingsError};

    const METHODS: [Method; 4] = [Method::Proposed, Method::Bracketed, Method::Long, Method::Hyperbolic];

    const fn whole(value: i32) -> i32 {
        value << FRAC_BITS
    }

    fn hundred() -> Settings<1> {
        Settings { start: [whole(10)], ..Settings::new([0], [whole(100)]) }
    }

    #[test]
    fn a_long_support_passes_over_a_ripple_that_stops_a_short_one() {
        // A valley at 40 with a ripple of period 3 on its slopes.
        let at = |c: i32| (c - 40).abs() * 4 + if c % 3 == 0 { 12 } else { 0 };
        let settings = Settings { first_support: 24, ..hundred() };
        let found = settings.build().unwrap().run(Method::Proposed, |&[c]| Some(at(c >> FRAC_BITS)));
        let short = super::super::descend(10, at(10), 200, |c| Some(at(c))).at;
        assert!(short < 20, "{short}");
        assert!((found.at[0] - whole(40)).abs() <= whole(2), "{}", found.at[0] >> FRAC_BITS);
    }

    #[test]
    fn two_parameters_are_found_together() {
        let settings =
            Settings { start: [whole(1); 2], first_support: 17, ..Settings::new([whole(-20); 2], [whole(20); 2]) };
        let search = Settings { least_step: 1 << 8, error: 1 << 10, ..settings }.build().unwrap();
        let cost = |&[x, y]: &[i32; 2]| {
            let (x, y) = ((x - whole(7)) >> 10, (y + whole(5)) >> 10);
            Some(x * x + y * y + x * y / 2)
        };
        let found = search.run(Method::Proposed, cost);
        assert!(found.registered);
        assert!(
            (found.at[0] - whole(7)).abs() < whole(1) / 8 && (found.at[1] + whole(5)).abs() < whole(1) / 8,
            "{found:?}"
        );
    }

    #[test]
    fn a_constant_cost_and_one_without_values_register_nothing_and_end() {
        for method in METHODS {
            for cost in [Some(7), Some(i32::MAX), Some(i32::MIN), None] {
                let found = hundred().build().unwrap().run(method, |_| cost);
                assert!(!found.registered && found.starts == 1 && found.iterations == 1, "{method:?} {found:?}");
                assert_eq!((found.at, found.cost), ([whole(10)], cost));
            }
        }
    }

    #[test]
    fn an_extremum_lower_than_the_least_height_is_not_registered() {
        let cost = |&[c]: &[i32; 1]| Some(((c >> FRAC_BITS) - 50).abs());
        let run = |least_height| Settings { least_height, ..hundred() }.build().unwrap().run(Method::Proposed, cost);
        assert!(run(1).registered);
        assert!(!run(1000).registered);
    }

    #[test]
    fn each_field_is_held_to_its_range() {
        let valid = hundred();
        let cases = [
            (Settings { upper: [0], ..valid }, SettingsError::EmptyDomain { parameter: 0 }),
            (Settings { lower: [whole(50)], upper: [whole(40)], ..valid }, SettingsError::EmptyDomain { parameter: 0 }),
            (Settings { upper: [i32::MAX], ..valid }, SettingsError::Coordinate { parameter: 0 }),
            (Settings { start: [-1], ..valid }, SettingsError::Start { parameter: 0 }),
            (Settings { gamma: 0, ..valid }, SettingsError::Gamma),
            (Settings { gamma: Settings::<1>::MAX_GAMMA + 1, ..valid }, SettingsError::Gamma),
            (Settings { step: 0, least_step: 0, ..valid }, SettingsError::Step),
            (Settings { step: 1, ..valid }, SettingsError::Step),
            (Settings { first_error: 0, ..valid }, SettingsError::Errors),
            (Settings { error: -1, ..valid }, SettingsError::Errors),
            (Settings { limit: 0, ..valid }, SettingsError::Limit),
            (Settings { least_height: -1, ..valid }, SettingsError::LeastHeight),
            (Settings { first_support: 1, ..valid }, SettingsError::Support),
            (Settings { first_support: 102, ..valid }, SettingsError::SupportOverDomain { parameter: 0 }),
        ];
        for (settings, error) in cases {
            assert_eq!(settings.build(), Err(error), "{error}");
        }
        assert!(valid.build().is_ok());
        assert_eq!(Settings::<0>::new([], []).build(), Err(SettingsError::NoParameter));
    }

    proptest! {
        #[test]
        fn every_search_ends_within_its_bounds(
            costs in prop::collection::vec(prop::option::weighted(0.9, any::<i32>()), 64),
            start in 0i32..64, support in 2u8..64, increment in 0u8..255, gamma in 1u32..(16 << FRAC_BITS),
            least_step in 1i32..(1 << FRAC_BITS), error in 1i32..(1 << 18), height in 0i32..i32::MAX, limit in 1u16..60,
        ) {
            let settings = Settings {
                start: [whole(start)], first_support: support, support_increment: increment, gamma, least_step, error,
                least_height: height, limit, ..Settings::new([0], [whole(63)])
            };
            for method in METHODS {
                let mut asked = 0;
                let found = settings.build().unwrap().run(method, |&[c]| {
                    asked += 1;
                    costs[usize::try_from(c >> FRAC_BITS).unwrap()]
                });
                prop_assert!((0..=whole(63)).contains(&found.at[0]));
                prop_assert_eq!(found.evaluations, asked);
                prop_assert!(found.iterations <= limit && found.starts <= found.iterations);
                prop_assert!(found.evaluations <= 256 * (u32::from(limit) + 1));
                prop_assert!(found.bracket[0][0] <= found.bracket[0][1]);
            }
        }

        #[test]
        fn a_parabola_is_found_from_everywhere(vertex in 5i32..95, start in 0i32..=100) {
            let cost = |&[c]: &[i32; 1]| Some(((c - whole(vertex)) >> 10).pow(2));
            let error = whole(1) / 16;
            let settings = Settings { start: [whole(start)], first_error: error, error, limit: 1000, ..hundred() };
            // The basic methods keep the range of the first start's beginning, so that their steps get short early:
            // they end within half a support.
            for (method, off) in [(Method::Proposed, 2), (Method::Long, 5), (Method::Hyperbolic, 5)] {
                let found = settings.build().unwrap().run(method, cost);
                prop_assert!((found.at[0] - whole(vertex)).abs() <= whole(off), "{:?} {:?}", method, found);
            }
        }
    }
}
