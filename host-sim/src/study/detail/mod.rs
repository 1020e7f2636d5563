//! Fig. 2: the Haar responses of one row at growing supports, and how the peak of a fine structure falls against
//! that of a coarse one.
//!
//! The support is given as half-support `s`: values on each side of an edge. Responses are divided by it, so
//! that they are differences of mean brightness, grey levels, whatever the support.

mod form;

use anyhow::{Context, Result};

use self::form::{BARS, Fall, Form, HALF_SUPPORTS, HEIGHT, Left, OBJECT, magnitudes, mean_differences};
use super::plot::{Axis, BLACK, Chart, Layer, Mark, figure};
use super::{Outcome, Part, Plot, Setup, Table};
use crate::Frame;
use crate::score::scene::Scene;

/// A real row takes part if its fine and its coarse structure are this strong, grey levels.
const LEAST_CONTRAST: f64 = 20.0;
/// The widest fine structure of a real row, px.
const FINE_WIDTH: usize = 3;

/// Does the study.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn run(setup: &Setup<'_>) -> Result<Outcome> {
    setup.progress.set_length(2 + setup.scenes.len() as u64);
    let synthetic = Form::ALL.map(|form| BARS.map(|bar| form.fall(bar)));
    setup.progress.inc(1);
    let mut rows = Vec::new();
    for scene in setup.scenes {
        rows.extend(real_rows(scene));
        setup.progress.inc(1);
    }
    let mut parts = vec![Part::Text(question(setup)), Part::Plot(responses(example(setup, &rows)?)?)];
    parts.push(Part::Table(synthetic_table(&synthetic)));
    parts.push(Part::Plot(fall_plot(&synthetic, &rows)?));
    parts.push(Part::Table(real_table(&rows)));
    parts.push(Part::Text(verdict(&synthetic, &rows)));
    setup.progress.inc(1);
    Ok(Outcome { name: "detail", title: "Adjustable detail (Fig. 2)".to_owned(), parts })
}

fn question(setup: &Setup<'_>) -> String {
    format!(
        "The paper transforms a row by the Haar wavelet and says of the support s: at s = 1 fine and coarse detail \
         peak alike, with a larger s the peaks of fine detail shrink and those of large objects grow. Here s is the \
         half-support, the pixels on each side of an edge, and the response is divided by s, which makes it a \
         difference of mean brightness in grey levels. Measured on synthetic rows with a bar of {} px or an object \
         of {OBJECT} px, both {HEIGHT} grey levels above the ground, and on the rows of {}. Two forms of the \
         transform: undecimated (a response at every column) and decimated with a1 = 0 as in eq. 1 (level n has s = \
         2^(n-1), the detail of that level alone is transformed back, and the row's place against the pairs of \
         pixels matters, so that all places are tried).",
        BARS.map(|bar| bar.to_string()).join(", "),
        setup.scenes_name
    )
}

/// A row of a scene with its finest clear structure and its coarsest clear edge.
struct RealRow<'a> {
    scene: &'a Scene,
    y: usize,
    /// First column of the fine structure.
    fine: usize,
    /// Column of the strongest edge at the longest support.
    coarse: usize,
    /// How clear the weaker of both is, grey levels.
    contrast: f64,
    /// The fine structure's peak over the coarse one's, for each half-support.
    ratios: [f64; HALF_SUPPORTS.len()],
}

/// The rows of a scene that have both structures.
fn real_rows(scene: &Scene) -> impl Iterator<Item = RealRow<'_>> {
    let frame = &scene.pair.left;
    (0..frame.height).filter_map(move |y| {
        let row = frame.row(y);
        let (fine, clear) = finest(row)?;
        let longest = magnitudes(row, HALF_SUPPORTS[HALF_SUPPORTS.len() - 1]);
        let (coarse, &edge) = longest.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        let contrast = clear.min(edge);
        let ratios = HALF_SUPPORTS.map(|s| {
            let response = magnitudes(row, s);
            let around = |first: usize, last: usize| {
                let reach = &response[first.saturating_sub(1)..(last + 2).min(row.len())];
                reach.iter().copied().fold(0.0, f64::max)
            };
            around(fine, fine + FINE_WIDTH) / around(coarse, coarse).max(1.0)
        });
        (contrast >= LEAST_CONTRAST).then_some(RealRow { scene, y, fine, coarse, contrast, ratios })
    })
}

