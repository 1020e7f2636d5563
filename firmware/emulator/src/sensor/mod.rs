//! Image sensors behind I2C: what their registers hold, and what frames come of it.
//!
//! They do not make it easier than the real ones: after a reset they do not answer for a while, what is written holds only
//! once it is latched (HM01B0) or a frame begins (MT9V034), and without a master clock they are silent.

mod hm01b0;
mod mt9v034;

use std::collections::BTreeMap;
use std::str::FromStr;
use std::sync::{Arc, Mutex};

use rigless::chip::Timeline;
use rigless::chip::i2c::Peer;
use rigless::snapshot::Store;

/// How long one does not answer after a reset, ns.
const AFTER_RESET: u64 = 2_000_000;

/// The models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    Hm01b0,
    Mt9v034,
}

impl FromStr for Model {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "hm01b0" => Ok(Self::Hm01b0),
            "mt9v034" => Ok(Self::Mt9v034),
            _ => Err("must be hm01b0 or mt9v034".to_owned()),
        }
    }
}

/// When frames come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Never.
    Off,
    /// One after the other, the start of each so many ns after that of the one before.
    Streaming(u64),
    /// One for each pulse of the trigger.
    Triggered,
}

/// A frame of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    pub mode: Mode,
    /// Pixel clocks of a line in which pixels come, and lines.
    pub pixels: usize,
    pub lines: usize,
    /// Time of a line, and of its pixels, ns.
    pub line: u64,
    pub pixel: u64,
    /// From a pulse of the trigger to the first line, ns.
    pub integration: u64,
    /// Pixels are valid at the falling edge of their clock.
    pub is_falling: bool,
    /// Every pixel reads as this, of ten bits or eight, in place of the picture.
    pub pattern: Option<u16>,
    /// It runs by a clock of its own.
    pub is_free: bool,
}

/// One sensor.
#[derive(Debug)]
pub struct Sensor {
    pub model: Model,
    /// What was written, and what of it holds.
    held: BTreeMap<u16, u16>,
    live: BTreeMap<u16, u16>,
    /// It does not answer before, ns; and after a reset for so long.
    pub silent_until: u64,
    pub after_reset: u64,
    /// Its master clock, Hz.
    pub clock: Option<u64>,
    /// It says to be another one.
    pub is_another: bool,
    /// When it goes into standby and leaves it, ns.
    pub standby: Option<[u64; 2]>,
}

/// A sensor that its bus and the camera interface share.
pub type Shared = Arc<Mutex<Sensor>>;

impl Sensor {
    pub fn new(model: Model) -> Self {
        Self {
            model,
            held: BTreeMap::new(),
            live: BTreeMap::new(),
            silent_until: 0,
            after_reset: AFTER_RESET,
            clock: None,
            is_another: false,
            standby: None,
        }
    }

