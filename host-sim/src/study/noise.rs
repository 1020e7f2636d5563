//! Study `noise` (Fig. 4): evaluations, time and error of the extremum against the signal-to-noise ratio.
//!
//! The ratio is the cost's amplitude (greatest minus least value over the domain) over the standard deviation of the
//! noise. The noise is white, Gaussian and frozen: a cost over whole steps, like one over disparities, that gives the
//! same value whenever it is asked for.

mod plot;
mod verdict;

use std::f64::consts::TAU;
use std::time::Instant;

use anyhow::Result;
use haarline::extremum::{FRAC_BITS, Method, Settings};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::schwefel::Searcher;
use super::{Outcome, Part, Setup, Table};

/// Noisy costs of each kind.
pub const SEEDS: u64 = 1000;
/// Whole steps of the domain.
const STEPS: usize = 256;
/// Integer costs of one amplitude.
const AMPLITUDE: f64 = 100_000.0;
const RATIOS: [f64; 10] = [1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0];
/// First the proposed method, then what it is compared with.
const SEARCHERS: [Searcher; 5] = [
    Searcher::Haar(Method::Proposed),
    Searcher::Haar(Method::Long),
    Searcher::Haar(Method::Hyperbolic),
    Searcher::Gradient,
    Searcher::Exhaustive,
];

/// The kind of a cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A parabola: a slope everywhere.
    Parabola,
    /// A well in a plain, as the cost of a block.
    Well,
    /// A parabola with a ripple, the global minimum in one of its dips.
    RippledParabola,
    /// A well with a ripple.
    RippledWell,
}

impl Shape {
    /// All of them, the unimodal ones first.
    pub const ALL: [Self; 4] = [Self::Parabola, Self::Well, Self::RippledParabola, Self::RippledWell];

    fn name(self) -> &'static str {
        match self {
            Self::Parabola => "parabola (unimodal)",
            Self::Well => "well (unimodal)",
            Self::RippledParabola => "rippled parabola (multimodal)",
            Self::RippledWell => "rippled well (multimodal)",
        }
    }

    /// The cost at a distance from the minimum, steps.
    fn at(self, distance: f64) -> f64 {
        let parabola = (distance / 192.0).powi(2);
        let well = 1.0 - (-(distance / 32.0).powi(2) / 2.0).exp();
        let ripple = 0.1 * (1.0 - (TAU * distance / 16.0).cos());
        match self {
            Self::Parabola => parabola,
            Self::Well => well,
            Self::RippledParabola => 0.8 * parabola + ripple,
            Self::RippledWell => 0.8 * well + ripple,
        }
    }
}

/// A noisy cost, where its minimum is and where a search starts.
#[derive(Debug, Clone)]
struct Noisy {
    costs: Vec<i32>,
    sigma: f64,
    minimum: f64,
    start: i32,
}

impl Noisy {
    fn new(shape: Shape, ratio: f64, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let minimum = rng.random_range(0.25..0.75) * STEPS as f64;
        let start = rng.random_range(0..STEPS as i32);
        let clean: Vec<f64> = (0..STEPS).map(|step| shape.at(step as f64 - minimum)).collect();
        let (least, most) = clean.iter().fold((f64::MAX, f64::MIN), |(a, b), &cost| (a.min(cost), b.max(cost)));
        let sigma = AMPLITUDE / ratio;
        let noisy = |cost: f64| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            ((cost - least) / (most - least) * AMPLITUDE + sigma * noise).round() as i32
        };
        Self { costs: clean.into_iter().map(noisy).collect(), sigma, minimum, start }
    }

    fn at(&self, coordinate: i32) -> Option<i32> {
        let step = (coordinate + (1 << (FRAC_BITS - 1))) >> FRAC_BITS;
        self.costs.get(usize::try_from(step).ok()?).copied()
    }
}

/// One search's figures.
#[derive(Debug, Clone, Copy)]
struct Trial {
    /// Distance from the minimum in parts of the domain.
    error: f64,
    evaluations: f64,
    seconds: f64,
}

