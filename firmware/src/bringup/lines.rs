//! The data lines of the camera port, from test patterns in which one of them is high and all others low.

use core::fmt;

/// Most data lines.
pub const MOST: usize = 14;

/// What was seen of a frame in which every pixel should be the same: the bits that were high in all of its samples, and
/// those that were in any.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seen {
    /// High in all.
    pub all: u16,
    /// High in any.
    pub any: u16,
}

impl Seen {
    /// Of no sample yet.
    pub const NOTHING: Self = Self { all: u16::MAX, any: 0 };

    /// Takes a sample.
    pub const fn add(&mut self, sample: u16) {
        self.all &= sample;
        self.any |= sample;
    }

    /// Lines that were high at times and low at others.
    const fn flickering(self) -> u16 {
        self.all ^ self.any
    }
}

/// What is wrong with a line. Lines are those of the port, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrong {
    /// It is never high.
    StuckLow(usize),
    /// It is never low.
    StuckHigh(usize),
    /// The two are exchanged.
    Swapped(usize, usize),
    /// The two touch each other.
    Shorted(usize, usize),
    /// It shows where another one should.
    Elsewhere(usize, usize),
    /// Its pixels are not those of the pattern all the time.
    Flickers(usize),
    /// The sensors answer on each other's bus.
    CrossedBuses,
    /// No line shows any pattern.
    NoPattern,
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StuckLow(line) => write!(f, "D{line} is always low: open, or short to ground"),
            Self::StuckHigh(line) => write!(f, "D{line} is always high: open, or short to the supply"),
            Self::Swapped(one, other) => write!(f, "D{one} and D{other} are exchanged"),
            Self::Shorted(one, other) => write!(f, "D{one} and D{other} touch each other"),
            Self::Elsewhere(line, seen) => write!(f, "what should come on D{line} comes on D{seen}"),
            Self::Flickers(line) => {
                write!(f, "D{line} is not steady: the pixel clock's edge, a long wire, or a supply without capacitors")
            }
            Self::CrossedBuses => f.write_str("each sensor is on the other one's I2C bus"),
            Self::NoPattern => {
                f.write_str("no line shows a pattern: the data wires, or no sensor takes what is written")
            }
        }
    }
}

/// What was seen of the patterns.
#[derive(Debug, Clone)]
pub struct Patterns {
    /// Lines in use: those of the first sensor, then as many of the second.
    pub lines: usize,
    /// With all lines low, and with all high.
    pub low: Seen,
    /// With all lines high.
    pub high: Seen,
    /// With that line high alone.
    pub alone: [Seen; MOST],
}

impl Patterns {
    /// What is wrong, one after the other; nothing if all is well.
    pub fn wrong(&self, mut tell: impl FnMut(Wrong)) {
        let lines = self.lines.min(MOST);
        let used = (1_u32 << lines).wrapping_sub(1).to_le_bytes();
        let used = u16::from_le_bytes([used[0], used[1]]);
        if (self.high.any ^ self.low.any) & used == 0 {
            return tell(Wrong::NoPattern);
        }
        let half = lines / 2;
        let seen = |line: usize| self.alone.get(line).map_or(0, |seen| seen.any) & used;
        let stuck_high = self.low.all & self.high.all & used;
        let stuck_low = !self.low.any & !self.high.any & used;
        if (0..lines).all(|line| (seen(line) ^ 1 << ((line + half) % lines)) & !stuck_high & !stuck_low == 0) {
            return tell(Wrong::CrossedBuses);
        }
        let flickering = (0..lines)
            .map(|line| self.alone.get(line).map_or(0, |seen| seen.flickering()))
            .fold(0, |all, one| all | one);
        let flickering = (flickering | self.low.flickering() | self.high.flickering()) & used;
        for line in 0..lines {
            let bit = 1_u16 << line;
            let alone = seen(line) & !stuck_high & !flickering;
            let wrong = if stuck_low & bit != 0 {
                Wrong::StuckLow(line)
            } else if stuck_high & bit != 0 {
                Wrong::StuckHigh(line)
            } else if flickering & bit != 0 {
                Wrong::Flickers(line)
            } else if alone == bit {
                continue;
            } else if let Some(other) = self.partner(line, lines, stuck_high) {
                // Told of the lower one of the two.
                if other < line {
                    continue;
                }
                if alone == 1 << other { Wrong::Swapped(line, other) } else { Wrong::Shorted(line, other) }
            } else {
                Wrong::Elsewhere(line, usize::try_from(alone.trailing_zeros()).unwrap_or(0))
            };
            tell(wrong);
        }
    }

