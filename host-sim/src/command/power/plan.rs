//! `haarline power plan`: whether a method keeps up, at which clock, and what that takes, before there is a board.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Result, ensure};

use super::super::shared::{SearchRange, quoted, warn_input};
use super::super::{number, print};
use crate::input::raw_dump::ViewSize;
use crate::output;
use crate::output::claims::Claims;
use crate::power::plan::accuracy::Accuracy;
use crate::power::plan::budget::{Battery, Instead, MODEL, Plan, Planner, Point, Request, Smaller};
use crate::power::plan::cost::Costs;
use crate::power::plan::currents::{Board, Currents, SensorModel};
use crate::power::plan::{comparison, counts, joules};
use crate::score::report;
use crate::stereo::method::MethodKind;
use crate::study::page::{document, parts};
use crate::study::{Part, Table};
use crate::twin::cycles::Range;

/// Arguments of `haarline power plan`.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct Args {
    /// The board; f407 is planned only, there is no program for it
    #[arg(long, value_enum, required_unless_present_any = ["all", "table_1"])]
    board: Option<Board>,
    /// Size of a view, px, 64 to 320 wide
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "320x240")]
    size: ViewSize,
    /// Frames a second
    #[arg(long, value_name = "F", default_value_t = 30.0, allow_hyphen_values = true, value_parser = number)]
    fps: f64,
    /// How to match
    #[arg(long, value_enum, default_value_t = MethodKind::BEST)]
    method: MethodKind,
    #[command(flatten)]
    search: SearchRange,
    /// The two sensors; none plans for the core alone
    #[arg(long, value_enum, default_value_t = SensorPair::Mt9v034)]
    sensor: SensorPair,
    /// The rig's exposure_lines, a fixed integration: with it two MT9V034 are in standby between frames; else they are always on
    #[arg(long, value_name = "LINES", value_parser = clap::value_parser!(u16).range(1..))]
    exposure_lines: Option<u16>,
    /// Charge of the battery, mAh, for the hours
    #[arg(long, value_name = "mAh", allow_hyphen_values = true, value_parser = charge, requires = "volts")]
    battery: Option<f64>,
    /// Mean voltage of the battery, V
    #[arg(long, value_name = "V", allow_hyphen_values = true, value_parser = number, requires = "battery")]
    volts: Option<f64>,
    /// Currents of your own in the place of the project's: a file like host-sim/src/power/plan/currents.toml
    #[arg(long, value_name = "FILE.toml")]
    currents: Option<PathBuf>,
    /// Counts of your own in the place of the stored ones, as haarline power count makes them
    #[arg(long, value_name = "FILE.csv")]
    counts: Option<PathBuf>,
    /// All methods on all boards, or on the one that is named, in one table with accuracy beside
    #[arg(long, conflicts_with = "method")]
    all: bool,
    /// The paper's Table 1 in joules, as Markdown
    #[arg(long, conflicts_with_all = ["all", "board", "method", "json", "output", "battery"])]
    table_1: bool,
    /// A page with the table and a plot
    #[arg(short, long = "output", value_name = "FILE.html", requires = "all")]
    output: Option<PathBuf>,
    /// Prints everything as JSON
    #[arg(long)]
    json: bool,
}

/// Which sensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum SensorPair {
    /// Two MT9V034
    Mt9v034,
    /// Two HM01B0
    Hm01b0,
    /// Somebody else's power
    None,
}

