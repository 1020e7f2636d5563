//! Bytes out of a serial port, by DMA.

use embassy_stm32::mode::Async;
use embassy_stm32::usart::{Error, UartTx};

use crate::app::edge::PacketSink;

/// A port and the memory that DMA fetches its bytes from.
pub struct Serial {
    port: UartTx<'static, Async>,
    chunk: &'static mut [u8],
}

impl Serial {
    /// Sends through `port`; `chunk`, of which each transfer takes what fits, lies where DMA reaches it.
    #[must_use]
    pub const fn new(port: UartTx<'static, Async>, chunk: &'static mut [u8]) -> Self {
        Self { port, chunk }
    }

    /// Sends all of it.
    ///
    /// # Errors
    /// If DMA fails.
    pub async fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        for bytes in bytes.chunks(self.chunk.len().max(1)) {
            let (chunk, _) = self.chunk.split_at_mut(bytes.len());
            chunk.copy_from_slice(bytes);
            self.port.write(chunk).await?;
        }
        Ok(())
    }
}

impl PacketSink for Serial {
    async fn send(&mut self, _: u32, packet: &[u8]) {
        if let Err(error) = Self::send(self, packet).await {
            defmt::warn!("serial port: {}", error);
        }
    }

    async fn finish(&mut self) {}
}
