//! The serial port that the debugger makes a USB device of: USART3 on PD8 and PD9.

use embassy_stm32::Peripherals;
use embassy_stm32::mode::Blocking;
use embassy_stm32::usart::{Config, ConfigError, Uart};

pub use embassy_stm32::interrupt::USART3 as INTERRUPT;
pub use embassy_stm32::pac::USART3 as REGISTERS;

/// Opens it.
///
/// # Errors
/// If the clock does not give the baud rate.
pub fn open(p: Peripherals, config: Config) -> Result<Uart<'static, Blocking>, ConfigError> {
    Uart::new_blocking(p.USART3, p.PD9, p.PD8, config)
}
