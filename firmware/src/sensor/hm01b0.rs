//! The sensor HM01B0 by its registers, whatever bus they are behind.
//!
//! Names are those of the datasheet. The settings: the window of 324x244 px, a frame for each pulse on
//! the trigger pin, 4 or 8 data lines, binning and motion detection off.

/// The sensor's address on I2C; it has only this one, so two sensors need two buses.
pub const ADDRESS: u8 = 0x24;
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
const BINNING_MODE: u16 = 0x0390;
const AE_CTRL: u16 = 0x2100;
const MAX_INTG_H: u16 = 0x2105;
const MAX_INTG_L: u16 = 0x2106;
const QVGA_WIN_EN: u16 = 0x3010;
const BIT_CONTROL: u16 = 0x3059;
const OSC_CLK_DIV: u16 = 0x3060;

const MODEL: u16 = 0x01B0;
/// `MODE_SELECT`: a frame for each pulse on the trigger pin.
const HARDWARE_TRIGGER: u8 = 0x05;
/// `OSC_CLK_DIV`: registers at the master clock.
const REGISTERS_WHOLE: u8 = 0b10 << 2;
/// `OSC_CLK_DIV`: of a pixel in several parts the high one comes first.
const MSB_FIRST: u8 = 1 << 4;

/// The registers that hold an exposure, in the order in which they are copied.
const EXPOSURE: [u16; 5] = [INTEGRATION_H, INTEGRATION_L, ANALOG_GAIN, DIGITAL_GAIN_H, DIGITAL_GAIN_L];

/// The registers of one sensor.
pub trait Registers {
    /// Why an access failed.
    type Error;

    /// Writes a register.
    ///
    /// # Errors
    /// If the sensor does not answer.
    fn write(&mut self, register: u16, value: u8) -> Result<(), Self::Error>;

    /// Reads a register.
    ///
    /// # Errors
    /// If the sensor does not answer.
    fn read(&mut self, register: u16) -> Result<u8, Self::Error>;
}

/// Why a sensor cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum SensorError<E> {
    /// It does not answer.
    Silent(E),
    /// Another model answers.
    Model(u16),
}

