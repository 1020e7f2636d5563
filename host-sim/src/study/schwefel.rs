//! Study `schwefel`: does the search reach the global minimum of a multimodal function from any start?

use std::f64::consts::{E, PI};

use anyhow::Result;
use haarline::extremum::Method;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::plot::{Axis, Chart, Layer, Mark, figure};
use super::scaled::{Parameters, Scaled};
use super::{Outcome, Part, Plot, Setup, Table};

/// Starts, as many as in the paper.
pub const STARTS: usize = 150;
/// The paper's error, for a domain of 1000; a hundred-thousandth of any other.
const ERROR: f64 = 1e-5;
/// Where the minimum is, and where the paper prints it.
const MINIMUM: f64 = 420.968_746;
const PRINTED: f64 = 420.9829;

/// One set for all functions: sixteen samples over the whole domain, so that the first start sees it all from its
/// middle. What lies outside of the domain is left out. Then six samples, half the span at every further start: the
/// step a shrinks with it, which the paper does not say.
const PARAMETERS: Parameters =
    Parameters { gamma: 1.5, first_support: 16, span: 1.0, errors: [1e-3, 2e-5], limit: 1000 };

/// A function with a known global minimum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// `418.9829 - x sin sqrt |x|` over (-500, 500).
    Schwefel,
    /// The same, moved by -100 to 20 each time. Further to either side its value at a border of the domain falls
    /// towards the next, deeper minimum outside.
    ShiftedSchwefel,
    /// `10 + x^2 - 10 cos 2 pi x` over (-5.12, 5.12), moved by up to a quarter of the domain.
    Rastrigin,
    /// Ackley's over (-32.768, 32.768), moved by up to a quarter of the domain.
    Ackley,
}

impl Function {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Schwefel, Self::ShiftedSchwefel, Self::Rastrigin, Self::Ackley];

    fn name(self) -> &'static str {
        match self {
            Self::Schwefel => "Schwefel",
            Self::ShiftedSchwefel => "Schwefel, shifted",
            Self::Rastrigin => "Rastrigin, shifted",
            Self::Ackley => "Ackley, shifted",
        }
    }

    /// Half the domain.
    fn reach(self) -> f64 {
        match self {
            Self::Schwefel | Self::ShiftedSchwefel => 500.0,
            Self::Rastrigin => 5.12,
            Self::Ackley => 32.768,
        }
    }

    fn scaled(self) -> Scaled {
        Scaled { domain: [-self.reach(), self.reach()], cost_unit: if self.reach() > 100.0 { 1e-6 } else { 1e-7 } }
    }

    fn shift(self, rng: &mut ChaCha8Rng) -> f64 {
        match self {
            Self::Schwefel => 0.0,
            Self::ShiftedSchwefel => rng.random_range(-100.0..20.0),
            _ => rng.random_range(-0.5..0.5) * self.reach(),
        }
    }

    fn minimum(self) -> f64 {
        match self {
            Self::Schwefel | Self::ShiftedSchwefel => MINIMUM,
            _ => 0.0,
        }
    }

    fn at(self, x: f64) -> f64 {
        let wave = (2.0 * PI * x).cos();
        match self {
            Self::Schwefel | Self::ShiftedSchwefel => 418.9829 - x * x.abs().sqrt().sin(),
            Self::Rastrigin => 10.0 + x * x - 10.0 * wave,
            Self::Ackley => 20.0 + E - 20.0 * (-0.2 * x.abs()).exp() - wave.exp(),
        }
    }
}

/// What looks for the minimum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Searcher {
    /// The core's search.
    Haar(Method),
    /// Down the numerical derivative, its steps halved where they climb.
    Gradient,
    /// At 401 equally spaced points, then twice at 401 around the best.
    Exhaustive,
}

impl Searcher {
    const ALL: [Self; 6] = [
        Self::Haar(Method::Proposed),
        Self::Haar(Method::Bracketed),
        Self::Haar(Method::Long),
        Self::Haar(Method::Hyperbolic),
        Self::Gradient,
        Self::Exhaustive,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Haar(Method::Proposed) => "proposed",
            Self::Haar(Method::Bracketed) => "proposed, a fixed",
            Self::Haar(Method::Long) => "basic, long Haar",
            Self::Haar(Method::Hyperbolic) => "basic, hyperbolic first",
            Self::Gradient => "gradient descent",
            Self::Exhaustive => "exhaustive",
        }
    }
}

