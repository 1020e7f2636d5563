//! Fig. 1: templates of 3 pixels around the extrema of a row, their match in the other view, and how much the
//! brightness of true correspondences differs.

mod template;

use anyhow::Result;

use self::template::{DISPERSION, Extremum, FLAT, Shape, UNIQUENESS, extrema, matching};
use super::plot::{Axis, BLACK, Chart, Layer, Mark, figure};
use super::{Outcome, Part, Plot, Setup, Table};
use crate::score::scene::Scene;

/// Widths of the templates, px; the paper's first.
const WIDTHS: [usize; 4] = [3, 5, 9, 15];
/// A match is right if it is off by no more than this, 1/256 px.
const RIGHT_Q8: u64 = 256;
/// Columns on either side of the extremum in the picture.
const REACH: usize = 28;

/// Does the study.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn run(setup: &Setup<'_>) -> Result<Outcome> {
    setup.progress.set_length(setup.scenes.len() as u64);
    let mut found = Vec::new();
    for scene in setup.scenes {
        found.push(Found::of(scene));
        setup.progress.inc(1);
    }
    let mut parts = vec![Part::Text(question(setup))];
    if let Some(example) = clearest(&found) {
        parts.extend([Part::Plot(rows_plot(&example)?), Part::Plot(template_plot(&example)?)]);
    }
    parts.extend([Part::Table(shape_table(&found)), Part::Table(match_table(&found))]);
    parts.extend([Part::Table(dispersion_table(&found)), Part::Plot(dispersion_plot(&found)?)]);
    parts.push(Part::Text(verdict(&found)));
    Ok(Outcome { name: "envelope", title: "Intensity envelopes (Fig. 1)".to_owned(), parts })
}

fn question(setup: &Setup<'_>) -> String {
    format!(
        "The paper takes an extremum of an image row and its neighbours as a template of 3 pixels, looks for the \
         similar fragment in the same row of the other view, within a dispersion of up to {DISPERSION} grey levels, \
         and takes the distance of both extrema as the disparity. Measured on {}: the shapes of 3-pixel templates, \
         how often the best template of the same shape lies at the true disparity (to 1 px, against truth, where \
         both views see the point), and how much the brightness of truly corresponding points differs. A template \
         matches if no pixel differs by more than {DISPERSION} grey levels after the means are taken out; the least \
         sum of differences wins, if it is below {UNIQUENESS} % of the next best candidate's that is no neighbour. \
         Steps of up to {FLAT} grey levels count as flat.",
        setup.scenes_name
    )
}

/// Extrema that have truth, and what became of them.
#[derive(Debug, Clone, Copy, Default)]
struct Matches {
    asked: u64,
    answered: u64,
    right: u64,
}

/// An extremum with its right match.
#[derive(Debug, Clone, Copy)]
struct Example {
    y: usize,
    left: Extremum,
    right: usize,
    /// The height of the extremum above (below) the nearer of its neighbours, grey levels.
    height: i32,
    true_q8: u16,
}

/// What a scene told.
struct Found<'a> {
    scene: &'a Scene,
    shapes: [u64; Shape::ALL.len()],
    matches: [Matches; WIDTHS.len()],
    /// How many true correspondences differ by that many grey levels.
    differences: [u64; 256],
    /// The highest extremum with a right match.
    example: Option<Example>,
}

impl<'a> Found<'a> {
    fn of(scene: &'a Scene) -> Self {
        let (shapes, matches) = ([0; Shape::ALL.len()], [Matches::default(); WIDTHS.len()]);
        let mut found = Self { scene, shapes, matches, differences: [0; 256], example: None };
        for y in 0..scene.pair.height() {
            found.count_shapes(scene.pair.left.row(y));
            found.try_matches(y);
        }
        found.count_differences();
        found
    }

    fn count_shapes(&mut self, row: &[u8]) {
        for &template in row.array_windows::<3>() {
            let shape = Shape::of(template);
            let counts = Shape::ALL.iter().zip(&mut self.shapes).filter(|(other, _)| **other == shape);
            counts.for_each(|(_, count)| *count += 1);
        }
    }

