//! The plot of the study: how wrong the methods are against what they cost.

use anyhow::{Result, anyhow};
use plotters::prelude::*;

use super::{Trial, find};
use crate::study::Plot;

/// Size of the picture, px.
const SIZE: (u32, u32) = (900, 560);
/// Size of words and numbers, px.
const FONT_SIZE: u32 = 14;
/// What is plotted, and how: the clean frames filled, the noisy ones not.
const FRAMES: [(&str, bool); 2] = [("clean", true), ("sigma 10", false)];

/// `tot2` over the operations of a pixel, clean and at sigma 10; over nothing where they were not counted.
pub(super) fn tot2_against_operations(trials: &[Trial]) -> Result<Plot> {
    let mut svg = String::new();
    draw(&mut svg, trials).map_err(|error| anyhow!("the plot: {error}"))?;
    let caption = "tot2 (lower is better) against counted operations per pixel (left is cheaper): filled on clean \
                   frames, hollow at noise of 10 grey levels. Without --features count nothing is counted, and all \
                   points lie at 0."
        .to_owned();
    Ok(Plot { name: "tot2_operations".to_owned(), caption, svg })
}

fn draw(svg: &mut String, trials: &[Trial]) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let operations = |trial: &Trial| trial.operations.map_or(0.0, |operations| operations.total());
    let most = trials.iter().map(operations).fold(1.0, f64::max);
    let highest = trials.iter().filter(|trial| is_shown(trial)).map(|trial| trial.mean.tot2).fold(1.0, f64::max);
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(56)
        .build_cartesian_2d(0.0..most * 1.6, 0.0..highest * 1.1)?;
    chart
        .configure_mesh()
        .x_desc("operations per pixel")
        .y_desc("tot2, % of the scored pixels")
        .label_style(("sans-serif", FONT_SIZE))
        .draw()?;
    for (index, entry) in super::ENTRIES.iter().enumerate() {
        let colour = Palette99::pick(index).to_rgba();
        for (frames, filled) in FRAMES {
            let Some(trial) = find(trials, entry.name, frames) else { continue };
            let place = (operations(trial), trial.mean.tot2);
            let style = if filled { colour.filled() } else { colour.stroke_width(2) };
            let point = chart.draw_series([Circle::new(place, 6, style)])?;
            if filled {
                point.label(entry.name).legend(move |place| Circle::new(place, 5, colour.filled()));
            }
        }
    }
    let label_font = ("sans-serif", FONT_SIZE);
    chart
        .configure_series_labels()
        .label_font(label_font)
        .background_style(WHITE.mix(0.9))
        .border_style(BLACK)
        .draw()?;
    drop(chart);
    root.present()?;
    Ok(())
}

fn is_shown(trial: &Trial) -> bool {
    FRAMES.iter().any(|(frames, _)| *frames == trial.frames)
}
