//! The boards: what differs, a folder each, with pins, clocks, DMA and what `build.rs` reads of it in `board.toml`; and beside
//! the folders what they share.

pub mod camera;
pub mod cycles;
pub mod dma_memory;
pub mod free_bus;
pub mod idle;
pub mod load;
mod pace;
#[cfg(sensor = "mt9v034")]
pub mod pair_mt9v034;
mod panic;
pub mod phases;
pub mod prompt;
pub mod sensors;
pub mod serial;
pub mod trigger;
pub mod watchdog;

#[cfg(feature = "board-h743")]
pub mod h743;
#[cfg(feature = "board-u575")]
pub mod u575;

/// The board that the programs are built for.
#[cfg(feature = "board-h743")]
pub use h743 as this;
#[cfg(feature = "board-u575")]
pub use u575 as this;

/// The pair of sensors that the rig's wiring asks for.
#[cfg(sensor = "mt9v034")]
pub use pair_mt9v034 as pair;
#[cfg(sensor = "hm01b0")]
pub use this::pair_hm01b0 as pair;

defmt::timestamp!("{=u64:us}", embassy_time::Instant::now().as_micros());

/// The chip, as probe-rs names it.
pub const CHIP: &str = env!("HAARLINE_CHIP");
