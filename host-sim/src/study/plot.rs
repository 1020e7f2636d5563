//! Plots of the studies in one look: white paper, thin axes with units, colours that colour-blind readers can
//! tell apart.
//!
//! A figure is a grid of [`Chart`]s, a chart is two [`Axis`]es and [`Layer`]s over each other. Numbers of a
//! logarithmic axis are given as they are.

use std::ops::Range;

use anyhow::{Result, ensure};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;

/// The colours by Okabe and Ito, which stay apart for colour-blind readers; black last.
const PALETTE: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(30, 30, 30),
];
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(228, 228, 228);
const BAND: RGBColor = RGBColor(205, 205, 205);
const FONT: &str = "sans-serif";
const SMALL: i32 = 12;
const LARGE: i32 = 14;
/// Height of the legend above the charts, px.
const LEGEND: u32 = 24;

/// Number of a colour in the palette that stands for no series: black.
pub const BLACK: usize = PALETTE.len() - 1;

/// An axis: what it measures, from where to where, and where its numbers stand.
#[derive(Debug, Clone)]
pub struct Axis {
    label: String,
    range: [f64; 2],
    ticks: Vec<f64>,
    is_log: bool,
}

impl Axis {
    /// A linear axis; `label` with the unit.
    #[must_use]
    pub fn linear(label: &str, range: [f64; 2]) -> Self {
        let range = widened(range);
        Self { label: label.to_owned(), range, ticks: round_numbers(range, 6), is_log: false }
    }

    /// A linear axis on which all of `values` have room.
    #[must_use]
    pub fn around(label: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let extent = values.into_iter().filter(|value| value.is_finite());
        let range = extent.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        let range = widened(if range[0] <= range[1] { range } else { [0.0, 1.0] });
        let margin = 0.05 * (range[1] - range[0]);
        Self::linear(label, [range[0] - margin, range[1] + margin])
    }

    /// A logarithmic axis with numbers at the powers of ten; `range` is positive.
    #[must_use]
    pub fn log(label: &str, range: [f64; 2]) -> Self {
        let [low, high] = range.map(f64::log10);
        let ticks = (low.ceil() as i32..=high.floor() as i32).map(|power| 10f64.powi(power)).collect();
        Self { label: label.to_owned(), range, ticks, is_log: true }
    }

    /// The same with numbers at `ticks` only.
    #[must_use]
    pub fn with_ticks(self, ticks: impl IntoIterator<Item = f64>) -> Self {
        Self { ticks: ticks.into_iter().collect(), ..self }
    }

    /// How far from the axis's beginning a value lies, 0 to 1 within its range.
    fn share(&self, value: f64) -> f64 {
        let place = |value: f64| if self.is_log { value.max(f64::MIN_POSITIVE).log10() } else { value };
        let [low, high] = self.range.map(place);
        (place(value) - low) / (high - low)
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        // Values beyond the range stay near enough to it for the arithmetic of pixels.
        let share = self.share(*value).clamp(-1.0, 2.0);
        first + (share * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.range[0]..self.range[1]
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        let text = format!("{value:.6}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" { "0".to_owned() } else { text.to_owned() }
    }
}

/// A range with some length, whatever it was.
fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    if low < high { [low, high] } else { [low - 0.5, low + 0.5] }
}

/// About `count` round numbers within `range`.
fn round_numbers([low, high]: [f64; 2], count: u32) -> Vec<f64> {
    let rough = (high - low) / f64::from(count);
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|m| m * power).into_iter().find(|&s| s >= rough).unwrap_or(rough);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last).map(|index| index as f64 * step).collect()
}

/// How a layer's points are drawn.
#[derive(Debug, Clone)]
pub enum Mark {
    /// Joined by a line.
    Line,
    /// Joined by a line of dashes.
    Dashes,
    /// Joined by a line, with a dot on each.
    DotsOnLine,
    /// A dot each: a scatter.
    Dots,
    /// A triangle each, upwards or downwards.
    Triangles {
        /// Whether it points downwards.
        down: bool,
    },
    /// A stem each, from 0.
    Stems,
    /// A bar each, from 0.
    Bars {
        /// Half of its width, in units of the x axis.
        half_width: f64,
    },
    /// A grey band from the points up to these values.
    Band {
        /// The band's upper edge, one for each point.
        upper: Vec<f64>,
    },
    /// A coloured cell around each point: a heat strip or map.
    Cells {
        /// Size of a cell, in units of the axes.
        size: [f64; 2],
        /// The value of each point, 0 (dark) to 1 (bright).
        values: Vec<f64>,
    },
}

/// Points of one kind in a chart.
#[derive(Debug, Clone)]
pub struct Layer {
    /// What the legend calls it; the layers of one name in a figure share an entry. Empty: no entry.
    pub name: String,
    /// Number of its colour, counted on from the start after the last.
    pub colour: usize,
    /// How the points are drawn.
    pub mark: Mark,
    /// The points.
    pub points: Vec<[f64; 2]>,
}

impl Layer {
    /// A layer of that kind.
    pub fn new(name: &str, colour: usize, mark: Mark, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self { name: name.to_owned(), colour, mark, points: points.into_iter().collect() }
    }

