//! The independent watchdog of the STM32H743 (RM0433, chapter "IWDG"), which resets the part unless the
//! program writes its key in time.
//!
//! Its clock is the LSI, which starts with it. New settings count at once: no flag of the status register
//! is ever set. Option bytes that start it without the program are not modelled.

use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::soc::stm32h743::generated::iwdg::{Register, kr, pr, rlr, winr};
use rigless::soc::stm32h743::peripherals::rcc::IWDG_STARTED;
use rigless::time::{EventId, VirtualNanos};

const UNLOCK: u64 = 0x5555;
const RELOAD: u64 = 0xAAAA;
const START: u64 = 0xCCCC;
/// What it starts from, whatever the reload register says.
const FIRST: u64 = 0xFFF;
const SECOND: u64 = 1_000_000_000;

/// The watchdog.
#[derive(Debug)]
pub struct Watchdog {
    /// The settings can be written.
    is_open: bool,
    prescaler: u64,
    reload: u64,
    window: u64,
    /// What the counter held, and when, once it was started.
    count: Option<(u64, u64)>,
    /// Its clock, Hz; 0 while that does not run.
    clock: u64,
    event: Option<EventId>,
}

impl Default for Watchdog {
    fn default() -> Self {
        Self { is_open: false, prescaler: 0, reload: FIRST, window: FIRST, count: None, clock: 0, event: None }
    }
}

impl Watchdog {
    /// Clocks of the LSI to a step of the counter.
    fn divider(&self) -> u64 {
        4 << self.prescaler.min(6)
    }

    /// What the counter holds.
    fn value(&self, now: u64) -> Option<u64> {
        let (count, since) = self.count?;
        let clocks = u128::from(now - since) * u128::from(self.clock) / u128::from(SECOND);
        let steps = u64::try_from(clocks / u128::from(self.divider())).unwrap_or(u64::MAX);
        Some(count.saturating_sub(steps))
    }

    /// Counts from `value` on, at the present settings; a step under way begins anew.
    fn count_from(&mut self, value: u64, context: &mut DeviceContext<'_>) {
        let now = context.now().0;
        self.count = Some((value, now));
        self.event = None;
        if self.clock > 0 {
            // It ends with the step after zero.
            let clocks = (value + 1) * self.divider();
            self.event = Some(context.schedule(VirtualNanos(now + (clocks * SECOND).div_ceil(self.clock))));
        }
    }

    fn key(&mut self, key: u64, context: &mut DeviceContext<'_>) {
        self.is_open = key == UNLOCK;
        match (key, self.value(context.now().0)) {
            (START, None) => {
                self.count_from(FIRST, context);
                context.request(IWDG_STARTED, Level::High);
            }
            (RELOAD, Some(value)) if value > self.window => context.request_reset(),
            (RELOAD, Some(_)) => self.count_from(self.reload, context),
            _ => {}
        }
    }
}

impl Device for Watchdog {
    type Register = Register;

    fn write(&mut self, register: Register, value: u64, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let now = context.now().0;
        match register {
            Register::Kr => self.key(kr::KEY.get(value), context),
            Register::Pr if self.is_open => {
                let left = self.value(now);
                self.prescaler = pr::PR.get(value);
                if let Some(left) = left {
                    self.count_from(left, context);
                }
            }
            Register::Rlr if self.is_open => self.reload = rlr::RL.get(value),
            Register::Winr if self.is_open => {
                self.window = winr::WIN.get(value);
                // This is a reload too.
                if self.count.is_some() {
                    self.count_from(self.reload, context);
                }
            }
            _ => {}
        }
        registers.set(Register::Pr, self.prescaler);
        registers.set(Register::Rlr, self.reload);
        registers.set(Register::Winr, self.window);
    }

    fn on_clock(&mut self, hz: u64, _registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let left = self.value(context.now().0);
        self.clock = hz;
        if let Some(left) = left {
            self.count_from(left, context);
        }
    }

    fn on_event(&mut self, event: EventId, _registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        if self.event == Some(event) {
            context.request_reset();
        }
    }

    fn reset(&mut self) {
        *self = Self::default();
    }
}