impl<E> From<E> for SensorError<E> {
    fn from(error: E) -> Self {
        Self::Silent(error)
    }
}

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
    const fn register(self) -> u8 {
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
    const fn register(self) -> u8 {
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
pub struct Settings {
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
    /// Another sensor, whose exposure is copied by [`ExposureCopy`].
    Copied,
}

/// Lines of a frame with its blanking, in the window.
pub const FRAME_LENGTH: u16 = 0x0104;

/// Sets a sensor up; it then waits for its trigger.
///
/// # Errors
/// If it does not answer, or is another model.
pub fn set_up<R: Registers>(sensor: &mut R, settings: Settings) -> Result<(), SensorError<R::Error>> {
    let model = u16::from_be_bytes([sensor.read(MODEL_ID_H)?, sensor.read(MODEL_ID_L)?]);
    if model != MODEL {
        return Err(SensorError::Model(model));
    }
    sensor.write(SW_RESET, 0)?;
    let [line_h, line_l] = settings.line_length.to_be_bytes();
    let [frame_h, frame_l] = FRAME_LENGTH.to_be_bytes();
    // With a longer integration it leaves frames out.
    let [longest_h, longest_l] = (FRAME_LENGTH - 2).to_be_bytes();
    let registers = [
        (BIT_CONTROL, settings.lines.register()),
        (OSC_CLK_DIV, MSB_FIRST | REGISTERS_WHOLE | settings.clock.register()),
        (QVGA_WIN_EN, 1),
        (BINNING_MODE, 0),
        (LINE_LENGTH_PCK_H, line_h),
        (LINE_LENGTH_PCK_L, line_l),
        (FRAME_LENGTH_LINES_H, frame_h),
        (FRAME_LENGTH_LINES_L, frame_l),
        (MAX_INTG_H, longest_h),
        (MAX_INTG_L, longest_l),
        (AE_CTRL, u8::from(settings.exposure == Exposure::Own)),
    ];
    for (register, value) in registers {
        sensor.write(register, value)?;
    }
    if let Exposure::Fixed(lines) = settings.exposure {
        let [high, low] = lines.to_be_bytes();
        sensor.write(INTEGRATION_H, high)?;
        sensor.write(INTEGRATION_L, low)?;
        sensor.write(GRP_PARAM_HOLD, 1)?;
    }
    sensor.write(MODE_SELECT, HARDWARE_TRIGGER)?;
    Ok(())
}

/// Copies the exposure from one sensor to the other, a register a call, so that nobody waits long.
#[derive(Debug, Clone, Default)]
pub struct ExposureCopy {
    values: [u8; EXPOSURE.len()],
    step: usize,
}

impl ExposureCopy {
    /// Takes the next step; whether it was the last one: the other sensor then exposes alike from its next
    /// frame on.
    ///
    /// # Errors
    /// If a sensor does not answer; the copy then begins anew.
    pub fn step<R: Registers>(&mut self, from: &mut R, to: &mut R) -> Result<bool, R::Error> {
        let step = core::mem::take(&mut self.step);
        let done = match (self.values.get_mut(step), EXPOSURE.get(step)) {
            (Some(value), Some(&register)) => {
                *value = from.read(register)?;
                false
            }
            _ => {
                let nth = step - EXPOSURE.len();
                match (EXPOSURE.get(nth), self.values.get(nth)) {
                    (Some(&register), Some(&value)) => to.write(register, value)?,
                    // What was written holds from the next frame on, all at once.
                    _ => to.write(GRP_PARAM_HOLD, 1)?,
                }
                nth >= EXPOSURE.len()
            }
        };
        self.step = if done { 0 } else { step + 1 };
        Ok(done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[derive(Default)]
    struct Fake {
        registers: BTreeMap<u16, u8>,
        /// Accesses until it falls silent.
        answers: usize,
    }

    impl Fake {
        fn sensor(answers: usize) -> Self {
            Self { registers: [(MODEL_ID_H, 0x01), (MODEL_ID_L, 0xB0)].into(), answers }
        }
        fn answer(&mut self) -> Result<(), ()> {
            self.answers = self.answers.checked_sub(1).ok_or(())?;
            Ok(())
        }
    }

    impl Registers for Fake {
        type Error = ();
        fn write(&mut self, register: u16, value: u8) -> Result<(), ()> {
            self.answer()?;
            self.registers.insert(register, value);
            Ok(())
        }
        fn read(&mut self, register: u16) -> Result<u8, ()> {
            self.answer()?;
            Ok(self.registers.get(&register).copied().unwrap_or(0))
        }
    }

    const SETTINGS: Settings =
        Settings { lines: Lines::Four, clock: Clock::Quarter, line_length: 500, exposure: Exposure::Fixed(0x0102) };

    #[test]
    fn the_trigger_is_armed_last_and_only_if_every_register_was_taken() {
        let mut whole = Fake::sensor(usize::MAX);
        assert_eq!(set_up(&mut whole, SETTINGS), Ok(()));
        let accesses = usize::MAX - whole.answers;
        assert_eq!(whole.registers[&MODE_SELECT], HARDWARE_TRIGGER);
        assert_eq!([INTEGRATION_H, INTEGRATION_L, AE_CTRL].map(|r| whole.registers[&r]), [1, 2, 0]);
        assert_eq!([LINE_LENGTH_PCK_H, LINE_LENGTH_PCK_L].map(|r| whole.registers[&r]), [1, 0xF4]);
        assert_eq!([BIT_CONTROL, OSC_CLK_DIV].map(|r| whole.registers[&r]), [0x42, 0b1_1001]);
        for answers in 0..accesses {
            let mut sensor = Fake::sensor(answers);
            assert_eq!(set_up(&mut sensor, SETTINGS), Err(SensorError::Silent(())));
            assert!(!sensor.registers.contains_key(&MODE_SELECT), "armed after {answers} accesses");
        }
    }

    #[test]
    fn only_a_sensor_that_nobody_else_controls_controls_its_exposure() {
        for (exposure, control) in [(Exposure::Own, 1), (Exposure::Fixed(9), 0), (Exposure::Copied, 0)] {
            let mut sensor = Fake::sensor(usize::MAX);
            assert_eq!(set_up(&mut sensor, Settings { exposure, ..SETTINGS }), Ok(()));
            assert_eq!(sensor.registers[&AE_CTRL], control, "{exposure:?}");
        }
    }

    #[test]
    fn another_model_is_refused() {
        let mut sensor = Fake { registers: [(MODEL_ID_L, 0x60)].into(), answers: 100 };
        assert_eq!(set_up(&mut sensor, SETTINGS), Err(SensorError::Model(0x60)));
    }

    #[test]
    fn an_exposure_is_copied_whole_and_anew_after_a_silence() {
        let mut from = Fake::sensor(100);
        from.registers.extend(EXPOSURE.into_iter().zip(1..));
        let mut to = Fake::sensor(2);
        let mut copy = ExposureCopy::default();
        let mut run =
            |to: &mut Fake| (0..20).find_map(|_| copy.step(&mut from, to).map_or(Some(false), |d| d.then_some(true)));
        assert_eq!(run(&mut to), Some(false));
        to.answers = 6;
        assert_eq!(run(&mut to), Some(true));
        assert_eq!(EXPOSURE.map(|register| to.registers[&register]), [1, 2, 3, 4, 5]);
        assert_eq!(to.registers[&GRP_PARAM_HOLD], 1);
    }
}