/// A charge with or without its unit.
fn charge(text: &str) -> Result<f64, &'static str> {
    let value = text.strip_suffix("mAh").unwrap_or(text).trim().parse::<f64>();
    value.ok().filter(|&value| value > 0.0 && value.is_finite()).ok_or("must be a charge in mAh, as 1000mAh")
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        self.check()?;
        let mut claims = Claims::new();
        claims.read(self.currents.iter().chain(&self.counts));
        self.output.as_ref().map_or(Ok(()), |path| claims.write("-o", path))?;
        let currents = self.currents.as_deref().map_or_else(Currents::own, Currents::read)?;
        let costs = match &self.counts {
            Some(path) => Costs::fit(&counts::read(path)?)?,
            None => Costs::stored()?,
        };
        let planner = Planner { costs: &costs, currents: &currents };
        let request = self.request()?;
        if self.table_1 {
            return print(&joules::markdown(&planner, &Accuracy::stored()?, &request)?);
        }
        if self.all {
            return self.compare(&planner, &request);
        }
        let plan = planner.plan(&request)?;
        print(&if self.json { serde_json::to_string(&plan)? + "\n" } else { text(&plan) })?;
        warn(plan.not_verified);
        Ok(())
    }

    fn check(&self) -> Result<()> {
        let positive = [("--fps", Some(self.fps), 1e4), ("--volts", self.volts, 60.0)];
        for (option, value, most) in positive {
            let is_right = value.is_none_or(|value| value > 0.0 && value <= most);
            ensure!(is_right, "{option} {}: must be more than 0, and {most} at most", value.unwrap_or_default());
        }
        ensure!(
            self.exposure_lines.is_none() || self.sensor == SensorPair::Mt9v034,
            "--exposure-lines: these sensors have no standby between frames, leave it out"
        );
        let is_page = self.output.as_ref().is_none_or(|path| path.extension().is_some_and(|suffix| suffix == "html"));
        ensure!(is_page, "-o {}: the name must end in .html", self.output.clone().unwrap_or_default().display());
        Ok(())
    }

    fn request(&self) -> Result<Request> {
        let ViewSize { width, height } = self.size;
        Ok(Request {
            board: self.board.unwrap_or(Board::H743),
            method: self.method,
            width,
            height,
            disparities: self.search.config(width)?.num_disparities,
            fps: self.fps,
            sensor: match self.sensor {
                SensorPair::Mt9v034 => Some(SensorModel::Mt9v034),
                SensorPair::Hm01b0 => Some(SensorModel::Hm01b0),
                SensorPair::None => None,
            },
            exposure_lines: self.exposure_lines,
            battery: self.battery.zip(self.volts).map(|(mah, volts)| Battery { mah, volts }),
        })
    }

    fn compare(&self, planner: &Planner<'_>, request: &Request) -> Result<()> {
        let boards = self.board.map_or_else(|| vec![Board::H743, Board::U575, Board::F407], |board| vec![board]);
        let plans = comparison::plans(planner, &boards, request)?;
        let accuracy = Accuracy::stored()?;
        let table = comparison::table(&plans, &accuracy);
        let mut sources: Vec<&str> = plans.iter().flat_map(|plan| &plan.sources).map(String::as_str).collect();
        sources.sort_unstable();
        sources.dedup();
        let marked = sources.iter().filter(|source| source.contains("not verified")).count();
        if let Some(path) = &self.output {
            let plot = comparison::plot(planner, &plans, &accuracy)?;
            let rests = Table {
                name: "sources".to_owned(),
                caption: "What the figures rest on.".to_owned(),
                columns: vec!["figure and source".to_owned()],
                rows: sources.iter().map(|&source| vec![source.to_owned()]).collect(),
            };
            let content = [Part::Table(table.clone()), Part::Plot(plot), Part::Table(rests)];
            let body = maud::html! {
                dl {
                    dt { "made by" } dd { code { (self.command_line()) } }
                    dt { "version" } dd { "haarline " (env!("CARGO_PKG_VERSION")) }
                }
                (parts(&content))
            };
            output::write(path, document("Power budget", &body).as_bytes())?;
        }
        if self.json {
            print(&(serde_json::to_string(&plans)? + "\n"))?;
        } else {
            let mut printed = report::table(table.columns.clone(), table.word_columns());
            printed.add_rows(table.rows.clone());
            let rests = sources.join("\n  ");
            print(&format!("{}\n\n{}\n\nrests on:\n  {rests}\n", table.caption, printed.trim_fmt()))?;
        }
        warn(marked);
        Ok(())
    }

    fn command_line(&self) -> String {
        let ViewSize { width, height } = self.size;
        let mut line = format!("haarline power plan --all --size {width}x{height} --fps {}", self.fps);
        if let Some(board) = self.board {
            line += &format!(" --board {}", board.name());
        }
        if let Some(lines) = self.exposure_lines {
            line += &format!(" --exposure-lines {lines}");
        }
        if let Some((mah, volts)) = self.battery.zip(self.volts) {
            line += &format!(" --battery {mah}mAh --volts {volts}");
        }
        let files = [("--currents", &self.currents), ("--counts", &self.counts), ("-o", &self.output)];
        for (option, path) in files.into_iter().filter_map(|(option, path)| Some((option, path.as_deref()?))) {
            line += &format!(" {option} {}", quoted(&path.to_string_lossy()));
        }
        line
    }
}