    fn try_matches(&mut self, y: usize) {
        let scene = self.scene;
        let (left, right) = (scene.pair.left.row(y), scene.pair.right.row(y));
        let (of_left, of_right) = (extrema(left), extrema(right));
        let range = usize::from(scene.meta.num_disparities);
        for extremum in of_left {
            let index = y * scene.pair.width() + extremum.column;
            if !scene.truth.is_scored(index) {
                continue;
            }
            let true_q8 = scene.truth.disparity_q8[index];
            for (number, width) in WIDTHS.into_iter().enumerate() {
                let answer = matching(left, right, &of_right, extremum, range, width);
                let is_right = answer.is_some_and(|column| is_right(extremum.column - column, true_q8));
                let matches = &mut self.matches[number];
                matches.asked += 1;
                matches.answered += u64::from(answer.is_some());
                matches.right += u64::from(is_right);
                if let (0, true, Some(right)) = (number, is_right, answer) {
                    self.offer(Example { y, left: extremum, right, height: height(left, extremum.column), true_q8 });
                }
            }
        }
    }

    /// Keeps the highest example that has room around it.
    fn offer(&mut self, example: Example) {
        let has_room = example.right >= REACH && example.left.column + REACH < self.scene.pair.width();
        if has_room && self.example.is_none_or(|kept| kept.height < example.height) {
            self.example = Some(example);
        }
    }

    fn count_differences(&mut self) {
        let (pair, width) = (&self.scene.pair, self.scene.pair.width());
        for (index, true_q8) in self.scene.truth.scored() {
            let (x, y) = (index % width, index / width);
            let Some(at_q8) = (256 * x).checked_sub(true_q8.into()) else { continue };
            let row = pair.right.row(y);
            let (first, part) = (at_q8 / 256, at_q8 as i64 % 256);
            let (a, b) = (i64::from(row[first]), i64::from(row[(first + 1).min(width - 1)]));
            let seen = (a * (256 - part) + b * part + 128) / 256;
            let difference = (i64::from(pair.left.luma[index]) - seen).unsigned_abs() as usize;
            self.differences[difference] += 1;
        }
    }
}

fn is_right(disparity: usize, true_q8: u16) -> bool {
    (disparity as u64 * 256).abs_diff(true_q8.into()) <= RIGHT_Q8
}

fn height(row: &[u8], column: usize) -> i32 {
    let step = |other: usize| (i32::from(row[column]) - i32::from(row[other])).abs();
    step(column - 1).min(step(column + 1))
}

/// The highest example of all scenes.
fn clearest<'a>(found: &[Found<'a>]) -> Option<(&'a Scene, Example)> {
    let examples = found.iter().filter_map(|found| Some((found.scene, found.example?)));
    examples.max_by_key(|(_, example)| example.height)
}

fn rows_plot((scene, example): &(&Scene, Example)) -> Result<Plot> {
    let Example { y, left, right, true_q8, .. } = *example;
    let views = [("left view", &scene.pair.left, left.column), ("right view", &scene.pair.right, right)];
    let fragment = |(name, frame, column): (&str, &crate::Frame, usize)| {
        let row = frame.row(y);
        let (first, last) = (right - REACH, left.column + REACH);
        let at = |x: usize| [x as f64, f64::from(row[x])];
        let marked = |peaks: bool| {
            let inside = move |e: &Extremum| e.is_peak == peaks && (first..=last).contains(&e.column);
            extrema(row).into_iter().filter(inside).map(move |e| at(e.column)).collect::<Vec<_>>()
        };
        let around = column - 1..=column + 1;
        let edge =
            |sign: f64| around.clone().map(move |x| (x, sign)).map(|(x, sign)| at(x)[1] + sign * f64::from(DISPERSION));
        let lower = around.clone().map(|x| x as f64).zip(edge(-1.0)).map(|(x, y)| [x, y]);
        let layers = vec![
            Layer::new("dispersion, 30 grey levels", BLACK, Mark::Band { upper: edge(1.0).collect() }, lower),
            Layer::new("brightness", BLACK, Mark::Line, (first..=last).map(at)),
            Layer::new("peaks", 1, Mark::Triangles { down: false }, marked(true)),
            Layer::new("troughs", 0, Mark::Triangles { down: true }, marked(false)),
            Layer::new("template", 2, Mark::DotsOnLine, around.map(at)),
        ];
        let x = Axis::linear("column, px", [first as f64, last as f64]);
        Chart { title: name.to_owned(), x, y: Axis::linear("brightness, grey levels", [0.0, 255.0]), layers }
    };
    let caption = format!(
        "Row {y} of {}: the extremum in column {} of the left view and its match in column {right} of the right \
         view, a disparity of {} px; the truth is {:.2} px. Chosen as the extremum that stands out most among those \
         matched right.",
        scene.name,
        left.column,
        left.column - right,
        f64::from(true_q8) / 256.0
    );
    Ok(Plot { name: "rows".to_owned(), caption, svg: figure(&views.map(fragment), 1, [900, 230])? })
}

