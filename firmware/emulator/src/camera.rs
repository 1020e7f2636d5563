//! What the cameras show: a dump in the middle of two HM01B0 views, line by line, with one fault.
//!
//! A raw row of the dump is played as it is in the middle of a line, in the time of its pixels. So it may be
//! of every wiring that has two bytes on one line for a pixel of both views: pixels by turns, their nibbles,
//! or one view after the other, if the program takes them apart alike. What it is nobody checks.

use std::str::FromStr;

use anyhow::{Result, ensure};

/// Pixels of a line of one sensor, border and all (datasheet, window QVGA).
pub const SENSOR_WIDTH: usize = 324;
/// Lines of a frame of a sensor in its QVGA window, and without it.
pub const SENSOR_LINES: [usize; 2] = [244, 324];
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
    /// The vision task stands still for ever.
    Hang,
    /// The vision task meets an instruction that is none.
    Crash,
}

impl FaultKind {
    const NAMES: [(&str, Self); 8] = [
        ("short", Self::Short),
        ("long", Self::Long),
        ("overrun", Self::Overrun),
        ("stall", Self::Stall),
        ("garbage", Self::Garbage),
        ("silent", Self::Silent),
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
            width <= SENSOR_WIDTH && width % 2 == 0 && height <= SENSOR_LINES[0],
            "a view of the dump may have at most {SENSOR_WIDTH}x{} px, and an even width",
            SENSOR_LINES[0]
        );
        let frame = 2 * width * height;
        ensure!(
            dump.is_empty() || dump.len().is_multiple_of(frame),
            "the dump holds no whole number of frames of that size"
        );
        let recorded = dump.len().checked_div(frame).unwrap_or(0);
        Ok(Self { dump, width, height, recorded, frames: if recorded == 0 { 0 } else { frames }, fault, noise: 1 })
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

    /// The bytes of a line, where a good frame has `lines` of them.
    pub fn line(&mut self, frame: u32, line: usize, lines: usize) -> Vec<u8> {
        let middle = lines / 2;
        if self.trouble(frame) == Some(FaultKind::Garbage) && (middle..middle + 8).contains(&line) {
            return self.garbage(line);
        }
        let mut bytes = vec![BORDER; 2 * SENSOR_WIDTH];
        let top = (lines - self.height) / 2;
        if let Some(row) = line.checked_sub(top).filter(|&row| row < self.height) {
            let raw_len = 2 * self.width;
            let from = ((frame as usize % self.recorded) * self.height + row) * raw_len;
            let left = SENSOR_WIDTH - self.width;
            bytes[left..left + raw_len].copy_from_slice(&self.dump[from..from + raw_len]);
        }
        bytes
    }

    fn garbage(&mut self, line: usize) -> Vec<u8> {
        let len = 2 * SENSOR_WIDTH - if line % 2 == 1 { 3 } else { 0 };
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
        let lines = SENSOR_LINES[0];
        assert_eq!(camera.line(0, 0, lines), [BORDER; 2 * SENSOR_WIDTH]);
        let line = camera.line(0, lines / 2, lines);
        assert_eq!(line[320..328], [9, 10, 11, 12, 13, 14, 15, 16]);
        assert_eq!((line.len(), line[319], line[328]), (648, BORDER, BORDER));
    }

    #[test]
    fn faults_have_names_and_a_frame() {
        assert_eq!("long@3".parse(), Ok(Fault { kind: FaultKind::Long, frame: 3 }));
        assert_eq!("silent".parse(), Ok(Fault { kind: FaultKind::Silent, frame: 0 }));
        assert_eq!("hang@1".parse(), Ok(Fault { kind: FaultKind::Hang, frame: 1 }));
        assert!("flood@1".parse::<Fault>().is_err());
    }
}
