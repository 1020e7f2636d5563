//! The page of a rig's check: what was found and what to do, pictures, maps of the view; in one HTML file, without scripts
//! and without links out.

use anyhow::Result;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};

use super::align::{PARTS, Parts};
use super::check::{BINS_A_PX, Checked};
use crate::study::page::{document, parts};
use crate::study::plot::{Axis, Chart, Layer, Mark, figure};
use crate::study::{Part, Plot, Table};

const WIDE: [u32; 2] = [900, 300];
/// Size of a map of the view.
const MAP: [u32; 2] = [450, 300];

/// A picture and what it shows.
#[derive(Debug, Clone)]
pub struct Picture {
    /// What it shows.
    pub caption: String,
    /// PNG.
    pub png: Vec<u8>,
}

/// The page: `command` made it; `size` is that of a view, px, `figures` its table.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn page(
    title: &str,
    command: &str,
    size: [usize; 2],
    checked: &Checked,
    figures: Table,
    pictures: &[Picture],
) -> Result<String> {
    let advice = checked.advice();
    let maps = [
        map(
            "rows",
            "Row error, px (of the rectified views; positive: the right one lies lower)",
            size,
            &checked.rows,
            [-1.0, 1.0],
        )?,
        map("sure", "Sure answers, percent", size, &checked.seen.sure.parts(), [0.0, 100.0])?,
        map(
            "agreement",
            "Left-right agreement: sure answers that the right view's map confirms, percent",
            size,
            &checked.seen.agreement.parts(),
            [50.0, 100.0],
        )?,
    ];
    let body = html! {
        dl {
            dt { "made by" } dd { code { (command) } }
            dt { "version" } dd { "haarline " (env!("CARGO_PKG_VERSION")) }
        }
        @if advice.is_empty() {
            p { strong { "Nothing to turn, swap or calibrate was found." } }
        } @else {
            ol { @for advice in &advice { li { strong { (advice.finding) } ": " (advice.to_do) } } }
        }
        (parts(&[Part::Table(figures)]))
        @for picture in pictures { (shown(picture)) }
        @for (plot, table) in maps { (parts(&[Part::Plot(plot), Part::Table(table)])) }
        (parts(&[Part::Plot(disparities(checked)?)]))
    };
    Ok(document(title, &body))
}

fn shown(picture: &Picture) -> Markup {
    let data = format!("data:image/png;base64,{}", STANDARD.encode(&picture.png));
    html! {
        figure {
            figcaption { (picture.caption) }
            div.wide tabindex="0" { img src=(data) alt=(picture.caption) style="max-width: 100%; image-rendering: pixelated;"; }
        }
    }
}

/// A figure over the view in colours, from dark to bright within `range`, and as a table.
fn map(name: &str, caption: &str, size: [usize; 2], found: &Parts, range: [f64; 2]) -> Result<(Plot, Table)> {
    let step = [0, 1].map(|j| size[j] as f64 / PARTS[j] as f64);
    let (mut points, mut values) = (Vec::new(), Vec::new());
    for (down, row) in found.iter().enumerate() {
        for (across, value) in row.iter().enumerate().filter_map(|(across, value)| Some((across, (*value)?))) {
            points.push([(across as f64 + 0.5) * step[0], (down as f64 + 0.5) * step[1]]);
            values.push((value - range[0]) / (range[1] - range[0]));
        }
    }
    let chart = Chart {
        title: format!("{} (dark) to {} (bright)", range[0], range[1]),
        x: Axis::linear("column, px", [0.0, size[0] as f64]),
        y: Axis::linear("row, px", [0.0, size[1] as f64]).downwards(),
        layers: vec![Layer::new("", 0, Mark::Cells { size: step, values }, points)],
    };
    let cell = |value: &Option<f64>| {
        let digits = if range[1] > 10.0 { 0 } else { 2 };
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
    };
    let table = Table {
        name: name.to_owned(),
        caption: format!(
            "{caption}; - where too little was seen. Rows and columns of parts of the view, from the top left."
        ),
        columns: (0..PARTS[0]).map(|across| format!("column {}", (across as f64 * step[0]).round())).collect(),
        rows: found.iter().map(|row| row.iter().map(cell).collect()).collect(),
    };
    let plot = Plot { name: name.to_owned(), caption: format!("{caption}."), svg: figure(&[chart], 1, MAP)? };
    Ok((plot, table))
}

/// How often which disparity was sure.
fn disparities(checked: &Checked) -> Result<Plot> {
    let seen = &checked.seen;
    let total = seen.histogram.iter().sum::<usize>().max(1) as f64;
    let bar = |(bin, &count): (usize, &usize)| {
        [seen.least_px + (bin as f64 + 0.5) / BINS_A_PX as f64, 100.0 * count as f64 / total]
    };
    let points: Vec<[f64; 2]> = seen.histogram.iter().enumerate().map(bar).collect();
    let last = seen.least_px + seen.histogram.len() as f64 / BINS_A_PX as f64;
    let most = points.iter().map(|point| point[1]).fold(0.1, f64::max);
    let mut layers = vec![Layer::new("sure disparities", 0, Mark::Bars { half_width: 0.5 / BINS_A_PX as f64 }, points)];
    let infinity = -checked.doffs;
    layers.push(Layer::new("infinity, by the description", 1, Mark::Dashes, [[infinity, 0.0], [infinity, most]]));
    if let Some(far) = seen.far_px() {
        layers.push(Layer::new("the farthest that was seen", 2, Mark::Dashes, [[far, 0.0], [far, most]]));
    }
    let chart = Chart {
        title: String::new(),
        x: Axis::linear("disparity, px", [seen.least_px, last]),
        y: Axis::linear("percent", [0.0, most]),
        layers,
    };
    let caption = "Sure disparities: what lies left of infinity cannot be.".to_owned();
    Ok(Plot { name: "disparities".to_owned(), caption, svg: figure(&[chart], 1, WIDE)? })
}