/// Means over the seeds with half the width of their 95 % confidence interval.
#[derive(Debug, Clone)]
pub struct Figures {
    /// Relative error of the extremum.
    pub error: [f64; 2],
    /// Evaluations of the cost.
    pub evaluations: [f64; 2],
    /// Executed time on this host, s: the median, since other work on the host delays single searches.
    pub seconds: f64,
    /// The error of each search, in the order of the seeds: the same costs for every searcher.
    errors: Vec<f64>,
}

/// The figures of a searcher at a ratio.
type Found = (Searcher, f64, Figures);

/// Searches [`SEEDS`] noisy costs.
///
/// # Errors
/// If the core refuses the parameters.
pub fn measure(shape: Shape, ratio: f64, searcher: Searcher, seed: u64) -> Result<Figures> {
    let trial = |index: u64| search(&Noisy::new(shape, ratio, seed.wrapping_mul(SEEDS).wrapping_add(index)), searcher);
    let trials: Vec<Trial> = (0..SEEDS).into_par_iter().map(trial).collect::<Result<_>>()?;
    let mut times: Vec<f64> = trials.iter().map(|trial| trial.seconds).collect();
    times.sort_by(f64::total_cmp);
    let seconds = times[times.len() / 2];
    let errors: Vec<f64> = trials.iter().map(|trial| trial.error).collect();
    let evaluations = mean(trials.iter().map(|trial| trial.evaluations));
    Ok(Figures { error: mean(errors.iter().copied()), evaluations, seconds, errors })
}

/// The mean and half the width of its 95 % confidence interval.
fn mean(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    [mean, 1.96 * (variance / count).sqrt()]
}

fn search(noisy: &Noisy, searcher: Searcher) -> Result<Trial> {
    let begin = Instant::now();
    let (at, evaluations) = match searcher {
        Searcher::Haar(method) => {
            let found = settings(noisy).build()?.run(method, |&[c]| noisy.at(c));
            (f64::from(found.at[0]) / f64::from(1 << FRAC_BITS), found.evaluations)
        }
        Searcher::Gradient => descend_gradient(&noisy.costs, noisy.start),
        Searcher::Exhaustive => {
            let best = (0..STEPS).min_by_key(|&step| noisy.costs[step]).unwrap_or(0);
            (best as f64, STEPS as u32)
        }
    };
    let seconds = begin.elapsed().as_secs_f64();
    Ok(Trial { error: (at - noisy.minimum).abs() / STEPS as f64, evaluations: evaluations.into(), seconds })
}

/// The same for all three methods: the paper's gamma of 0.9 and s_1 of 10, sixteen steps apart; the least height
/// is two standard deviations of the noise, known from "preliminary studies" as in the paper.
fn settings(noisy: &Noisy) -> Settings<1> {
    let step = 1 << FRAC_BITS;
    Settings {
        start: [noisy.start << FRAC_BITS],
        first_support: 10,
        step: 16 * step,
        least_step: step,
        support_increment: 4,
        least_height: (2.0 * noisy.sigma).round() as i32,
        limit: 200,
        ..Settings::new([0], [((STEPS - 1) as i32) << FRAC_BITS])
    }
}

/// Gradient descent over whole steps: a step of an eighth of the domain against the difference of both neighbours,
/// halved where it climbs.
fn descend_gradient(costs: &[i32], start: i32) -> (f64, u32) {
    let last = costs.len() as i32 - 1;
    let cost = |at: i32| costs[at.clamp(0, last) as usize];
    let (mut at, mut step, mut evaluations) = (start, costs.len() as i32 / 8, 1);
    while step > 0 {
        let next = (at - (cost(at + 1) - cost(at - 1)).signum() * step).clamp(0, last);
        evaluations += 3;
        if cost(next) < cost(at) {
            at = next;
        } else {
            step /= 2;
        }
    }
    (f64::from(at), evaluations)
}

