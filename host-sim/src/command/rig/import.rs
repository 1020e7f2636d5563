//! `haarline rig import`: calibration files in, a rig description out.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use haarline::Config;
use haarline_rig::{CameraModel, Description, Lens};

use super::super::{number, print, whole_number};
use crate::input::raw_dump::ViewSize;
use crate::input::rig_file;
use crate::output::claims::Claims;
use crate::rig::description_file::{DescriptionFile, Field};
use crate::rig::import::{self, Imported, Options};

/// Arguments of `haarline rig import`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// One file, or two: of a pair the left camera's first
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// The description to write; one that is there is changed only with --update
    #[arg(short, long = "output", value_name = "RIG.toml")]
    output: PathBuf,
    /// Changes the description of -o, which must be there; the previous one is kept as RIG.toml.bak
    #[arg(long)]
    update: bool,
    /// Size of the calibrated pictures, where the file does not tell it
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Option<ViewSize>,
    /// The frames are so many times smaller than the calibrated pictures, by averages
    #[arg(long, value_name = "K", default_value_t = 1, allow_hyphen_values = true, value_parser = whole_number)]
    shrink: i64,
    /// The frames are rectified already, by the projections that the file tells (P1 and P2, projection_matrix)
    #[arg(long)]
    rectified: bool,
    /// Millimetres of the file's unit of length, where that is none of m and mm: the side of a chessboard's square
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = number)]
    unit_mm: Option<f64>,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let shrink = u32::try_from(self.shrink).ok().filter(|shrink| (1..=16).contains(shrink));
        let shrink = shrink.with_context(|| format!("--shrink {}: must be 1 to 16", self.shrink))?;
        if let Some(unit) = self.unit_mm {
            ensure!(unit.is_finite() && unit > 0.0, "--unit-mm {unit}: must be a positive number");
        }
        let options = Options {
            size: self.size.map(|size| [size.width.into(), size.height.into()]),
            unit_mm: self.unit_mm,
            shrink,
            is_rectified: self.rectified,
        };
        let mut claims = Claims::new();
        claims.read(&self.files);
        claims.write("-o", &self.output)?;
        let file = DescriptionFile::open("-o", &self.output, self.update)?;
        file.claim_backup("-o", &mut claims)?;
        let imported = import::import(&self.files, &options)?;
        let changes = file.write(&fields(&imported, file.description().as_ref())?)?;
        let description = rig_file::read(&self.output)?;
        print(&text(&imported, &description, &self.output.display().to_string(), self.update, &changes)?)
    }
}

fn fields(imported: &Imported, before: Option<&Description>) -> Result<Vec<Field>> {
    let Imported { size, rig, baseline_mm, .. } = imported;
    let width = u16::try_from(size[0]).ok().filter(|width| (Config::MIN_WIDTH..=Config::MAX_WIDTH).contains(width));
    let width = width.with_context(|| {
        format!("views of {}x{} px are not supported, 32 to 1280 px are wide: give --shrink", size[0], size[1])
    })?;
    let mut fields = vec![
        ("width", width.to_string()),
        ("height", size[1].to_string()),
        ("row_offset", format!("{:.3}", rig.row_offset)),
        ("roll_deg", format!("{:.4}", rig.roll_deg)),
        ("scale_percent", format!("{:.3}", rig.scale_percent)),
        ("column_offset", rig.column_offset.to_string()),
        ("focal_px", format!("{:.3}", rig.focal_px)),
        ("cx", format!("{:.3}", rig.axis[0])),
        ("cy", format!("{:.3}", rig.axis[1])),
        ("doffs", format!("{:.3}", rig.doffs)),
        ("baseline_mm", format!("{baseline_mm:.3}")),
    ];
    match &imported.cameras {
        Some(cameras) => fields.extend(camera_fields(cameras)),
        None => ensure!(
            before.is_none_or(|before| before.cameras.is_none()),
            "the description of -o has lenses and the calibration needs none: write a new one"
        ),
    }
    if before.is_none() {
        fields.push(("num_disparities", Config::for_width(width).num_disparities.to_string()));
    }
    Ok(fields)
}

