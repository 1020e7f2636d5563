//! The boards, a folder each: pins, clocks, DMA, interrupts, and what `build.rs` reads of it in `board.toml`.

#[cfg(feature = "board-h743")]
pub mod h743;
/// The board that the programs are built for.
#[cfg(feature = "board-h743")]
pub use h743 as this;
