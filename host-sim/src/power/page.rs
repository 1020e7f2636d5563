//! The page of a measurement: tables and plots in one HTML file, without scripts and without links out.

use anyhow::Result;
use maud::html;

use super::measurement::Measurement;
use super::phase::Phase;
use super::segments::Segment;
use crate::study::page::{document, parts};
use crate::study::plot::{Axis, Chart, Layer, Mark, figure};
use crate::study::{Part, Plot, Table};

/// Points of the plot over time.
const POINTS: usize = 600;
const WIDE: [u32; 2] = [900, 320];

/// A segment with its name, if one was told.
pub type Named = (Option<String>, Segment);

/// The page: `command` made it; `tables` stand before the plots.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn page(
    title: &str,
    command: &str,
    measured: &Measurement,
    segments: &[Named],
    tables: Vec<Table>,
) -> Result<String> {
    let mut content: Vec<Part> = tables.into_iter().map(Part::Table).collect();
    content.push(Part::Plot(over_time(measured)?));
    if measured.has_phases {
        content.push(Part::Plot(by_phase(measured)?));
    }
    if !segments.is_empty() {
        content.push(Part::Plot(by_segment(segments)?));
    }
    let body = html! {
        dl {
            dt { "made by" } dd { code { (command) } }
            dt { "version" } dd { "haarline " (env!("CARGO_PKG_VERSION")) }
        }
        (parts(&content))
    };
    Ok(document(title, &body))
}

fn over_time(measured: &Measurement) -> Result<Plot> {
    let found = measured.blocks.parts(POINTS);
    let of = |nth: usize| found.iter().map(move |(at, watts)| [*at, 1e3 * watts[nth]]);
    let upper: Vec<f64> = of(2).map(|[_, milliwatts]| milliwatts).collect();
    let end = found.last().map_or(1.0, |(at, _)| *at);
    let milliwatts = [0, 2].into_iter().flat_map(|nth| of(nth).map(|point| point[1]).collect::<Vec<_>>());
    let chart = Chart {
        title: String::new(),
        x: Axis::linear("time, s", [0.0, end]),
        y: Axis::around("power, mW", milliwatts.chain([0.0])),
        layers: vec![
            Layer::new("least to greatest", 0, Mark::Band { upper }, of(0)),
            Layer::new("mean", 0, Mark::Line, of(1)),
        ],
    };
    let blocks =
        format!("Power over time: mean, least and greatest of blocks of {} ms.", 1e3 * measured.blocks.length());
    Ok(Plot { name: "time".to_owned(), caption: blocks, svg: figure(&[chart], 1, WIDE)? })
}

fn by_phase(measured: &Measurement) -> Result<Plot> {
    let bars = |what: fn(&super::measurement::Tally) -> f64| {
        let bar = move |(at, phase): (usize, &Phase)| {
            let point = [at as f64, what(measured.phase(*phase))];
            Layer::new(phase.name(), at, Mark::Bars { half_width: 0.4 }, [point])
        };
        Phase::ALL.iter().enumerate().map(bar).collect::<Vec<Layer>>()
    };
    let chart = |title: &str, label: &str, layers: Vec<Layer>| {
        let values: Vec<f64> =
            layers.iter().flat_map(|layer| &layer.points).map(|point| point[1]).chain([0.0]).collect();
        let (x, y) = (Axis::linear("", [-0.6, 3.6]).with_ticks([]), Axis::around(label, values));
        Chart { title: title.to_owned(), x, y, layers }
    };
    let charts = [
        chart("mean power", "mW", bars(|tally| 1e3 * tally.watts().unwrap_or_default())),
        chart("energy", "mJ", bars(|tally| 1e3 * tally.joules)),
    ];
    let caption = "Mean power and energy of each phase.".to_owned();
    Ok(Plot { name: "phases".to_owned(), caption, svg: figure(&charts, 2, [WIDE[0] / 2, WIDE[1]])? })
}

fn by_segment(segments: &[Named]) -> Result<Plot> {
    let mut layers: Vec<Layer> = Vec::new();
    for (at, (name, segment)) in segments.iter().enumerate() {
        let (name, point) = (name.clone().unwrap_or_default(), [at as f64 + 1.0, 1e3 * segment.watts()]);
        match layers.iter_mut().find(|layer| layer.name == name) {
            Some(layer) => layer.points.push(point),
            None => layers.push(Layer::new(&name, layers.len(), Mark::Bars { half_width: 0.4 }, [point])),
        }
    }
    let milliwatts: Vec<f64> = segments.iter().map(|(_, segment)| 1e3 * segment.watts()).chain([0.0]).collect();
    let chart = Chart {
        title: String::new(),
        x: Axis::linear("segment", [0.4, segments.len() as f64 + 0.6]),
        y: Axis::around("mean power, mW", milliwatts),
        layers,
    };
    let caption = "Mean power of each segment between two sleeps.".to_owned();
    Ok(Plot { name: "segments".to_owned(), caption, svg: figure(&[chart], 1, WIDE)? })
}
