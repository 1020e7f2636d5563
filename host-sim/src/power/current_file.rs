//! The tables that a PPK2 or a Joulescope exports, read row by row.

use std::io::Read;

use super::lines::Lines;
use super::phase::Phase;
use super::{decimal, time};
use anyhow::{Context, Result, bail, ensure};

/// No meter that writes these files measures more, A.
const MOST_AMPERES: f64 = 20.0;

/// What a row tells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// When, s.
    pub seconds: f64,
    /// Power, W.
    pub watts: f64,
    /// What the program does, if the pins tell.
    pub phase: Option<Phase>,
}

/// Who wrote a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The export of Nordic's Power Profiler Kit II.
    Ppk2,
    /// The statistics that a Joulescope's program logs.
    Statistics,
    /// What a Joulescope's program shows of a waveform.
    Waveform,
}

impl Kind {
    /// What it is called.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ppk2 => "PPK2 export",
            Self::Statistics => "Joulescope statistics",
            Self::Waveform => "Joulescope waveform",
        }
    }
}

/// What the command line tells of a file.
#[derive(Debug, Clone, Copy)]
pub struct Setup {
    /// Supply, V, where the file has no voltage.
    pub volts: Option<f64>,
    /// Samples a second, where the file has no times.
    pub rate: Option<f64>,
    /// Digital inputs of the low and the high phase pin.
    pub pins: [usize; 2],
}

/// Where the levels of the pins are.
#[derive(Debug)]
enum Pins {
    /// In a column each.
    Columns([usize; 2]),
    /// In one column of eight letters.
    Letters(usize, [usize; 2]),
}

/// A file that is read.
#[derive(Debug)]
pub struct CurrentFile<R> {
    lines: Lines<R>,
    format: RowFormat,
    kind: Kind,
    /// Where the fields of the row that was read last end.
    ends: Vec<usize>,
    rows: u64,
    is_cut: bool,
}

/// Which columns a row's sample is in.
#[derive(Debug)]
struct RowFormat {
    /// Column of the times, and a second in their unit.
    time: Option<(usize, f64)>,
    period: f64,
    /// Column of the current, and an ampere in its unit.
    current: (usize, f64),
    /// Column of the voltage; else the supply.
    voltage: Option<usize>,
    power: Option<usize>,
    volts: f64,
    pins: Option<Pins>,
    /// Columns that each row must have.
    columns: usize,
}

impl<R: Read> CurrentFile<R> {
    /// Reads the head of a file.
    ///
    /// # Errors
    /// If it is none of these kinds, or does not tell what is needed.
    pub fn open(from: R, setup: &Setup) -> Result<Self> {
        let mut lines = Lines::new(from);
        let head = lines.next()?.context("the file is empty, where a table of currents is expected")?;
        let names: Vec<String> = head
            .text
            .split(|&byte| byte == b',')
            .map(|name| String::from_utf8_lossy(name).trim_matches(['#', ' ', '\u{feff}']).to_owned())
            .collect();
        let kind = kind(&names)?;
        let columns = Columns { kind, names: &names };
        let time = columns.time()?;
        let period = match (time, setup.rate) {
            (Some(_), None) => 0.0,
            (None, Some(rate)) => 1.0 / rate,
            (Some(_), Some(rate)) => bail!("--rate {rate}: the file has times of its own, leave it out"),
            (None, None) => bail!("has no column of times: tell by --rate how many rows come in a second"),
        };
        let (current, voltage, power) = (columns.current()?, columns.named("voltage"), columns.named("power"));
        let volts = match (voltage.or(power), setup.volts) {
            (None, None) => bail!("has no voltage: tell the supply by --volts, as --volts 3.3"),
            (_, volts) => volts.unwrap_or_default(),
        };
        let pins = columns.pins(setup.pins);
        let needed = [time.map(|time| time.0), Some(current.0), voltage, power].into_iter().flatten();
        let digital = match pins {
            Some(Pins::Columns(both)) => both[0].max(both[1]),
            Some(Pins::Letters(column, _)) => column,
            None => 0,
        };
        let columns = 1 + needed.max().unwrap_or_default().max(digital);
        let format = RowFormat { time, period, current, voltage, power, volts, pins, columns };
        Ok(Self { lines, format, kind, ends: vec![0; columns], rows: 0, is_cut: false })
    }

