//! Study `alignment` (section 5): the two-dimensional search for how far one view is displaced against the other.

use anyhow::Result;
use haarline::extremum::{FRAC_BITS, Method, Settings, descend, parabola};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use rayon::prelude::*;

use super::plot::{Axis, Chart, Layer, Mark, figure};
use super::{Outcome, Part, Plot, Setup, Table};
use crate::Frame;

/// Greatest displacement searched, px.
const REACH: i32 = 12;
/// Greatest true displacement, px.
const MOST: f64 = 8.0;
/// Trials with each scene.
const TRIALS: usize = 8;
/// Noise on both views, grey levels.
const NOISE: f64 = 5.0;
/// Every so manyth pixel of every so manyth row is compared.
const SPARSE: usize = 3;
/// Row offsets applied to the real pairs, px.
const ROWS: [i32; 9] = [-4, -3, -2, -1, 0, 1, 2, 3, 4];

/// Where a displacement was found, and at what cost.
#[derive(Debug, Clone, Copy)]
pub struct Aligned {
    /// Column and row displacement, px.
    pub at: [f64; 2],
    /// Iterations, with those of the last walk in whole pixels.
    pub iterations: u16,
    /// Comparisons of the views.
    pub evaluations: u32,
}

/// Finds the displacement of `second` against `first` by the two-dimensional search from [1; 1] with the paper's
/// s = 17, a = 1 px and gamma = 0.9.
///
/// Columns are searched from -12 px to `columns`. The cost is the mean absolute difference of the pixels, in
/// integers. The walk with the shortest support along each parameter ends the search, and a parabola gives the
/// fraction.
///
/// # Errors
/// If the core refuses the parameters.
pub fn align(first: &Frame, second: &Frame, columns: i32) -> Result<Aligned> {
    let pixel = 1 << FRAC_BITS;
    let settings = Settings {
        start: [pixel; 2],
        first_support: 17,
        ..Settings::new([-REACH * pixel; 2], [columns * pixel, REACH * pixel])
    };
    let whole = |c: i32| (c + pixel / 2) >> FRAC_BITS;
    let cost = |at: [i32; 2]| difference(first, second, at, [columns, REACH]);
    let found = settings.build()?.run(Method::Proposed, |at| cost(at.map(whole)));
    let mut at = found.at.map(whole);
    let (mut evaluations, mut iterations) = (found.evaluations, found.iterations);
    let mut fraction = [0.0; 2];
    for _ in 0..2 {
        let before = at;
        for j in 0..2 {
            let along = |c: i32| {
                let mut point = at;
                point[j] = c;
                evaluations += 1;
                cost(point)
            };
            let Some(here) = cost(at) else { continue };
            let minimum = descend(at[j], here, 4, along);
            at[j] = minimum.at;
            fraction[j] = match (minimum.before, minimum.after) {
                (Some(before), Some(after)) => f64::from(parabola(before, minimum.cost, after)) / 16.0,
                _ => 0.0,
            };
        }
        iterations += 1;
        if at == before {
            break;
        }
    }
    Ok(Aligned { at: [0, 1].map(|j| f64::from(at[j]) + fraction[j]), iterations, evaluations })
}

/// Mean absolute difference, 1/256 grey levels, of `first(x, y)` and `second(x + dx, y + dy)` over the part of the
/// views that every displacement within the reach keeps inside; `None` beyond the reach.
fn difference(first: &Frame, second: &Frame, [dx, dy]: [i32; 2], [columns, rows]: [i32; 2]) -> Option<i32> {
    if !(-REACH..=columns).contains(&dx) || dy.abs() > rows {
        return None;
    }
    let (margin, right) = (REACH as usize, columns as usize);
    let (mut sum, mut count) = (0_u64, 0);
    for y in (margin..first.height.checked_sub(margin)?).step_by(SPARSE) {
        let (a, b) = (first.row(y), second.row((y as i32 + dy) as usize));
        for x in (margin..first.width.checked_sub(right)?).step_by(SPARSE) {
            sum += u64::from(a[x].abs_diff(b[(x as i32 + dx) as usize]));
            count += 1;
        }
    }
    i32::try_from((sum * 256).checked_div(count)?).ok()
}

