//! The registers of an HM01B0 behind I2C.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use rigless::chip::Timeline;
use rigless::chip::i2c::Peer;
use rigless::snapshot::Store;

/// Its only address.
const ADDRESS: u8 = 0x24;
const MODEL_ID_H: u16 = 0x0000;
const MODEL_ID_L: u16 = 0x0001;
const MODE_SELECT: u16 = 0x0100;
const SW_RESET: u16 = 0x0103;
const LINE_LENGTH_PCK_H: u16 = 0x0342;
const QVGA_WIN_EN: u16 = 0x3010;
const BIT_CONTROL: u16 = 0x3059;
const OSC_CLK_DIV: u16 = 0x3060;
/// `MODE_SELECT`: a frame for each pulse on the trigger pin.
const HARDWARE_TRIGGER: u8 = 0x05;
/// `BIT_CONTROL`: a pixel on eight lines, or as two nibbles on four.
const EIGHT_BITS: u8 = 0x02;
const FOUR_BITS: u8 = 0x42;
/// The master clock that the board gives, Hz.
const MCLK: u64 = 8_000_000;

/// What a sensor's registers hold. Those never written read as their value after reset.
#[derive(Debug, Default)]
pub struct Registers(BTreeMap<u16, u8>);

impl Registers {
    /// After a reset (datasheet, register table): the values that matter here.
    fn get(&self, register: u16) -> u8 {
        let reset = match register {
            MODEL_ID_H => 0x01,
            MODEL_ID_L => 0xB0,
            LINE_LENGTH_PCK_H => 0x01,
            0x0343 => 0x78,
            // Assumed; the program sets it.
            BIT_CONTROL => EIGHT_BITS,
            OSC_CLK_DIV => 0x08,
            _ => 0,
        };
        self.0.get(&register).copied().unwrap_or(reset)
    }

    fn set(&mut self, register: u16, value: u8) {
        match register {
            MODEL_ID_H | MODEL_ID_L => {}
            SW_RESET => self.0.clear(),
            _ => _ = self.0.insert(register, value),
        }
    }

    /// Whether it waits for the trigger.
    pub fn is_armed(&self) -> bool {
        self.get(MODE_SELECT) == HARDWARE_TRIGGER
    }

    /// Whether it shows the window of 244 lines.
    pub fn has_window(&self) -> bool {
        self.get(QVGA_WIN_EN) & 1 == 1
    }

    /// On how many lines a pixel comes; of one line nothing is modelled.
    pub fn bits(&self) -> Option<u8> {
        match self.get(BIT_CONTROL) {
            EIGHT_BITS => Some(8),
            FOUR_BITS => Some(4),
            _ => None,
        }
    }

    /// Length of a line with its blanking, pixels.
    pub fn line_length(&self) -> u64 {
        u64::from(u16::from_be_bytes([self.get(LINE_LENGTH_PCK_H), self.get(LINE_LENGTH_PCK_H + 1)]))
    }

    /// Pixels a second. Its clock pin gives one clock for each on eight lines and two on four, so that a
    /// line takes as long; and the port gets two bytes in the time of a pixel from two sensors either way,
    /// by turns of a multiplexer or a nibble of both at once.
    pub fn pixel_rate(&self) -> u64 {
        MCLK >> (3 - (self.get(OSC_CLK_DIV) & 3))
    }
}

/// The end of a sensor that hangs on I2C.
#[derive(Debug)]
pub struct Sensor {
    registers: Arc<Mutex<Registers>>,
    /// It does not answer before, ns.
    silent_until: u64,
    /// Bytes of the register's address that came, and the address.
    addressed: u8,
    register: u16,
}

impl Sensor {
    /// Answers from `silent_until` ns on.
    pub fn new(registers: Arc<Mutex<Registers>>, silent_until: u64) -> Self {
        Self { registers, silent_until, addressed: 0, register: 0 }
    }
}

// A run is never kept.
impl Store for Sensor {}

impl Peer for Sensor {
    fn start(&mut self, address: u8, read: bool, context: &mut Timeline<'_, '_>) -> bool {
        if !read {
            self.addressed = 0;
        }
        address == ADDRESS && context.now().0 >= self.silent_until
    }

    fn write(&mut self, byte: u8, _context: &mut Timeline<'_, '_>) -> bool {
        if self.addressed < 2 {
            self.register = self.register << 8 | u16::from(byte);
            self.addressed += 1;
        } else {
            self.registers.lock().expect("nobody panics").set(self.register, byte);
            self.register = self.register.wrapping_add(1);
        }
        true
    }

    fn read(&mut self, _last: bool, _context: &mut Timeline<'_, '_>) -> u8 {
        let value = self.registers.lock().expect("nobody panics").get(self.register);
        self.register = self.register.wrapping_add(1);
        value
    }

    fn stop(&mut self, _context: &mut Timeline<'_, '_>) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nibbles_change_no_timing() {
        let mut registers = Registers::default();
        registers.set(LINE_LENGTH_PCK_H, 2);
        let timing = |registers: &Registers| (registers.line_length(), registers.pixel_rate());
        let [eight, four] = [EIGHT_BITS, FOUR_BITS].map(|bits| {
            registers.set(BIT_CONTROL, bits);
            (registers.bits(), timing(&registers))
        });
        assert_eq!(eight, (Some(8), (0x278, 1_000_000)));
        assert_eq!(four, (Some(4), eight.1));
        registers.set(BIT_CONTROL, 0x22);
        assert_eq!(registers.bits(), None);
        registers.set(SW_RESET, 0);
        assert_eq!((registers.bits(), registers.line_length()), (Some(8), 0x178));
    }
}
