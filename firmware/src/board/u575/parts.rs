//! What the application works with, on the pins of this board.

use embassy_stm32::gpio::{Flex, OutputType};
use embassy_stm32::peripherals::{GPDMA1_CH1, GPDMA1_CH2, IWDG};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::CountingMode;
use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm};
use embassy_stm32::usart::{self, UartTx};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Peripherals, bind_interrupts, dma, i2c};
use embassy_time::Duration;

use super::clock::{ROWS_BAUD, SENSORS_HZ};
use super::dma_ring::DmaRing;
use crate::board::camera::{Camera, Pins, PortHandler};
use crate::board::dma_memory::DmaCell;
use crate::board::sensors::Sensors;
use crate::board::serial::Serial;
use crate::board::trigger::Trigger;
use crate::board::watchdog::{self, Watchdog};
use crate::board::{free_bus, phases};
use crate::dma_cell;

bind_interrupts!(struct Irqs {
    DCMI_PSSI => PortHandler;
    GPDMA1_CHANNEL0 => PortHandler;
    GPDMA1_CHANNEL1 => dma::InterruptHandler<GPDMA1_CH1>;
    GPDMA1_CHANNEL2 => dma::InterruptHandler<GPDMA1_CH2>;
});

/// The chip's watchdog.
pub type WatchdogUnit = IWDG;

/// Bytes of row packets that one transfer takes.
const ROWS_CHUNK: usize = 1088;
/// MAVLink's port: a message has 179 bytes, and comes with each frame.
const MAVLINK_BAUD: u32 = 115_200;

static ROWS_MEMORY: DmaCell<[u8; ROWS_CHUNK]> = dma_cell!([u8; ROWS_CHUNK]);
static MAVLINK_MEMORY: DmaCell<[u8; haarline_telemetry::MAX_BYTES]> = dma_cell!([u8; haarline_telemetry::MAX_BYTES]);

/// The parts.
pub struct Parts {
    /// The camera interface.
    pub camera: Camera,
    /// The sensors behind it.
    pub sensors: Sensors,
    /// Takes row packets.
    pub rows: Serial,
    /// Leads to the autopilot.
    pub mavlink: Serial,
    /// Starts the chip anew unless it is fed.
    pub watchdog: Watchdog,
}

impl Parts {
    /// Takes them from the chip's peripherals.
    ///
    /// # Panics
    /// If it is called twice.
    #[inline(never)]
    #[must_use]
    pub fn new(mut p: Peripherals) -> Self {
        phases::start(p.PE9, p.PE11);
        // The sensors' master clock comes before anything is asked of them. It stays on. What MCO gives is too fast.
        let pin = PwmPin::new(p.PA8, OutputType::PushPull);
        let rate = Hertz(SENSORS_HZ);
        let mut clock = SimplePwm::new(p.TIM1, Some(pin), None, None, None, rate, CountingMode::EdgeAlignedUp);
        clock.ch1().set_duty_cycle_percent(50);
        clock.ch1().enable();
        core::mem::forget(clock);
        let trigger = Trigger::new(p.TIM3, p.PB4, p.PB5);
        free_bus::free(1, Flex::new(p.PB8.reborrow()), Flex::new(p.PB9.reborrow()));
        free_bus::free(2, Flex::new(p.PF1.reborrow()), Flex::new(p.PF0.reborrow()));
        let mut config = i2c::Config::default();
        config.frequency = Hertz::khz(400);
        config.timeout = Duration::from_millis(5);
        let first = i2c::I2c::new_blocking(p.I2C1, p.PB8, p.PB9, config);
        let second = i2c::I2c::new_blocking(p.I2C2, p.PF1, p.PF0, config);

        // Each with the number of the camera port's function on it.
        let data = [
            (Flex::new(p.PC6), 10),
            (Flex::new(p.PC7), 10),
            (Flex::new(p.PC8), 10),
            (Flex::new(p.PC9), 4),
            (Flex::new(p.PE4), 10),
            (Flex::new(p.PD3), 4),
            (Flex::new(p.PE5), 10),
            (Flex::new(p.PE6), 10),
            (Flex::new(p.PC10), 10),
            (Flex::new(p.PC12), 10),
            (Flex::new(p.PD6), 4),
            (Flex::new(p.PD2), 10),
            (Flex::new(p.PF6), 4),
            (Flex::new(p.PG15), 10),
        ];
        let sync = [(Flex::new(p.PA6), 4), (Flex::new(p.PA4), 10), (Flex::new(p.PB7), 10)];
        let camera = Camera::new(p.DCMI, DmaRing::new(p.GPDMA1_CH0), Pins::new(data, sync));

        let mut config = usart::Config::default();
        config.baudrate = ROWS_BAUD;
        let Ok(rows) = UartTx::new(p.USART1, p.PB6, p.GPDMA1_CH1, Irqs, config) else {
            defmt::panic!("the clock gives the baud rate")
        };
        config.baudrate = MAVLINK_BAUD;
        let Ok(mavlink) = UartTx::new(p.USART2, p.PD5, p.GPDMA1_CH2, Irqs, config) else {
            defmt::panic!("the clock gives 115,200 baud")
        };
        Self {
            camera,
            sensors: Sensors { buses: [first, second], trigger },
            rows: Serial::new(rows, ROWS_MEMORY.fill(|| 0)),
            mavlink: Serial::new(mavlink, MAVLINK_MEMORY.fill(|| 0)),
            watchdog: Watchdog(IndependentWatchdog::new(p.IWDG, watchdog::PERIOD)),
        }
    }
}