/// A view moved by `[dx, dy]` px, bilinear, its border repeated.
fn moved(frame: &Frame, [dx, dy]: [f64; 2]) -> Vec<f64> {
    let at = |x: i64, y: i64| {
        let (x, y) = (x.clamp(0, frame.width as i64 - 1), y.clamp(0, frame.height as i64 - 1));
        f64::from(frame.luma[y as usize * frame.width + x as usize])
    };
    let pixel = |index: usize| {
        let (x, y) = ((index % frame.width) as f64 - dx, (index / frame.width) as f64 - dy);
        let (left, top) = (x.floor(), y.floor());
        let (fx, fy) = (x - left, y - top);
        let row = |y: i64| at(left as i64, y) * (1.0 - fx) + at(left as i64 + 1, y) * fx;
        row(top as i64) * (1.0 - fy) + row(top as i64 + 1) * fy
    };
    (0..frame.luma.len()).map(pixel).collect()
}

fn noisy(frame: &Frame, values: Vec<f64>, rng: &mut ChaCha8Rng) -> Result<Frame> {
    let noise = Normal::new(0.0, NOISE)?;
    let luma = values.into_iter().map(|value| (value + noise.sample(rng)).round().clamp(0.0, 255.0) as u8).collect();
    Ok(Frame::from_luma(frame.width, frame.height, luma))
}

/// One trial's search, and by how far it missed.
#[derive(Debug, Clone, Copy)]
pub struct Trial {
    /// Distance from the true displacement, px.
    pub error: f64,
    /// The search.
    pub found: Aligned,
}

/// Displaces a view by up to 8 px, by whole pixels or fractions, with independent noise on both, and finds it.
///
/// # Errors
/// If the core refuses the parameters.
pub fn displaced(view: &Frame, is_whole: bool, seed: u64) -> Result<Trial> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let true_at = [(); 2].map(|()| rng.random_range(-MOST..=MOST)).map(|d: f64| if is_whole { d.round() } else { d });
    let first = noisy(view, moved(view, [0.0; 2]), &mut rng)?;
    let second = noisy(view, moved(view, true_at), &mut rng)?;
    let found = align(&first, &second, REACH)?;
    Ok(Trial { error: (found.at[0] - true_at[0]).hypot(found.at[1] - true_at[1]), found })
}

/// The row offset of a real pair whose right view is moved by `rows`.
fn row_offset(pair: &crate::StereoPair, rows: i32) -> Result<Trial> {
    let shifted = moved(&pair.right, [0.0, f64::from(rows)]);
    let luma = shifted.into_iter().map(|value| value as u8).collect();
    let right = Frame::from_luma(pair.right.width, pair.right.height, luma);
    // The left view's point lies further right: the right view is the first one.
    let found = align(&right, &pair.left, 64)?;
    Ok(Trial { error: (found.at[1] + f64::from(rows)).abs(), found })
}

/// Runs the study.
///
/// # Errors
/// If the core refuses the parameters or a plot cannot be drawn.
pub fn run(setup: &Setup<'_>) -> Result<Outcome> {
    setup.progress.set_length(3);
    let trials = |is_whole: bool| -> Result<Vec<Trial>> {
        let of = |index: usize| {
            let scene = &setup.scenes[index / TRIALS];
            displaced(&scene.pair.left, is_whole, setup.seed.wrapping_mul(1 << 20).wrapping_add(index as u64))
        };
        (0..setup.scenes.len() * TRIALS).into_par_iter().map(of).collect()
    };
    let mut kinds = Vec::new();
    for (name, is_whole) in [("whole pixels", true), ("fractions of pixels", false)] {
        kinds.push((name, trials(is_whole)?));
        setup.progress.inc(1);
    }
    let pairs = (0..setup.scenes.len() * ROWS.len()).into_par_iter();
    let rows = pairs.map(|index| row_offset(&setup.scenes[index / ROWS.len()].pair, ROWS[index % ROWS.len()]));
    kinds.push(("row offset of real pairs", rows.collect::<Result<_>>()?));
    setup.progress.inc(1);
    let columns = [
        "trials",
        "number",
        "median iterations",
        "mean evaluations",
        "median error (px)",
        "within 0.5 px (%)",
        "within 0.1 px (%)",
    ];
    let table = Table {
        name: "trials".to_owned(),
        caption: "The two-dimensional search from [1; 1]".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: kinds.iter().map(|(name, trials)| row(name, trials)).collect(),
    };
    let parts = vec![Part::Text(text(setup, &kinds)), Part::Table(table), Part::Plot(draw(&kinds)?)];
    Ok(Outcome { name: "alignment", title: "Alignment of two views".to_owned(), parts })
}