/// Runs the study.
///
/// # Errors
/// If the core refuses the parameters or a plot cannot be drawn.
pub fn run(setup: &Setup<'_>) -> Result<Outcome> {
    setup.progress.set_length((Shape::ALL.len() * SEARCHERS.len() * RATIOS.len()) as u64);
    let (mut rows, mut kinds) = (Vec::new(), Vec::new());
    for shape in Shape::ALL {
        let mut figures = Vec::new();
        for searcher in SEARCHERS {
            for ratio in RATIOS {
                let found = measure(shape, ratio, searcher, setup.seed)?;
                rows.push(row(shape, ratio, searcher, &found));
                figures.push((searcher, ratio, found));
                setup.progress.inc(1);
            }
        }
        kinds.push((shape, figures));
    }
    let columns = [
        "cost",
        "SNR",
        "method",
        "mean evaluations",
        "+- (95 %)",
        "relative error",
        "+- (95 %)",
        "median time on this host, us (measured)",
    ];
    let table = Table {
        name: "methods".to_owned(),
        caption: format!("Means over {SEEDS} noisy costs each; the error is in parts of the domain"),
        columns: columns.map(str::to_owned).to_vec(),
        rows,
    };
    let mut parts =
        vec![Part::Text(verdict::musts(&kinds)), Part::Table(verdict::table(&kinds)), Part::Text(introduction())];
    parts.extend(kinds.iter().map(|(shape, figures)| Part::Text(verdict::text(*shape, figures))));
    for (shape, figures) in &kinds {
        parts.push(Part::Plot(plot::evaluations_and_error(*shape, figures)?));
    }
    parts.push(Part::Plot(plot::times(&kinds)?));
    parts.push(Part::Table(table));
    Ok(Outcome { name: "noise", title: "The extremum of a noisy cost".to_owned(), parts })
}

fn introduction() -> String {
    format!(
        "Costs over {STEPS} whole steps with white Gaussian noise, frozen, {SEEDS} of each kind and ratio. SNR is the \
         amplitude of the cost over the standard deviation of the noise. The paper's proposed method is 1.1 times faster \
         than its basic one at SNR 2, at 1.2 times the error. All three methods have the same first start, gamma, errors \
         and limit, and search the same costs. Two parts of the proposed method are ours and not the paper's: in noise the \
         ends of the starts are averaged, and a start whose best sample undercuts its end by more than twice the least \
         height is followed by one from that sample. Parameters and rules were tuned on costs of these same four kinds, drawn by another generator; so the \
         figures speak for costs of these kinds. The time includes what the search itself costs on this host, with a cost \
         that is a table look-up: where a cost is as cheap as that, trying all of them can be faster than any search."
    )
}

fn row(shape: Shape, ratio: f64, searcher: Searcher, found: &Figures) -> Vec<String> {
    vec![
        shape.name().to_owned(),
        format!("{ratio}"),
        searcher.name().to_owned(),
        format!("{:.1}", found.evaluations[0]),
        format!("{:.1}", found.evaluations[1]),
        format!("{:.4}", found.error[0]),
        format!("{:.4}", found.error[1]),
        format!("{:.2}", found.seconds * 1e6),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_a_ratio_of_two_fewer_evaluations_find_the_extremum_at_no_larger_error() {
        for shape in Shape::ALL {
            let [ours, long, hyperbolic] = [0, 1, 2].map(|index| measure(shape, 2.0, SEARCHERS[index], 1).unwrap());
            for basic in [long, hyperbolic] {
                assert!(ours.evaluations[0] * 1.1 <= basic.evaluations[0], "{shape:?} {ours:?} {basic:?}");
                assert!(ours.error[0] <= basic.error[0], "{shape:?} {ours:?} {basic:?}");
            }
        }
    }

    #[test]
    fn at_a_ratio_of_two_gradient_descent_fails() {
        for shape in Shape::ALL {
            let [ours, gradient] = [0, 3].map(|index| measure(shape, 2.0, SEARCHERS[index], 1).unwrap());
            assert!(gradient.error[0] > 1.5 * ours.error[0], "{shape:?} {ours:?} {gradient:?}");
        }
    }
}