fn template_plot((scene, example): &(&Scene, Example)) -> Result<Plot> {
    let views =
        [("left view", &scene.pair.left, example.left.column), ("right view", &scene.pair.right, example.right)];
    let chart = |(name, frame, column): (&str, &crate::Frame, usize)| {
        let row = frame.row(example.y);
        let values = [column - 1, column, column + 1].map(|x| f64::from(row[x]));
        let places = [-1.0, 0.0, 1.0];
        let points = |shift: f64| places.into_iter().zip(values).map(move |(x, value)| [x, value + shift]);
        let upper = values.map(|value| value + f64::from(DISPERSION)).to_vec();
        let layers = vec![
            Layer::new("dispersion, 30 grey levels", BLACK, Mark::Band { upper }, points(-f64::from(DISPERSION))),
            Layer::new("template", 2, Mark::DotsOnLine, points(0.0)),
        ];
        Chart {
            title: format!("{name}, column {column}"),
            x: Axis::linear("pixel of the template", [-1.2, 1.2]).with_ticks(places),
            y: Axis::linear("brightness, grey levels", [-30.0, 285.0]).with_ticks([0.0, 100.0, 200.0]),
            layers,
        }
    };
    let caption = "The template of 3 pixels in both views, with the band within which a pixel may differ.".to_owned();
    Ok(Plot { name: "template".to_owned(), caption, svg: figure(&views.map(chart), 2, [360, 270])? })
}