    fn ink(&self) -> RGBColor {
        if matches!(self.mark, Mark::Band { .. }) { BAND } else { PALETTE[self.colour % PALETTE.len()] }
    }
}

/// Layers over each other on two axes.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Stands above; may be empty.
    pub title: String,
    /// The axis to the right.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// The lowest first.
    pub layers: Vec<Layer>,
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Canvas<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// Draws a grid of charts, `columns` in a row, each of `size` px, with one legend above; gives the SVG.
///
/// # Errors
/// If there is no chart or no column.
pub fn figure(charts: &[Chart], columns: usize, size: [u32; 2]) -> Result<String> {
    ensure!(!charts.is_empty() && columns > 0, "a figure needs a chart and a column");
    let entries = legend_entries(charts);
    let legend = if entries.is_empty() { 0 } else { LEGEND };
    let rows = charts.len().div_ceil(columns);
    let (width, height) = (size[0] * columns as u32, size[1] * rows as u32 + legend);
    let mut svg = String::new();
    {
        let paper = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
        paper.fill(&WHITE)?;
        let (top, body) = paper.split_vertically(legend);
        draw_legend(&top, &entries)?;
        for (area, chart) in body.split_evenly((rows, columns)).iter().zip(charts) {
            chart.draw(area)?;
        }
        paper.present()?;
    }
    Ok(svg)
}

/// The named layers of all charts, each name once.
fn legend_entries(charts: &[Chart]) -> Vec<&Layer> {
    let mut entries: Vec<&Layer> = Vec::new();
    for layer in charts.iter().flat_map(|chart| &chart.layers) {
        if !layer.name.is_empty() && entries.iter().all(|entry| entry.name != layer.name) {
            entries.push(layer);
        }
    }
    entries
}

fn draw_legend(area: &Area<'_>, entries: &[&Layer]) -> Result<()> {
    let mut left = 60;
    for entry in entries {
        let colour = entry.ink();
        let middle = LEGEND as i32 / 2 + 2;
        match entry.mark {
            Mark::Line | Mark::Stems | Mark::DotsOnLine => {
                area.draw(&PathElement::new([(left, middle), (left + 20, middle)], colour.stroke_width(2)))?;
            }
            Mark::Dashes => {
                for start in [left, left + 8, left + 16] {
                    area.draw(&PathElement::new([(start, middle), (start + 5, middle)], colour.stroke_width(2)))?;
                }
            }
            Mark::Bars { .. } | Mark::Band { .. } | Mark::Cells { .. } => {
                area.draw(&Rectangle::new([(left, middle - 5), (left + 20, middle + 5)], colour.filled()))?;
            }
            Mark::Dots | Mark::Triangles { .. } => {}
        }
        match entry.mark {
            Mark::Dots | Mark::DotsOnLine => area.draw(&Circle::new((left + 10, middle), 3, colour.filled()))?,
            Mark::Triangles { down } => {
                area.draw(&TriangleMarker::new((left + 10, middle), triangle(down), colour.filled()))?;
            }
            _ => {}
        }
        area.draw(&Text::new(entry.name.clone(), (left + 26, middle - 6), (FONT, SMALL).into_font().color(&INK)))?;
        left += 26 + 6 * entry.name.chars().count() as i32 + 18;
    }
    Ok(())
}

/// Size of a triangle, px; a negative one points downwards.
fn triangle(down: bool) -> i32 {
    if down { -5 } else { 5 }
}

impl Chart {
    fn draw(&self, area: &Area<'_>) -> Result<()> {
        let has_label = !self.x.label.is_empty();
        let mut builder = ChartBuilder::on(area);
        builder.margin(8).margin_right(14).x_label_area_size(if has_label { 36 } else { 18 }).y_label_area_size(56);
        if !self.title.is_empty() {
            builder.caption(&self.title, (FONT, LARGE).into_font().color(&INK));
        }
        let mut canvas = builder.build_cartesian_2d(self.x.clone(), self.y.clone())?;
        canvas
            .configure_mesh()
            .bold_line_style(GRID)
            .light_line_style(TRANSPARENT)
            .axis_style(INK)
            .label_style((FONT, SMALL).into_font().color(&INK))
            .axis_desc_style((FONT, SMALL).into_font().color(&INK))
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .x_labels(self.x.ticks.len())
            .y_labels(self.y.ticks.len())
            .x_label_formatter(&|value| self.x.format_ext(value))
            .y_label_formatter(&|value| self.y.format_ext(value))
            .draw()?;
        self.layers.iter().try_for_each(|layer| self.draw_layer(&mut canvas, layer))
    }

