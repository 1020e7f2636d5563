//! The serial port that the debugger makes a USB device of: USART1 on PA9 and PA10.

use embassy_stm32::Peripherals;
use embassy_stm32::mode::Blocking;
use embassy_stm32::usart::{Config, ConfigError, Uart};

pub use embassy_stm32::interrupt::USART1 as INTERRUPT;
pub use embassy_stm32::pac::USART1 as REGISTERS;

/// Opens it.
///
/// # Errors
/// If the clock does not give the baud rate.
pub fn open(p: Peripherals, config: Config) -> Result<Uart<'static, Blocking>, ConfigError> {
    Uart::new_blocking(p.USART1, p.PA10, p.PA9, config)
}
