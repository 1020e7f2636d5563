//! Arguments that several commands have in common.

use std::fmt;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use haarline::wiring::{First, Kind, Skew};
use haarline::{Config, ContourSettings, Scales, Wiring};
use haarline_rig::Description;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use super::{number, print, whole_number};
use crate::input::frame::Shrink;
use crate::input::recording::{Layout, Side};
use crate::output;
use crate::output::claims::Claims;
use crate::output::colour_range::ColourRange;
use crate::score::baselines::Baselines;
use crate::score::scene::{self, find_scenes, read_meta};
use crate::score::split::{Half, halves};
use crate::stereo::method::{Method, MethodKind, check_config};
use crate::{Geometry, input::rig_file};

/// The search range.
#[derive(Debug, clap::Args)]
pub(super) struct SearchRange {
    /// How many whole disparities to search, 1 to 256 [default: a quarter of the width, up to a multiple of 16]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole_number)]
    num_disparities: Option<i64>,
    /// Least disparity to search, px, -128 to 128 [default: 0]
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = whole_number)]
    min_disparity: Option<i64>,
}

impl SearchRange {
    /// The configuration for views of `width` px.
    pub(super) fn config(&self, width: u16) -> Result<Config> {
        let default = Config::for_width(width);
        let asked = self.num_disparities.unwrap_or_else(|| default.num_disparities.into());
        let num_disparities = u16::try_from(asked);
        let num_disparities =
            num_disparities.ok().with_context(|| format!("--num-disparities {asked}: must be 1 to 256"))?;
        let asked = self.min_disparity.unwrap_or(0);
        let min_disparity = i16::try_from(asked);
        let min_disparity =
            min_disparity.ok().with_context(|| format!("--min-disparity {asked}: must be -128 to 128 px"))?;
        let config = Config { width, min_disparity, num_disparities };
        check_config(&config, "--num-disparities")?;
        Ok(config)
    }

    /// The same, with the rig's values where nothing was told.
    fn or(&self, rig: &Description) -> Self {
        let num_disparities = self.num_disparities.unwrap_or_else(|| rig.num_disparities.into());
        let min_disparity = self.min_disparity.unwrap_or_else(|| rig.min_disparity.into());
        Self { num_disparities: Some(num_disparities), min_disparity: Some(min_disparity) }
    }
}

/// The rig.
#[derive(Debug, clap::Args)]
pub(super) struct RigArg {
    /// Rig description (see haarline rig new): its search range, focal length, baseline, offsets and, for raw
    /// dumps, wiring hold where no option tells otherwise; obstacles are looked for
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
}

impl RigArg {
    /// Its file, if there is one.
    pub(super) fn path(&self) -> Option<&PathBuf> {
        self.rig.as_ref()
    }

    /// The description, if there is one, with the search range, focal length in px and baseline in mm of the
    /// options where these tell some.
    pub(super) fn read(
        &self,
        search: &SearchRange,
        [focal_px, baseline_mm]: [Option<f64>; 2],
        shrink: Shrink,
    ) -> Result<Option<Description>> {
        let Some(path) = &self.rig else { return Ok(None) };
        let mut rig = rig_file::read(path)?;
        rig.focal_px = focal_px.unwrap_or(rig.focal_px);
        rig = rig_file::shrunk(&rig, shrink);
        let config = search.or(&rig).config(rig.width)?;
        (rig.min_disparity, rig.num_disparities) = (config.min_disparity, config.num_disparities);
        rig.baseline_mm = baseline_mm.unwrap_or(rig.baseline_mm);
        // Refuses what is not positive, in the options' words.
        Geometry::new(rig.focal_px, rig.baseline_mm)?;
        rig.check().with_context(|| path.display().to_string())?;
        Ok(Some(rig))
    }
}

