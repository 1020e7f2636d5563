//! The plot of the study: how wrong the methods are against what they cost.

use std::mem::discriminant;

use anyhow::Result;

use super::{ENTRIES, Entry, Kind, Trial, find};
use crate::stereo::method::MethodKind;
use crate::study::Plot;
use crate::study::plot::{Axis, Chart, Layer, Mark, figure};

/// The frames of a chart each.
const FRAMES: [&str; 2] = ["clean", "sigma 10"];

/// `tot2` over the instructions of a pixel, clean and at sigma 10, of the methods that the chip has.
pub(super) fn tot2_against_instructions(trials: &[Trial]) -> Result<Plot> {
    let shown = || ENTRIES.iter().filter(|entry| is_dense(entry) && entry.on_chip().is_some());
    let points: Vec<&Trial> =
        shown().flat_map(|entry| FRAMES.into_iter().filter_map(|frames| find(trials, entry.name, frames))).collect();
    let x = points.iter().map(|trial| place(trial)[0]).chain([0.0]);
    let y = points.iter().map(|trial| place(trial)[1]).chain([0.0]);
    let (x, y) = (Axis::around("instructions per pixel", x), Axis::around("tot2, % of the scored pixels", y));
    let charts = FRAMES.map(|frames| {
        let mut layers: Vec<Layer> = Vec::new();
        for entry in shown() {
            let (point, mark) = (find(trials, entry.name, frames).map(place), mark(entry));
            let is_alike = |layer: &&Layer| discriminant(&layer.mark) == discriminant(&mark);
            let colour = layers.iter().filter(is_alike).count();
            layers.push(Layer::new(entry.name, colour, mark, point));
        }
        Chart { title: frames.to_owned(), x: x.clone(), y: y.clone(), layers }
    });
    let caption = "tot2 (lower is better) against instructions per pixel on the emulated chip (left is cheaper), on clean frames and \
                   at noise of 10 grey levels; the methods that are sparse by design are left out."
        .to_owned();
    Ok(Plot { name: "tot2_instructions".to_owned(), caption, svg: figure(&charts, 2, [450, 360])? })
}

fn place(trial: &Trial) -> [f64; 2] {
    [trial.instructions.unwrap_or(0.0), trial.mean.tot2]
}

/// Whether it sets out to answer everywhere.
fn is_dense(entry: &Entry) -> bool {
    !matches!(entry.kind, Kind::Contour(_) | Kind::Method(MethodKind::Contour | MethodKind::Envelope))
}

/// Triangles for the wavelet-modified forms: there are more methods than colours.
fn mark(entry: &Entry) -> Mark {
    match entry.kind {
        Kind::Wavelet(_) => Mark::Triangles { down: false },
        Kind::WaveletOf(_) => Mark::Triangles { down: true },
        _ => Mark::Dots,
    }
}
