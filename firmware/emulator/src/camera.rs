//! What the cameras show: a dump in the middle of two sensors' views, line by line, with one fault.
//!
//! A raw row of the dump is played as it is in the middle of a line, in the time of its pixels. So it may be
//! of every wiring that has two bytes on one line for a pixel of both views: seven bits of each, pixels by turns, their
//! nibbles, or one view after the other, if the program takes them apart alike. What it is nobody checks.

use std::str::FromStr;

use anyhow::{Result, ensure};

/// The largest view of a sensor, px.
const MOST: [usize; 2] = [752, 480];
/// The grey level around the dump.
const BORDER: u8 = 0x40;

/// What can go wrong: with the camera, all in the middle of the frame, or with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultKind {
    /// The frame ends after half of its lines.
    Short,
    /// Lines go on after the last one, a quarter more.
    Long,
    /// A line's bytes are not fetched in time.
    Overrun,
    /// The pixel clock stands still for 100 ms.
    Stall,
    /// Eight lines of noise, every other one three bytes short.
    Garbage,
    /// No sensor answers on I2C for 300 ms.
    Silent,
    /// No sensor answers on I2C for 300 ms after each of its resets.
    Nak,
    /// The vision task stands still for ever.
    Hang,
    /// The vision task meets an instruction that is none.
    Crash,
}

impl FaultKind {
    const NAMES: [(&str, Self); 9] = [
        ("short", Self::Short),
        ("long", Self::Long),
        ("overrun", Self::Overrun),
        ("stall", Self::Stall),
        ("garbage", Self::Garbage),
        ("silent", Self::Silent),
        ("nak", Self::Nak),
        ("hang", Self::Hang),
        ("crash", Self::Crash),
    ];
}

/// One fault in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fault {
    /// What goes wrong.
    pub kind: FaultKind,
    /// In which frame, from 0.
    pub frame: u32,
}

impl FromStr for Fault {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, frame) = text.split_once('@').unwrap_or((text, "0"));
        let Some(&(_, kind)) = FaultKind::NAMES.iter().find(|(name, _)| *name == kind) else {
            return Err(format!("must be one of {}", FaultKind::NAMES.map(|(name, _)| name).join(", ")));
        };
        Ok(Self { kind, frame: frame.parse().map_err(|_| "the frame must be a number".to_owned())? })
    }
}

/// The bytes of both cameras on one port.
#[derive(Debug)]
pub struct Camera {
    dump: Vec<u8>,
    /// Of a view in the dump.
    width: usize,
    height: usize,
    /// Frames in the dump, and to play.
    recorded: usize,
    pub frames: u32,
    pub fault: Option<Fault>,
    noise: u32,
}

impl Camera {
    /// Plays `dump`, raw rows of two views of `width` x `height` px.
    pub fn new(dump: Vec<u8>, [width, height]: [usize; 2], frames: u32, fault: Option<Fault>) -> Result<Self> {
        ensure!(
            width <= MOST[0] && width % 2 == 0 && height <= MOST[1],
            "a view of the dump may have at most {}x{} px, and an even width",
            MOST[0],
            MOST[1]
        );
        let frame = 2 * width * height;
        ensure!(
            dump.is_empty() || dump.len().is_multiple_of(frame),
            "the dump holds no whole number of frames of that size"
        );
        let recorded = dump.len().checked_div(frame).unwrap_or(0);
        Ok(Self { dump, width, height, recorded, frames, fault, noise: 1 })
    }

    /// What goes wrong with that frame.
    pub fn trouble(&self, frame: u32) -> Option<FaultKind> {
        self.fault.filter(|fault| fault.frame == frame).map(|fault| fault.kind)
    }

    /// Lines of that frame, where a good one has `lines`.
    pub fn lines(&self, frame: u32, lines: usize) -> usize {
        match self.trouble(frame) {
            Some(FaultKind::Short) => lines / 2,
            Some(FaultKind::Long) => lines + lines / 4,
            _ => lines,
        }
    }

    /// The bytes of a line of two sensors of `pixels`, where a good frame has `lines` of them. Of a dump that is larger the
    /// middle is seen.
    pub fn line(&mut self, frame: u32, line: usize, lines: usize, pixels: usize) -> Vec<u8> {
        let middle = lines / 2;
        if self.trouble(frame) == Some(FaultKind::Garbage) && (middle..middle + 8).contains(&line) {
            return self.garbage(line, pixels);
        }
        let mut bytes = vec![BORDER; 2 * pixels];
        let row = (line + self.height / 2).checked_sub(lines / 2).filter(|&row| row < self.height);
        if let Some(row) = row.filter(|_| self.recorded > 0) {
            let width = self.width.min(pixels);
            let start = ((frame as usize % self.recorded) * self.height + row) * 2 * self.width;
            let from = start + (self.width - width);
            let to = pixels - width;
            bytes[to..to + 2 * width].copy_from_slice(&self.dump[from..from + 2 * width]);
        }
        bytes
    }

    fn garbage(&mut self, line: usize, pixels: usize) -> Vec<u8> {
        let len = 2 * pixels - if line % 2 == 1 { 3 } else { 0 };
        let mut next = || {
            self.noise = self.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            self.noise.to_be_bytes()[0]
        };
        (0..len).map(|_| next()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dump_is_in_the_middle_of_the_sensors_view() {
        let mut camera = Camera::new((1..=16).collect(), [4, 2], 1, None).unwrap();
        assert_eq!(camera.line(0, 0, 244, 324), [BORDER; 648]);
        let line = camera.line(0, 122, 244, 324);
        assert_eq!(line[320..328], [9, 10, 11, 12, 13, 14, 15, 16]);
        assert_eq!((line.len(), line[319], line[328]), (648, BORDER, BORDER));
        assert_eq!(camera.line(0, 0, 2, 4), [1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(camera.line(0, 0, 2, 2), [3, 4, 5, 6]);
    }

    #[test]
    fn faults_have_names_and_a_frame() {
        assert_eq!("long@3".parse(), Ok(Fault { kind: FaultKind::Long, frame: 3 }));
        assert_eq!("silent".parse(), Ok(Fault { kind: FaultKind::Silent, frame: 0 }));
        assert_eq!("hang@1".parse(), Ok(Fault { kind: FaultKind::Hang, frame: 1 }));
        assert!("flood@1".parse::<Fault>().is_err());
    }
}
