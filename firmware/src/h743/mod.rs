//! The board `board-h743`: an STM32H743ZI at 480 MHz, as on the Nucleo-144, with two HM01B0.
//!
//! The two sensors share the camera interface through a multiplexer that takes a pixel of each in turn.
//!
//! | signal | pin | |
//! |---|---|---|
//! | DCMI D0 to D7 | PC6 PC7 PC8 PC9 PE4 PD3 PE5 PE6 | the multiplexer's output |
//! | DCMI PIXCLK, HSYNC, VSYNC | PA6, PA4, PG9 | pixels valid while both are high |
//! | MCO1 | PA8 | 8 MHz: the master clock of the sensors and of the multiplexer |
//! | TIM3 CH1 | PB4 | the trigger pins of both sensors |
//! | I2C1 SCL, SDA | PB8, PB9 | first sensor |
//! | I2C2 SCL, SDA | PF1, PF0 | second sensor: both have the same address |
//! | USART1 TX | PB6 | row packets, 6 Mbaud |
//! | UART7 TX, RX | PE8, PE7 | kept for MAVLink |

pub mod camera;
pub mod clock;
pub mod cycles;
pub mod dma_memory;
pub mod panic;
pub mod sensors;
pub mod serial;
pub mod settings;

defmt::timestamp!("{=u64:us}", embassy_time::Instant::now().as_micros());