fn shape_table(found: &[Found<'_>]) -> Table {
    let row = |name: &str, counts: [u64; 5]| {
        let all = counts.iter().sum::<u64>().max(1);
        let shares = counts.map(|count| format!("{:.1}", percent(count, all)));
        [name.to_owned(), all.to_string()].into_iter().chain(shares).collect()
    };
    let mut rows: Vec<Vec<String>> = found.iter().map(|found| row(&found.scene.name, found.shapes)).collect();
    rows.push(row("all", std::array::from_fn(|shape| found.iter().map(|found| found.shapes[shape]).sum())));
    let columns = ["scene", "templates", "peak, %", "trough, %", "plateau, %", "rise, %", "fall, %"];
    let caption = "Shapes of all 3-pixel templates of the left views' rows.".to_owned();
    Table { name: "shapes".to_owned(), caption, columns: columns.map(str::to_owned).to_vec(), rows }
}

fn percent(part: u64, of: u64) -> f64 {
    100.0 * part as f64 / of.max(1) as f64
}

/// The sums over all scenes, by width of the template.
fn all_matches(found: &[Found<'_>]) -> [Matches; WIDTHS.len()] {
    std::array::from_fn(|number| {
        let each = found.iter().map(|found| found.matches[number]);
        each.fold(Matches::default(), |sum, m| Matches {
            asked: sum.asked + m.asked,
            answered: sum.answered + m.answered,
            right: sum.right + m.right,
        })
    })
}

fn match_table(found: &[Found<'_>]) -> Table {
    let cells = |(width, m): (usize, Matches)| {
        let shares = [(m.answered, m.asked), (m.right, m.answered), (m.right, m.asked)];
        let shares =
            shares.map(|(part, of)| if of == 0 { "-".to_owned() } else { format!("{:.1}", percent(part, of)) });
        [width.to_string(), m.asked.to_string()].into_iter().chain(shares).collect()
    };
    let columns =
        ["template, px", "extrema", "matched, % of the extrema", "right, % of the matched", "right, % of the extrema"];
    let caption = "Matches of extrema by their templates' width; right: within 1 px of the truth.".to_owned();
    let rows = WIDTHS.into_iter().zip(all_matches(found)).map(cells).collect();
    Table { name: "matches".to_owned(), caption, columns: columns.map(str::to_owned).to_vec(), rows }
}

/// The smallest difference that `share` of all stay within.
fn quantile(counts: &[u64; 256], share: f64) -> usize {
    let wanted = share * counts.iter().sum::<u64>() as f64;
    let mut sum = 0;
    counts
        .iter()
        .position(|count| {
            sum += count;
            sum as f64 >= wanted
        })
        .unwrap_or(255)
}

/// Percentage of the correspondences that differ by at most so many grey levels.
fn within(counts: &[u64; 256], most: usize) -> f64 {
    percent(counts[..=most].iter().sum(), counts.iter().sum())
}

fn all_differences(found: &[Found<'_>]) -> [u64; 256] {
    std::array::from_fn(|difference| found.iter().map(|found| found.differences[difference]).sum())
}

fn dispersion_table(found: &[Found<'_>]) -> Table {
    let row = |name: &str, counts: &[u64; 256]| {
        let pixels: u64 = counts.iter().sum();
        let sum: f64 = (0u32..).zip(counts).map(|(d, &count)| f64::from(d) * count as f64).sum();
        let quantiles = [0.5, 0.9, 0.95, 0.99].map(|share| quantile(counts, share).to_string());
        let mut cells = vec![name.to_owned(), pixels.to_string(), format!("{:.2}", sum / pixels.max(1) as f64)];
        cells.extend(quantiles);
        cells.push(format!("{:.2}", within(counts, DISPERSION as usize)));
        cells
    };
    let mut rows: Vec<Vec<String>> = found.iter().map(|found| row(&found.scene.name, &found.differences)).collect();
    rows.push(row("all", &all_differences(found)));
    let columns = ["scene", "pixels", "mean", "median", "90 %", "95 %", "99 %", "within 30, %"];
    let caption = "Brightness difference of true correspondences, grey levels: mean, and what so many percent stay \
    within. The right view is read between pixels.";
    Table {
        name: "dispersion".to_owned(),
        caption: caption.to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows,
    }
}

fn dispersion_plot(found: &[Found<'_>]) -> Result<Plot> {
    const SHOWN: usize = 60;
    let counts = all_differences(found);
    let all = counts.iter().sum();
    let bars = (0..=SHOWN).map(|d| [d as f64, percent(counts[d], all)]);
    let limit = f64::from(DISPERSION);
    let most = counts[..=SHOWN].iter().map(|&count| percent(count, all)).fold(1.0, f64::max);
    let shares = Chart {
        title: "share of each difference".to_owned(),
        x: Axis::linear("brightness difference, grey levels", [-1.0, SHOWN as f64]),
        y: Axis::linear("correspondences, %", [0.0, 1.1 * most]),
        layers: vec![
            Layer::new("", 0, Mark::Bars { half_width: 0.4 }, bars),
            Layer::new("the paper's 30", 1, Mark::Dashes, [[limit, 0.0], [limit, 1.1 * most]]),
        ],
    };
    let sums = Chart {
        title: "share within".to_owned(),
        x: Axis::linear("brightness difference, grey levels", [0.0, SHOWN as f64]),
        y: Axis::linear("correspondences, %", [0.0, 105.0]).with_ticks([0.0, 25.0, 50.0, 75.0, 100.0]),
        layers: vec![
            Layer::new("", 0, Mark::Line, (0..=SHOWN).map(|d| [d as f64, within(&counts, d)])),
            Layer::new("the paper's 30", 1, Mark::Dashes, [[limit, 0.0], [limit, 105.0]]),
        ],
    };
    let caption = "How much the brightness of true correspondences differs, over all scenes.".to_owned();
    Ok(Plot { name: "dispersion".to_owned(), caption, svg: figure(&[shares, sums], 2, [450, 280])? })
}

/// What holds of the paper's statement, from the figures.
fn verdict(found: &[Found<'_>]) -> String {
    let counts = all_differences(found);
    let matches = all_matches(found);
    let right = |m: Matches| percent(m.right, m.answered);
    let last = WIDTHS.len() - 1;
    let is_better = right(matches[last]) > right(matches[0]);
    let told =
        if is_better { "A wider template is right more often" } else { "A wider template is not right more often" };
    format!(
        "Of the true correspondences {:.2} % differ by no more than {DISPERSION} grey levels, and 99 % by no more \
         than {}. A template of 3 pixels is matched at {:.1} % of the extrema, and {:.1} % of these matches are \
         right to 1 px; one of {} pixels is matched at {:.1} %, of which {:.1} % are right. {told}.",
        within(&counts, DISPERSION as usize),
        quantile(&counts, 0.99),
        percent(matches[0].answered, matches[0].asked),
        right(matches[0]),
        WIDTHS[last],
        percent(matches[last].answered, matches[last].asked),
        right(matches[last]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_count_from_the_smallest_difference() {
        let mut counts = [0; 256];
        (counts[0], counts[3], counts[40]) = (50, 45, 5);
        assert_eq!([0.5, 0.9, 0.99].map(|share| quantile(&counts, share)), [0, 3, 40]);
        assert_eq!(within(&counts, 30), 95.0);
    }
}
