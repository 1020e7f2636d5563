//! Study `rigs` (section 5 at work): random rigs aligned from one frame each.

use anyhow::Result;
use haarline::align::{Estimate, Order, Verdict};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::{Outcome, Part, Setup, Table};
use crate::rig::align::{self, Displacement};
use crate::rig::warp::Disturbance;
use crate::score::scene::Scene;

/// Rigs with many scenes; with a few rendered ones, so many each.
const RIGS: usize = 500;
const RIGS_A_SCENE: usize = 16;

/// One rig.
#[derive(Debug, Clone)]
struct Trial {
    estimate: Estimate,
    /// By how much row offset (px), roll (degrees) and scale (percent) are wrong.
    errors: [f64; 3],
}

/// Aligns the undisturbed pair and those of random rigs, and compares.
fn trial(scene: &Scene, undisturbed: &Displacement, seed: u64) -> Result<Trial> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let rig = Disturbance::random(&mut rng);
    let pair = rig.apply(&scene.pair, &mut rng)?;
    let estimate = align::align(&pair)?;
    let found = Displacement::from(&estimate.ramp);
    let roll = rig.roll_deg.to_radians().tan();
    // In the middle column of the turned view, which a column offset displaces, too.
    let rows = rig.rows - rig.columns * roll + undisturbed.rows;
    let errors = [
        found.rows - rows,
        found.roll_deg - rig.roll_deg - undisturbed.roll_deg,
        found.scale_percent - rig.scale_percent - undisturbed.scale_percent,
    ]
    .map(f64::abs);
    Ok(Trial { estimate, errors })
}

/// Runs the study.
///
/// # Errors
/// If the core refuses a scene.
pub fn run(setup: &Setup<'_>) -> Result<Outcome> {
    let scenes = setup.scenes;
    let count = RIGS.min(RIGS_A_SCENE * scenes.len());
    setup.progress.set_length((scenes.len() + count) as u64);
    let undisturbed = scenes.par_iter().map(|scene| {
        let estimate = align::align(&scene.pair)?;
        setup.progress.inc(1);
        Ok(Displacement::from(&estimate.ramp))
    });
    let undisturbed = undisturbed.collect::<Result<Vec<Displacement>>>()?;
    let trials = (0..count).into_par_iter().map(|index| {
        let scene = index % scenes.len();
        let seed = setup.seed.wrapping_mul(1 << 20).wrapping_add(index as u64);
        let trial = trial(&scenes[scene], &undisturbed[scene], seed);
        setup.progress.inc(1);
        trial
    });
    let trials = trials.collect::<Result<Vec<Trial>>>()?;
    let parts = vec![Part::Text(text(setup, &trials)), Part::Table(errors_table(&trials))];
    Ok(Outcome { name: "rigs", title: "Random rigs aligned".to_owned(), parts })
}

fn errors_table(trials: &[Trial]) -> Table {
    let answered: Vec<&Trial> = trials.iter().filter(|trial| trial.estimate.verdict() == Verdict::Observable).collect();
    let row = |j: usize, what: &str, limits: [f64; 2]| {
        let mut errors: Vec<f64> = answered.iter().map(|trial| trial.errors[j]).collect();
        errors.sort_by(f64::total_cmp);
        let quantile =
            |q: f64| errors.get(((errors.len().max(1) - 1) as f64 * q) as usize).copied().unwrap_or(f64::NAN);
        let within = |limit: f64| {
            let count = errors.iter().filter(|&&error| error <= limit).count();
            format!("{:.1} ({limit})", 100.0 * count as f64 / trials.len() as f64)
        };
        vec![
            what.to_owned(),
            answered.len().to_string(),
            format!("{:.3}", quantile(0.5)),
            format!("{:.3}", quantile(0.98)),
            format!("{:.3}", quantile(1.0)),
            within(limits[0]),
            within(limits[1]),
        ]
    };
    let columns = ["error of", "answered", "median", "98 %", "greatest", "within, % of all", "within, % of all "];
    Table {
        name: "errors".to_owned(),
        caption: "Against the undisturbed pair's own estimate".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: vec![
            row(0, "row offset, px", [0.10, 0.15]),
            row(1, "roll, degrees", [0.05, 0.10]),
            row(2, "scale, percent", [0.10, 0.25]),
        ],
    }
}

fn text(setup: &Setup<'_>, trials: &[Trial]) -> String {
    let count = |wanted: Order| trials.iter().filter(|trial| trial.estimate.order() == wanted).count();
    let most = trials.iter().map(|trial| trial.estimate.evaluations).max().unwrap_or(0);
    let mean = trials.iter().map(|trial| f64::from(trial.estimate.evaluations)).sum::<f64>() / trials.len() as f64;
    format!(
        "The right views of {} scenes ({}) displaced by up to 10 rows, 8 columns, 2 degrees and 2 percent, at a gain of 0.8 to \
         1.25, with a noise of 5 grey levels on both: {} rigs, one frame each. The search over row offset and roll took {mean:.0} \
         evaluations in the mean, {most} at most. Order of the views: {} as given, {} swapped, {} contradictory, {} not observable.",
        setup.scenes.len(),
        setup.scenes_name,
        trials.len(),
        count(Order::AsGiven),
        count(Order::Swapped),
        count(Order::Contradictory),
        count(Order::NotObservable),
    )
}