    /// The line that is exchanged with this one or touches it.
    fn partner(&self, line: usize, lines: usize, stuck_high: u16) -> Option<usize> {
        let seen = |line: usize| self.alone.get(line).map_or(0, |seen| seen.any) & !stuck_high;
        (0..lines).filter(|&other| other != line).find(|&other| match seen(line) {
            // Low wins: neither shows alone, though both do with all others.
            0 => seen(other) == 0 && self.high.any >> other & 1 == 1,
            alone if alone == 1 << other => seen(other) == 1 << line,
            // High wins.
            alone => alone == 1 << line | 1 << other && seen(other) == alone,
        })
    }
}

/// By how many samples the second sensor is late, from a row whose every pixel should have all lines high: the samples at
/// its beginning in which only the first sensor's lines are.
#[must_use]
pub fn late_samples(row: impl Iterator<Item = u16>, first: u16, second: u16) -> usize {
    row.take_while(|sample| sample & first == first && sample & second != second).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is told of lines that `bend` what is sent.
    fn told(bend: impl Fn(u16) -> u16) -> Vec<Wrong> {
        let seen = |sent: u16| {
            let mut seen = Seen::NOTHING;
            seen.add(bend(sent));
            seen
        };
        let alone = core::array::from_fn(|line| seen(1 << line));
        let mut wrong = Vec::new();
        Patterns { lines: 14, low: seen(0), high: seen(0x3FFF), alone }.wrong(|one| wrong.push(one));
        wrong
    }

    fn swap(sample: u16, one: usize, other: usize) -> u16 {
        let differ = (sample >> one ^ sample >> other) & 1;
        sample ^ (differ << one | differ << other)
    }

    #[test]
    fn good_lines_are_not_complained_of() {
        assert_eq!(told(|sent| sent), []);
    }

    #[test]
    fn every_single_mistake_is_named() {
        for line in 0..14 {
            assert_eq!(told(|sent| sent & !(1 << line)), [Wrong::StuckLow(line)]);
            assert_eq!(told(|sent| sent | 1 << line), [Wrong::StuckHigh(line)]);
            for other in line + 1..14 {
                assert_eq!(told(|sent| swap(sent, line, other)), [Wrong::Swapped(line, other)]);
                let both = 1 << line | 1 << other;
                let low_wins = |sent: u16| if sent & both == both { sent } else { sent & !both };
                let high_wins = |sent: u16| if sent & both == 0 { sent } else { sent | both };
                assert_eq!(told(low_wins), [Wrong::Shorted(line, other)]);
                assert_eq!(told(high_wins), [Wrong::Shorted(line, other)]);
            }
        }
    }

    #[test]
    fn crossed_buses_and_no_pattern_at_all_are_told_apart() {
        assert_eq!(told(|sent| (sent >> 7 | sent << 7) & 0x3FFF), [Wrong::CrossedBuses]);
        assert_eq!(told(|_| 0x1234), [Wrong::NoPattern]);
    }

    #[test]
    fn a_line_that_is_not_steady_is_named() {
        let mut wrong = Vec::new();
        let seen = |sent: u16| Seen { all: sent, any: sent };
        let mut alone = core::array::from_fn(|line| seen(1 << line));
        alone[3].any |= 1 << 5;
        Patterns { lines: 14, low: seen(0), high: seen(0x3FFF), alone }.wrong(|one| wrong.push(one));
        assert_eq!(wrong, [Wrong::Flickers(5)]);
    }

    #[test]
    fn a_late_second_sensor_leaves_the_first_samples_of_a_row() {
        let row = |late: usize| (0..320).map(move |at| if at < late { 0x7F } else { 0x3FFF });
        for late in [0, 1, 5, 64] {
            assert_eq!(late_samples(row(late), 0x7F, 0x3F80), late);
        }
    }
}
