//! The ring that DMA1 fills from the camera port: its counter tells how far it has come.

use core::sync::atomic::AtomicU32;

use embassy_stm32::dma::{Channel, InterruptHandler, ReadableRingBuffer, TransferOptions};
use embassy_stm32::interrupt::typelevel::{Binding, DMA1_STREAM0, Handler};
use embassy_stm32::peripherals::{self, DMA1_CH0};
use embassy_stm32::{Peri, dcmi, pac};

use crate::app::address_ring::AddressRing;
use crate::board::camera::{PortHandler, RING, serve, stored};
use crate::board::dma_memory::DmaCell;
use crate::dma_cell;

static MEMORY: DmaCell<[AtomicU32; RING]> = dma_cell!([AtomicU32; RING]);

/// Where in the ring DMA stores next, words.
pub fn position() -> u32 {
    u32::try_from(RING).unwrap_or(0) - u32::from(pac::DMA1.st(0).ndtr().read().ndt())
}

/// Whether DMA failed since the last look.
pub fn take_error() -> bool {
    let has_failed = pac::DMA1.isr(0).read().teif(0);
    if has_failed {
        pac::DMA1.ifcr(0).write(|w| w.set_teif(0, true));
    }
    has_failed
}

// Before the HAL, for which an error is a panic.
impl Handler<DMA1_STREAM0> for PortHandler {
    #[expect(unsafe_code, reason = "the trait's")]
    unsafe fn on_interrupt() {
        if pac::DMA1.isr(0).read().teif(0) {
            serve();
        }
    }
}

/// The ring. The HAL's reading out of it takes a division for each word: it only starts and stops DMA.
pub struct DmaRing {
    dma: ReadableRingBuffer<'static, u32>,
    ring: AddressRing<'static>,
}

impl DmaRing {
    /// Takes the channel. Can be called once.
    ///
    /// # Panics
    /// If it is called twice.
    pub fn new(
        dma: Peri<'static, DMA1_CH0>,
        irqs: impl Binding<DMA1_STREAM0, InterruptHandler<DMA1_CH0>> + 'static,
    ) -> Self {
        let request = dcmi::FrameDma::<peripherals::DCMI>::request(&*dma);
        let memory: &'static [AtomicU32; RING] = MEMORY.fill(|| AtomicU32::new(0));
        let from = pac::DCMI.dr().as_ptr().cast::<u32>();
        #[expect(unsafe_code, reason = "DMA into memory that is the ring's alone")]
        // SAFETY: the data register stays where it is; the HAL gives the memory's address to DMA and never looks at it
        // itself, for nobody reads by it, and who does reads atomically.
        let dma = unsafe {
            let words = core::slice::from_raw_parts_mut(memory.as_ptr().cast::<u32>().cast_mut(), RING);
            ReadableRingBuffer::new(Channel::new(dma, irqs), request, from, words, TransferOptions::default())
        };
        Self { dma, ring: AddressRing::new(memory, 0) }
    }

    /// Stops DMA.
    pub fn stop(&mut self) {
        self.dma.request_pause();
        while self.dma.is_running() {}
    }

    /// Starts DMA at the ring's first word.
    pub fn start(&mut self) {
        self.dma.start();
        self.ring.restart();
    }

    /// Reads the words from the one numbered `at` on; whether they were still there.
    pub fn read(&mut self, at: u32, to: &mut [[u8; 4]]) -> bool {
        self.ring.read(at, to, stored)
    }
}
