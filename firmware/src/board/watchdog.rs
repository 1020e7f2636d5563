//! The watchdog, whose clock nothing stops.

use embassy_stm32::wdg::IndependentWatchdog;

use super::this::parts::WatchdogUnit;
use crate::app::alive;

/// The chip begins anew when nobody fed the watchdog for so long, us.
pub const PERIOD: u32 = 2_000_000;

/// The watchdog.
pub struct Watchdog(pub IndependentWatchdog<'static, WatchdogUnit>);

impl alive::Watchdog for Watchdog {
    fn unleash(&mut self) {
        self.0.unleash();
    }

    fn pet(&mut self) {
        self.0.pet();
    }
}