    fn draw_layer(&self, canvas: &mut Canvas<'_, '_>, layer: &Layer) -> Result<()> {
        let colour = layer.ink();
        let points = || layer.points.iter().map(|&[x, y]| (x, y));
        let foot = self.y.range[0].max(0.0);
        match &layer.mark {
            Mark::Line => drop(canvas.draw_series(LineSeries::new(points(), colour.stroke_width(2)))?),
            Mark::Dashes => {
                canvas.draw_series(DashedLineSeries::new(points(), 5, 4, colour.stroke_width(2)))?;
            }
            Mark::DotsOnLine => {
                canvas.draw_series(LineSeries::new(points(), colour.stroke_width(2)))?;
                canvas.draw_series(points().map(|point| Circle::new(point, 3, colour.filled())))?;
            }
            Mark::Dots => drop(canvas.draw_series(points().map(|point| Circle::new(point, 3, colour.filled())))?),
            Mark::Triangles { down } => {
                let size = triangle(*down);
                canvas.draw_series(points().map(|point| TriangleMarker::new(point, size, colour.filled())))?;
            }
            Mark::Stems => {
                let stem = |(x, y)| PathElement::new([(x, foot), (x, y)], colour.stroke_width(2));
                canvas.draw_series(points().map(stem))?;
            }
            Mark::Bars { half_width } => {
                let bar = |(x, y)| Rectangle::new([(x - half_width, foot), (x + half_width, y)], colour.filled());
                canvas.draw_series(points().map(bar))?;
            }
            Mark::Band { upper } => {
                let back = layer.points.iter().zip(upper).rev().map(|(&[x, _], &y)| (x, y));
                let outline: Vec<(f64, f64)> = points().chain(back).collect();
                canvas.draw_series([Polygon::new(outline, colour.mix(0.6))])?;
            }
            Mark::Cells { size: [width, height], values } => {
                let cell = |((x, y), &value): ((f64, f64), &f64)| {
                    let corners = [(x - width / 2.0, y - height / 2.0), (x + width / 2.0, y + height / 2.0)];
                    Rectangle::new(corners, heat(value).filled())
                };
                canvas.draw_series(points().zip(values).map(cell))?;
            }
        }
        Ok(())
    }
}

/// The colour of a value from 0 to 1.
fn heat(value: f64) -> RGBColor {
    let colorous::Color { r, g, b } = colorous::VIRIDIS.eval_continuous(value.clamp(0.0, 1.0));
    RGBColor(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(mark: Mark) -> Chart {
        let points = [[1.0, 2.0], [10.0, -3.0], [100.0, 5.0]];
        let x = Axis::log("SNR", [1.0, 100.0]);
        Chart {
            title: "<A>".to_owned(),
            x,
            y: Axis::around("error, px", [-3.0, 5.0]),
            layers: vec![Layer::new("a & b", 0, mark, points)],
        }
    }

    #[test]
    fn every_mark_draws_more_than_the_empty_chart() {
        let empty = figure(&[Chart { layers: Vec::new(), ..chart(Mark::Line) }], 1, [300, 200]).unwrap();
        let marks = [
            Mark::Line,
            Mark::Dashes,
            Mark::DotsOnLine,
            Mark::Dots,
            Mark::Triangles { down: true },
            Mark::Stems,
            Mark::Bars { half_width: 0.2 },
            Mark::Band { upper: vec![3.0, 3.0, 6.0] },
            Mark::Cells { size: [0.5, 1.0], values: vec![0.0, 0.5, 1.0] },
        ];
        for mark in marks {
            let svg = figure(&[chart(mark.clone())], 1, [300, 200]).unwrap();
            assert!(svg.len() > empty.len() + 100 && svg.ends_with("</svg>\n"), "{mark:?}");
            assert!(svg.contains("a &amp; b") && svg.contains("&lt;A&gt;"), "{mark:?}: words are escaped");
        }
    }

    #[test]
    fn a_name_stands_in_the_legend_once() {
        let charts = [chart(Mark::Line), chart(Mark::Dots)];
        assert_eq!(legend_entries(&charts).len(), 1);
        assert_eq!(figure(&charts, 2, [300, 200]).unwrap().matches("a &amp; b").count(), 1);
    }

    #[test]
    fn numbers_of_axes_are_round() {
        assert_eq!(round_numbers([0.0, 255.0], 6), [0.0, 50.0, 100.0, 150.0, 200.0, 250.0]);
        assert_eq!(Axis::log("", [0.5, 2000.0]).ticks, [1.0, 10.0, 100.0, 1000.0]);
        let axis = Axis::linear("", [7.0, 7.0]);
        assert!(axis.range[0] < axis.range[1] && !axis.ticks.is_empty());
        assert_eq!([0.25, -0.0, 1000.0, 20.0].map(|v| axis.format_ext(&v)), ["0.25", "0", "1000", "20"]);
    }

    #[test]
    fn a_logarithmic_axis_gives_every_power_as_much_room() {
        let axis = Axis::log("", [1.0, 1000.0]);
        assert_eq!([1.0, 10.0, 100.0, 1000.0].map(|v| axis.map(&v, (0, 300))), [0, 100, 200, 300]);
        assert_eq!(axis.map(&0.0, (0, 300)), -300, "what has no logarithm lies beyond, and is no fault");
    }

    #[test]
    fn nothing_to_draw_is_refused() {
        assert!(figure(&[], 1, [300, 200]).is_err());
        assert!(figure(&[chart(Mark::Line)], 0, [300, 200]).is_err());
    }
}
