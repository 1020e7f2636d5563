//! The command line, which the host gives by semihosting.

use haarline::wiring::{First, Kind, Skew};
use haarline::{Config, Wiring};
use haarline_firmware::ring::{MAX_RAW, MAX_WIDTH};

use crate::fault::Fault;

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
        };
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
                _ => return Err("an argument is not known"),
            }
        }
        options.raw_len = options.wiring.row_bytes(options.config.width);
        if usize::from(options.config.width) > MAX_WIDTH || options.raw_len > MAX_RAW {
            return Err("the views are wider than 320 px");
        }
        Ok(options)
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
            _ => Err("the method is not known"),
        }
    }
}
