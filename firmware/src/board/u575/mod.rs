//! The board of the feature `board-u575`: an STM32U575ZI at 160 MHz, as on the NUCLEO-U575ZI-Q, with two MT9V034 that share
//! the camera interface with seven data lines each (wiring "pairs14"). **Not tried on silicon.**
//!
//! | signal | pin | |
//! |---|---|---|
//! | DCMI D0 to D6 | PC6 PC7 PC8 PC9 PE4 PD3 PE5 | D3 to D9 of the first |
//! | DCMI D7 to D13 | PE6 PC10 PC12 PD6 PD2 PF6 PG15 | D3 to D9 of the second |
//! | DCMI PIXCLK, HSYNC, VSYNC | PA6, PA4, PB7 | PIXCLK, LINE_VALID, FRAME_VALID of the first |
//! | TIM1 CH1 | PA8 | 13.33 or 13.5 MHz: SYSCLK of both |
//! | TIM3 CH1, CH2 | PB4, PB5 | EXPOSURE and STANDBY of both |
//! | I2C1 SCL, SDA | PB8, PB9 | first sensor |
//! | I2C2 SCL, SDA | PF1, PF0 | second sensor |
//! | USART1 TX | PB6 | row packets, 8 or 4 Mbaud |
//! | USART2 TX | PD5 | MAVLink, 115,200 baud |
//! | phase, low and high | PE9, PE11 | with the feature `measure`: what the program is doing |
//!
//! Two LEDs of the Nucleo hang on camera pins: LD1 on PC7, LD2 on PB7.

pub mod clock;
pub mod debugger_port;
pub mod dma_ring;
pub mod guard;
pub mod parts;
pub mod reset;
pub mod start;

#[cfg(not(sensor = "mt9v034"))]
compile_error!("HAARLINE_RIG: on this board wiring is \"pairs14\" (two MT9V034)");

/// The camera port's interrupt.
pub use embassy_stm32::interrupt::typelevel::DCMI_PSSI as PortInterrupt;

/// Raw rows that may wait for the vision task: more than elsewhere, for even the slowest lines of these sensors come twice as fast
/// as this core works on them. There is memory for it, and it does not grow with the height either.
pub const RAW_ROWS: usize = 3 * crate::app::ring::RAW_ROWS;
/// What the log calls it.
pub const NAME: &str = "board-u575";
/// What its chip is called.
pub const SERIES: &str = "STM32U575";
/// Its caches.
pub const CACHES: &str = "instruction cache on";
