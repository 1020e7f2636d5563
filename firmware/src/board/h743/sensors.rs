//! The two sensors behind I2C, and their common trigger.

use embassy_futures::yield_now;
use embassy_stm32::i2c::{Error, I2c, Master};
use embassy_stm32::mode::Blocking;
use embassy_stm32::peripherals::TIM3;
use embassy_stm32::timer::simple_pwm::SimplePwm;
use embassy_time::{Duration, Timer};

use super::settings;
use crate::hm01b0::{self, ADDRESS, Exposure, ExposureCopy, Registers, SensorError};
use crate::rig::PLAN;

/// Between two tries to reach a sensor.
const RETRY: Duration = Duration::from_millis(100);
/// Tries between two complaints.
const TRIES: u32 = 10;
/// Between two looks at the first sensor's exposure.
const COPY: Duration = Duration::from_millis(200);

/// The bus of one sensor.
pub type Bus = I2c<'static, Blocking, Master>;

impl Registers for Bus {
    type Error = Error;

    fn write(&mut self, register: u16, value: u8) -> Result<(), Error> {
        let [high, low] = register.to_be_bytes();
        self.blocking_write(ADDRESS, &[high, low, value])
    }

    fn read(&mut self, register: u16) -> Result<u8, Error> {
        let mut value = [0];
        self.blocking_write_read(ADDRESS, &register.to_be_bytes(), &mut value)?;
        Ok(value[0])
    }
}

/// Sets both sensors up, tries until they answer; starts them by one trigger, and lets the second expose
/// as the first does.
pub async fn run(mut buses: [Bus; 2], mut trigger: SimplePwm<'static, TIM3>) {
    let line_length = u16::try_from(settings::LINE_LENGTH).unwrap_or(u16::MAX);
    let exposures = match PLAN.exposure_lines {
        Some(lines) => [Exposure::Fixed(lines); 2],
        None => [Exposure::Own, Exposure::Copied],
    };
    for ((number, bus), exposure) in (1_u8..).zip(&mut buses).zip(exposures) {
        let settings = hm01b0::Settings { lines: settings::LINES, clock: settings::CLOCK, line_length, exposure };
        let mut tries: u32 = 0;
        while let Err(error) = hm01b0::set_up(bus, settings) {
            if tries.is_multiple_of(TRIES) {
                complain(number, error);
            }
            tries = tries.saturating_add(1);
            Timer::after(RETRY).await;
        }
        defmt::info!("sensor {}: HM01B0 set up", number);
    }
    // Long pulses: the sensors look at the edge.
    trigger.ch1().set_duty_cycle_percent(10);
    trigger.ch1().enable();
    if PLAN.exposure_lines.is_some() {
        core::future::pending::<()>().await;
    }
    let [first, second] = &mut buses;
    let mut copy = ExposureCopy::default();
    loop {
        match copy.step(first, second) {
            Ok(false) => yield_now().await,
            Ok(true) => Timer::after(COPY).await,
            Err(error) => {
                defmt::warn!("exposure: {}", error);
                Timer::after(COPY).await;
            }
        }
    }
}

fn complain(number: u8, error: SensorError<Error>) {
    let pins = if number == 1 { "PB8, PB9" } else { "PF1, PF0" };
    match error {
        SensorError::Silent(error) => defmt::error!(
            "no answer from sensor {} (I2C, {}, {}): check its wires, its supply and its master clock",
            number,
            pins,
            error
        ),
        SensorError::Model(model) => defmt::error!("sensor {} is no HM01B0 but model {=u16:#06x}", number, model),
    }
}