/// What turns disparities into depth.
#[derive(Debug, clap::Args)]
pub(super) struct DepthOptions {
    /// Focal length, px; with --baseline-mm depth is told, too
    #[arg(long, value_name = "F", allow_hyphen_values = true, value_parser = number)]
    focal_px: Option<f64>,
    /// Distance of the two cameras, mm
    #[arg(long, value_name = "B", allow_hyphen_values = true, value_parser = number)]
    baseline_mm: Option<f64>,
    /// Leaves what is farther out of depth images and point clouds, m
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    max_depth: Option<f64>,
    /// Makes one pixel, their mean, of K x K of both views, 1 to 8; focal length and rig are those of the views as
    /// they are and follow, the options of the search mean the small ones
    #[arg(long, value_name = "K", default_value = "1", hide_default_value = true)]
    pub(super) shrink: Shrink,
}

impl DepthOptions {
    /// The rig, with the values of these options where they tell some.
    pub(super) fn rig(&self, rig: &RigArg, search: &SearchRange) -> Result<Option<Description>> {
        rig.read(search, [self.focal_px, self.baseline_mm], self.shrink)
    }

    /// Focal length and baseline, if they are known; `rig` has what the options told already.
    pub(super) fn geometry(&self, rig: Option<&Description>) -> Result<Option<Geometry>> {
        match rig {
            Some(rig) => Geometry::of_rig(rig).map(Some),
            None => {
                let focal_px = self.focal_px.map(|focal_px| focal_px / f64::from(self.shrink.factor()));
                Geometry::from_options(focal_px, self.baseline_mm)
            }
        }
    }

    /// What is farther is left out, m; only where depth is known can it be told.
    pub(super) fn max_depth_m(&self, geometry: Option<&Geometry>) -> Result<Option<f64>> {
        let Some(most) = self.max_depth else { return Ok(None) };
        ensure!(most.is_finite() && most > 0.0, "--max-depth {most}: must be a positive number of m");
        ensure!(geometry.is_some(), "--max-depth {most}: needs --focal-px and --baseline-mm, or --rig");
        Ok(Some(most))
    }
}

/// What the colours of pictures span.
#[derive(Debug, clap::Args)]
pub(super) struct RangeArg {
    /// Disparities that the colours and greys of pictures span, px
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub(super) range: Option<ColourRange>,
}

/// Which method, and its settings.
#[derive(Debug, clap::Args)]
pub(super) struct MethodOptions {
    /// How to match
    #[arg(long, value_enum, default_value_t = MethodKind::BEST)]
    method: MethodKind,
    /// With --method contour: half-support of the Haar wavelet along rows and columns, px, 1 to 16
    /// [default: 2 along rows, 1 along columns]
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = whole_number, conflicts_with = "scales")]
    half_support: Option<i64>,
    /// With --method contour: several half-supports, of whose contours all are matched
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', allow_hyphen_values = true, value_parser = whole_number)]
    scales: Vec<i64>,
}

impl MethodOptions {
    /// The method's name.
    pub(super) fn name(&self) -> &'static str {
        self.method.name()
    }

    /// The method with its settings.
    pub(super) fn get(&self) -> Result<Method> {
        let (option, half_supports) = match self.half_support {
            Some(half_support) => ("--half-support", vec![half_support]),
            None => ("--scales", self.scales.clone()),
        };
        let mut method = Method::from(self.method);
        if half_supports.is_empty() {
            return Ok(method);
        }
        if self.method != MethodKind::Contour {
            bail!("{option}: is for --method contour, not for {}", self.method);
        }
        let mut valid = Vec::new();
        for half_support in half_supports {
            let found = u8::try_from(half_support).ok().filter(|s| (1..=Scales::MAX_HALF_SUPPORT).contains(s));
            valid.push(found.with_context(|| format!("{option} {half_support}: must be 1 to 16 px"))?);
        }
        let scales = Scales::new(&valid)?;
        method.contours = ContourSettings { rows: scales, columns: scales, ..method.contours };
        Ok(method)
    }
}

/// Where a report goes as JSON.
#[derive(Debug, clap::Args)]
pub(super) struct JsonOutput {
    /// Writes everything as JSON; - is the standard output, instead of the tables
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl JsonOutput {
    /// The file, if it does not go to the standard output.
    pub(super) fn file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|path| *path != Path::new("-"))
    }

    /// Delivers the report: as JSON where it was asked for, as text unless that went to the standard output.
    pub(super) fn deliver(&self, json: impl FnOnce() -> Result<String>, text: impl FnOnce() -> String) -> Result<()> {
        match (&self.json, self.file()) {
            (Some(_), None) => return print(&json()?),
            (_, Some(path)) => output::write(path, json()?.as_bytes())?,
            (None, None) => {}
        }
        print(&text())
    }
}

