//! `haarline bench`: how long the methods take on this machine, in turn with OpenCV's.

mod opencv;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::Result;
use serde::Serialize;

use self::opencv::OpenCv;
use super::print;
use super::shared::SearchRange;
use crate::StereoPair;
use crate::stereo::method::MethodKind;
use crate::stereo::pipeline;

/// Arguments of `haarline bench`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Left view
    left: PathBuf,
    /// Right view
    right: PathBuf,
    #[command(flatten)]
    search: SearchRange,
    /// Methods to time
    #[arg(long, value_enum, value_name = "A,B,...", value_delimiter = ',', default_values_t = [MethodKind::Full, MethodKind::Lite, MethodKind::Block, MethodKind::Sgm])]
    methods: Vec<MethodKind>,
    /// Times OpenCV's StereoBM and StereoSGBM in turn with them, one thread each; needs python3 with
    /// opencv-python-headless
    #[arg(long)]
    against_opencv: bool,
    /// Rounds, in each of which every method runs once
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Prints everything as JSON
    #[arg(long)]
    json: bool,
}

/// What is told.
#[derive(Debug, Serialize)]
struct Summary {
    width: usize,
    height: usize,
    min_disparity: i16,
    num_disparities: u16,
    rounds: u32,
    /// OpenCV's version, where it ran.
    opencv: Option<String>,
    methods: Vec<Timing>,
    ratios: Vec<Ratio>,
}

/// Milliseconds of a method.
#[derive(Debug, Serialize)]
struct Timing {
    method: String,
    least_ms: f64,
    median_ms: f64,
}

/// How many times as long OpenCV's method takes as ours, by the least and by the median times.
#[derive(Debug, Serialize)]
struct Ratio {
    opencv: String,
    method: String,
    least: f64,
    median: f64,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let pair = StereoPair::read(&self.left, &self.right)?;
        let config = self.search.config(u16::try_from(pair.width())?)?;
        let mut ours = self.methods.iter().map(|kind| Ok((kind, kind.build(config)?))).collect::<Result<Vec<_>>>()?;
        let mut opencv = if self.against_opencv { Some(OpenCv::start(&pair, &config)?) } else { None };
        let theirs = if opencv.is_some() { &opencv::METHODS[..] } else { &[] };
        let mut times = vec![Vec::new(); ours.len() + theirs.len()];
        // The first round fills the caches and does not count.
        for round in 0..=self.rounds {
            let mut keep = |nth: usize, elapsed: Duration| {
                if round > 0 {
                    times[nth].push(elapsed.as_secs_f64() * 1e3);
                }
            };
            for (nth, (_, method)) in ours.iter_mut().enumerate() {
                keep(nth, pipeline::run(&mut **method, &pair)?.elapsed);
            }
            if let Some(opencv) = &mut opencv {
                for (nth, name) in theirs.iter().enumerate() {
                    keep(self.methods.len() + nth, opencv.time(name)?);
                }
            }
        }
        let names = self.methods.iter().map(|kind| kind.name()).chain(theirs.iter().copied());
        let methods: Vec<_> = names.zip(times).map(|(name, times)| Timing::of(name, times)).collect();
        let (ours, theirs) = methods.split_at(self.methods.len());
        let ratio = |theirs: &Timing, ours: &Timing| Ratio {
            opencv: theirs.method.clone(),
            method: ours.method.clone(),
            least: theirs.least_ms / ours.least_ms,
            median: theirs.median_ms / ours.median_ms,
        };
        let ratios = theirs.iter().flat_map(|theirs| ours.iter().map(move |ours| ratio(theirs, ours))).collect();
        let summary = Summary {
            width: pair.width(),
            height: pair.height(),
            min_disparity: config.min_disparity,
            num_disparities: config.num_disparities,
            rounds: self.rounds,
            opencv: opencv.map(|opencv| opencv.version.clone()),
            methods,
            ratios,
        };
        print(&if self.json { serde_json::to_string(&summary)? + "\n" } else { summary.text() })
    }
}

impl Timing {
    /// Of times in ms, at least one.
    fn of(method: &str, mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        Self { method: method.to_owned(), least_ms: times[0], median_ms: times[times.len() / 2] }
    }
}

impl Summary {
    fn text(&self) -> String {
        let Self { width, height, num_disparities, rounds, .. } = self;
        let opencv = self.opencv.as_ref().map(|version| format!(", OpenCV {version}")).unwrap_or_default();
        let s = if *rounds == 1 { "" } else { "s" };
        let mut text = format!(
            "{width}x{height} px, {num_disparities} disparities, {rounds} round{s} in turn, one thread each{opencv}\n"
        );
        let _ = writeln!(text, "{:<20}{:>12}{:>12}", "ms a frame", "least", "median");
        for Timing { method, least_ms, median_ms } in &self.methods {
            let _ = writeln!(text, "{method:<20}{least_ms:>12.3}{median_ms:>12.3}");
        }
        if !self.ratios.is_empty() {
            let _ = writeln!(text, "\n{:<32}{:>8}{:>12}", "times as long as ours", "least", "median");
        }
        for Ratio { opencv, method, least, median } in &self.ratios {
            let _ = writeln!(text, "{:<32}{least:>8.2}{median:>12.2}", format!("{opencv} / {method}"));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_and_median_do_not_depend_on_the_order() {
        let Timing { least_ms, median_ms, .. } = Timing::of("lite", vec![3.0, 1.0, 9.0, 2.0, 4.0]);
        assert_eq!([least_ms, median_ms], [1.0, 3.0]);
    }
}
