//! What the application works with, on the pins of this board.

use embassy_stm32::gpio::{Flex, Speed};
use embassy_stm32::peripherals::{DMA1_CH0, DMA1_CH1, DMA1_CH2, IWDG1};
use embassy_stm32::rcc::{Mco, McoConfig};
#[cfg(sensor = "mt9v034")]
use embassy_stm32::rcc::{Mco1Source, McoPrescaler};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, UartTx};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Peripherals, bind_interrupts, dma, i2c};
use embassy_time::Duration;

use super::clock::{CORE, Source};
use super::dma_ring::DmaRing;
#[cfg(sensor = "hm01b0")]
use super::pair_hm01b0::MASTER_CLOCK;
use super::start;
use crate::board::camera::{Camera, Pins, PortHandler};
use crate::board::dma_memory::DmaCell;
use crate::board::sensors::Sensors;
use crate::board::serial::Serial;
use crate::board::trigger::Trigger;
use crate::board::watchdog::{self, Watchdog};
use crate::board::{free_bus, phases};
use crate::dma_cell;

bind_interrupts!(struct Irqs {
    DCMI => PortHandler;
    DMA1_STREAM0 => PortHandler, dma::InterruptHandler<DMA1_CH0>;
    DMA1_STREAM1 => dma::InterruptHandler<DMA1_CH1>;
    DMA1_STREAM2 => dma::InterruptHandler<DMA1_CH2>;
});

/// The chip's watchdog.
pub type WatchdogUnit = IWDG1;

/// The sensors' master clock by the crystal and without it, the same: an output of the core's PLL.
#[cfg(sensor = "mt9v034")]
const MASTER_CLOCK: [(Mco1Source, McoPrescaler); 2] = [(Mco1Source::PLL1_Q, McoPrescaler::DIV1); 2];
/// The number of the camera port's function, on every pin.
const PORT: u8 = 13;

/// The row packets' port: its clock allows an eighth of it. At 30 frames a second of 320 x 240 px the packets take less than
/// half of 12 Mbaud.
const ROWS_BAUD: u32 = if CORE < 400_000_000 { 6_000_000 } else { 12_000_000 };
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
        // The sensors' master clock comes before anything is asked of them. It stays on.
        let mut mco = McoConfig::default();
        let [by_crystal, without] = MASTER_CLOCK;
        let (source, prescaler) = if start::source() == Source::Crystal { by_crystal } else { without };
        (mco.prescaler, mco.speed) = (prescaler, Speed::Medium);
        let _master_clock = Mco::new(p.MCO1, p.PA8, source, mco);
        let trigger = Trigger::new(p.TIM3, p.PB4, p.PB5);
        free_bus::free(1, Flex::new(p.PB8.reborrow()), Flex::new(p.PB9.reborrow()));
        free_bus::free(2, Flex::new(p.PF1.reborrow()), Flex::new(p.PF0.reborrow()));
        let mut config = i2c::Config::default();
        config.frequency = Hertz::khz(400);
        config.timeout = Duration::from_millis(5);
        let first = i2c::I2c::new_blocking(p.I2C1, p.PB8, p.PB9, config);
        let second = i2c::I2c::new_blocking(p.I2C2, p.PF1, p.PF0, config);

        let data = [
            Flex::new(p.PC6),
            Flex::new(p.PC7),
            Flex::new(p.PC8),
            Flex::new(p.PC9),
            Flex::new(p.PE4),
            Flex::new(p.PD3),
            Flex::new(p.PE5),
            Flex::new(p.PE6),
            #[cfg(sensor = "mt9v034")]
            Flex::new(p.PC10),
            #[cfg(sensor = "mt9v034")]
            Flex::new(p.PC12),
            #[cfg(sensor = "mt9v034")]
            Flex::new(p.PD6),
            #[cfg(sensor = "mt9v034")]
            Flex::new(p.PD2),
            #[cfg(sensor = "mt9v034")]
            Flex::new(p.PF11),
            #[cfg(sensor = "mt9v034")]
            Flex::new(p.PG15),
        ];
        let sync = [Flex::new(p.PA6), Flex::new(p.PA4), Flex::new(p.PG9)];
        let pins = Pins::new(data.map(|pin| (pin, PORT)), sync.map(|pin| (pin, PORT)));
        let camera = Camera::new(p.DCMI, DmaRing::new(p.DMA1_CH0, Irqs), pins);

        let mut config = usart::Config::default();
        config.baudrate = ROWS_BAUD;
        let Ok(rows) = UartTx::new(p.USART1, p.PB6, p.DMA1_CH1, Irqs, config) else {
            defmt::panic!("the clock gives the baud rate")
        };
        config.baudrate = MAVLINK_BAUD;
        let Ok(mavlink) = UartTx::new(p.UART7, p.PE8, p.DMA1_CH2, Irqs, config) else {
            defmt::panic!("120 MHz give 115,200 baud")
        };
        Self {
            camera,
            sensors: Sensors { buses: [first, second], trigger },
            rows: Serial::new(rows, ROWS_MEMORY.fill(|| 0)),
            mavlink: Serial::new(mavlink, MAVLINK_MEMORY.fill(|| 0)),
            watchdog: Watchdog(IndependentWatchdog::new(p.IWDG1, watchdog::PERIOD)),
        }
    }
}
