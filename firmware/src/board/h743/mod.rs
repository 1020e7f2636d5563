//! The board `board-h743`: an STM32H743ZI at 480 MHz, as on the Nucleo-144, with two HM01B0.
//!
//! The two sensors share the camera interface: with 4 data lines each (wiring "nibble"), or through a
//! multiplexer that takes a pixel of each in turn (wiring "pixel").
//!
//! | signal | pin | |
//! |---|---|---|
//! | DCMI D0 to D7 | PC6 PC7 PC8 PC9 PE4 PD3 PE5 PE6 | D0 to D3 of the first sensor, then of the second; or the multiplexer's output |
//! | DCMI PIXCLK, HSYNC, VSYNC | PA6, PA4, PG9 | pixels valid while both are high |
//! | MCO1 | PA8 | 8 MHz: the master clock of both sensors |
//! | TIM3 CH1 | PB4 | the trigger pins of both sensors |
//! | I2C1 SCL, SDA | PB8, PB9 | first sensor |
//! | I2C2 SCL, SDA | PF1, PF0 | second sensor: both have the same address |
//! | USART1 TX | PB6 | row packets, 6 Mbaud |
//! | UART7 TX, RX | PE8, PE7 | MAVLink, 115,200 baud; RX is not in use |

pub mod camera;
pub mod clock;
pub mod cycles;
pub mod dma_memory;
pub mod idle;
pub mod panic;
pub mod reset;
pub mod sensors;
pub mod serial;
pub mod settings;

defmt::timestamp!("{=u64:us}", embassy_time::Instant::now().as_micros());
