//! The plots of the extremum search's studies.

use anyhow::{Result, anyhow};
use plotters::prelude::*;

const SIZE: (u32, u32) = (760, 420);
/// Colours by Okabe and Ito, which colour-blind readers can tell apart.
const COLOURS: [RGBColor; 5] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167), RGBColor(60, 60, 60)];

/// Points of one name.
#[derive(Debug, Clone)]
pub struct Series {
    /// What the legend says.
    pub name: String,
    /// Column and row, in the axes' units.
    pub points: Vec<(f64, f64)>,
    /// Whether a line joins them.
    pub is_line: bool,
}

/// Draws series on two linear axes, named with their units, that hold all points; gives the SVG.
///
/// # Errors
/// If the drawing fails.
pub fn chart(labels: [&str; 2], series: &[Series]) -> Result<String> {
    let mut svg = String::new();
    draw(&mut svg, labels, series).map_err(|error| anyhow!("the plot of {} cannot be drawn: {error}", labels[1]))?;
    Ok(svg)
}

fn draw(svg: &mut String, [x_label, y_label]: [&str; 2], series: &[Series]) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let all = || series.iter().flat_map(|series| &series.points);
    let [x, y] = [extent(all().map(|point| point.0)), extent(all().map(|point| point.1))];
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(64)
        .build_cartesian_2d(x[0]..x[1], y[0]..y[1])?;
    chart.configure_mesh().x_desc(x_label).y_desc(y_label).light_line_style(WHITE).draw()?;
    for (series, &colour) in series.iter().zip(COLOURS.iter().cycle()) {
        if series.is_line {
            chart.draw_series(LineSeries::new(series.points.iter().copied(), colour.stroke_width(2)))?;
        }
        chart
            .draw_series(series.points.iter().map(|&point| Circle::new(point, 3, colour.filled())))?
            .label(&series.name)
            .legend(move |(x, y)| Circle::new((x + 8, y), 4, colour.filled()));
    }
    chart.configure_series_labels().background_style(WHITE.mix(0.8)).border_style(BLACK.mix(0.3)).draw()?;
    root.present()?;
    Ok(())
}

/// The least and greatest value with some room around.
fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (least, most) = values.fold((f64::MAX, f64::MIN), |(a, b), value| (a.min(value), b.max(value)));
    let room = if most > least { 0.05 * (most - least) } else { 1.0 };
    [least - room, most + room]
}

/// How many of `values` lie in each of the bins of that width from 0 on, as points over the bins' middles.
#[must_use]
pub fn histogram(values: &[f64], width: f64) -> Vec<(f64, f64)> {
    let bin = |value: f64| (value / width) as usize;
    let bins = values.iter().map(|&value| bin(value) + 1).max().unwrap_or(0);
    let mut counts = vec![0.0; bins];
    for &value in values {
        counts[bin(value)] += 1.0;
    }
    counts.into_iter().enumerate().map(|(index, count)| ((index as f64 + 0.5) * width, count)).collect()
}