fn camera_fields(cameras: &[CameraModel; 2]) -> Vec<Field> {
    let numbers =
        |values: &[f64]| format!("[{}]", values.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(", "));
    // The right one's is of the same model.
    let model = match cameras[0].lens {
        Lens::Radial(_) => "radtan",
        Lens::Equidistant(_) => "equidistant",
    };
    let mut fields = vec![("lens", format!("\"{model}\""))];
    let names = [["left_camera", "left_lens", "left_turn"], ["right_camera", "right_lens", "right_turn"]];
    for (names, camera) in names.into_iter().zip(cameras) {
        let bent = match &camera.lens {
            Lens::Radial(of) => numbers(of),
            Lens::Equidistant(of) => numbers(of),
        };
        fields.extend([(names[0], numbers(&camera.intrinsics)), (names[1], bent), (names[2], numbers(&camera.turn))]);
    }
    fields
}

/// What lens tables need and how good they are.
pub(super) fn lens_text(rig: &Description) -> Result<String> {
    let [fit, inside] = rig.lens_fit().context("no lenses")?;
    let rows = rig.plan()?.waiting_rows();
    Ok(format!(
        "{rows} rows of both views wait in a ring ({:.1} KB), tables at most {fit:.2} px off, {inside:.1} % of the views seen\n",
        (rows * usize::from(rig.width)) as f64 / 1024.0
    ))
}

fn text(
    imported: &Imported,
    description: &Description,
    name: &str,
    is_update: bool,
    changes: &[String],
) -> Result<String> {
    let Imported { kind, calibrated_size, shrink, size, rig, baseline_mm, is_rectified, cameras } = imported;
    let mut text = format!(
        "{kind}: {}x{} px, focal length {:.2} px, cameras {baseline_mm:.2} mm apart\n",
        size[0], size[1], rig.focal_px
    );
    let cut = calibrated_size.map(|px| px % shrink);
    if cut != [0; 2] {
        text += &format!(
            "of {}x{} px, {} columns on the right and {} rows at the bottom fill no pixel and fall away, as depth --shrink leaves \
             them out; for frames that are scaled without this cut the rig is wrong\n",
            calibrated_size[0], calibrated_size[1], cut[0], cut[1]
        );
    }
    if *is_rectified {
        text += &format!("for rectified frames; doffs {:.3} px\n", rig.doffs);
    } else if cameras.is_some() {
        text += &format!(
            "for frames as they come off the cameras, by lens tables: offsets alone would leave rows {:.2} px (greatest {:.2}), \
             disparities {:.2} px (greatest {:.2}) wrong\n",
            rig.row_residual[0], rig.row_residual[1], rig.column_residual[0], rig.column_residual[1]
        );
        text += &lens_text(description)?;
    } else {
        text += &format!(
            "for frames as they come off the cameras: the right view lies {:.2} rows lower, rolled by {:.2} degrees, {:.2} % higher, \
             {} columns too far right\n",
            rig.row_offset, rig.roll_deg, rig.scale_percent, rig.column_offset
        );
        text += &format!(
            "what lenses and turns leave: rows {:.2} px (greatest {:.2}), disparities {:.2} px (greatest {:.2})\n",
            rig.row_residual[0], rig.row_residual[1], rig.column_residual[0], rig.column_residual[1]
        );
    }
    let changed = if changes.is_empty() { "nothing changed".to_owned() } else { changes.join("; ") };
    let before = if is_update { format!(" (before: {name}.bak)") } else { String::new() };
    let rest = if is_update { "" } else { "; the mounting is an example still: fill it in" };
    Ok(text + &format!("in {name}{before}: {changed}{rest}\n"))
}