/// The limit below which pixels become unknown.
#[derive(Debug, clap::Args)]
pub(super) struct MinConfidence {
    /// Makes pixels of less confidence unknown, 0 to 255. Unless told, guesses (less than 16) of full and lite are
    #[arg(long, value_name = "C", allow_hyphen_values = true, value_parser = whole_number)]
    min_confidence: Option<i64>,
}

impl MinConfidence {
    /// Least confidence of an answer that is no guess.
    const MEASURED: u8 = 16;

    /// For maps of `method`, or of a chip's method that is not known.
    pub(super) fn get(&self, method: Option<MethodKind>) -> Result<u8> {
        let Some(min_confidence) = self.min_confidence else {
            let has_guesses = method.is_none_or(MethodKind::has_guesses);
            return Ok(if has_guesses { Self::MEASURED } else { 0 });
        };
        u8::try_from(min_confidence)
            .ok()
            .with_context(|| format!("--min-confidence {min_confidence}: must be 0 to 255"))
    }

    /// Whether a limit was told.
    pub(super) const fn is_told(&self) -> bool {
        self.min_confidence.is_some()
    }
}

/// Where the two views are.
#[derive(Debug, clap::Args)]
pub(super) struct LayoutArgs {
    /// How the views are stored
    #[arg(long, value_enum, default_value_t = LayoutKind::Auto)]
    pub(super) layout: LayoutKind,
    /// The left views below the recording's folder, as 'cam_a/*.png'; with --right
    #[arg(id = "left_views", long = "left", value_name = "GLOB", requires = "right_views", conflicts_with = "layout")]
    left: Option<String>,
    /// The right views
    #[arg(id = "right_views", long = "right", value_name = "GLOB", requires = "left_views", conflicts_with = "layout")]
    right: Option<String>,
}

impl LayoutArgs {
    /// The layout; `first` is the camera of the left or upper half, if something tells it.
    pub(super) fn get(&self, first: Option<Side>) -> Result<Layout> {
        match (&self.left, &self.right) {
            (Some(left), Some(right)) => Ok(Layout::Patterns { left: left.clone(), right: right.clone() }),
            _ => layout(self.layout, first),
        }
    }
}

/// How the two views are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum LayoutKind {
    /// Each in a file of its own: folders or names, whichever is found
    Auto,
    /// In two folders: left and right, image_0 and image_1, cam0/data and cam1/data (mav0/...) and the like
    Folders,
    /// In one folder, the camera in each name: left_01 and right_01, l1 and r1, 01_0 and 01_1 and the like
    Names,
    /// Both in each image, side by side; which camera is in the left half must be told
    SideBySide,
    /// Both in each image, one above the other; which camera is in the upper half must be told
    TopBottom,
}

impl LayoutKind {
    /// Whether each image has both views.
    pub(super) const fn has_both(self) -> bool {
        matches!(self, Self::SideBySide | Self::TopBottom)
    }
}

/// The layout; `first` is the camera of the left or upper half, if something tells it.
pub(super) fn layout(kind: LayoutKind, first: Option<Side>) -> Result<Layout> {
    match (kind, first) {
        (LayoutKind::Auto, _) => Ok(Layout::Separate),
        (LayoutKind::Folders, _) => Ok(Layout::Folders),
        (LayoutKind::Names, _) => Ok(Layout::Names),
        (LayoutKind::SideBySide, Some(first)) => Ok(Layout::SideBySide { first }),
        (LayoutKind::TopBottom, Some(first)) => Ok(Layout::TopBottom { first }),
        (LayoutKind::SideBySide, None) => {
            bail!("--layout side-by-side needs --first left or --first right, the camera of the left half")
        }
        (LayoutKind::TopBottom, None) => {
            bail!("--layout top-bottom needs --first left or --first right, the camera of the upper half")
        }
    }
}