/// One search.
#[derive(Debug, Clone, Copy)]
pub struct Trial {
    start: f64,
    found: f64,
    minimum: f64,
    evaluations: u32,
    iterations: u16,
}

/// Searches from [`STARTS`] random points.
///
/// # Errors
/// If the core refuses the parameters.
pub fn trials(function: Function, searcher: Searcher, seed: u64) -> Result<Vec<Trial>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut trial = || {
        let start = rng.random_range(-1.0..1.0) * function.reach();
        let shift = function.shift(&mut rng);
        let cost = |x: f64| function.at(x - shift);
        let (found, evaluations, iterations) = match searcher {
            Searcher::Haar(method) => {
                let found = function.scaled().search(&PARAMETERS, method, start, cost)?;
                (function.scaled().value(found.at[0]), found.evaluations, found.iterations)
            }
            Searcher::Gradient => descend_gradient(cost, start, function.reach()),
            Searcher::Exhaustive => search_exhaustively(cost, function.reach()),
        };
        Ok(Trial { start, found, minimum: function.minimum() + shift, evaluations, iterations })
    };
    (0..STARTS).map(|_| trial()).collect()
}

/// How many trials ended within the error.
#[must_use]
pub fn successes(trials: &[Trial], function: Function) -> usize {
    let error = ERROR * 2.0 * function.reach();
    trials.iter().filter(|trial| (trial.found - trial.minimum).abs() <= error).count()
}

/// Gradient descent: a first step of a hundredth of the domain's length against the derivative, halved where it climbs.
fn descend_gradient(cost: impl Fn(f64) -> f64, start: f64, reach: f64) -> (f64, u32, u16) {
    let (mut at, mut step, mut evaluations, mut iterations) = (start, reach / 50.0, 1, 0);
    let mut here = cost(at);
    let near = reach * 1e-6;
    while step > near && iterations < 1000 {
        iterations += 1;
        let slope = cost((at + near).min(reach)) - cost((at - near).max(-reach));
        let next = (at - slope.signum() * step).clamp(-reach, reach);
        let there = cost(next);
        evaluations += 3;
        if there < here {
            (at, here) = (next, there);
        } else {
            step /= 2.0;
        }
    }
    (at, evaluations, iterations)
}

fn search_exhaustively(cost: impl Fn(f64) -> f64, reach: f64) -> (f64, u32, u16) {
    let (mut middle, mut half) = (0.0, reach);
    for _ in 0..3 {
        let points = (0..=400).map(|index| middle + half * (f64::from(index) / 200.0 - 1.0));
        middle = points.min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(middle).clamp(-reach, reach);
        half /= 100.0;
    }
    (middle, 3 * 401, 3)
}

/// Runs the study.
///
/// # Errors
/// If the core refuses the parameters or a plot cannot be drawn.
pub fn run(setup: &Setup<'_>) -> Result<Outcome> {
    setup.progress.set_length((Function::ALL.len() * Searcher::ALL.len()) as u64);
    let mut rows = Vec::new();
    let mut ours = Vec::new();
    for function in Function::ALL {
        for searcher in Searcher::ALL {
            let trials = trials(function, searcher, setup.seed)?;
            rows.push(row(function, searcher, &trials));
            if (function, searcher) == (Function::Schwefel, Searcher::Haar(Method::Proposed)) {
                ours = trials;
            }
            setup.progress.inc(1);
        }
    }
    let columns = [
        "function",
        "method",
        "found of 150",
        "within 5 % of the domain",
        "mean evaluations",
        "most evaluations",
        "mean iterations",
    ];
    let caption = "Searches that end within 1e-5 of the domain's length (1e-2 for Schwefel) of the global minimum, one start each";
    let table = Table {
        name: "methods".to_owned(),
        caption: caption.to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows,
    };
    let parts = vec![Part::Text(text(&ours)), Part::Table(table), Part::Plot(map(&ours)?)];
    Ok(Outcome { name: "schwefel", title: "The global minimum from 150 random starts".to_owned(), parts })
}

