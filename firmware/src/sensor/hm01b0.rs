//! The sensor HM01B0 by its registers, named as in its data sheet; how it is set up follows its known public drivers.
//!
//! The settings: the window of 324x244 px, frame after frame, 4 or 8 data lines, binning and motion detection off.
//! Values of analog registers and of the black level are those that OpenMV's driver gives them.

use crate::sensor::{Bus, Sensor, Setting};

/// Columns and lines of the window, border and all.
pub const WINDOW: [u16; 2] = [324, 244];

const MODEL_ID_H: u16 = 0x0000;
const MODEL_ID_L: u16 = 0x0001;
const MODE_SELECT: u16 = 0x0100;
const SW_RESET: u16 = 0x0103;
const GRP_PARAM_HOLD: u16 = 0x0104;
const INTEGRATION_H: u16 = 0x0202;
const INTEGRATION_L: u16 = 0x0203;
const ANALOG_GAIN: u16 = 0x0205;
const DIGITAL_GAIN_H: u16 = 0x020E;
const DIGITAL_GAIN_L: u16 = 0x020F;
const FRAME_LENGTH_LINES_H: u16 = 0x0340;
const FRAME_LENGTH_LINES_L: u16 = 0x0341;
const LINE_LENGTH_PCK_H: u16 = 0x0342;
const LINE_LENGTH_PCK_L: u16 = 0x0343;
const READOUT_X: u16 = 0x0383;
const READOUT_Y: u16 = 0x0387;
const BINNING_MODE: u16 = 0x0390;
const TEST_PATTERN_MODE: u16 = 0x0601;
const AE_CTRL: u16 = 0x2100;
const MAX_INTG_H: u16 = 0x2105;
const MAX_INTG_L: u16 = 0x2106;
const QVGA_WIN_EN: u16 = 0x3010;
const BIT_CONTROL: u16 = 0x3059;
const OSC_CLK_DIV: u16 = 0x3060;
const VSYNC_HSYNC_PIXEL_SHIFT_EN: u16 = 0x1012;
const IO_AND_PCLK: u16 = 0x3067;
const PCLK_POLARITY: u16 = 0x3068;

/// `MODE_SELECT`: frame after frame.
const STREAMING: u16 = 0x01;
/// `PCLK_POLARITY`: pixels are valid at the rising edge.
const RISING: u16 = 0x20;
/// `TEST_PATTERN_MODE`: a one that walks over the data lines.
const WALKING_ONE: u16 = 0x11;
/// `OSC_CLK_DIV`: registers at the master clock.
const REGISTERS_WHOLE: u16 = 0b10 << 2;
/// `OSC_CLK_DIV`: of a pixel in several parts the high one comes first.
const MSB_FIRST: u16 = 1 << 4;

/// Registers whose meaning is not public or does not matter here, as the known drivers write them: black level, digital
/// signal path, analog part, synchronisation.
const AS_KNOWN: [(u16, u16); 21] = [
    (0x1000, 0x43),
    (0x1001, 0x40),
    (0x1002, 0x32),
    (0x1003, 0x08),
    (0x1006, 0x01),
    (0x1007, 0x08),
    (0x1008, 0x00),
    (0x0350, 0x7F),
    (0x3011, 0x70),
    (0x3044, 0x0A),
    (0x3045, 0x00),
    (0x3047, 0x0A),
    (0x3050, 0xC0),
    (0x3051, 0x42),
    (0x3052, 0x50),
    (0x3053, 0x00),
    (0x3054, 0x03),
    (0x3055, 0xF7),
    (0x3056, 0xF8),
    (0x3057, 0x29),
    (0x3058, 0x1F),
];

/// Data lines that are in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lines {
    /// D0 to D7: a pixel a clock.
    Eight,
    /// D0 to D3: a pixel in two clocks, its high half first.
    Four,
}

impl Lines {
    /// `BIT_CONTROL`.
    const fn register(self) -> u16 {
        match self {
            Self::Eight => 0x02,
            Self::Four => 0x42,
        }
    }
}

/// The pixel clock, as a part of the master clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// All of it.
    Whole,
    /// Every second one.
    Half,
    /// Every fourth one.
    Quarter,
    /// Every eighth one.
    Eighth,
}

impl Clock {
    /// Master clocks in one of the pixels'.
    #[must_use]
    pub const fn divisor(self) -> u32 {
        match self {
            Self::Whole => 1,
            Self::Half => 2,
            Self::Quarter => 4,
            Self::Eighth => 8,
        }
    }

    /// `OSC_CLK_DIV`, its lowest bits.
    const fn register(self) -> u16 {
        match self {
            Self::Whole => 0b11,
            Self::Half => 0b10,
            Self::Quarter => 0b01,
            Self::Eighth => 0b00,
        }
    }
}

