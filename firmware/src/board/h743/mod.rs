//! The board of the feature `board-h743`: an STM32H743ZI at 480 MHz, as on the Nucleo-144, with two sensors.
//!
//! Two MT9V034 share the camera interface with seven data lines each (wiring "pairs14"); two HM01B0 with four each (wiring
//! "nibble"), or through a multiplexer that takes a pixel of each in turn (wiring "pixel").
//!
//! | signal | pin | pairs14 | nibble, pixel |
//! |---|---|---|---|
//! | DCMI D0 to D6 | PC6 PC7 PC8 PC9 PE4 PD3 PE5 | D3 to D9 of the first | D0 to D3 of the first, then of the second; or the multiplexer's output |
//! | DCMI D7 | PE6 | D3 of the second | |
//! | DCMI D8 to D13 | PC10 PC12 PD6 PD2 PF11 PG15 | D4 to D9 of the second | not in use |
//! | DCMI PIXCLK, HSYNC, VSYNC | PA6, PA4, PG9 | PIXCLK, LINE_VALID, FRAME_VALID of the first | the first's, or the multiplexer's |
//! | MCO1 | PA8 | 13.15 MHz: SYSCLK of both | 8 MHz: MCLK of both |
//! | TIM3 CH1, CH2 | PB4, PB5 | EXPOSURE and STANDBY of both | not in use |
//! | I2C1 SCL, SDA | PB8, PB9 | first sensor | both |
//! | I2C2 SCL, SDA | PF1, PF0 | second sensor | not in use |
//! | USART1 TX | PB6 | row packets, 12 Mbaud | |
//! | UART7 TX, RX | PE8, PE7 | MAVLink, 115,200 baud; RX is not in use | |
//! | phase, low and high | PE9, PE11 | with the feature `measure`: what the program is doing | |

pub mod clock;
pub mod debugger_port;
pub mod dma_ring;
pub mod guard;
#[cfg(sensor = "hm01b0")]
pub mod pair_hm01b0;
pub mod parts;
pub mod reset;
pub mod start;

/// The camera port's interrupt.
pub use embassy_stm32::interrupt::typelevel::DCMI as PortInterrupt;

/// Raw rows that may wait for the vision task.
pub const RAW_ROWS: usize = crate::app::ring::RAW_ROWS;
/// What the log calls it.
pub const NAME: &str = "board-h743";
/// What its chip is called.
pub const SERIES: &str = "STM32H743";
/// Its caches.
pub const CACHES: &str = "instruction cache on, data cache off";
