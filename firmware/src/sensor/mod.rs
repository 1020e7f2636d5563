//! Image sensors by their registers, a file each, whatever bus they are behind.

pub mod exposure;
pub mod hm01b0;
pub mod mt9v034;

/// An I2C bus.
pub trait Bus {
    /// Why an access failed.
    type Error;

    /// Writes bytes to what has that address (7 bits).
    ///
    /// # Errors
    /// If nobody answers.
    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), Self::Error>;

    /// Writes bytes, and reads what is answered.
    ///
    /// # Errors
    /// If nobody answers.
    fn write_read(&mut self, address: u8, bytes: &[u8], answer: &mut [u8]) -> Result<(), Self::Error>;
}

/// What a register holds, and whether it reads as it was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setting {
    /// The register.
    pub register: u16,
    /// Its value.
    pub value: u16,
    /// Whether it reads back. Commands do not.
    pub is_kept: bool,
}

impl Setting {
    /// A value that is kept.
    #[must_use]
    pub const fn kept(register: u16, value: u16) -> Self {
        Self { register, value, is_kept: true }
    }

    /// A command: it does something, and reads as anything.
    #[must_use]
    pub const fn command(register: u16, value: u16) -> Self {
        Self { register, value, is_kept: false }
    }
}

/// A model of image sensor.
pub trait Sensor {
    /// Its name on a data sheet.
    const NAME: &'static str;
    /// Addresses on I2C that it may have, 7 bits.
    const ADDRESSES: &'static [u8];
    /// What it says it is.
    const IDENTITY: u16;
    /// Time from a reset until it may be spoken to, ms. For longer than that it may not answer yet, which is no fault.
    const RESET_MS: u32;
    /// Longest that a good one does not answer after a reset, ms.
    const SILENT_MS: u32;
    /// Registers of an exposure: where it is read in the sensor that controls its own, and where it is written in the one
    /// that is to expose alike. They are written in this order.
    const EXPOSURE: &'static [(u16, u16)];
    /// How it is set up.
    type Setup: Copy;

    /// Writes a register.
    ///
    /// # Errors
    /// If it does not answer.
    fn write<B: Bus>(bus: &mut B, address: u8, register: u16, value: u16) -> Result<(), B::Error>;

    /// Reads a register.
    ///
    /// # Errors
    /// If it does not answer.
    fn read<B: Bus>(bus: &mut B, address: u8, register: u16) -> Result<u16, B::Error>;

    /// What it says it is.
    ///
    /// # Errors
    /// If it does not answer.
    fn identity<B: Bus>(bus: &mut B, address: u8) -> Result<u16, B::Error>;

    /// Resets it.
    fn reset() -> Setting;

    /// Everything that it has to hold, in the order in which it is written; it shows nothing yet.
    fn settings(setup: Self::Setup) -> impl Iterator<Item = Setting>;

    /// Lets what was written hold from the next frame on, where that takes a command.
    fn latch() -> Option<Setting>;

    /// Lets it show frames.
    fn start(setup: Self::Setup) -> Setting;

    /// Lets it show frame after frame without any trigger, where it can.
    fn free_running() -> Option<Setting>;

    /// Data lines on which a test pattern can be told, from the lowest that is wired; 0 if none.
    const PATTERN_LINES: usize;

    /// Lets every pixel be high on the data lines of the bits in `lines`, the lowest that is wired first, and low on all
    /// others; `None` is the picture again.
    fn pattern(lines: Option<u16>) -> Setting;
}

/// Why a sensor cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum SensorError<E> {
    /// It does not answer.
    Silent(E),
    /// Another model answers.
    Model(u16),
    /// It does not hold what was written: register, what was written, what it reads as.
    Forgets(u16, u16, u16),
}

impl<E> From<E> for SensorError<E> {
    fn from(error: E) -> Self {
        Self::Silent(error)
    }
}

/// Looks for the sensor at its addresses: the one at which it is.
///
/// # Errors
/// If none answers, or another model does.
pub fn find<S: Sensor, B: Bus>(bus: &mut B) -> Result<u8, SensorError<B::Error>> {
    let mut failed = None;
    for &address in S::ADDRESSES {
        match S::identity(bus, address) {
            Ok(identity) if identity == S::IDENTITY => return Ok(address),
            Ok(other) => failed = Some(SensorError::Model(other)),
            Err(error) => failed = failed.or(Some(SensorError::Silent(error))),
        }
    }
    Err(failed.unwrap_or(SensorError::Model(0)))
}

/// Writes one setting.
///
/// # Errors
/// If the sensor does not answer.
pub fn apply<S: Sensor, B: Bus>(bus: &mut B, address: u8, setting: Setting) -> Result<(), B::Error> {
    S::write(bus, address, setting.register, setting.value)
}

/// Writes all that the sensor has to hold, reads it back, and lets it hold. It shows nothing yet.
///
/// # Errors
/// If it does not answer, or does not hold what was written.
pub fn set_up<S: Sensor, B: Bus>(bus: &mut B, address: u8, setup: S::Setup) -> Result<(), SensorError<B::Error>> {
    for setting in S::settings(setup) {
        apply::<S, B>(bus, address, setting)?;
    }
    for Setting { register, value, .. } in S::settings(setup).filter(|setting| setting.is_kept) {
        let found = S::read(bus, address, register)?;
        if found != value {
            return Err(SensorError::Forgets(register, value, found));
        }
    }
    if let Some(latch) = S::latch() {
        apply::<S, B>(bus, address, latch)?;
    }
    Ok(())
}

#[cfg(test)]
pub(crate) mod fake;
#[cfg(test)]
mod tests;
