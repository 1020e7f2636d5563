//! `haarline rig check`: whether a rig is as its description says, by what it sees.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use haarline::Config;
use haarline_rig::Description;
use serde::Serialize;

use super::super::shared::{FrameArgs, MethodOptions, progress, quoted, readable};
use super::super::{Finding, print};
use crate::input::recording::RecordedFrame;
use crate::input::rig_file;
use crate::output::claims::Claims;
use crate::output::colour_range::ColourRange;
use crate::output::{self, picture};
use crate::rig::align::{Displacement, Parts, align_parts, order_name, steps, verdict_name};
use crate::rig::align_picture;
use crate::rig::check::{Advice, Checked, Seen};
use crate::rig::check_page::{Picture, page};
use crate::stereo::pipeline;
use crate::study::Table;
use crate::{DisparityMap, Geometry, StereoPair};

/// Frames that are looked at without --frames and --every, spread over the recording.
const USUAL_FRAMES: usize = 20;
/// So many px below the description's search are searched, too: where things farther than infinity show.
const BELOW: i16 = 16;

/// Arguments of `haarline rig check`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// A recording of textured surroundings, as the rig's cameras took it; best with something far away in it
    recording: PathBuf,
    /// Description of the rig
    #[arg(long, value_name = "FILE")]
    rig: PathBuf,
    /// Where the page goes
    #[arg(short, long = "output", value_name = "FILE.html", default_value = "rig-check.html")]
    output: PathBuf,
    #[command(flatten)]
    frames: FrameArgs,
    #[command(flatten)]
    method: MethodOptions,
    /// Prints everything as JSON
    #[arg(long)]
    json: bool,
}

/// What is told.
#[derive(Debug, Serialize)]
struct Summary {
    frames: usize,
    damaged: usize,
    /// Whether the row error is known.
    verdict: &'static str,
    order: &'static str,
    /// Of the rectified views, the right one against the left one: px, degrees, percent.
    row_error: f64,
    roll_deg: f64,
    scale_percent: f64,
    /// Standard error of the row error, px.
    error: f64,
    worst_row_error: f64,
    worst_bend: f64,
    rows_by_part: Parts,
    sure_percent: Option<f64>,
    sure_by_part: Parts,
    agreement_percent: Option<f64>,
    agreement_by_part: Parts,
    /// Frames that are no stereo pair.
    not_ok_frames: usize,
    /// Disparity of the farthest things, px; 0 is infinity. And their depth by the description, m.
    far_px: Option<f64>,
    far_m: Option<f64>,
    advice: Vec<Advice>,
    page: String,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let name = self.output.display();
        let is_page = self.output.extension().is_some_and(|suffix| suffix == "html");
        ensure!(is_page, "-o {name}: the name must end in .html");
        let rig = rig_file::read(&self.rig)?;
        let geometry = Geometry::of_rig(&rig)?;
        let rectification = rig.rectification()?;
        let frames = self.frames.choose(&self.recording, Some(&rig), USUAL_FRAMES)?;
        let mut claims = Claims::new();
        claims.read([&self.rig]);
        claims.read_recording(&self.recording, frames.iter().flat_map(RecordedFrame::files));
        claims.write("-o", &self.output)?;
        let (frames, damaged, middle) = readable(frames)?;
        let size = [middle.width(), middle.height()];
        rig_file::check_size(&rig, size)?;
        let config = wider(rig.config());
        let mut method = self.method.get()?.build(config)?;
        let mut seen = Seen::new(size, config.min_disparity, config.num_disparities);
        let bar = progress(steps(frames.len()) + frames.len(), "frames")?;
        let (estimate, rows) = align_parts(size, |see| {
            for frame in &frames {
                let views = pipeline::rectified_views(&rectification, &frame.read()?)?;
                see(&views).with_context(|| frame.file.clone())?;
                bar.inc(1);
            }
            Ok(())
        })?;
        let mut map = None;
        for (nth, frame) in frames.iter().enumerate() {
            let made = seen.add(&mut *method, &rectification, &frame.read()?).with_context(|| frame.file.clone())?;
            map = map.filter(|_| nth != frames.len() / 2).or(Some(made));
            bar.inc(1);
        }
        bar.finish_and_clear();
        let checked = Checked {
            seen,
            estimate,
            rows,
            focal_px: rig.focal_px,
            doffs: geometry.doffs,
            has_lenses: rig.cameras.is_some(),
        };
        let summary = Summary::new(&checked, &rig, damaged, self.output.display().to_string());
        let pictures =
            pictures(&middle, &rectification, &map.unwrap_or_else(|| DisparityMap::with_capacity(0, 0)), &geometry)?;
        let title = format!("Rig check: {}", self.recording.display());
        let made = page(&title, &self.command_line(), size, &checked, summary.table(), &pictures)?;
        output::write(&self.output, made.as_bytes())?;
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.text() })?;
        match summary.advice.len() {
            0 => Ok(()),
            1 => Err(Finding("one thing is not as it should be".to_owned()).into()),
            count => Err(Finding(format!("{count} things are not as they should be")).into()),
        }
    }

    fn command_line(&self) -> String {
        let word = |path: &PathBuf| quoted(&path.to_string_lossy());
        format!("haarline rig check {} --rig {} -o {}", word(&self.recording), word(&self.rig), word(&self.output))
    }
}

