//! Plots of the studies in one look: white paper, thin axes with units, colours that colour-blind readers can
//! tell apart.
//!
//! A figure is a grid of [`Chart`]s, a chart is two [`Axis`]es and [`Layer`]s over each other. Numbers of a
//! logarithmic axis are given as they are.

mod axis;

pub use axis::Axis;

use anyhow::{Result, ensure};
use plotters::coord::Shift;
use plotters::coord::ranged1d::ValueFormatter;
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
/// Height of a line of the legend above the charts, px.
const LEGEND: u32 = 24;
/// Where its lines begin, px.
const LEGEND_LEFT: i32 = 60;

/// Number of a colour in the palette that stands for no series: black.
pub const BLACK: usize = PALETTE.len() - 1;

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
    let rows = charts.len().div_ceil(columns);
    let width = size[0] * columns as u32;
    let (entries, lines) = legend_places(&legend_entries(charts), width);
    let legend = LEGEND * lines;
    let height = size[1] * rows as u32 + legend;
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

/// Where each entry of the legend begins, px, in as many lines as the width asks for.
fn legend_places<'a>(entries: &[&'a Layer], width: u32) -> (Vec<(&'a Layer, [i32; 2])>, u32) {
    let (mut left, mut line) = (LEGEND_LEFT, 0);
    let mut places = Vec::new();
    for &entry in entries {
        let length = 44 + 6 * entry.name.chars().count() as i32;
        if left > LEGEND_LEFT && left + length > width as i32 {
            (left, line) = (LEGEND_LEFT, line + 1);
        }
        places.push((entry, [left, line * LEGEND as i32]));
        left += length;
    }
    let lines = if entries.is_empty() { 0 } else { line as u32 + 1 };
    (places, lines)
}

fn draw_legend(area: &Area<'_>, entries: &[(&Layer, [i32; 2])]) -> Result<()> {
    for &(entry, [left, top]) in entries {
        let colour = entry.ink();
        let middle = top + LEGEND as i32 / 2 + 2;
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
    fn a_long_legend_has_more_lines() {
        let layers: Vec<Layer> = (0..5).map(|i| Layer::new(&format!("method {i}"), i, Mark::Dots, [])).collect();
        let entries: Vec<&Layer> = layers.iter().collect();
        let (places, lines) = legend_places(&entries, 300);
        assert_eq!(lines, 3);
        assert_eq!(places.iter().map(|place| place.1).collect::<Vec<_>>()[1..3], [[152, 0], [60, 24]]);
        assert_eq!(legend_places(&[], 300).1, 0);
    }

    #[test]
    fn nothing_to_draw_is_refused() {
        assert!(figure(&[], 1, [300, 200]).is_err());
        assert!(figure(&[chart(Mark::Line)], 0, [300, 200]).is_err());
    }
}
