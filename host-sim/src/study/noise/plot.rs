//! The plots of the study, as Fig. 4 of the paper has them.

use anyhow::Result;

use super::{Figures, Found, SEARCHERS, Shape};
use crate::study::Plot;
use crate::study::plot::{Axis, Chart, Layer, Mark, figure};

/// Size of a chart, px.
const SIZE: [u32; 2] = [450, 300];

/// Evaluations and error on one kind of cost.
pub(super) fn evaluations_and_error(shape: Shape, figures: &[Found]) -> Result<Plot> {
    let charts = [
        chart("", "mean evaluations", figures, |found| found.evaluations[0]),
        chart("", "relative error, parts of the domain", figures, |found| found.error[0]),
    ];
    Ok(Plot {
        name: shape.name().split(" (").next().unwrap_or_default().replace(' ', "_"),
        caption: format!("{}: evaluations and error against the signal-to-noise ratio", shape.name()),
        svg: figure(&charts, 2, SIZE)?,
    })
}

/// The times on all kinds of costs.
pub(super) fn times(kinds: &[(Shape, Vec<Found>)]) -> Result<Plot> {
    let time = |found: &Figures| found.seconds * 1e6;
    let charts: Vec<Chart> =
        kinds.iter().map(|(shape, figures)| chart(shape.name(), "median time, us (measured)", figures, time)).collect();
    let caption = "Time of a search on this host (measured) against the signal-to-noise ratio".to_owned();
    Ok(Plot { name: "time_measured".to_owned(), caption, svg: figure(&charts, 2, SIZE)? })
}

fn chart(title: &str, label: &str, figures: &[Found], value: fn(&Figures) -> f64) -> Chart {
    let layer = |(colour, searcher)| {
        let points = figures.iter().filter(|found| found.0 == searcher).map(|found| [found.1, value(&found.2)]);
        Layer::new(searcher.name(), colour, Mark::DotsOnLine, points)
    };
    let layers: Vec<Layer> = SEARCHERS.into_iter().enumerate().map(layer).collect();
    Chart {
        title: title.to_owned(),
        x: Axis::linear("SNR: amplitude / sigma", [0.0, 21.0]),
        y: Axis::around(label, figures.iter().map(|found| value(&found.2)).chain([0.0])),
        layers,
    }
}