/// A search that begins lower, as far as there is room.
fn wider(config: Config) -> Config {
    let below = BELOW.min(config.min_disparity + Config::MAX_MIN_DISPARITY);
    let count = config.num_disparities.saturating_add_signed(below);
    let most = Config::MAX_DISPARITIES.min(config.width);
    let (min_disparity, num_disparities) = (config.min_disparity - below, count.min(most));
    Config { min_disparity, num_disparities, ..config }
}

fn pictures(
    pair: &StereoPair,
    rectification: &haarline::Rectification,
    map: &DisparityMap,
    geometry: &Geometry,
) -> Result<Vec<Picture>> {
    let range = ColourRange::of(map);
    Ok(vec![
        Picture {
            caption: "A frame in the middle: both views as they came above, rectified below. The same things must lie on the same line below.".to_owned(),
            png: align_picture::encode(pair, rectification)?,
        },
        Picture {
            caption: "Its disparities; what is not sure is dim.".to_owned(),
            png: picture::encode(map, &range, Some(geometry), None)?,
        },
    ])
}

impl Summary {
    fn new(checked: &Checked, rig: &Description, damaged: usize, page: String) -> Self {
        let round = |value: f64| (value * 1000.0).round() / 1000.0;
        let parts = |parts: Parts| parts.map(|row| row.map(|value| value.map(round)));
        let Displacement { rows, roll_deg, scale_percent } = checked.displacement();
        let far_px = checked.far_px().map(round);
        let depth = |px: f64| round(rig.focal_px * rig.baseline_mm / px / 1000.0);
        Self {
            frames: checked.seen.frames,
            damaged,
            verdict: verdict_name(checked.estimate.verdict()),
            order: order_name(checked.estimate.order()),
            row_error: round(rows),
            roll_deg: round(roll_deg),
            scale_percent: round(scale_percent),
            error: round(f64::from(checked.estimate.errors_q16[0]) / 65_536.0),
            worst_row_error: round(checked.worst_ramp()),
            worst_bend: round(checked.worst_bend()),
            rows_by_part: parts(checked.rows),
            sure_percent: checked.seen.sure.whole().map(round),
            sure_by_part: parts(checked.seen.sure.parts()),
            agreement_percent: checked.seen.agreement.whole().map(round),
            agreement_by_part: parts(checked.seen.agreement.parts()),
            not_ok_frames: checked.seen.inputs.len(),
            far_px,
            far_m: far_px.filter(|&px| px > 0.1).map(depth),
            advice: checked.advice(),
            page,
        }
    }

    /// Names and values.
    fn rows(&self) -> Vec<(&'static str, String)> {
        let share = |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |share| format!("{share:.1} %"));
        let rows = if self.verdict == "observable" {
            format!(
                "{:+.3} px (± {:.3}), roll {:+.3} degrees, scale {:+.3} %; at most {:.2} px, {:.2} px more in parts of the view",
                self.row_error, self.error, self.roll_deg, self.scale_percent, self.worst_row_error, self.worst_bend
            )
        } else {
            self.verdict.to_owned()
        };
        let far = match (self.far_px, self.far_m) {
            (Some(px), Some(m)) => format!(
                "{px:.2} px, {m:.1} m by the description; if it is much farther, column_offset is wrong by as much"
            ),
            (Some(px), None) => format!("{px:.2} px, where infinity is 0"),
            _ => "not observable".to_owned(),
        };
        vec![
            ("frames", format!("{}, {} damaged, {} not ok as a whole", self.frames, self.damaged, self.not_ok_frames)),
            ("row error behind the description", rows),
            ("left and right", self.order.to_owned()),
            ("sure answers", share(self.sure_percent)),
            ("left-right agreement of these", share(self.agreement_percent)),
            ("the farthest that was seen", far),
        ]
    }

    fn table(&self) -> Table {
        Table {
            name: "figures".to_owned(),
            caption: "What the recording says.".to_owned(),
            columns: ["what", "found"].map(str::to_owned).into(),
            rows: self.rows().into_iter().map(|(what, found)| vec![what.to_owned(), found]).collect(),
        }
    }

    fn text(&self) -> String {
        let mut text: String = self.rows().iter().map(|(what, found)| format!("{what}: {found}\n")).collect();
        for Advice { finding, to_do } in &self.advice {
            text += &format!("- {finding}: {to_do}\n");
        }
        if self.advice.is_empty() {
            text += "nothing to turn, swap or calibrate was found\n";
        }
        text + &format!("pictures: {}\n", self.page)
    }
}