    /// Who wrote it.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Whether it tells phases.
    #[must_use]
    pub fn has_phases(&self) -> bool {
        self.format.pins.is_some()
    }

    /// Whether its last row was cut off.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// The next sample.
    ///
    /// # Errors
    /// Names the line where one cannot be read.
    #[inline]
    pub fn read(&mut self) -> Result<Option<Sample>> {
        let Some(line) = self.lines.next()? else { return Ok(None) };
        self.rows += 1;
        match self.format.sample(line.text, &mut self.ends, self.rows) {
            Ok(sample) if line.is_ended => Ok(Some(sample)),
            // Nothing ends the line: it may be cut off within a number.
            Ok(_) => Ok(None),
            Err(error) => self.refuse(error),
        }
    }

    /// A row that cannot be read is the last one, then perhaps cut off, or an error.
    #[cold]
    fn refuse(&mut self, error: anyhow::Error) -> Result<Option<Sample>> {
        let number = self.lines.number();
        if self.lines.next()?.is_some() {
            return Err(error.context(format!("line {number}")));
        }
        self.is_cut = true;
        Ok(None)
    }
}

/// A row, and where each of its first fields ends.
#[derive(Clone, Copy)]
struct Row<'a> {
    text: &'a [u8],
    ends: &'a [usize],
}

impl<'a> Row<'a> {
    #[inline]
    fn field(&self, column: usize) -> &'a [u8] {
        let begin = if column == 0 { 0 } else { self.ends[column - 1] + 1 };
        &self.text[begin..self.ends[column]]
    }

    #[inline]
    fn number(&self, column: usize) -> Result<f64> {
        decimal::number(self.field(column)).with_context(|| self.no_number(column))
    }

    #[inline]
    fn seconds(&self, column: usize) -> Result<f64> {
        time::seconds(self.field(column)).with_context(|| self.no_number(column))
    }

    fn no_number(&self, column: usize) -> String {
        format!("{:?} is no number", String::from_utf8_lossy(self.field(column)))
    }
}

impl RowFormat {
    #[inline]
    fn sample(&self, text: &[u8], ends: &mut [usize], nth: u64) -> Result<Sample> {
        let mut found = 0;
        for end in memchr::memchr_iter(b',', text).chain([text.len()]) {
            ends[found] = end;
            found += 1;
            if found == ends.len() {
                break;
            }
        }
        ensure!(found == self.columns, "has {found} of {} columns", self.columns);
        let row = Row { text, ends };
        let seconds = match self.time {
            Some((column, unit)) => unit * row.seconds(column)?,
            None => nth as f64 * self.period,
        };
        let amperes = self.current.1 * row.number(self.current.0)?;
        ensure!(
            amperes.abs() <= MOST_AMPERES,
            "{amperes} A is more than such a meter measures: is the file's unit another one?"
        );
        let watts = match (self.power, self.voltage) {
            (Some(power), _) => row.number(power)?,
            (None, Some(voltage)) => amperes * row.number(voltage)?,
            (None, None) => amperes * self.volts,
        };
        Ok(Sample { seconds, watts, phase: self.phase(row) })
    }

