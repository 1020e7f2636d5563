//! Why the chip began anew (RM0456, `RCC_CSR`).

use embassy_stm32::pac;

/// The cause of the last reset, for the log; the flags are cleared, so that the next one tells its own.
///
/// A reset raises the flag of the pin, too: those that name a cause come first.
#[must_use]
pub fn cause() -> &'static str {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    if flags.iwdgrstf() {
        "the watchdog: the vision task stood still"
    } else if flags.sftrstf() {
        "the program itself, after a panic or a fault"
    } else if flags.borrstf() {
        "power"
    } else {
        "the reset pin"
    }
}
