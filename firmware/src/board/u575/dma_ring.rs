//! The ring that GPDMA1 fills from the camera port. It has no counter of what is left of the ring: the destination address tells
//! how far it has come. Its block is the whole ring, and one linked-list item begins it anew, again and again; the HAL's own ring
//! counts its items in interrupts, and tells of a place half a ring off while one is waiting.

use core::sync::atomic::{AtomicU32, Ordering, fence};

use embassy_stm32::interrupt::typelevel::{GPDMA1_CHANNEL0, Handler};
use embassy_stm32::pac::gpdma::Channel;
use embassy_stm32::pac::gpdma::regs::{ChBr1, ChFcr, ChLlr};
use embassy_stm32::pac::gpdma::vals::{Ap, Dreq, Dw, Prio};
use embassy_stm32::peripherals::{self, GPDMA1_CH0};
use embassy_stm32::{Peri, dcmi, pac};

use crate::app::address_ring::AddressRing;
use crate::board::camera::{PortHandler, RING, serve, stored};

/// Bytes of the ring: a block has 65,535 at most.
#[expect(clippy::cast_possible_truncation, reason = "checked below")]
const BYTES: u16 = (4 * RING) as u16;
const _: () = assert!(4 * RING <= u16::MAX as usize);

/// All flags that can be cleared: `TCF` to `TOF`.
const FLAGS: u32 = 0b111_1111 << 8;

/// Looks until the channel must be at rest; it is reset then in any case.
const LOOKS: u32 = 1000;

/// DMA reaches all of the chip's SRAM.
static MEMORY: [AtomicU32; RING] = [const { AtomicU32::new(0) }; RING];
/// The linked-list item: block length, destination and link, in this order (RM0456, GPDMA linked-list data structure). Aligned,
/// it does not cross a border of 64 KiB, as it must not.
#[repr(C, align(16))]
struct Item([AtomicU32; 3]);
static ITEM: Item = Item([const { AtomicU32::new(0) }; 3]);

const fn channel() -> Channel {
    pac::GPDMA1.ch(0)
}

/// Addresses have 32 bits.
fn address(of: &[AtomicU32]) -> u32 {
    u32::try_from(of.as_ptr().addr()).unwrap_or(0)
}

fn ring() -> AddressRing<'static> {
    AddressRing::new(&MEMORY, address(&MEMORY))
}

/// Where in the ring DMA stores next, words.
pub fn position() -> u32 {
    ring().position(channel().dar().read())
}

/// Whether DMA failed since the last look.
pub fn take_error() -> bool {
    let status = channel().sr().read();
    let has_failed = status.dtef() || status.ulef() || status.usef();
    if has_failed {
        channel().fcr().write(|w| {
            w.set_dtef(true);
            w.set_ulef(true);
            w.set_usef(true);
        });
    }
    has_failed
}

// Errors are all that it interrupts for.
impl Handler<GPDMA1_CHANNEL0> for PortHandler {
    #[expect(unsafe_code, reason = "the trait's")]
    unsafe fn on_interrupt() {
        serve();
    }
}

/// The ring.
pub struct DmaRing {
    ring: AddressRing<'static>,
    request: u8,
    _channel: Peri<'static, GPDMA1_CH0>,
}

impl DmaRing {
    /// Takes the channel.
    #[must_use]
    pub fn new(dma: Peri<'static, GPDMA1_CH0>) -> Self {
        let request = dcmi::FrameDma::<peripherals::DCMI>::request(&*dma);
        Self { ring: ring(), request, _channel: dma }
    }

    /// Stops DMA.
    pub fn stop(&mut self) {
        if channel().cr().read().en() {
            channel().cr().modify(|w| w.set_susp(true));
            let is_at_rest = || {
                let status = channel().sr().read();
                status.suspf() || status.idlef()
            };
            let _ = (0..LOOKS).any(|_| is_at_rest());
        }
        channel().cr().write(|w| w.set_reset(true));
        channel().fcr().write_value(ChFcr(FLAGS));
        fence(Ordering::SeqCst);
    }

    /// Starts DMA at the ring's first word.
    pub fn start(&mut self) {
        self.ring.restart();
        let mut length = ChBr1::default();
        length.set_bndt(BYTES);
        let mut link = ChLlr::default();
        let (item, memory) = (address(&ITEM.0), address(&MEMORY));
        link.set_ub1(true);
        link.set_uda(true);
        link.set_ull(true);
        // The address within 64 KiB, words.
        link.set_la(low(item) >> 2);
        for (place, word) in ITEM.0.iter().zip([length.0, memory, link.0]) {
            place.store(word, Ordering::Relaxed);
        }
        fence(Ordering::SeqCst);
        channel().tr1().write(|w| {
            w.set_sdw(Dw::WORD);
            w.set_ddw(Dw::WORD);
            w.set_dinc(true);
            w.set_sap(Ap::PORT1);
            w.set_dap(Ap::PORT0);
        });
        channel().tr2().write(|w| {
            w.set_dreq(Dreq::SOURCE_PERIPHERAL);
            w.set_reqsel(self.request);
        });
        channel().br1().write_value(length);
        channel().sar().write_value(u32::try_from(pac::DCMI.dr().as_ptr().addr()).unwrap_or(0));
        channel().dar().write_value(memory);
        channel().lbar().write(|w| w.set_lba(high(item)));
        channel().llr().write_value(link);
        channel().cr().write(|w| {
            w.set_prio(Prio::HIGH);
            w.set_dteie(true);
            w.set_uleie(true);
            w.set_useie(true);
        });
        channel().cr().modify(|w| w.set_en(true));
    }

    /// Reads the words from the one numbered `at` on; whether they were still there.
    pub fn read(&mut self, at: u32, to: &mut [[u8; 4]]) -> bool {
        self.ring.read(at, to, stored)
    }
}

fn high(address: u32) -> u16 {
    let [.., a, b] = address.to_le_bytes();
    u16::from_le_bytes([a, b])
}

fn low(address: u32) -> u16 {
    let [a, b, ..] = address.to_le_bytes();
    u16::from_le_bytes([a, b])
}
