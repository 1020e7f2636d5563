//! The sensor MT9V034: global shutter, 752x480 px, 3.3 V. Registers are named as in its data sheet, those of context A.
//!
//! A frame is integrated and then read out for each pulse on its pin EXPOSURE, 2x2 pixels binned to one. A line lasts
//! window width and horizontal blanking, clocks of SYSCLK, whether binned or not: a binned line is two rows read at once.
//!
//! The reserved registers hold what the data sheet's table of recommended settings and the firmware of PX4FLOW give them.

use crate::sensor::{Bus, Sensor, Setting};

const CHIP_VERSION: u16 = 0x00;
const COLUMN_START: u16 = 0x01;
const ROW_START: u16 = 0x02;
const WINDOW_HEIGHT: u16 = 0x03;
const WINDOW_WIDTH: u16 = 0x04;
const HORIZONTAL_BLANKING: u16 = 0x05;
const VERTICAL_BLANKING: u16 = 0x06;
const CHIP_CONTROL: u16 = 0x07;
const COARSE_SHUTTER_WIDTH_TOTAL: u16 = 0x0B;
const RESET: u16 = 0x0C;
const READ_MODE: u16 = 0x0D;
const SENSOR_TYPE_CONTROL: u16 = 0x0F;
const ADC_RESOLUTION_CONTROL: u16 = 0x1C;
const ANALOG_GAIN: u16 = 0x35;
const ROW_NOISE_CORRECTION: u16 = 0x70;
const PIXEL_CLOCK_CONTROL: u16 = 0x72;
const TEST_PATTERN: u16 = 0x7F;
const MINIMUM_COARSE_SHUTTER_WIDTH: u16 = 0xAC;
const MAXIMUM_COARSE_SHUTTER_WIDTH: u16 = 0xAD;
const AEC_AGC_ENABLE: u16 = 0xAF;
const AGC_GAIN_OUTPUT: u16 = 0xBA;
const AEC_EXPOSURE_OUTPUT: u16 = 0xBB;
const FINE_SHUTTER_WIDTH_TOTAL: u16 = 0xD5;

/// `CHIP_CONTROL` after a reset, but for its operating mode, bits 3 and 4, and its parallel output, bit 7.
const CONTROL_REST: u16 = 0x0388 & !(0b11 << 3) & !PARALLEL_OUTPUT;
const PARALLEL_OUTPUT: u16 = 1 << 7;
/// `CHIP_CONTROL`: frame after frame.
const MASTER: u16 = 0b01 << 3;
/// `CHIP_CONTROL`: a frame for each pulse on EXPOSURE.
const SNAPSHOT: u16 = 0b11 << 3;
/// `READ_MODE`: the reserved bits, and two rows and two columns binned to one.
const BIN_2X2: u16 = 0x0300 | 0b01 << 2 | 0b01;
/// `ADC_RESOLUTION_CONTROL`: 10 bits, linear, in both contexts.
const LINEAR: u16 = 0x0202;
/// Analog gain of 1.
const GAIN_1: u16 = 16;
/// Reserved registers and what they are recommended to hold.
const RECOMMENDED: [(u16, u16); 5] = [(0x13, 0x2D2E), (0x20, 0x03C7), (0x24, 0x001B), (0x2B, 0x0003), (0x2F, 0x0003)];
/// `TEST_PATTERN`: every pixel is the value in the lowest ten bits.
const TEST_VALUE: u16 = 1 << 13 | 1 << 10;

/// Pixels of a row and rows, and the first of each.
const ARRAY: [u16; 2] = [752, 480];
const FIRST: [u16; 2] = [1, 4];
/// Largest view, px.
pub const MOST: [u16; 2] = [ARRAY[0] / 2, ARRAY[1] / 2];
/// Master clocks that a line takes at least, and blanking with binned columns, at least and at most.
pub const LEAST_LINE: u16 = 704;
/// Least horizontal blanking with two columns binned, clocks.
pub const LEAST_BLANKING: u16 = 71;
/// Greatest horizontal blanking, clocks.
pub const MOST_BLANKING: u16 = 1023;
/// Lines between the end of the integration and the first one of the picture, and after the last one: a guess on the
/// safe side for what the data sheet tells of master mode only.
pub const SPARE_LINES: u16 = 12;
/// Master clock, Hz.
pub const SYSCLK: [u32; 2] = [13_000_000, 27_000_000];

