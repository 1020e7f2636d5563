//! Mistakes of whoever wired the rig.

use std::str::FromStr;

/// One mistake.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mistake {
    /// A data line of the port is always low.
    StuckLow(u32),
    /// A data line of the port is always high.
    StuckHigh(u32),
    /// Two data lines are exchanged.
    Swapped(u32, u32),
    /// Two data lines touch each other: low wins.
    Shorted(u32, u32),
    /// No pixel clock comes.
    NoPixelClock,
    /// No line signal comes.
    NoLines,
    /// No frame signal comes.
    NoFrames,
    /// The sensors get no master clock.
    NoMasterClock,
    /// The sensors get no trigger.
    NoTrigger,
    /// One sensor, 1 or 2, is not on its I2C bus.
    Mute(usize),
    /// One sensor, 1 or 2, is another model.
    Another(usize),
    /// Each sensor is on the other one's bus.
    CrossedBuses,
    /// The second sensor is so many pixel clocks late.
    OutOfPhase(usize),
    /// The crystal does not start.
    NoCrystal,
}

impl FromStr for Mistake {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut words = text.split(':');
        let name = words.next().unwrap_or("");
        let numbers: Vec<u32> = words.map(str::parse).collect::<Result<_, _>>().map_err(|_| "a number is none")?;
        let is_line = |line: u32| line < 14;
        Ok(match (name, numbers[..].as_ref()) {
            ("stuck-low", &[line]) if is_line(line) => Self::StuckLow(line),
            ("stuck-high", &[line]) if is_line(line) => Self::StuckHigh(line),
            ("swapped", &[one, other]) if is_line(one) && is_line(other) => Self::Swapped(one, other),
            ("shorted", &[one, other]) if is_line(one) && is_line(other) => Self::Shorted(one, other),
            ("no-pixel-clock", []) => Self::NoPixelClock,
            ("no-lines", []) => Self::NoLines,
            ("no-frames", []) => Self::NoFrames,
            ("no-master-clock", []) => Self::NoMasterClock,
            ("no-trigger", []) => Self::NoTrigger,
            ("mute", &[sensor @ (1 | 2)]) => Self::Mute(sensor as usize),
            ("another", &[sensor @ (1 | 2)]) => Self::Another(sensor as usize),
            ("crossed-buses", []) => Self::CrossedBuses,
            ("out-of-phase", &[clocks @ 1..=64]) => Self::OutOfPhase(clocks as usize),
            ("no-crystal", []) => Self::NoCrystal,
            _ => {
                return Err("must be stuck-low:LINE, stuck-high:LINE, swapped:LINE:LINE, shorted:LINE:LINE, \
                            no-pixel-clock, no-lines, no-frames, no-master-clock, no-trigger, mute:SENSOR, \
                            another:SENSOR, crossed-buses, out-of-phase:CLOCKS or no-crystal"
                    .to_owned());
            }
        })
    }
}

impl Mistake {
    /// What the port sees of a line's samples, a bit a data line; `second` are the lines of the second sensor.
    pub fn bend(self, samples: &mut [u16], second: u16) {
        match self {
            Self::OutOfPhase(clocks) => {
                for at in (0..samples.len()).rev() {
                    let late = at.checked_sub(clocks).map_or(0, |at| samples[at]);
                    samples[at] = samples[at] & !second | late & second;
                }
            }
            _ => samples.iter_mut().for_each(|sample| *sample = self.bend_sample(*sample)),
        }
    }

    fn bend_sample(self, sample: u16) -> u16 {
        let bit = |line: u32| sample >> line & 1;
        let with = |line: u32, value: u16, sample: u16| sample & !(1 << line) | value << line;
        match self {
            Self::StuckLow(line) => with(line, 0, sample),
            Self::StuckHigh(line) => with(line, 1, sample),
            Self::Swapped(one, other) => with(one, bit(other), with(other, bit(one), sample)),
            Self::Shorted(one, other) => {
                let low = bit(one) & bit(other);
                with(one, low, with(other, low, sample))
            }
            _ => sample,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_bend_the_lines_that_they_name() {
        let bent = |mistake: &str, sample: u16| {
            let mut samples = [sample];
            mistake.parse::<Mistake>().unwrap().bend(&mut samples, 0x3F80);
            samples[0]
        };
        assert_eq!(bent("stuck-low:3", 0b1111), 0b0111);
        assert_eq!(bent("stuck-high:13", 0), 0x2000);
        assert_eq!(bent("swapped:0:2", 0b001), 0b100);
        assert_eq!(bent("shorted:0:1", 0b01), 0b00);
        assert_eq!(bent("shorted:0:1", 0b11), 0b11);
        assert!("stuck-low:14".parse::<Mistake>().is_err() && "mute:3".parse::<Mistake>().is_err());
        let mut samples = [0x0081, 0x0102, 0x0183];
        Mistake::OutOfPhase(1).bend(&mut samples, 0x3F80);
        assert_eq!(samples, [0x0001, 0x0082, 0x0103]);
    }
}