    /// Unknown where a pin was not read (`-`) or changed within the sample (`X`, or a mean of both levels).
    fn phase(&self, row: Row<'_>) -> Option<Phase> {
        let level = |field: &[u8]| match field {
            b"0" | b"0.0" => Some(false),
            b"1" | b"1.0" => Some(true),
            _ => match decimal::number(field)? {
                0.0 => Some(false),
                1.0 => Some(true),
                _ => None,
            },
        };
        let [low, high] = match self.pins.as_ref()? {
            Pins::Columns(columns) => columns.map(|column| level(row.field(column))),
            Pins::Letters(column, pins) => {
                let letters = row.field(*column);
                pins.map(|pin| level(letters.get(pin..=pin)?))
            }
        };
        Some(Phase::of_pins(low?, high?))
    }
}

/// The names of a table's columns.
struct Columns<'a> {
    kind: Kind,
    names: &'a [String],
}

const fn is_no_text(character: char) -> bool {
    matches!(character, char::REPLACEMENT_CHARACTER | '\0'..='\u{8}' | '\u{e}'..='\u{1f}')
}

/// Which program writes such a head.
fn kind(names: &[String]) -> Result<Kind> {
    let has = |wanted: &str| names.iter().any(|name| name == wanted);
    let is_quantity = |name: &String| name.rsplit_once('.').is_some_and(|(_, quantity)| quantity == "current");
    if names.iter().any(|name| name.starts_with("Current(")) {
        Ok(Kind::Ppk2)
    } else if names.iter().any(is_quantity) {
        Ok(Kind::Waveform)
    } else if has("current") {
        Ok(Kind::Statistics)
    } else if names.iter().any(|name| name.contains(is_no_text)) {
        bail!("is no text, where an export with currents of a PPK2 or a Joulescope (CSV) is expected")
    } else {
        bail!(
            "is no export with currents of a PPK2 (Timestamp(ms),Current(uA),...) or a Joulescope (time,current,voltage,...): \
             its first line is {:?}",
            names.join(",").chars().take(60).collect::<String>()
        )
    }
}

impl Columns<'_> {
    fn find(&self, is_it: impl Fn(&str) -> bool) -> Option<usize> {
        self.names.iter().position(|name| is_it(name))
    }

    /// A column by its quantity, after the device's name where there is one.
    fn named(&self, quantity: &str) -> Option<usize> {
        match self.kind {
            Kind::Ppk2 => None,
            _ => self.find(|name| name.rsplit('.').next() == Some(quantity)),
        }
    }

    fn time(&self) -> Result<Option<(usize, f64)>> {
        if self.kind != Kind::Ppk2 {
            return Ok(self.find(|name| name == "time").map(|column| (column, 1.0)));
        }
        let Some(column) = self.find(|name| name.starts_with("Timestamp")) else { return Ok(None) };
        let name = &self.names[column];
        ensure!(name == "Timestamp(ms)", "its column {name} is not in ms, as a PPK2 writes it: export it anew");
        Ok(Some((column, 1e-3)))
    }

    fn current(&self) -> Result<(usize, f64)> {
        if self.kind != Kind::Ppk2 {
            return Ok((self.named("current").context("has no column of currents")?, 1.0));
        }
        let column = self.find(|name| name.starts_with("Current(")).context("has no column of currents")?;
        let name = &self.names[column];
        ensure!(name == "Current(uA)", "its column {name} is not in uA, as a PPK2 writes it: export it anew");
        Ok((column, 1e-6))
    }

    fn pins(&self, pins: [usize; 2]) -> Option<Pins> {
        if self.kind == Kind::Ppk2 {
            let [low, high] = pins.map(|pin| self.find(|name| name == format!("D{pin}")));
            if let (Some(low), Some(high)) = (low, high) {
                return Some(Pins::Columns([low, high]));
            }
            return self.find(|name| name == "D0-D7").map(|column| Pins::Letters(column, pins));
        }
        let input = |pin: usize| {
            let names = [format!("gpi[{pin}]"), format!("gpi{pin}"), format!("{pin}")];
            self.find(|name| name.rsplit('.').next().is_some_and(|name| names.iter().any(|wanted| wanted == name)))
        };
        Some(Pins::Columns([input(pins[0])?, input(pins[1])?]))
    }
}