/// The clearest bar of at most [`FINE_WIDTH`] px between grounds of one brightness: its first column, and how
/// far it stands out from the nearer ground less by what the grounds differ, grey levels.
fn finest(row: &[u8]) -> Option<(usize, f64)> {
    const GROUND_WIDTH: usize = 16;
    let mean =
        |from: usize, count: usize| row[from..from + count].iter().map(|&v| f64::from(v)).sum::<f64>() / count as f64;
    let last = row.len().checked_sub(2 * GROUND_WIDTH + FINE_WIDTH)?;
    let clear = |first: usize| {
        let (left, right) = (mean(first - GROUND_WIDTH, GROUND_WIDTH), mean(first + FINE_WIDTH, GROUND_WIDTH));
        let bar = mean(first, FINE_WIDTH);
        let stands_out = if (bar > left) == (bar > right) { (bar - left).abs().min((bar - right).abs()) } else { 0.0 };
        stands_out - (left - right).abs()
    };
    let places = (GROUND_WIDTH..=GROUND_WIDTH + last).map(|first| (first, clear(first)));
    places.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The row to draw: that whose structures are the clearest; without any the first scene's middle row.
fn example<'a>(setup: &Setup<'a>, rows: &[RealRow<'a>]) -> Result<(&'a Scene, usize)> {
    let clearest = rows.iter().max_by(|a, b| a.contrast.total_cmp(&b.contrast)).map(|row| (row.scene, row.y));
    let first = || setup.scenes.first().map(|scene| (scene, scene.pair.height() / 2));
    clearest.or_else(first).context("the study needs a scene")
}

/// The row's brightness and its responses at all supports, left view and right view.
fn responses((scene, y): (&Scene, usize)) -> Result<Plot> {
    let views = [("left view", &scene.pair.left), ("right view", &scene.pair.right)];
    let mut charts: Vec<Chart> = views.iter().map(|(name, frame)| brightness(name, frame, y)).collect();
    let lines = HALF_SUPPORTS.map(|s| views.map(|(_, frame)| mean_differences(frame.row(y), s)));
    // One scale for all, so that heights can be compared.
    let most = lines.iter().flatten().flatten().fold(10.0, |most: f64, value| most.max(value.abs()));
    let round = (most / 10.0).floor() * 10.0;
    for (s, lines) in HALF_SUPPORTS.iter().zip(&lines) {
        let label = if *s == HALF_SUPPORTS[HALF_SUPPORTS.len() - 1] { "column, px" } else { "" };
        charts.extend(lines.iter().map(|line| Chart {
            title: String::new(),
            x: Axis::linear(label, [0.0, scene.pair.width() as f64]),
            y: Axis::linear(&format!("s = {s}"), [-1.1 * most, 1.1 * most]).with_ticks([-round, 0.0, round]),
            layers: vec![Layer::new("", 0, Mark::Line, columns(line))],
        }));
    }
    let caption = format!(
        "Row {y} of {}, brightness, and the Haar responses divided by s at half-supports s of 1, 2, 4, 8 and 16 px, \
         all in grey levels.",
        scene.name
    );
    Ok(Plot { name: "responses".to_owned(), caption, svg: figure(&charts, 2, [500, 130])? })
}

fn brightness(name: &str, frame: &Frame, y: usize) -> Chart {
    let line: Vec<f64> = frame.row(y).iter().map(|&value| value.into()).collect();
    Chart {
        title: name.to_owned(),
        x: Axis::linear("", [0.0, frame.width as f64]),
        y: Axis::linear("brightness", [0.0, 255.0]).with_ticks([0.0, 100.0, 200.0]),
        layers: vec![Layer::new("", BLACK, Mark::Line, columns(&line))],
    }
}

fn columns(line: &[f64]) -> impl Iterator<Item = [f64; 2]> {
    line.iter().enumerate().map(|(x, &value)| [x as f64, value])
}

fn synthetic_table(falls: &[[Fall; BARS.len()]; 2]) -> Table {
    let mut rows = Vec::new();
    for (form, falls) in Form::ALL.iter().zip(falls) {
        for (level, s) in HALF_SUPPORTS.iter().enumerate() {
            let mut cells = vec![form.name().to_owned(), s.to_string()];
            cells.extend(falls.iter().map(|fall| format!("{:.2}", fall[level].ratio())));
            let Left { fine, coarse } = falls[1][level];
            cells.extend([fine, coarse].map(|peak| format!("{:.1} to {:.1}", peak.least, peak.most)));
            rows.push(cells);
        }
    }
    let mut columns = vec!["form".to_owned(), "half-support, px".to_owned()];
    columns.extend(BARS.map(|bar| format!("bar of {bar} px")));
    columns.extend([BARS[1], OBJECT].map(|width| format!("peak of {width} px, grey levels")));
    let caption = format!(
        "Peak of a bar over the peak of an object of {OBJECT} px and the same height, each the mean over all places \
         against the transform's pairs (the object's two edges fall between pairs together, those of a bar of odd \
         width never); at the end the least and the greatest peak over these places."
    );
    Table { name: "synthetic".to_owned(), caption, columns, rows }
}

fn fall_plot(falls: &[[Fall; BARS.len()]; 2], rows: &[RealRow<'_>]) -> Result<Plot> {
    let supports = || HALF_SUPPORTS.map(|s| s as f64);
    let ratios = falls.iter().flatten().flatten().map(Left::ratio);
    let quartiles = if rows.is_empty() { Default::default() } else { quartiles_by_support(rows) };
    let most = ratios.chain(quartiles.iter().map(|q| q[2])).fold(1.0, f64::max);
    let axes = |title: &str, layers| Chart {
        title: title.to_owned(),
        x: Axis::log("half-support s, px", [0.9, 18.0]).with_ticks(supports()),
        y: Axis::linear("peak of fine / peak of coarse", [0.0, 1.1 * most]),
        layers,
    };
    let bars = |falls: &[Fall; BARS.len()]| -> Vec<Layer> {
        let line = |(number, fall): (usize, &Fall)| {
            let points = supports().into_iter().zip(fall).map(|(s, left)| [s, left.ratio()]);
            Layer::new(&format!("bar of {} px", BARS[number]), number, Mark::DotsOnLine, points)
        };
        falls.iter().enumerate().map(line).collect()
    };
    let mut charts: Vec<Chart> =
        Form::ALL.iter().zip(falls).map(|(form, falls)| axes(form.name(), bars(falls))).collect();
    if !rows.is_empty() {
        let at = |index: usize| supports().into_iter().zip(&quartiles).map(move |(s, q)| [s, q[index]]);
        let upper = quartiles.iter().map(|q| q[2]).collect();
        let layers = vec![
            Layer::new("middle half of the rows", BLACK, Mark::Band { upper }, at(0)),
            Layer::new("median of the rows", BLACK, Mark::DotsOnLine, at(1)),
        ];
        charts.push(axes(&format!("{} rows of the frames", rows.len()), layers));
    }
    let caption = "How the peak of fine structure falls against that of coarse structure with the support.".to_owned();
    Ok(Plot { name: "fall".to_owned(), caption, svg: figure(&charts, charts.len(), [340, 280])? })
}

/// Lower quartile, median and upper quartile of the ratio at each support.
fn quartiles_by_support(rows: &[RealRow<'_>]) -> [[f64; 3]; HALF_SUPPORTS.len()] {
    std::array::from_fn(|level| {
        let mut ratios: Vec<f64> = rows.iter().map(|row| row.ratios[level]).collect();
        ratios.sort_by(f64::total_cmp);
        [0.25, 0.5, 0.75].map(|share| ratios[(share * (ratios.len() - 1) as f64).round() as usize])
    })
}

fn real_table(rows: &[RealRow<'_>]) -> Table {
    let columns = ["half-support, px", "lower quartile", "median", "upper quartile", "clearest row"];
    let clearest = rows.iter().max_by(|a, b| a.contrast.total_cmp(&b.contrast));
    let cells = clearest.map_or_else(Vec::new, |clearest| {
        let lines = HALF_SUPPORTS.iter().zip(quartiles_by_support(rows)).zip(clearest.ratios);
        let line = |((s, [low, middle, high]), example): ((&usize, [f64; 3]), f64)| {
            let figures = [low, middle, high, example].map(|ratio| format!("{ratio:.2}"));
            std::iter::once(s.to_string()).chain(figures).collect()
        };
        lines.map(line).collect()
    });
    let which = clearest.map_or_else(String::new, |row| {
        let RealRow { scene, y, fine, coarse, .. } = row;
        format!(" The clearest: row {y} of {}, fine at column {fine}, coarse at column {coarse}.", scene.name)
    });
    let caption = format!(
        "Peak of the clearest bar of at most {FINE_WIDTH} px over that of the strongest edge at s = 16, of the {} \
         rows in which both reach {LEAST_CONTRAST} grey levels (undecimated).{which}",
        rows.len()
    );
    Table { name: "real".to_owned(), caption, columns: columns.map(str::to_owned).to_vec(), rows: cells }
}

/// What holds of the paper's statement, from the figures.
fn verdict(falls: &[[Fall; BARS.len()]; 2], rows: &[RealRow<'_>]) -> String {
    let [undecimated, decimated] = falls.each_ref().map(|falls| falls[1]);
    let mut text = format!(
        "The bar of {} px against the object. Undecimated: \"at s = 1 both peak alike\" {}, \"with larger s fine \
         detail shrinks\" {}. Decimated, mean over all places: the first {}, the second {}; but there the place \
         decides (at s = 1 the bar peaks at {:.0} to {:.0} grey levels: an edge between two pairs leaves no detail). \
         \"Large objects grow\": undecimated, the object's peak goes from {:.0} at s = 1 to {:.0} grey levels at s = \
         16 as a mean, and from {:.0} to {:.0} as a sum over the support.",
        BARS[1],
        alike(undecimated[0].ratio()),
        shrinks(undecimated.map(|left| left.ratio())),
        alike(decimated[0].ratio()),
        shrinks(decimated.map(|left| left.ratio())),
        decimated[0].fine.least,
        decimated[0].fine.most,
        undecimated[0].coarse.mean,
        undecimated[4].coarse.mean,
        undecimated[0].coarse.mean,
        undecimated[4].coarse.mean * HALF_SUPPORTS[4] as f64,
    );
    if !rows.is_empty() {
        let medians = quartiles_by_support(rows).map(|quartiles| quartiles[1]);
        let (first, second) = (alike(medians[0]), shrinks(medians));
        text += &format!(" On the rows of the frames, by the median: the first {first}, the second {second}.");
    }
    text
}

/// Whether fine and coarse peak alike, to a tenth.
fn alike(ratio: f64) -> String {
    format!("{} (ratio {ratio:.2})", holds((0.9..=1.1).contains(&ratio)))
}

/// Whether the fine structure falls and never rises against the coarse one.
fn shrinks(ratios: [f64; HALF_SUPPORTS.len()]) -> String {
    let [first, .., last] = ratios;
    let never_rises = ratios.windows(2).all(|pair| pair[1] <= pair[0] + 1e-9);
    let list = ratios.map(|ratio| format!("{ratio:.2}")).join(", ");
    format!("{} (ratios {list} at s = 1, 2, 4, 8, 16)", holds(never_rises && last < first))
}

fn holds(is_so: bool) -> &'static str {
    if is_so { "holds" } else { "does not hold" }
}

#[cfg(test)]
mod tests {
    use super::form::{BAR_AT, raised};
    use super::*;

    #[test]
    fn the_finest_structure_is_found_where_it_is() {
        let row = raised(BAR_AT, 2);
        let (first, clear) = finest(&row).unwrap();
        assert!((BAR_AT - 1..=BAR_AT).contains(&first) && clear > 50.0, "{first}, {clear}");
        assert!(finest(&[7; 20]).is_none());
    }
}
