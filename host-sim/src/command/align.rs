//! `haarline align`: row offset, roll and scale of a rig from its own frames.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use haarline::align::{Estimate, Order, Verdict};
use haarline_rig::Description;
use serde::Serialize;

use super::shared::{FrameArgs, progress, readable};
use super::{Finding, print};
use crate::StereoPair;
use crate::input::recording::{RecordedFrame, Side};
use crate::output;
use crate::output::claims::Claims;
use crate::rig::align::{self, Displacement};
use crate::rig::align_picture;
use crate::rig::description_file::{DescriptionFile, Field};

/// Frames that are looked at without --frames and --every, spread over the recording.
const USUAL_FRAMES: usize = 40;

/// Arguments of `haarline align`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Folder with the folders left and right; or folder of images with both views (--layout side-by-side); or a
    /// file with the bytes a camera port stored (--raw). Ordinary frames of textured surroundings do
    recording: PathBuf,
    /// Writes a rig description with what was found; one that is there is changed only with --update
    #[arg(short, long = "output", value_name = "RIG.toml")]
    output: Option<PathBuf>,
    /// Changes the description of -o, which must be there; the previous one is kept as RIG.toml.bak. Its wiring and
    /// first camera hold where no option tells otherwise
    #[arg(long, requires = "output")]
    update: bool,
    /// Picture of both views with rows drawn through them, as they came above and aligned below
    #[arg(long, value_name = "FILE.png")]
    picture: Option<PathBuf>,
    #[command(flatten)]
    frames: FrameArgs,
    /// Prints everything as JSON
    #[arg(long)]
    json: bool,
}

/// What is told.
#[derive(Debug, Serialize)]
struct Summary {
    verdict: &'static str,
    order: &'static str,
    frames: usize,
    damaged: usize,
    row_offset: f64,
    roll_deg: f64,
    scale_percent: f64,
    /// Standard errors of the three, if anything was found.
    errors: Option<[f64; 3]>,
    contrast_percent: u32,
    agreement_percent: u32,
    /// Standard deviation of the frames' own row offsets, px.
    spread: f64,
    /// Standard error of the row offset that one such frame has, px.
    frame_error: f64,
    median_disparity: i16,
    ground_percent: i8,
    disparities: [i16; 2],
    evaluations: u32,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        if let Some(path) = &self.picture {
            output::check_png_name("--picture", path)?;
        }
        let file = self.output.as_deref().map(|path| DescriptionFile::open("-o", path, self.update)).transpose()?;
        let frames =
            self.frames.find(&self.recording, file.as_ref().and_then(DescriptionFile::description).as_ref())?;
        self.claim(&frames, file.as_ref())?;
        let frames = self.frames.choose_from(frames, USUAL_FRAMES)?;
        let (frames, damaged, middle) = readable(frames)?;
        if let Some(description) = file.as_ref().and_then(DescriptionFile::description) {
            check_update(&description, &middle)?;
        }
        let bar = progress(align::steps(frames.len()), "frames")?;
        let mut same = BTreeSet::new();
        let estimate = align::align_all([middle.width(), middle.height()], |see| {
            for frame in &frames {
                let pair = frame.read()?;
                if pair.left.luma == pair.right.luma {
                    same.insert(frame.index);
                }
                see(&pair).with_context(|| frame.file.clone())?;
                bar.inc(1);
            }
            Ok(())
        });
        bar.finish_and_clear();
        let estimate = estimate?;
        // Nothing is the same in both views, too.
        ensure!(
            same.is_empty() || estimate.verdict() == Verdict::NotObservable,
            Finding(format!(
                "in {} of {} frames both views are the same image: one camera is read twice",
                same.len(),
                frames.len()
            ))
        );
        let found = Displacement::from(&estimate.ramp);
        let summary = Summary::new(&estimate, &found, frames.len(), damaged);
        if let Some(path) = self.picture.as_ref().filter(|_| estimate.ramp.is_valid()) {
            output::write(path, &align_picture::encode(&middle, &estimate.ramp.into())?)?;
        }
        let refused = refusal(&estimate);
        let mut text = summary.text();
        if let (Some(file), None) = (&file, &refused) {
            let mut fields = fields(&found, &estimate, &middle, file.description().is_none());
            // The offsets are those of the views in this order.
            if let Some(first) = self.frames.first() {
                fields.push(("first", format!("\"{}\"", if first == Side::Left { "left" } else { "right" })));
            }
            let changes = file.write(&fields)?;
            text += &self.written(&changes);
        }
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { text })?;
        match refused {
            Some(words) => Err(Finding(words).into()),
            None => Ok(()),
        }
    }

    /// Refuses to replace what is read, and a picture among the frames: it would be a frame of the next run.
    fn claim(&self, frames: &[RecordedFrame], file: Option<&DescriptionFile>) -> Result<()> {
        let mut claims = Claims::new();
        claims.read_recording(&self.recording, frames.iter().flat_map(RecordedFrame::files));
        self.output.as_ref().map_or(Ok(()), |path| claims.write("-o", path))?;
        file.map_or(Ok(()), |file| file.claim_backup("-o", &mut claims))?;
        self.picture.as_ref().map_or(Ok(()), |path| claims.write_beside("--picture", path))
    }

    fn written(&self, changes: &[String]) -> String {
        let name = self.output.as_deref().unwrap_or_else(|| Path::new("")).display();
        let changed = if changes.is_empty() { "nothing changed".to_owned() } else { changes.join("; ") };
        if self.update {
            format!("in {name} (before: {name}.bak): {changed}\n")
        } else {
            format!("in {name}: {changed}; focal_px, baseline_mm and the mounting are examples still: fill them in\n")
        }
    }
}