fn warn(not_verified: usize) {
    if not_verified > 0 {
        warn_input(&format!(
            "{not_verified} figures that this rests on are not verified; --currents takes those of your data sheets or your meter"
        ));
    }
}

fn range(Range { least, likely, most }: Range, digits: usize) -> String {
    format!("{likely:.digits$} ({least:.digits$} to {most:.digits$})")
}

fn text(plan: &Plan) -> String {
    let Plan { chip, core, method, width, height, disparities, fps, .. } = plan;
    let mut text = format!(
        "{method}, {width}x{height} px, {disparities} disparities, {fps} frames a second, on {chip} ({core}): {MODEL}\n"
    );
    let inputs = &plan.instructions_per_pixel;
    let _ = writeln!(
        text,
        "instructions a pixel: clean {:.1}, noisy {:.1}, random {:.1}, of which packets {:.1}",
        inputs.clean.mean.all(),
        inputs.noisy.mean.all(),
        inputs.random.mean.all(),
        inputs.clean.mean.packets
    );
    let _ = writeln!(text, "cycles a pixel, all that the program does with it: {}", range(plan.cycles_per_pixel, 0));
    for (nth, Point { name, mhz, busy_percent, busy_noisy_percent, core_mw, fits, .. }) in
        plan.points.iter().enumerate()
    {
        let verdict = match (fits, plan.chosen == Some(nth)) {
            (_, true) => "chosen: the least that keeps up",
            (true, _) => "keeps up",
            (false, _) => "too slow",
        };
        let _ = writeln!(
            text,
            "  {mhz:>4} MHz, {name:<8} busy {} %, noisy {busy_noisy_percent:.0} %; core {} mW; {verdict}",
            range(*busy_percent, 0),
            range(*core_mw, 1)
        );
    }
    if let (Some(budget), Some(nth)) = (&plan.budget, plan.chosen) {
        if !plan.is_sure {
            text.push_str(
                "not sure: with the most of any input and of the model of cycles it would be too slow at that clock\n",
            );
        }
        let mut sensors = format!("{:.1} mW", budget.sensors_mw);
        if budget.standby_percent > 0.0 {
            sensors += &format!(", in standby for {:.0} % of the time", budget.standby_percent);
        }
        for (name, value) in [
            ("core", range(budget.core_mw, 1) + " mW"),
            ("sensors", sensors),
            ("supply", range(budget.supply_mw, 1) + " mW"),
            ("total", range(budget.total_mw, 1) + " mW"),
        ] {
            let _ = writeln!(text, "{name:<8} {value}");
        }
        let _ = writeln!(text, "core     {} nJ a pixel", range(plan.points[nth].nj_per_pixel, 2));
        let _ = writeln!(text, "total    {:.1} frames a joule", budget.frames_per_joule);
        if let Some(hours) = budget.hours {
            let _ = writeln!(text, "battery  {} hours", range(hours, 1));
        }
    }
    if let Some(instead) = &plan.instead {
        text += &unfit(instead);
    }
    text.push_str("rests on:\n");
    for source in &plan.sources {
        let _ = writeln!(text, "  {source}");
    }
    text
}

/// By how much it does not fit, and what would.
fn unfit(instead: &Instead) -> String {
    let Instead { over, fps, smaller, methods, boards } = instead;
    let text = format!("does not fit: needs {over:.3} times the time that there is\nwould fit: ");
    let mut ways = vec![format!("--fps {}", floor(*fps))];
    ways.extend(smaller.map(|Smaller { width, height, disparities }| {
        format!("--size {width}x{height} --num-disparities {disparities}")
    }));
    ways.extend((!methods.is_empty()).then(|| format!("--method {}", methods.join(", "))));
    ways.extend((!boards.is_empty()).then(|| format!("--board {}", boards.join(", "))));
    text + &ways.join("; or ") + "\n"
}

/// A rate that still fits, to two digits.
fn floor(fps: f64) -> f64 {
    let unit = 10f64.powf(fps.log10().floor() - 1.0);
    ((fps / unit).floor() * unit * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_charge_has_its_unit_or_none() {
        assert_eq!(charge("1000mAh"), Ok(1000.0));
        assert_eq!(charge("850"), Ok(850.0));
        for wrong in ["1Ah", "-3", "0", "x", "inf"] {
            assert!(charge(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_rate_is_told_so_that_it_fits() {
        assert_eq!([floor(13.79), floor(9.99), floor(0.123)], [13.0, 9.9, 0.12]);
    }
}
