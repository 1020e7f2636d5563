//! The serial port byte by byte; the core sleeps while it waits.

use cortex_m::asm::wfe;
use cortex_m::peripheral::{NVIC, SCB};
use embassy_stm32::mode::Blocking;
use embassy_stm32::usart::Uart;
use haarline_firmware::board::this::debugger_port::{INTERRUPT, REGISTERS};

/// `SCR.SEVONPEND` (ARMv7-M, B3.2.7): an interrupt that becomes pending is an event, also while it is masked.
const SEVONPEND: u32 = 1 << 4;

/// The port, set up by the HAL.
pub struct Port {
    _uart: Uart<'static, Blocking>,
}

impl Port {
    #[expect(unsafe_code, reason = "a register of the core")]
    pub fn new(uart: Uart<'static, Blocking>, scb: &mut SCB) -> Self {
        // SAFETY: only lets interrupts that are not enabled wake the core.
        unsafe { scb.scr.modify(|scr| scr | SEVONPEND) };
        REGISTERS.cr1().modify(|w| w.set_rxneie(true));
        Self { _uart: uart }
    }

    /// The next byte. What was lost meanwhile is asked for again.
    pub fn take(&mut self) -> u8 {
        wait(|| REGISTERS.isr().read().rxne());
        REGISTERS.icr().write(|w| w.set_ore(true));
        REGISTERS.rdr().read().dr().to_le_bytes()[0]
    }

    /// Sends bytes.
    pub fn put(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            REGISTERS.cr1().modify(|w| w.set_txeie(true));
            wait(|| REGISTERS.isr().read().txe());
            REGISTERS.cr1().modify(|w| w.set_txeie(false));
            REGISTERS.tdr().write(|w| w.set_dr(u16::from(byte)));
        }
    }
}

/// Sleeps until it is so. The interrupt wakes the core and is never served: it is let through only while all are masked.
#[expect(unsafe_code, reason = "an interrupt that nobody serves")]
fn wait(is_ready: impl Fn() -> bool) {
    critical_section::with(|_| {
        // SAFETY: masked again before the critical section ends.
        unsafe { NVIC::unmask(INTERRUPT) };
        while !is_ready() {
            NVIC::unpend(INTERRUPT);
            if !is_ready() {
                wfe();
            }
        }
        NVIC::mask(INTERRUPT);
    });
}