    fn addresses(&self) -> &'static [u8] {
        match self.model {
            Model::Hm01b0 => &[hm01b0::ADDRESS],
            Model::Mt9v034 => &[mt9v034::ADDRESS],
        }
    }

    /// Bytes of a register's number, and of its value.
    fn bytes(&self) -> (u8, u8) {
        match self.model {
            Model::Hm01b0 => (2, 1),
            Model::Mt9v034 => (1, 2),
        }
    }

    /// What reads back.
    fn get(&self, register: u16) -> u16 {
        match self.model {
            Model::Hm01b0 => hm01b0::get(self, register),
            Model::Mt9v034 => mt9v034::get(self, register),
        }
    }

    fn set(&mut self, register: u16, value: u16, now: u64) {
        match self.model {
            Model::Hm01b0 => hm01b0::set(self, register, value, now),
            Model::Mt9v034 => mt9v034::set(self, register, value, now),
        }
    }

    /// What holds of a register, `reset` where nothing does.
    fn holds(&self, register: u16, reset: u16) -> u16 {
        self.live.get(&register).copied().unwrap_or(reset)
    }

    /// What was written holds from now on.
    fn latch(&mut self) {
        self.live.clone_from(&self.held);
    }

    fn be_silent(&mut self, now: u64) {
        self.silent_until = now + self.after_reset;
    }

    /// A frame begins: what was written may hold from here on.
    pub fn begin_frame(&mut self) {
        if self.model == Model::Mt9v034 {
            self.latch();
        }
    }

    /// The frames that come.
    pub fn timing(&self) -> Timing {
        let Some(clock) = self.clock else { return Timing::OFF };
        match self.model {
            Model::Hm01b0 => hm01b0::timing(self, clock),
            Model::Mt9v034 => mt9v034::timing(self, clock),
        }
    }

    /// On how many lines a pixel comes.
    pub fn bits(&self) -> Option<u8> {
        match self.model {
            Model::Hm01b0 => hm01b0::bits(self),
            Model::Mt9v034 => Some(7),
        }
    }

    fn answers(&self, address: u8, now: u64) -> bool {
        // In standby the bus is off (MT9V034/D, appendix A).
        let is_awake = self.standby.is_none_or(|[begin, end]| now < begin || now >= end);
        self.addresses().contains(&address) && self.clock.is_some() && now >= self.silent_until && is_awake
    }

    /// Whether it is awake so long after its standby, ns: 10 clocks (the same).
    pub fn wakes_within(&self, nanos: u64) -> bool {
        self.clock.is_some_and(|clock| nanos * clock >= 10 * 1_000_000_000)
    }
}

impl Timing {
    pub const OFF: Self = Self {
        mode: Mode::Off,
        pixels: 0,
        lines: 0,
        line: 0,
        pixel: 0,
        integration: 0,
        is_falling: false,
        pattern: None,
        is_free: false,
    };
}

/// The sensor's end of the bus.
#[derive(Debug)]
pub struct OnBus {
    sensor: Shared,
    /// Bytes that came, the register's number and its value so far.
    came: u8,
    register: u16,
    value: u16,
    /// Bytes of a value that were sent.
    sent: u8,
}

impl OnBus {
    pub fn new(sensor: Shared) -> Self {
        Self { sensor, came: 0, register: 0, value: 0, sent: 0 }
    }
}

// A run is never kept.
impl Store for OnBus {}

impl Peer for OnBus {
    fn start(&mut self, address: u8, read: bool, context: &mut Timeline<'_, '_>) -> bool {
        if !read {
            self.came = 0;
        }
        self.sent = 0;
        self.sensor.lock().expect("nobody panics").answers(address, context.now().0)
    }

    fn write(&mut self, byte: u8, context: &mut Timeline<'_, '_>) -> bool {
        let mut sensor = self.sensor.lock().expect("nobody panics");
        let (number, value) = sensor.bytes();
        if self.came == 0 {
            self.register = 0;
        }
        if self.came < number {
            self.register = self.register << 8 | u16::from(byte);
            self.value = 0;
            self.came += 1;
            return true;
        }
        self.value = self.value << 8 | u16::from(byte);
        self.came += 1;
        if self.came == number + value {
            sensor.set(self.register, self.value, context.now().0);
            self.register = self.register.wrapping_add(1);
            self.came = number;
            self.value = 0;
        }
        true
    }

    fn read(&mut self, _last: bool, _context: &mut Timeline<'_, '_>) -> u8 {
        let sensor = self.sensor.lock().expect("nobody panics");
        let (_, bytes) = sensor.bytes();
        let value = sensor.get(self.register);
        self.sent += 1;
        let byte = if bytes == 2 && self.sent == 1 { value.to_be_bytes()[0] } else { value.to_be_bytes()[1] };
        if self.sent == bytes {
            self.sent = 0;
            self.register = self.register.wrapping_add(1);
        }
        byte
    }

    fn stop(&mut self, _context: &mut Timeline<'_, '_>) {}
}
