//! The command line, which the host gives by semihosting.

use haarline::setup::Reach;
use haarline::wiring::{First, Kind, Skew};
use haarline::{Config, Ramp, Rectification, Rig, Wiring};
use haarline_firmware::app::ring::{MAX_RAW, MAX_WIDTH};
use haarline_rig::Plan;

use crate::fault::Fault;
use crate::tables::Counts;

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    pub config: Config,
    pub height: u32,
    /// Bytes of a raw row.
    pub raw_len: usize,
    /// Frames of the file, and to play.
    pub recorded: u32,
    pub frames: u32,
    /// Frames at either end whose results are kept.
    pub keep: u32,
    pub method: Method,
    pub wiring: Wiring,
    pub fault: Option<Fault>,
    /// The rig, if obstacles are looked for.
    pub plan: Option<Plan>,
    /// Nodes of its tables.
    pub tables: Counts,
}

/// A stereo method, by its name on the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    Lite,
    Full,
    WaveletBlock,
    Contour,
    Envelope,
    Block,
    Sgm,
}

impl Options {
    /// Reads `key=value` words.
    pub fn parse<'a>(words: impl Iterator<Item = &'a str>) -> Result<Self, &'static str> {
        let mut options = Self {
            config: Config { width: 0, min_disparity: 0, num_disparities: 0 },
            height: 0,
            raw_len: 0,
            recorded: 1,
            frames: 1,
            keep: u32::MAX,
            wiring: Wiring::new(Kind::SideBySide, First::Left),
            method: Method::Lite,
            fault: None,
            plan: None,
            tables: Counts::default(),
        };
        let mut rig = RigFigures::default();
        for word in words {
            let (key, value) = word.split_once('=').ok_or("an argument is no key=value")?;
            let number = value.parse::<i32>().ok();
            let natural = number.and_then(|number| u32::try_from(number).ok());
            let bad = "an argument's value is out of range";
            match key {
                "width" => options.config.width = natural.and_then(|n| u16::try_from(n).ok()).ok_or(bad)?,
                "min" => options.config.min_disparity = number.and_then(|n| i16::try_from(n).ok()).ok_or(bad)?,
                "num" => options.config.num_disparities = natural.and_then(|n| u16::try_from(n).ok()).ok_or(bad)?,
                "height" => options.height = natural.ok_or(bad)?,
                "recorded" => options.recorded = natural.filter(|&n| n > 0).ok_or(bad)?,
                "frames" => options.frames = natural.ok_or(bad)?,
                "keep" => options.keep = natural.ok_or(bad)?,
                "wiring" => options.wiring.kind = Kind::from_name(value).ok_or(bad)?,
                "first" => options.wiring.first = First::from_name(value).ok_or(bad)?,
                "skew" => options.wiring.skew = Skew::from_name(value).ok_or(bad)?,
                "method" => options.method = Method::parse(value)?,
                "fault" => options.fault = Some(value.parse()?),
                "lens_nodes" => options.tables.lens = natural.and_then(|n| n.try_into().ok()).ok_or(bad)?,
                "correction_nodes" => options.tables.correction = natural.and_then(|n| n.try_into().ok()).ok_or(bad)?,
                "correction_columns" => options.tables.columns = natural.and_then(|n| n.try_into().ok()).ok_or(bad)?,
                _ => rig.take(key, number.ok_or(bad)?)?,
            }
        }
        options.plan = rig.plan(&options)?;
        options.raw_len = options.wiring.row_bytes(options.config.width);
        if usize::from(options.config.width) > MAX_WIDTH || options.raw_len > MAX_RAW {
            return Err("the views are wider than 320 px");
        }
        Ok(options)
    }
}

/// What the host tells of a rig, by name.
#[derive(Default)]
struct RigFigures {
    /// In the order of [`Self::NAMES`]; all or none must be there.
    figures: [i32; Self::NAMES.len()],
    told: usize,
}

impl RigFigures {
    /// The pitch, a float, comes as its bits, so that it is the host's to the last one.
    const NAMES: [&'static str; 16] = [
        "rows_q16",
        "roll_q16",
        "scale_q16",
        "columns",
        "axis_x_q8",
        "axis_y_q8",
        "doffs_q8",
        "focal_px_q8",
        "baseline_um",
        "camera_height_mm",
        "pitch_bits",
        "lowest_mm",
        "highest_mm",
        "sectors",
        "sector_deg",
        "first_deg",
    ];

    fn take(&mut self, key: &str, value: i32) -> Result<(), &'static str> {
        let nth = Self::NAMES.iter().position(|&name| name == key).ok_or("an argument is not known")?;
        self.figures[nth] = value;
        self.told += 1;
        Ok(())
    }

    fn plan(&self, options: &Options) -> Result<Option<Plan>, &'static str> {
        if self.told == 0 {
            return Ok(None);
        }
        if self.told != Self::NAMES.len() {
            return Err("of the rig's figures some are missing");
        }
        let [
            rows_q16,
            roll_q16,
            scale_q16,
            columns,
            axis_x,
            axis_y,
            doffs,
            focal,
            baseline,
            camera_height_mm,
            pitch,
            lowest_mm,
            highest_mm,
            sectors,
            degrees,
            first,
        ] = self.figures;
        let plan = || {
            Some(Plan {
                config: options.config,
                height: u16::try_from(options.height).ok()?,
                wiring: options.wiring,
                frame_rate_hz: 1,
                exposure_lines: None,
                rectification: Rectification {
                    ramp: Ramp { rows_q16, roll_q16, scale_q16 },
                    columns: columns.try_into().ok()?,
                    ..Rectification::default()
                },
                ring_rows: 0,
                rig: Rig::new(focal.try_into().ok()?, baseline.try_into().ok()?)?
                    .with_axes(Some([axis_x, axis_y]), doffs),
                camera_height_mm,
                pitch_deg: f32::from_bits(pitch.cast_unsigned()),
                lowest_mm,
                highest_mm,
                sectors: sectors.try_into().ok()?,
                reach: Reach {
                    sector_deg: degrees.try_into().ok()?,
                    first_deg: first.try_into().ok()?,
                    nearest_cm: 0,
                    farthest_cm: 0,
                },
            })
        };
        plan().map(Some).ok_or("the rig's figures are out of range")
    }
}

impl Method {
    fn parse(name: &str) -> Result<Self, &'static str> {
        match name {
            "lite" => Ok(Self::Lite),
            "full" => Ok(Self::Full),
            "wavelet-block" => Ok(Self::WaveletBlock),
            "contour" => Ok(Self::Contour),
            "envelope" => Ok(Self::Envelope),
            "block" => Ok(Self::Block),
            "sgm" => Ok(Self::Sgm),
            _ => Err("the method is not known"),
        }
    }
}