/// How it is set up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setup {
    /// Columns and rows of a view, px, even columns.
    pub size: [u16; 2],
    /// Length of a line with its blanking, master clocks.
    pub line_length: u16,
    /// Who controls the exposure.
    pub exposure: Exposure,
    /// Longest integration, lines.
    pub most_lines: u16,
}

/// Who controls a sensor's exposure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exposure {
    /// The sensor itself.
    Own,
    /// Nobody: an integration time of that many lines.
    Fixed(u16),
    /// Another sensor, whose exposure is copied.
    Copied,
}

/// The sensor.
pub enum Mt9v034 {}

impl Sensor for Mt9v034 {
    const NAME: &'static str = "MT9V034";
    // By the pins S_CTRL_ADR1 and S_CTRL_ADR0.
    const ADDRESSES: &'static [u8] = &[0x5C, 0x58, 0x4C, 0x48];
    const IDENTITY: u16 = 0x1324;
    const RESET_MS: u32 = 1;
    const SILENT_MS: u32 = 500;
    const EXPOSURE: &'static [(u16, u16)] =
        &[(AEC_EXPOSURE_OUTPUT, COARSE_SHUTTER_WIDTH_TOTAL), (AGC_GAIN_OUTPUT, ANALOG_GAIN)];
    type Setup = Setup;

    fn write<B: Bus>(bus: &mut B, address: u8, register: u16, value: u16) -> Result<(), B::Error> {
        let ([_, register], [high, low]) = (register.to_be_bytes(), value.to_be_bytes());
        bus.write(address, &[register, high, low])
    }

    fn read<B: Bus>(bus: &mut B, address: u8, register: u16) -> Result<u16, B::Error> {
        let ([_, register], mut value) = (register.to_be_bytes(), [0; 2]);
        bus.write_read(address, &[register], &mut value)?;
        Ok(u16::from_be_bytes(value))
    }

    fn identity<B: Bus>(bus: &mut B, address: u8) -> Result<u16, B::Error> {
        Self::read(bus, address, CHIP_VERSION)
    }

    fn reset() -> Setting {
        // Of the logic; the registers keep what they hold, so all that matters is written.
        Setting::command(RESET, 1)
    }

    fn settings(setup: Setup) -> impl Iterator<Item = Setting> {
        let Setup { size: [width, height], line_length, exposure, most_lines } = setup;
        let [width, height] = [2 * width, 2 * height];
        let (control, lines) = match exposure {
            Exposure::Own => (0b11, 1),
            Exposure::Fixed(lines) => (0, lines),
            Exposure::Copied => (0, 1),
        };
        let settings = [
            // Silent until it is started.
            (CHIP_CONTROL, CONTROL_REST | SNAPSHOT),
            (COLUMN_START, FIRST[0] + (ARRAY[0] - width) / 2),
            (ROW_START, FIRST[1] + (ARRAY[1] - height) / 2),
            (WINDOW_WIDTH, width),
            (WINDOW_HEIGHT, height),
            (HORIZONTAL_BLANKING, line_length - width),
            // Between frames of master mode only.
            (VERTICAL_BLANKING, SPARE_LINES),
            (READ_MODE, BIN_2X2),
            (SENSOR_TYPE_CONTROL, 0),
            (ADC_RESOLUTION_CONTROL, LINEAR),
            (ROW_NOISE_CORRECTION, 0),
            (PIXEL_CLOCK_CONTROL, 0),
            (TEST_PATTERN, 0),
            (COARSE_SHUTTER_WIDTH_TOTAL, lines),
            (FINE_SHUTTER_WIDTH_TOTAL, 0),
            (ANALOG_GAIN, GAIN_1),
            (MINIMUM_COARSE_SHUTTER_WIDTH, 1),
            (MAXIMUM_COARSE_SHUTTER_WIDTH, most_lines),
            (AEC_AGC_ENABLE, control),
        ];
        RECOMMENDED.into_iter().chain(settings).map(|(register, value)| Setting::kept(register, value))
    }

    fn latch() -> Option<Setting> {
        None
    }

    fn start(_: Setup) -> Setting {
        Setting::kept(CHIP_CONTROL, CONTROL_REST | SNAPSHOT | PARALLEL_OUTPUT)
    }

    fn free_running() -> Option<Setting> {
        Some(Setting::kept(CHIP_CONTROL, CONTROL_REST | MASTER | PARALLEL_OUTPUT))
    }

    /// D3 to D9.
    const PATTERN_LINES: usize = 7;

    fn pattern(lines: Option<u16>) -> Setting {
        Setting::kept(TEST_PATTERN, lines.map_or(0, |lines| TEST_VALUE | lines << 3 & 0x3FF))
    }
}
