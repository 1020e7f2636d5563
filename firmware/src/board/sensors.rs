//! The two sensors behind I2C, and their common trigger.

use embassy_futures::yield_now;
use embassy_stm32::i2c::{Error, I2c, Master};
use embassy_stm32::mode::Blocking;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant, Timer};

use super::pair::{COPIES, IS_TRIGGERED, Model, SETUPS};
use super::trigger::Trigger;
use crate::sensor::exposure::ExposureCopy;
use crate::sensor::{self, Sensor, SensorError};

/// Between two tries to reach a sensor, and two looks whether it is back from its reset.
const RETRY: Duration = Duration::from_millis(100);
const LOOK: Duration = Duration::from_millis(5);
/// Tries between two complaints.
const TRIES: u32 = 10;
/// Between two looks at the first sensor's exposure.
const COPY: Duration = Duration::from_millis(200);

/// The bus of one sensor, or of both.
pub type Bus = I2c<'static, Blocking, Master>;

impl sensor::Bus for Bus {
    type Error = Error;

    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), Error> {
        self.blocking_write(address, bytes)
    }

    fn write_read(&mut self, address: u8, bytes: &[u8], answer: &mut [u8]) -> Result<(), Error> {
        self.blocking_write_read(address, bytes, answer)
    }
}

/// Tells that the sensors are set up.
pub type Ready = Signal<CriticalSectionRawMutex, ()>;

/// Both sensors.
pub struct Sensors {
    /// The buses; the second one is in use only where each sensor has its own.
    pub buses: [Bus; 2],
    /// Starts a frame of both.
    pub trigger: Trigger,
}

/// Sets both sensors up, tries until they answer; tells by `ready` that they are, starts them, and lets the second expose as
/// the first does.
pub async fn run(sensors: Sensors, ready: &Ready) {
    let Sensors { mut buses, mut trigger } = sensors;
    let mut addresses = [0; 2];
    for ((nth, bus), setup) in buses.iter_mut().enumerate().zip(SETUPS) {
        let address = set_up(nth, bus, setup).await;
        if let Some(place) = addresses.get_mut(nth) {
            *place = address;
        }
    }
    // The camera port is to wait for their first frame.
    ready.signal(());
    yield_now().await;
    for ((bus, address), setup) in buses.iter_mut().zip(addresses).zip(SETUPS) {
        while let Err(error) = sensor::apply::<Model, _>(bus, address, Model::start(setup)) {
            defmt::error!("a sensor cannot be started: {}", error);
            Timer::after(RETRY).await;
        }
    }
    if IS_TRIGGERED {
        trigger.start();
        trigger.sleep_between_frames();
    }
    if !COPIES {
        core::future::pending::<()>().await;
    }
    let [first, second] = &mut buses;
    let mut copy = ExposureCopy::<Model>::default();
    loop {
        match copy.step((first, addresses[0]), (second, addresses[1])) {
            Ok(false) => yield_now().await,
            Ok(true) => Timer::after(COPY).await,
            Err(error) => {
                defmt::warn!("exposure: {}", error);
                Timer::after(COPY).await;
            }
        }
    }
}

/// Sets one up, or both where they share the bus; its address.
async fn set_up(nth: usize, bus: &mut Bus, setup: <Model as Sensor>::Setup) -> u8 {
    let mut is_reset = false;
    let mut tries: u32 = 0;
    loop {
        match try_set_up(bus, setup, &mut is_reset).await {
            Ok(address) => {
                defmt::info!("sensor {}: {=str} set up, address {=u8:#x}", nth + 1, Model::NAME, address);
                return address;
            }
            Err(error) if tries.is_multiple_of(TRIES) => complain(nth, error),
            Err(_) => {}
        }
        tries = tries.saturating_add(1);
        Timer::after(RETRY).await;
    }
}

/// The wires of a sensor's bus.
#[must_use]
pub const fn pins(nth: usize) -> &'static str {
    if nth == 0 { "PB8, PB9" } else { "PF1, PF0" }
}

/// Sets a sensor up once; its address. One that was reset and is silent still is not reset again: it might never end.
///
/// # Errors
/// If it does not answer in time, is another model, or does not hold what is written.
pub async fn try_set_up(
    bus: &mut Bus,
    setup: <Model as Sensor>::Setup,
    is_reset: &mut bool,
) -> Result<u8, SensorError<Error>> {
    let address = sensor::find::<Model, _>(bus)?;
    if !*is_reset {
        sensor::apply::<Model, _>(bus, address, Model::reset())?;
        *is_reset = true;
        Timer::after_millis(u64::from(Model::RESET_MS)).await;
        let begun = Instant::now();
        // Right after a reset no answer is no fault.
        while let Err(error) = Model::identity(bus, address) {
            if begun.elapsed() > Duration::from_millis(u64::from(Model::SILENT_MS)) {
                return Err(error.into());
            }
            Timer::after(LOOK).await;
        }
    }
    *is_reset = false;
    sensor::set_up::<Model, _>(bus, address, setup)?;
    Ok(address)
}

fn complain(nth: usize, error: SensorError<Error>) {
    let (number, pins) = (nth + 1, pins(nth));
    match error {
        SensorError::Silent(error) => defmt::error!(
            "no answer from sensor {} (I2C, {}, {}): check its wires, its supply and its master clock",
            number,
            pins,
            error
        ),
        SensorError::Model(model) => {
            defmt::error!("sensor {} is no {=str} but model {=u16:#06x}", number, Model::NAME, model);
        }
        SensorError::Forgets(register, written, found) => defmt::error!(
            "sensor {} holds {=u16:#06x} in register {=u16:#06x}, where {=u16:#06x} was written: check its supply and the bus",
            number,
            found,
            register,
            written
        ),
    }
}
