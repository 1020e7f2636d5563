//! Fig. 2: the Haar responses of one row at growing supports, and how the peak of a fine structure falls against
//! that of a coarse one.
//!
//! The support is given as half-support `s`: values on each side of an edge. Responses are divided by it, so
//! that they are differences of mean brightness, grey levels, whatever the support.

use anyhow::{Context, Result};
use haarline::haar::{forward, inverse, sliding_response};

use super::plot::{Axis, BLACK, Chart, Layer, Mark, figure};
use super::{Outcome, Part, Plot, Setup, Table};
use crate::Frame;
use crate::scene::Scene;

/// The half-supports, px: those of the decimated transform's levels 1 to 5.
const HALF_SUPPORTS: [usize; 5] = [1, 2, 4, 8, 16];
/// Widths of the synthetic fine structure, px.
const BARS: [usize; 4] = [1, 2, 4, 8];
/// Width of the synthetic coarse structure, px.
const OBJECT: usize = 40;
/// Grey levels of the synthetic background, and of the structures above it.
const GROUND: u8 = 60;
const HEIGHT: u8 = 100;
/// Columns of a synthetic row, and where a bar or the object begins in its own.
const ROW: usize = 256;
const BAR_AT: usize = 64;
const OBJECT_AT: usize = 144;
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
        "The paper transforms a row by the Haar wavelet and says of the support s: at s = 1 fine and coarse detail peak \
         alike, with a larger s the peaks of fine detail shrink and those of large objects grow. Here s is the \
         half-support, the pixels on each side of an edge, and the response is divided by s, which makes it a \
         difference of mean brightness in grey levels. Measured on synthetic rows with a bar of {} px or an object of \
         {OBJECT} px, both {HEIGHT} grey levels above the ground, and on the rows of {}. Two forms of the transform: \
         undecimated (a response at every column) and decimated with a1 = 0 as in eq. 1 (level n has s = 2^(n-1), the \
         detail of that level alone is transformed back, and the row's place against the pairs of pixels matters, so \
         that all places are tried).",
        BARS.map(|bar| bar.to_string()).join(", "),
        setup.scenes_name
    )
}

/// The two forms of the transform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Undecimated,
    Decimated,
}

/// The peaks of a structure over its places in the row, grey levels.
#[derive(Debug, Clone, Copy)]
struct Peak {
    least: f64,
    mean: f64,
    most: f64,
}

impl Peak {
    fn of(peaks: &[f64]) -> Self {
        Self {
            least: peaks.iter().copied().fold(f64::INFINITY, f64::min),
            mean: peaks.iter().sum::<f64>() / peaks.len() as f64,
            most: peaks.iter().copied().fold(0.0, f64::max),
        }
    }
}

/// What a support leaves of a bar and of the object.
#[derive(Debug, Clone, Copy)]
struct Left {
    fine: Peak,
    coarse: Peak,
}

impl Left {
    /// The mean peak of the bar over that of the object.
    fn ratio(&self) -> f64 {
        self.fine.mean / self.coarse.mean
    }
}

/// For each half-support.
type Fall = [Left; HALF_SUPPORTS.len()];

impl Form {
    const ALL: [Self; 2] = [Self::Undecimated, Self::Decimated];

    fn name(self) -> &'static str {
        match self {
            Self::Undecimated => "undecimated",
            Self::Decimated => "decimated, a1 = 0",
        }
    }

    /// The magnitudes of what the transform leaves of `row`, grey levels.
    fn transform(self, row: &[u8], level: usize) -> Vec<f64> {
        match self {
            Self::Undecimated => magnitudes(row, HALF_SUPPORTS[level]),
            Self::Decimated => contours_of_level(row, level).iter().map(|&v| f64::from(v).abs()).collect(),
        }
    }

    /// How the peak of a bar falls against that of the object.
    fn fall(self, bar: usize) -> Fall {
        std::array::from_fn(|level| {
            let s = HALF_SUPPORTS[level];
            let places = if self == Self::Decimated { 2 * s } else { 1 };
            let peaks = |first: usize, width: usize| {
                let peak = |place| {
                    let contours = self.transform(&raised(first + place, width), level);
                    // Far from the row's ends, which some places cut a pair short at.
                    contours[2 * s..ROW - 2 * s].iter().copied().fold(0.0, f64::max)
                };
                Peak::of(&(0..places).map(peak).collect::<Vec<_>>())
            };
            Left { fine: peaks(BAR_AT, bar), coarse: peaks(OBJECT_AT, OBJECT) }
        })
    }
}

/// A row with one structure.
fn raised(first: usize, width: usize) -> Vec<u8> {
    let is_raised = |x: &usize| (first..first + width).contains(x);
    (0..ROW).map(|x| if is_raised(&x) { GROUND + HEIGHT } else { GROUND }).collect()
}

/// The sliding response of `row` divided by `s`.
fn mean_differences(row: &[u8], s: usize) -> Vec<f64> {
    let mut response = vec![0; row.len()];
    sliding_response(row, s, &mut response);
    response.iter().map(|&value| f64::from(value) / s as f64).collect()
}

fn magnitudes(row: &[u8], s: usize) -> Vec<f64> {
    mean_differences(row, s).into_iter().map(f64::abs).collect()
}