/// How two cameras share a port.
#[derive(Debug, clap::Args)]
pub(super) struct WiringArgs {
    /// In which order a raw dump has the pixels of the two cameras
    #[arg(long, value_name = "KIND", value_parser = by_name(Kind::ALL, Kind::name))]
    wiring: Option<Kind>,
    /// Which camera is first: in time, in the left half (in a recording's frames, too), on the low data
    /// lines [default: the rig's; of a raw dump without a rig: left]
    #[arg(long, value_enum, value_name = "CAMERA")]
    pub(super) first: Option<Side>,
    /// Whose pixels come one late; with --wiring pixel only [default: none]
    #[arg(long, value_name = "CAMERA", value_parser = by_name(Skew::ALL, Skew::name))]
    skew: Option<Skew>,
}

impl WiringArgs {
    /// The wiring, if one was told.
    pub(super) fn get(&self) -> Result<Option<Wiring>> {
        let Some(kind) = self.wiring else {
            ensure!(self.skew.is_none(), "--skew: is for raw dumps, with --wiring pixel");
            return Ok(None);
        };
        let skew = self.skew.unwrap_or_default();
        let name = skew.name();
        ensure!(
            kind == Kind::PixelInterleaved || skew == Skew::None,
            "--skew {name}: is for --wiring pixel only, no other one has a skew"
        );
        let first = self.first.map_or(First::Left, |side| match side {
            Side::Left => First::Left,
            Side::Right => First::Right,
        });
        Ok(Some(Wiring { kind, first, skew }))
    }

    /// The first camera, the rig's where nothing was told.
    pub(super) fn first_with(&self, rig: Option<&Description>) -> Option<Side> {
        self.first.or_else(|| {
            rig.map(|rig| match rig.wiring.first {
                First::Left => Side::Left,
                First::Right => Side::Right,
            })
        })
    }

    /// The wiring with the rig's values where nothing was told. One or the other must tell the kind. The rig's
    /// skew goes with its kind: another one has none.
    pub(super) fn get_with(&self, rig: Option<&Description>) -> Result<Wiring> {
        let Some(Wiring { kind, skew, .. }) = rig.map(|rig| rig.wiring) else { return self.get_required() };
        let skew = self.wiring.is_none_or(|asked| asked == kind).then_some(skew);
        let merged = Self { wiring: self.wiring.or(Some(kind)), first: self.first_with(rig), skew: self.skew.or(skew) };
        merged.get_required()
    }

    /// The wiring, which must be told.
    pub(super) fn get_required(&self) -> Result<Wiring> {
        self.get()?.with_context(|| {
            let names: Vec<&str> = Kind::ALL.iter().map(|kind| kind.name()).collect();
            format!("--wiring is missing, the order of the pixels: one of {}", names.join(", "))
        })
    }
}

/// Reads one of `all` by its name.
fn by_name<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let names = all.iter().map(|&value| name(value));
    PossibleValuesParser::new(names).map(move |text| {
        let found = all.iter().find(|&&value| name(value) == text);
        *found.expect("only names of these are possible")
    })
}

/// One line about input that is not as it should be.
pub(super) fn warn_input(what: &str) {
    // Nowhere is left to tell if this fails, too.
    let _ = writeln!(io::stderr(), "warning: {what}");
}

/// One line about a damaged frame.
pub(super) fn warn_skipped(frame: usize, why: &str) {
    // Nowhere is left to tell if this fails, too.
    let _ = writeln!(io::stderr(), "frame {frame} skipped: {why}");
}

/// Which benchmark scenes, and OpenCV's figures on them.
#[derive(Debug, clap::Args)]
pub(super) struct Benchmark {
    /// Folder of scene folders, each with left.png, right.png, truth.png, nonocc.png and meta.json; or
    /// one scene folder
    #[arg(value_name = "SCENES_DIR")]
    pub(super) scenes: PathBuf,
    /// Only these scenes
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    only: Vec<String>,
    /// Only one half of the scenes: in each family they go by name to A, B, B, A, A, B, B, A, ...
    #[arg(long, value_enum, value_name = "A|B")]
    split: Option<Half>,
    /// OpenCV's figures [default: baselines.json in the scenes' folder or in one of the two above it]
    #[arg(long, value_name = "FILE")]
    baselines: Option<PathBuf>,
}

