//! `haarline rig`: writes, imports and shows rig descriptions.

mod check;
mod correct;
mod import;
mod rectify;

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use comfy_table::{Table, presets};
use haarline_rig::{Derived, Description, template};
use serde_json::json;

use super::print;
use crate::{input::rig_file, output};

/// Arguments of `haarline rig`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Writes a description with comments, to be filled in
    New {
        /// Its name; a file that is there is not replaced
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
    /// Makes a description of calibration files: OpenCV's (YAML, XML, JSON), ROS camera_info, Kalibr, EuRoC, Middlebury,
    /// KITTI
    Import(import::Args),
    /// Fits what is added to disparities (disparity_correction) to recordings of a plane at a known distance
    Correct(Box<correct::Args>),
    /// Holds a rig against its description by a recording: a page with pictures, and what to turn or swap
    Check(Box<check::Args>),
    /// Writes a recording's views as the core rectifies them
    Rectify(Box<rectify::Args>),
    /// Shows a description and what follows from it: depths, their resolution, the field of view
    Show {
        /// The description
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// Prints everything as JSON
        #[arg(long)]
        json: bool,
    },
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        match self.command {
            Command::New { file } => write_new(&file),
            Command::Import(args) => args.run(),
            Command::Correct(args) => args.run(),
            Command::Check(args) => args.run(),
            Command::Rectify(args) => args.run(),
            Command::Show { file, json } => {
                let description = rig_file::read(&file)?;
                let derived = Derived::of(&description);
                print(&if json { to_json(&description, &derived) } else { to_text(&description, &derived) })
            }
        }
    }
}

fn write_new(file: &Path) -> Result<()> {
    let name = file.display();
    output::check_writable("rig new", file)?;
    ensure!(!file.exists(), "rig new {name}: the file is there and is not replaced, give another name");
    output::write(file, template().as_bytes())?;
    print(&format!("in {name}: fill it in, then haarline rig show {name}\n"))
}

fn to_text(rig: &Description, derived: &Derived) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    for (what, value) in rows(rig).into_iter().chain(derived_rows(derived)) {
        table.add_row([what, value]);
    }
    table.trim_fmt() + "\n"
}

fn rows(rig: &Description) -> Vec<(String, String)> {
    let skew = rig.wiring.skew.name();
    let exposure = match rig.exposure_lines {
        0 => "exposed as the first camera thinks right".to_owned(),
        lines => format!("exposed for {lines} lines"),
    };
    let wiring = format!("{}, {} first, skew {skew}", rig.wiring.kind.name(), rig.wiring.first.name());
    let lenses = match rig.cameras {
        Some(_) => import::lens_text(rig).unwrap_or_else(|error| error.to_string()).trim_end().to_owned(),
        None => "left as they are".to_owned(),
    };
    [
        ("wiring", wiring),
        ("size of a view", format!("{} x {} px", rig.width, rig.height)),
        ("frame rate on a board", format!("{} a second, {exposure}", rig.frame_rate_hz)),
        (
            "right view displaced by",
            format!(
                "{} rows, {} columns, roll {} degrees, scale {} %: {} rows wait in a ring",
                rig.row_offset,
                rig.column_offset,
                rig.roll_deg,
                rig.scale_percent,
                rig.plan().map_or(0, |plan| plan.waiting_rows())
            ),
        ),
        ("lenses", lenses),
        ("focal length", format!("{} px", rig.focal_px)),
        (
            "left camera's axis",
            format!("{} px across, {} px down, doffs {} px", rig.middle()[0], rig.middle()[1], rig.doffs),
        ),
        ("baseline", format!("{} mm", rig.baseline_mm)),
        ("search", format!("{} to {} px", rig.min_disparity, rig.max_disparity())),
        ("camera", format!("{} mm over the ground, pitch {} degrees", rig.camera_height_mm, rig.pitch_deg)),
        ("in the way", format!("{} to {} mm over the ground", rig.lowest_mm, rig.highest_mm)),
    ]
    .map(|(what, value)| (what.to_owned(), value))
    .into()
}

fn derived_rows(derived: &Derived) -> Vec<(String, String)> {
    let [across, down] = derived.view_deg;
    let [first, last] = derived.bearings_deg;
    let ground = derived.ground_from_m.map_or_else(|| "not in view".to_owned(), |from| format!("from {from:.2} m on"));
    let mut rows = vec![
        ("field of view".to_owned(), format!("{across:.1} x {down:.1} degrees")),
        ("nearest depth".to_owned(), format!("{:.3} m", derived.nearest_m)),
        ("farthest depth".to_owned(), format!("{:.2} m", derived.farthest_m)),
        ("depth of 1 px".to_owned(), format!("{:.2} m", derived.one_px_m)),
    ];
    for (depth, step) in Derived::DEPTHS_M.into_iter().zip(derived.resolution_m) {
        let value = format!("{step:.3} m for 1 px, {:.4} m for 1/16 px", step / 16.0);
        rows.push((format!("depth resolution at {depth} m"), value));
    }
    rows.push(("ground".to_owned(), format!("seen {ground}")));
    rows.push(("sectors".to_owned(), format!("{}, middles at {first} to {last} degrees", derived.sectors)));
    rows
}

fn to_json(rig: &Description, derived: &Derived) -> String {
    let json = json!({
        "wiring": rig.wiring.kind.name(),
        "first": rig.wiring.first.name(),
        "skew": rig.wiring.skew.name(),
        "width": rig.width,
        "height": rig.height,
        "frame_rate_hz": rig.frame_rate_hz,
        "exposure_lines": rig.exposure_lines,
        "row_offset": rig.row_offset,
        "roll_deg": rig.roll_deg,
        "scale_percent": rig.scale_percent,
        "column_offset": rig.column_offset,
        "cx": rig.middle()[0],
        "cy": rig.middle()[1],
        "doffs": rig.doffs,
        "focal_px": rig.focal_px,
        "baseline_mm": rig.baseline_mm,
        "min_disparity": rig.min_disparity,
        "num_disparities": rig.num_disparities,
        "camera_height_mm": rig.camera_height_mm,
        "pitch_deg": rig.pitch_deg,
        "lowest_mm": rig.lowest_mm,
        "highest_mm": rig.highest_mm,
        "sector_deg": rig.sector_deg,
        "one_px_m": derived.one_px_m,
        "nearest_m": derived.nearest_m,
        "farthest_m": derived.farthest_m,
        "resolution_m": derived.resolution_m,
        "view_deg": derived.view_deg,
        "ground_from_m": derived.ground_from_m,
        "sectors": derived.sectors,
        "bearings_deg": derived.bearings_deg,
    });
    json.to_string() + "\n"
}