/// The share of trials within an error, percent.
fn within(trials: &[Trial], error: f64) -> f64 {
    100.0 * trials.iter().filter(|trial| trial.error <= error).count() as f64 / trials.len() as f64
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn row(name: &str, trials: &[Trial]) -> Vec<String> {
    let evaluations = trials.iter().map(|trial| f64::from(trial.found.evaluations)).sum::<f64>() / trials.len() as f64;
    vec![
        name.to_owned(),
        trials.len().to_string(),
        format!("{:.0}", median(trials.iter().map(|trial| f64::from(trial.found.iterations)))),
        format!("{evaluations:.0}"),
        format!("{:.3}", median(trials.iter().map(|trial| trial.error))),
        format!("{:.1}", within(trials, 0.5)),
        format!("{:.1}", within(trials, 0.1)),
    ]
}

fn text(setup: &Setup<'_>, kinds: &[(&str, Vec<Trial>)]) -> String {
    let said = kinds.iter().map(|(name, trials)| {
        let iterations = median(trials.iter().map(|trial| f64::from(trial.found.iterations)));
        format!(
            "{name}: {iterations:.0} iterations in the median, {:.1} % within 0.5 px and {:.1} % within 0.1 px",
            within(trials, 0.5),
            within(trials, 0.1)
        )
    });
    format!(
        "The paper aligns one pair of an image database after 12 iterations from [1; 1] with s = 17, a = 1 and gamma = 0.9. \
         Here the left view of each of {} scenes ({}) is displaced by up to {MOST} px in both directions, with independent \
         noise of {NOISE} grey levels on both, {TRIALS} times; the cost, a mean absolute difference, is divided by its \
         range in the first support, without which gamma would have a unit. Then the row offset of the real pairs, moved by \
         {} to {} rows: only its row counts, since the columns differ by the disparities. Found: {}.",
        setup.scenes.len(),
        setup.scenes_name,
        ROWS[0],
        ROWS[ROWS.len() - 1],
        said.collect::<Vec<_>>().join("; "),
    )
}

/// How many trials have which iterations, and which error.
fn draw(kinds: &[(&str, Vec<Trial>)]) -> Result<Plot> {
    let chart = |label: &str, width: f64, value: fn(&Trial) -> f64| {
        let layer = |(colour, (name, trials)): (usize, &(&str, Vec<Trial>))| {
            let values: Vec<f64> = trials.iter().map(value).collect();
            Layer::new(name, colour, Mark::DotsOnLine, histogram(&values, width))
        };
        let layers: Vec<Layer> = kinds.iter().enumerate().map(layer).collect();
        let along = |axis: usize| layers.iter().flat_map(move |l| l.points.iter().map(move |p| p[axis])).chain([0.0]);
        let (x, y) = (Axis::around(label, along(0)), Axis::around("share of the trials, %", along(1)));
        Chart { title: String::new(), x, y, layers }
    };
    let charts = [
        chart("iterations", 1.0, |trial| f64::from(trial.found.iterations)),
        chart("error, px (2 and more as 2)", 0.1, |trial| trial.error.min(2.0)),
    ];
    Ok(Plot {
        name: "trials".to_owned(),
        caption: "Which share of the trials has how many iterations, and which error in steps of 0.1 px".to_owned(),
        svg: figure(&charts, 2, [450, 300])?,
    })
}

/// Which share of `values` lies in each of the bins of that width from 0 on, percent, over the bins' beginnings.
fn histogram(values: &[f64], width: f64) -> Vec<[f64; 2]> {
    let bin = |value: f64| (value / width) as usize;
    let bins = values.iter().map(|&value| bin(value) + 1).max().unwrap_or(0);
    let mut shares = vec![0.0; bins];
    for &value in values {
        shares[bin(value)] += 100.0 / values.len() as f64;
    }
    shares.into_iter().enumerate().map(|(index, share)| [index as f64 * width, share]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Scene;

    #[test]
    fn a_histogram_holds_every_value_once() {
        assert_eq!(histogram(&[0.0, 0.9, 2.5, 2.6], 1.0), [[0.0, 50.0], [1.0, 0.0], [2.0, 50.0]]);
        assert_eq!(histogram(&[], 1.0), [[0.0; 2]; 0]);
    }

    #[test]
    fn a_displaced_view_is_found_in_few_iterations() {
        let view = Scene::room(3).render().pair.left;
        let trials: Vec<Trial> = (0..40).map(|seed| displaced(&view, true, seed).unwrap()).collect();
        assert!(within(&trials, 0.5) >= 95.0, "{trials:?}");
        assert!(median(trials.iter().map(|trial| f64::from(trial.found.iterations))) <= 12.0);
    }
}