fn row(function: Function, searcher: Searcher, trials: &[Trial]) -> Vec<String> {
    let valley = 0.05 * 2.0 * function.reach();
    let mean = |sum: f64| format!("{:.0}", sum / trials.len() as f64);
    vec![
        function.name().to_owned(),
        searcher.name().to_owned(),
        successes(trials, function).to_string(),
        trials.iter().filter(|trial| (trial.found - trial.minimum).abs() <= valley).count().to_string(),
        mean(trials.iter().map(|trial| f64::from(trial.evaluations)).sum()),
        trials.iter().map(|trial| trial.evaluations).max().unwrap_or(0).to_string(),
        mean(trials.iter().map(|trial| f64::from(trial.iterations)).sum()),
    ]
}

fn text(ours: &[Trial]) -> String {
    let printed = ours.iter().filter(|trial| (trial.found - PRINTED).abs() <= 1e-2).count();
    let failed = ours.iter().filter(|trial| (trial.found - trial.minimum).abs() > 1e-2).map(|trial| trial.start);
    let (least, most, failures) = failed.fold((f64::MAX, f64::MIN, 0), |(a, b, n), x| (a.min(x), b.max(x), n + 1));
    let range = if failures == 0 { String::new() } else { format!(", from starts between {least:.1} and {most:.1}") };
    format!(
        "The paper reaches the global minimum of Schwefel's function within 1e-2 from 128 of {STARTS} random starts and \
         fails from starts outside of (-420, 470). One search from one start each, counted against {MINIMUM:.4}: {} of \
         {STARTS}; {failures} fail{range}. Counted against the printed {PRINTED}, which is further from the minimum than the \
         error allowed and so an erratum, it would be {printed}. The parameters are the same for all functions, in parts of \
         the domain: s_1 = {}, gamma = {}, a = 1/{} of the domain at the first two starts and half as long at each \
         further one, samples outside of the domain left out, the next start from the best sample where it lies below the \
         end of the walk. With a fixed step a, as the paper has it, the error wanted cannot be reached (see \"a fixed\"): \
         that part of the claim is not reproduced to the letter.",
        successes(ours, Function::Schwefel),
        PARAMETERS.first_support,
        PARAMETERS.gamma,
        PARAMETERS.first_support,
    )
}

/// Where each start ends: a success map over the starting point.
fn map(ours: &[Trial]) -> Result<Plot> {
    let layer = |name: &str, colour: usize, is_found: bool| {
        let trials = ours.iter().filter(|trial| ((trial.found - trial.minimum).abs() <= 1e-2) == is_found);
        Layer::new(name, colour, Mark::Dots, trials.map(|trial| [trial.start, trial.found]))
    };
    let domain = Function::Schwefel.scaled().domain;
    let chart = Chart {
        title: String::new(),
        x: Axis::linear("start x", domain),
        y: Axis::linear("found x", domain),
        layers: vec![layer("global minimum", 0, true), layer("elsewhere", 1, false)],
    };
    Ok(Plot {
        name: "map".to_owned(),
        caption: "Schwefel's function, proposed method: where the search ends over where it starts".to_owned(),
        svg: figure(&[chart], 1, [640, 360])?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_start_finds_the_global_minimum_as_often_as_promised() {
        for seed in 0..4 {
            for function in Function::ALL {
                let trials = trials(function, Searcher::Haar(Method::Proposed), seed).unwrap();
                let least = if function == Function::Schwefel { 135 } else { 128 };
                let found = successes(&trials, function);
                assert!(found >= least, "{found} of {function:?}, seed {seed}");
                assert!(trials.iter().all(|trial| trial.evaluations <= 400), "{function:?}");
            }
        }
    }

    #[test]
    fn the_minima_are_where_they_are_said_to_be() {
        for function in Function::ALL {
            let (found, ..) = search_exhaustively(|x| function.at(x), function.reach());
            assert!((found - function.minimum()).abs() < 1e-4 * function.reach(), "{found} {function:?}");
        }
    }

    #[test]
    fn gradient_descent_finds_the_nearest_minimum_only() {
        let trials = trials(Function::Schwefel, Searcher::Gradient, 0).unwrap();
        assert!(successes(&trials, Function::Schwefel) < STARTS / 2);
    }
}