/// How a sensor is set up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setup {
    /// Data lines in use.
    pub lines: Lines,
    /// The pixel clock.
    pub clock: Clock,
    /// Length of a line with its blanking, pixel clocks, 376 or more.
    pub line_length: u16,
    /// Who controls the exposure.
    pub exposure: Exposure,
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

/// Lines of a frame with its blanking, in the window.
pub const FRAME_LENGTH: u16 = 0x0104;

/// The sensor.
pub enum Hm01b0 {}

impl Sensor for Hm01b0 {
    const NAME: &'static str = "HM01B0";
    // Others are possible by its registers 0x3400 and 0x3401 only.
    const ADDRESSES: &'static [u8] = &[0x24];
    const IDENTITY: u16 = 0x01B0;
    const RESET_MS: u32 = 1;
    const SILENT_MS: u32 = 500;
    const EXPOSURE: &'static [(u16, u16)] = &[
        (INTEGRATION_H, INTEGRATION_H),
        (INTEGRATION_L, INTEGRATION_L),
        (ANALOG_GAIN, ANALOG_GAIN),
        (DIGITAL_GAIN_H, DIGITAL_GAIN_H),
        (DIGITAL_GAIN_L, DIGITAL_GAIN_L),
    ];
    type Setup = Setup;

    fn write<B: Bus>(bus: &mut B, address: u8, register: u16, value: u16) -> Result<(), B::Error> {
        let ([high, low], [_, value]) = (register.to_be_bytes(), value.to_be_bytes());
        bus.write(address, &[high, low, value])
    }

    fn read<B: Bus>(bus: &mut B, address: u8, register: u16) -> Result<u16, B::Error> {
        let mut value = [0];
        bus.write_read(address, &register.to_be_bytes(), &mut value)?;
        Ok(u16::from(value[0]))
    }

    fn identity<B: Bus>(bus: &mut B, address: u8) -> Result<u16, B::Error> {
        Ok(Self::read(bus, address, MODEL_ID_H)? << 8 | Self::read(bus, address, MODEL_ID_L)?)
    }

    fn reset() -> Setting {
        Setting::command(SW_RESET, 0)
    }

    fn settings(setup: Setup) -> impl Iterator<Item = Setting> {
        let Setup { lines, clock, line_length, exposure } = setup;
        let halves = |value: u16| value.to_be_bytes().map(u16::from);
        let [line_h, line_l] = halves(line_length);
        let [frame_h, frame_l] = halves(FRAME_LENGTH);
        // With a longer integration it leaves frames out.
        let [longest_h, longest_l] = halves(FRAME_LENGTH - 2);
        let fixed = match exposure {
            Exposure::Fixed(lines) => halves(lines).map(Some),
            Exposure::Own | Exposure::Copied => [None; 2],
        };
        let settings = [
            // The master clock is the one on its pin.
            (IO_AND_PCLK, 0),
            (PCLK_POLARITY, RISING),
            (0x3064, 0x00),
            (0x3065, 0x04),
            (VSYNC_HSYNC_PIXEL_SHIFT_EN, 0x01),
            (READOUT_X, 0x01),
            (READOUT_Y, 0x01),
            (BIT_CONTROL, lines.register()),
            (OSC_CLK_DIV, MSB_FIRST | REGISTERS_WHOLE | clock.register()),
            (QVGA_WIN_EN, 1),
            (BINNING_MODE, 0),
            (TEST_PATTERN_MODE, 0),
            (LINE_LENGTH_PCK_H, line_h),
            (LINE_LENGTH_PCK_L, line_l),
            (FRAME_LENGTH_LINES_H, frame_h),
            (FRAME_LENGTH_LINES_L, frame_l),
            (MAX_INTG_H, longest_h),
            (MAX_INTG_L, longest_l),
            (AE_CTRL, u16::from(exposure == Exposure::Own)),
        ];
        let integration = [INTEGRATION_H, INTEGRATION_L].into_iter().zip(fixed);
        let integration = integration.filter_map(|(register, value)| Some((register, value?)));
        AS_KNOWN.into_iter().chain(settings).chain(integration).map(|(register, value)| Setting::kept(register, value))
    }

    fn latch() -> Option<Setting> {
        Some(Setting::command(GRP_PARAM_HOLD, 1))
    }

    fn start(_: Setup) -> Setting {
        Setting::kept(MODE_SELECT, STREAMING)
    }

    fn free_running() -> Option<Setting> {
        None
    }

    /// Its one that walks from line to line tells no line by itself.
    const PATTERN_LINES: usize = 0;

    fn pattern(lines: Option<u16>) -> Setting {
        Setting::kept(TEST_PATTERN_MODE, lines.map_or(0, |_| WALKING_ONE))
    }
}