impl Benchmark {
    /// The folders that `--only` names, or all, of the half that `--split` names, or of both.
    pub(super) fn folders(&self) -> Result<Vec<PathBuf>> {
        let folders = scene_folders(&self.scenes, &self.only)?;
        let Some(half) = self.split else { return Ok(folders) };
        // Halved are all scenes, whichever of them are wanted.
        let all = find_scenes(&self.scenes)?;
        let name = |folder: &Path| folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let family = |folder: &Path| read_meta(&folder.join("meta.json")).map(|meta| meta.family);
        let scenes = all.iter().map(|folder| Ok((name(folder), family(folder)?))).collect::<Result<Vec<_>>>()?;
        let inside: Vec<&PathBuf> =
            all.iter().zip(halves(&scenes)).filter(|(_, other)| *other == half).map(|(folder, _)| folder).collect();
        let folders: Vec<PathBuf> = folders.into_iter().filter(|folder| inside.contains(&folder)).collect();
        ensure!(!folders.is_empty(), "--split {half}: none of the scenes is in that half");
        Ok(folders)
    }

    /// OpenCV's figures, if a file is named or found.
    pub(super) fn read_baselines(&self) -> Result<Option<Baselines>> {
        self.baselines_file().map(|path| Baselines::read(&path)).transpose()
    }

    fn baselines_file(&self) -> Option<PathBuf> {
        self.baselines.clone().or_else(|| Baselines::find(&self.scenes))
    }

    /// The scenes in `folders` and OpenCV's figures as files that are read.
    pub(super) fn claims(&self, folders: &[PathBuf]) -> Claims<'static> {
        let mut claims = Claims::new();
        claims.read(self.baselines_file());
        read_scenes(&mut claims, folders);
        claims
    }
}

/// The scenes' files are read.
pub(super) fn read_scenes(claims: &mut Claims<'_>, folders: &[PathBuf]) {
    claims.read(folders.iter().flat_map(|folder| scene::FILES.map(|file| folder.join(file))));
}

/// The folders of the scenes in `scenes` that `only` names, or of all.
pub(super) fn scene_folders(scenes: &Path, only: &[String]) -> Result<Vec<PathBuf>> {
    let folders = find_scenes(scenes)?;
    let name = |folder: &Path| folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    for wanted in only {
        ensure!(
            folders.iter().any(|folder| name(folder) == *wanted),
            "--only: there is no scene {wanted:?} in {}, which has {}",
            scenes.display(),
            list(folders.iter().map(|folder| name(folder)))
        );
    }
    let is_wanted = |folder: &PathBuf| only.is_empty() || only.contains(&name(folder));
    Ok(folders.into_iter().filter(is_wanted).collect())
}

/// The first names, and how many more there are.
fn list(names: impl ExactSizeIterator<Item = String>) -> String {
    const SHOWN: usize = 8;
    let more = names.len().saturating_sub(SHOWN);
    let shown = names.take(SHOWN).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{shown} and {more} more") } else { shown }
}

/// A word as a shell takes it.
pub(super) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/._-,+=:@%".contains(c);
    if word.chars().all(is_plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

/// A bar with rate and time left; shown only where the standard error is a terminal.
pub(super) fn progress(length: usize, what: &str) -> Result<ProgressBar> {
    let style =
        ProgressStyle::with_template("{bar:40} {pos}/{len} {msg}, {rate}, {eta} left")?.with_key("rate", write_rate);
    Ok(ProgressBar::new(length as u64).with_style(style).with_message(what.to_owned()))
}

/// The rate, to one digit after the point.
fn write_rate(state: &ProgressState, text: &mut dyn fmt::Write) {
    // A bar without its rate is still a bar.
    let _ = write!(text, "{:.1}/s", state.per_sec());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_can_be_given_to_a_shell() {
        assert_eq!(quoted("data/qvga"), "data/qvga");
        assert_eq!(quoted("my data"), "'my data'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
    }
}
