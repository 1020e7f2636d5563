//! All methods on several boards: a table and a plot with accuracy beside.

use anyhow::Result;

use super::accuracy::Accuracy;
use super::budget::{MODEL, Plan, Planner, Request};
use super::counting::METHODS;
use super::counts::Input;
use super::currents::Board;
use crate::study::plot::{Axis, Chart, Layer, Mark, figure};
use crate::study::{Plot, Table};

/// Sides of a chart, px.
const CHART: [u32; 2] = [330, 330];

/// The plans of every method on the boards, with what is asked for else.
///
/// # Errors
/// If one was not counted at such a size.
pub fn plans(planner: &Planner<'_>, boards: &[Board], request: &Request) -> Result<Vec<Plan>> {
    let each = boards.iter().flat_map(|&board| METHODS.map(|method| Request { board, method, ..*request }));
    each.map(|request| planner.plan(&request)).collect()
}

/// What they take, in one table.
#[must_use]
pub fn table(plans: &[Plan], accuracy: &[Accuracy]) -> Table {
    let columns = [
        "board",
        "method",
        "clock, MHz",
        "busy, noisy, %",
        "core, mW",
        "total, mW",
        "core, nJ/px",
        "frames/J",
        "hours",
        "tot2, %",
        "tot2 noisy, %",
    ];
    let row = |plan: &Plan| {
        let names = [plan.board.name().to_owned(), plan.method.to_owned()];
        let figures = match (plan.chosen, &plan.budget) {
            (Some(nth), Some(budget)) => {
                let point = &plan.points[nth];
                [
                    format!("{}", point.mhz),
                    format!("{:.0}", point.busy_noisy_percent),
                    format!("{:.1}", budget.core_mw.likely),
                    format!("{:.0}", budget.total_mw.likely),
                    format!("{:.2}", point.nj_per_pixel.likely),
                    format!("{:.1}", budget.frames_per_joule),
                    budget.hours.map_or_else(|| "-".to_owned(), |hours| format!("{:.1}", hours.likely)),
                ]
            }
            // How far it is from fitting stands where the share of its time would.
            _ => {
                let busy = format!("{:.0}", plan.points[0].busy_noisy_percent);
                ["-", busy.as_str(), "-", "-", "-", "-", "-"].map(str::to_owned)
            }
        };
        let tot2 = [Input::Clean, Input::Noisy].map(|input| {
            let found = accuracy.iter().find(|one| one.method == plan.method && one.input == input);
            found.map_or_else(|| "-".to_owned(), |one| format!("{:.2}", one.tot2))
        });
        names.into_iter().chain(figures).chain(tot2).collect()
    };
    let first = &plans[0];
    let scenes = accuracy.first().map_or(0, |one| one.scenes);
    Table {
        name: "plan".to_owned(),
        caption: format!(
            "{MODEL}: {}x{} px, {} frames a second, {} disparities; without a clock: does not fit (busy: noisy frames, there at the highest clock; 90 % at most). tot2: \
             wrong by more than 2 px or unanswered, mean of {scenes} recorded scenes of 320 px, clean and with noise of 10 grey \
             levels.",
            first.width, first.height, first.fps, first.disparities
        ),
        columns: columns.map(str::to_owned).to_vec(),
        rows: plans.iter().map(row).collect(),
    }
}

/// Energy of a pixel against `tot2`, a chart for each board.
///
/// # Errors
/// If the plot cannot be drawn.
pub fn plot(planner: &Planner<'_>, plans: &[Plan], accuracy: &[Accuracy]) -> Result<Plot> {
    let mut boards: Vec<Board> = plans.iter().map(|plan| plan.board).collect();
    boards.dedup();
    let energy = |plan: &Plan| full_load_nj(planner, plan).likely;
    let tot2 =
        |plan: &Plan| Some(accuracy.iter().find(|one| one.method == plan.method && one.input == Input::Clean)?.tot2);
    let all = || plans.iter().map(energy);
    let x = Axis::log("nJ a pixel", [0.8 * all().fold(f64::INFINITY, f64::min), 1.25 * all().fold(0.0, f64::max)]);
    let y = Axis::linear("tot2, %", [0.0, 100.0]);
    let charts: Vec<Chart> = boards
        .into_iter()
        .map(|board| {
            let own = plans.iter().filter(|plan| plan.board == board);
            let layer = |(colour, plan): (usize, &Plan)| {
                let point = tot2(plan).map(|tot2| [energy(plan), tot2]);
                Layer::new(plan.method, colour, Mark::Dots, point)
            };
            Chart {
                title: planner.currents.chip(board).name.clone(),
                x: x.clone(),
                y: y.clone(),
                layers: own.enumerate().map(layer).collect(),
            }
        })
        .collect();
    let columns = charts.len();
    Ok(Plot {
        name: "plan".to_owned(),
        caption: format!(
            "{MODEL}: energy of the core for a pixel while it works at its highest clock (logarithmic), and tot2 on clean \
             scenes; left and low is better. contour and envelope are sparse by design."
        ),
        svg: figure(&charts, columns, CHART)?,
    })
}

/// Energy of the core for a pixel of clean frames while it works at its highest clock, nJ.
#[must_use]
pub fn full_load_nj(planner: &Planner<'_>, plan: &Plan) -> crate::twin::cycles::Range {
    let chip = planner.currents.chip(plan.board);
    let point = &chip.points[0];
    // mW over MHz is nJ a cycle.
    let clean = plan.instructions_per_pixel.clean.mean.all();
    plan.cycles_per_instruction.map(|cycles| clean * cycles * point.run.ma * chip.volts / point.mhz)
}