/// The fields of a description that tell what was found; a new one has the views' size, too.
fn fields(found: &Displacement, estimate: &Estimate, pair: &StereoPair, is_new: bool) -> Vec<Field> {
    let mut fields = vec![
        ("row_offset", format!("{:.3}", found.rows)),
        ("roll_deg", format!("{:.3}", found.roll_deg)),
        ("scale_percent", format!("{:.3}", found.scale_percent)),
    ];
    if is_new {
        let [least, most] = estimate.disparities.map(i32::from);
        let least = least.min(0).clamp(-128, 0);
        let count = ((most - least + 16) / 16 * 16).clamp(16, (pair.width() as i32).min(256));
        fields.extend([
            ("width", pair.width().to_string()),
            ("height", pair.height().to_string()),
            ("min_disparity", least.to_string()),
            ("num_disparities", count.to_string()),
        ]);
    }
    fields
}

/// Refuses to change the description of another rig, or one in which what is found would be without effect.
fn check_update(description: &Description, pair: &StereoPair) -> Result<()> {
    let (width, height) = (description.width, description.height);
    ensure!(
        (usize::from(width), usize::from(height)) == (pair.width(), pair.height()),
        "--update: its width and height are {width}x{height} px, but the views are {}x{} px",
        pair.width(),
        pair.height()
    );
    ensure!(
        description.cameras.is_none(),
        "--update: its lens tables tell where rows lie, not offsets; haarline rig check tells whether they still do"
    );
    Ok(())
}

/// Why nothing is written, if so.
fn refusal(estimate: &Estimate) -> Option<String> {
    match (estimate.verdict(), estimate.order()) {
        (Verdict::NotObservable, _) if estimate.blocks == 0 || estimate.contrast_percent == 0 => Some(
            "the row offset is not observable: the views have no texture in common within 16 rows; take frames of textured \
             surroundings at one moment, or turn a camera until both views show the same in about the same rows"
                .to_owned(),
        ),
        (Verdict::NotObservable, _) => Some(format!(
            "the row offset is not observable: contrast {} %, where {} % are needed, and blocks differ by {:.3} px, where \
             {:.3} px are allowed; take frames of textured surroundings that are not too near",
            estimate.contrast_percent,
            Estimate::LEAST_CONTRAST_PERCENT,
            f64::from(estimate.frame_error_q16()) / 65_536.0,
            f64::from(Estimate::MOST_FRAME_ERROR_Q16) / 65_536.0,
        )),
        (Verdict::Contradictory, _) => Some(format!(
            "the row offset is contradictory: {}; take both views at one moment (one trigger for both cameras), of things that \
             stand still while the rig moves, or of many scenes",
            align::contradiction(estimate).unwrap_or_default()
        )),
        (Verdict::OutOfRange, _) => Some(
            "the row offset is not within ±16 px, or roll and scale not within ±5: the views show different things, or the \
             cameras must be turned"
                .to_owned(),
        ),
        (Verdict::Observable, Order::Swapped) => {
            Some("the views are swapped: exchange left and right (--first names the other camera)".to_owned())
        }
        (Verdict::Observable, _) => None,
    }
}

impl Summary {
    fn new(estimate: &Estimate, found: &Displacement, frames: usize, damaged: usize) -> Self {
        let [rows, roll, scale] = estimate.errors_q16.map(|q16| f64::from(q16) / 65_536.0);
        Self {
            verdict: align::verdict_name(estimate.verdict()),
            order: align::order_name(estimate.order()),
            frames,
            damaged,
            row_offset: found.rows,
            roll_deg: found.roll_deg,
            scale_percent: found.scale_percent,
            errors: (estimate.blocks > 0).then(|| [rows, roll.to_degrees(), 100.0 * scale]),
            contrast_percent: estimate.contrast_percent,
            agreement_percent: estimate.agreement_percent,
            spread: f64::from(estimate.spread_q16) / 65_536.0,
            frame_error: f64::from(estimate.frame_error_q16()) / 65_536.0,
            median_disparity: estimate.median_disparity,
            ground_percent: estimate.ground_percent,
            disparities: estimate.disparities,
            evaluations: estimate.evaluations,
        }
    }

    fn text(&self) -> String {
        let Self {
            frames,
            row_offset,
            roll_deg,
            scale_percent,
            errors,
            contrast_percent,
            agreement_percent,
            disparities,
            ..
        } = self;
        let frames = if *frames == 1 { "1 frame".to_owned() } else { format!("{frames} frames") };
        let order = match self.order {
            "as given" => "left is left".to_owned(),
            "contradictory" => format!(
                "contradictory: a median disparity of {} px says {}, the ground, nearer below, says {}",
                self.median_disparity,
                side(self.median_disparity > 0),
                side(self.ground_percent > 0)
            ),
            other => other.to_owned(),
        };
        let Some(errors) = errors else { return format!("{frames}: nothing was found that both views show\n") };
        format!(
            "{frames}: the right view lies {row_offset:.2} ± {:.2} rows lower, rolled by {roll_deg:.2} ± {:.2} degrees, {scale_percent:.2} \
             ± {:.2} % higher\nrow offset {}: contrast {contrast_percent} %, agreement {agreement_percent} %\nleft and right: {order}\ndisparities from {} to \
             {} px; the column offset is not observable from such frames\n",
            errors[0], errors[1], errors[2], self.verdict, disparities[0], disparities[1],
        )
    }
}

fn side(is_as_given: bool) -> &'static str {
    if is_as_given { "as given" } else { "swapped" }
}
