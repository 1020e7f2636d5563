//! The registers of an HM01B0.

use super::{Mode, Sensor, Timing};

/// Its address.
pub const ADDRESS: u8 = 0x24;
/// Pixels of a line, border and all, in the window or not; lines with the window and without.
const PIXELS: usize = 324;
const LINES: [usize; 2] = [324, 244];
const MODEL_ID_H: u16 = 0x0000;
const MODEL_ID_L: u16 = 0x0001;
const MODE_SELECT: u16 = 0x0100;
const SW_RESET: u16 = 0x0103;
const GRP_PARAM_HOLD: u16 = 0x0104;
const FRAME_LENGTH_LINES_H: u16 = 0x0340;
const LINE_LENGTH_PCK_H: u16 = 0x0342;
const TEST_PATTERN_MODE: u16 = 0x0601;
const QVGA_WIN_EN: u16 = 0x3010;
const BIT_CONTROL: u16 = 0x3059;
const OSC_CLK_DIV: u16 = 0x3060;
const CLOCK_SOURCE: u16 = 0x3067;
const PCLK_POLARITY: u16 = 0x3068;
/// `BIT_CONTROL`: a pixel on eight lines, or as two nibbles on four.
const EIGHT_BITS: u16 = 0x02;
const FOUR_BITS: u16 = 0x42;

/// After a reset (data sheet, register table): the values that matter here.
fn reset(register: u16) -> u16 {
    match register {
        LINE_LENGTH_PCK_H | FRAME_LENGTH_LINES_H => 0x01,
        0x0343 => 0x78,
        0x0341 => 0x04,
        // Assumed; the program sets it.
        BIT_CONTROL => EIGHT_BITS,
        OSC_CLK_DIV => 0x08,
        // Without being told it runs by its own oscillator, and pixels are valid at the falling edge.
        CLOCK_SOURCE => 1,
        _ => 0,
    }
}

pub fn get(sensor: &Sensor, register: u16) -> u16 {
    match register {
        MODEL_ID_H => 0x01,
        MODEL_ID_L if sensor.is_another => 0x60,
        MODEL_ID_L => 0xB0,
        _ => sensor.held.get(&register).copied().unwrap_or_else(|| reset(register)),
    }
}

pub fn set(sensor: &mut Sensor, register: u16, value: u16, now: u64) {
    match register {
        MODEL_ID_H | MODEL_ID_L => {}
        SW_RESET => {
            sensor.held.clear();
            sensor.live.clear();
            sensor.be_silent(now);
        }
        GRP_PARAM_HOLD => sensor.latch(),
        MODE_SELECT => {
            sensor.held.insert(register, value);
            sensor.live.insert(register, value);
        }
        _ => _ = sensor.held.insert(register, value),
    }
}

fn holds(sensor: &Sensor, register: u16) -> u16 {
    sensor.holds(register, reset(register))
}

/// On how many lines a pixel comes; of one line nothing is modelled.
pub fn bits(sensor: &Sensor) -> Option<u8> {
    match holds(sensor, BIT_CONTROL) {
        EIGHT_BITS => Some(8),
        FOUR_BITS => Some(4),
        _ => None,
    }
}

/// Its clock pin gives one clock for each pixel on eight lines and two on four, so that a line takes as long; and the
/// port gets two bytes in the time of a pixel from two sensors either way, by turns of a multiplexer or a nibble of both
/// at once.
pub fn timing(sensor: &Sensor, clock: u64) -> Timing {
    let word = |register| u64::from(holds(sensor, register) << 8 | holds(sensor, register + 1) & 0xFF);
    let rate = clock >> (3 - (holds(sensor, OSC_CLK_DIV) & 3));
    let nanos = |clocks: u64| clocks * 1_000_000_000 / rate;
    let line = nanos(word(LINE_LENGTH_PCK_H).max(PIXELS as u64 + 8));
    let lines = LINES[usize::from(holds(sensor, QVGA_WIN_EN) & 1)];
    let mode = match holds(sensor, MODE_SELECT) {
        1 => Mode::Streaming(line * word(FRAME_LENGTH_LINES_H).max(lines as u64 + 2)),
        5 => Mode::Triggered,
        _ => Mode::Off,
    };
    Timing {
        mode,
        pixels: PIXELS,
        lines,
        line,
        pixel: nanos(PIXELS as u64),
        integration: 0,
        is_falling: holds(sensor, PCLK_POLARITY) & 0x20 == 0,
        // Of its patterns only that there is one.
        pattern: (holds(sensor, TEST_PATTERN_MODE) & 1 == 1).then_some(0x55),
        is_free: holds(sensor, CLOCK_SOURCE) & 1 == 1,
    }
}

#[cfg(test)]
mod tests {
    use super::super::Model;
    use super::*;

    fn sensor() -> Sensor {
        Sensor { clock: Some(8_000_000), ..Sensor::new(Model::Hm01b0) }
    }

    #[test]
    fn nothing_holds_until_it_is_latched() {
        let mut sensor = sensor();
        for (register, value) in [(LINE_LENGTH_PCK_H, 2), (BIT_CONTROL, FOUR_BITS), (CLOCK_SOURCE, 0), (QVGA_WIN_EN, 1)]
        {
            sensor.set(register, value, 0);
            assert_eq!(sensor.get(register), value);
        }
        assert_eq!((sensor.bits(), sensor.timing().line), (Some(8), 376_000));
        assert!(sensor.timing().is_free);
        sensor.set(GRP_PARAM_HOLD, 1, 0);
        // Nibbles change no timing.
        assert_eq!((sensor.bits(), sensor.timing().line), (Some(4), 632_000));
        sensor.set(MODE_SELECT, 1, 0);
        assert_eq!(sensor.timing().mode, Mode::Streaming(632_000 * 260));
    }

    #[test]
    fn after_a_reset_it_holds_nothing_and_does_not_answer() {
        let mut sensor = sensor();
        sensor.set(LINE_LENGTH_PCK_H, 2, 0);
        sensor.set(GRP_PARAM_HOLD, 1, 0);
        sensor.set(SW_RESET, 0, 1000);
        assert_eq!(sensor.timing().line, 376_000);
        assert!(!sensor.answers(ADDRESS, 1000) && sensor.answers(ADDRESS, 1000 + sensor.after_reset));
        sensor.clock = None;
        assert!(!sensor.answers(ADDRESS, u64::MAX));
    }
}
