//! The registers of an MT9V034, context A.

use super::{Mode, Sensor, Timing};

/// Its address where both address pins are high.
pub const ADDRESS: u8 = 0x5C;
const CHIP_VERSION: u16 = 0x00;
const WINDOW_HEIGHT: u16 = 0x03;
const WINDOW_WIDTH: u16 = 0x04;
const HORIZONTAL_BLANKING: u16 = 0x05;
const VERTICAL_BLANKING: u16 = 0x06;
const CHIP_CONTROL: u16 = 0x07;
const COARSE_SHUTTER_WIDTH_TOTAL: u16 = 0x0B;
const RESET: u16 = 0x0C;
const READ_MODE: u16 = 0x0D;
const ANALOG_GAIN: u16 = 0x35;
const PIXEL_CLOCK_CONTROL: u16 = 0x72;
const TEST_PATTERN: u16 = 0x7F;
const MAXIMUM_COARSE_SHUTTER_WIDTH: u16 = 0xAD;
const AEC_AGC_ENABLE: u16 = 0xAF;
const AGC_GAIN_OUTPUT: u16 = 0xBA;
const AEC_EXPOSURE_OUTPUT: u16 = 0xBB;
/// Least clocks of a line, and blanking.
const LEAST_LINE: u64 = 704;
const MOST_BLANKING: u64 = 1023;
/// Master clock that it works with, Hz.
const CLOCK: std::ops::RangeInclusive<u64> = 13_000_000..=27_000_000;
/// What its own control exposes, lines, and its gain.
const OWN: (u16, u16) = (24, 20);

/// After a reset (data sheet, register table): the values that matter here.
fn reset(register: u16) -> u16 {
    match register {
        WINDOW_HEIGHT | COARSE_SHUTTER_WIDTH_TOTAL | MAXIMUM_COARSE_SHUTTER_WIDTH => 480,
        WINDOW_WIDTH => 752,
        HORIZONTAL_BLANKING => 94,
        VERTICAL_BLANKING => 45,
        CHIP_CONTROL => 0x0388,
        READ_MODE => 0x0300,
        ANALOG_GAIN => 16,
        AEC_AGC_ENABLE => 0x0303,
        _ => 0,
    }
}

fn holds(sensor: &Sensor, register: u16) -> u16 {
    sensor.holds(register, reset(register))
}

/// Lines of integration, and gain.
fn exposure(sensor: &Sensor) -> (u16, u16) {
    let enabled = holds(sensor, AEC_AGC_ENABLE);
    let lines = if enabled & 1 == 1 {
        OWN.0.min(holds(sensor, MAXIMUM_COARSE_SHUTTER_WIDTH))
    } else {
        holds(sensor, COARSE_SHUTTER_WIDTH_TOTAL)
    };
    (lines, if enabled & 2 == 2 { OWN.1 } else { holds(sensor, ANALOG_GAIN) })
}

pub fn get(sensor: &Sensor, register: u16) -> u16 {
    match register {
        CHIP_VERSION if sensor.is_another => 0x1313,
        CHIP_VERSION => 0x1324,
        AEC_EXPOSURE_OUTPUT => exposure(sensor).0,
        AGC_GAIN_OUTPUT => exposure(sensor).1,
        _ => sensor.held.get(&register).copied().unwrap_or_else(|| reset(register)),
    }
}

pub fn set(sensor: &mut Sensor, register: u16, value: u16, now: u64) {
    match register {
        CHIP_VERSION | AEC_EXPOSURE_OUTPUT | AGC_GAIN_OUTPUT => {}
        // Of the logic: the registers keep what they hold.
        RESET if value & 1 == 1 => {
            sensor.latch();
            sensor.be_silent(now);
        }
        // How it works holds at once, all else from the next frame on.
        CHIP_CONTROL => {
            sensor.held.insert(register, value);
            sensor.live.insert(register, value);
        }
        _ => _ = sensor.held.insert(register, value),
    }
}

pub fn timing(sensor: &Sensor, clock: u64) -> Timing {
    let nanos = |clocks: u64| clocks * 1_000_000_000 / clock;
    let [width, height, blanking] =
        [WINDOW_WIDTH, WINDOW_HEIGHT, HORIZONTAL_BLANKING].map(|register| u64::from(holds(sensor, register)));
    let read = holds(sensor, READ_MODE);
    let [rows, columns] = [read & 3, read >> 2 & 3];
    let least_blanking = [61, 71, 91, 91][usize::from(columns)];
    let line = nanos(width + blanking);
    let lines = height >> rows;
    let control = holds(sensor, CHIP_CONTROL);
    let works = CLOCK.contains(&clock)
        && control & 1 << 7 != 0
        && width + blanking >= LEAST_LINE
        && (least_blanking..=MOST_BLANKING).contains(&blanking);
    let mode = match control >> 3 & 3 {
        1 if works => Mode::Streaming(line * (lines + u64::from(holds(sensor, VERTICAL_BLANKING)))),
        3 if works => Mode::Triggered,
        _ => Mode::Off,
    };
    let pattern = holds(sensor, TEST_PATTERN);
    Timing {
        mode,
        pixels: (width >> columns) as usize,
        lines: lines as usize,
        line,
        pixel: nanos(width),
        integration: u64::from(exposure(sensor).0) * line,
        is_falling: holds(sensor, PIXEL_CLOCK_CONTROL) & 1 << 4 != 0,
        pattern: (pattern >> 13 & 1 == 1 && pattern >> 10 & 1 == 1).then_some(pattern & 0x3FF),
        is_free: false,
    }
}

#[cfg(test)]
mod tests {
    use super::super::Model;
    use super::*;

    #[test]
    fn what_was_written_holds_from_the_next_frame_on() {
        let mut sensor = Sensor { clock: Some(15_000_000), ..Sensor::new(Model::Mt9v034) };
        let written = [(WINDOW_WIDTH, 640), (WINDOW_HEIGHT, 480), (HORIZONTAL_BLANKING, 860), (READ_MODE, 0x305)];
        for (register, value) in [(CHIP_CONTROL, 0x398), (AEC_AGC_ENABLE, 0), (COARSE_SHUTTER_WIDTH_TOTAL, 30)] {
            sensor.set(register, value, 0);
        }
        for (register, value) in written {
            sensor.set(register, value, 0);
            assert_eq!(sensor.get(register), value);
        }
        assert_eq!((sensor.timing().mode, sensor.timing().lines), (Mode::Triggered, 480));
        sensor.begin_frame();
        let Timing { pixels, lines, line, integration, .. } = sensor.timing();
        assert_eq!((pixels, lines, line, integration), (320, 240, 100_000, 3_000_000));
        assert!(sensor.answers(ADDRESS, 0) && sensor.wakes_within(667) && !sensor.wakes_within(666));
        sensor.standby = Some([100, 200]);
        assert_eq!([99, 100, 199, 200].map(|now| sensor.answers(ADDRESS, now)), [true, false, false, true]);
        for clock in [8_000_000, 30_000_000] {
            sensor.clock = Some(clock);
            assert_eq!(sensor.timing().mode, Mode::Off, "{clock} Hz");
        }
    }
}