/// What the detail of one level alone leaves of a row: eq. 1 with the approximation set to zero, level 0 the
/// finest.
fn contours_of_level(row: &[u8], level: usize) -> Vec<i16> {
    let mut line: Vec<i16> = row.iter().map(|&value| value.into()).collect();
    let mut lengths = Vec::new();
    let mut detail = Vec::new();
    for _ in 0..=level {
        let mut approximation = vec![0; line.len().div_ceil(2)];
        detail = vec![0; line.len() / 2];
        forward(&line, &mut approximation, &mut detail);
        lengths.push(line.len());
        line = approximation;
    }
    let mut back = vec![0; line.len()];
    for length in lengths.into_iter().rev() {
        let mut finer = vec![0; length];
        inverse(&back, &detail, &mut finer);
        // The finer details are left out, too: all zero, and at most as many.
        detail = vec![0; length];
        back = finer;
    }
    back
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
         against the transform's pairs; at the end the least and the greatest peak over these places."
    );
    Table { name: "synthetic".to_owned(), caption, columns, rows }
}

fn fall_plot(falls: &[[Fall; BARS.len()]; 2], rows: &[RealRow<'_>]) -> Result<Plot> {
    let supports = || HALF_SUPPORTS.map(|s| s as f64);
    let axes = |title: &str, layers| Chart {
        title: title.to_owned(),
        x: Axis::log("half-support s, px", [0.9, 18.0]).with_ticks(supports()),
        y: Axis::linear("peak of fine / peak of coarse", [0.0, 1.1]),
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
        let quartiles = quartiles_by_support(rows);
        let at = |index: usize| supports().into_iter().zip(&quartiles).map(move |(s, q)| [s, q[index]]);
        let upper = quartiles.iter().map(|q| q[2]).collect();
        let most = quartiles.iter().map(|q| q[2]).fold(1.0, f64::max);
        let layers = vec![
            Layer::new("middle half of the rows", BLACK, Mark::Band { upper }, at(0)),
            Layer::new("median of the rows", BLACK, Mark::DotsOnLine, at(1)),
        ];
        let chart = axes(&format!("{} real or rendered rows", rows.len()), layers);
        charts.push(Chart { y: Axis::linear("peak of fine / peak of coarse", [0.0, 1.1 * most]), ..chart });
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
        "Peak of the clearest bar of at most {FINE_WIDTH} px over that of the strongest edge at s = 16, of the {} rows in \
         which both reach {LEAST_CONTRAST} grey levels (undecimated).{which}",
        rows.len()
    );
    Table { name: "real".to_owned(), caption, columns: columns.map(str::to_owned).to_vec(), rows: cells }
}

/// What holds of the paper's statement, from the figures.
fn verdict(falls: &[[Fall; BARS.len()]; 2], rows: &[RealRow<'_>]) -> String {
    let [undecimated, decimated] = falls.each_ref().map(|falls| falls[1]);
    let mut text = format!(
        "The bar of {} px against the object. Undecimated: \"at s = 1 both peak alike\" {}, \"with larger s fine detail \
         shrinks\" {}. Decimated, mean over all places: the first {}, the second {}; but there the place decides (at s = 1 \
         the bar peaks at {:.0} to {:.0} grey levels: an edge between two pairs leaves no detail). \"Large objects grow\": \
         undecimated, the object's peak goes from {:.0} at s = 1 to {:.0} grey levels at s = 16 as a mean, and from {:.0} to \
         {:.0} as a sum over the support.",
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
    format!("{} ({first:.2} at s = 1, {last:.2} at s = 16)", holds(never_rises && last < first))
}

fn holds(is_so: bool) -> &'static str {
    if is_so { "holds" } else { "does not hold" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_falls_as_its_width_over_the_support() {
        for (bar, fall) in BARS.iter().zip(BARS.map(|bar| Form::Undecimated.fall(bar))) {
            for (s, ratio) in HALF_SUPPORTS.iter().zip(fall) {
                let theory = (*bar).min(*s) as f64 / *s as f64;
                let found = ratio.ratio();
                assert!((found - theory).abs() < 1e-9, "bar {bar}, s {s}: {found}, not {theory}");
            }
        }
    }

    #[test]
    fn the_details_of_all_levels_and_the_last_mean_add_up_to_the_row() {
        // Even differences at every level, so that no rounding hides a mistake.
        let row: Vec<u8> = (0..64u8).map(|x| if (20..36).contains(&x) { 164 } else { 36 }).collect();
        let sum: Vec<i16> = (0..64).map(|x| (0..5).map(|level| contours_of_level(&row, level)[x]).sum()).collect();
        let rest: Vec<i16> = sum.iter().zip(&row).map(|(&sum, &value)| i16::from(value) - sum).collect();
        assert!(rest.chunks(32).all(|block| block.iter().all(|&v| v == block[0])), "{rest:?}");
    }

    #[test]
    fn odd_rows_come_back_in_their_length() {
        let row: Vec<u8> = (0..=72).map(|x| x * 3).collect();
        for level in 0..5 {
            assert_eq!(contours_of_level(&row, level).len(), 73, "level {level}");
        }
        assert!(contours_of_level(&[9; 73], 2).iter().all(|&v| v == 0 || v == 9));
    }

    #[test]
    fn the_finest_structure_is_found_where_it_is() {
        let row = raised(BAR_AT, 2);
        let (first, clear) = finest(&row).unwrap();
        assert!((BAR_AT - 1..=BAR_AT).contains(&first) && clear > 50.0, "{first}, {clear}");
        assert!(finest(&[7; 20]).is_none());
    }
}
