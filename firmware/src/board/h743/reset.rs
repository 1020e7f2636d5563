//! Why the chip began anew (RM0433, section 8.7.39).

use embassy_stm32::pac;

/// The cause of the last reset, for the log; the flags are cleared, so that the next one tells its own.
///
/// A reset raises the flags of everything that it resets: those that name a cause come first.
#[must_use]
pub fn cause() -> &'static str {
    let flags = pac::RCC.rsr().read();
    pac::RCC.rsr().modify(|w| w.set_rmvf(true));
    if flags.iwdg1rstf() {
        "the watchdog: the vision task stood still"
    } else if flags.sftrstf() {
        "the program itself, after a panic or a fault"
    } else if flags.borrstf() || flags.porrstf() {
        "power"
    } else {
        "the reset pin"
    }
}
