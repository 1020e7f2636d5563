//! Time for embassy-time: the machine's timer tells it, SysTick wakes.
//!
//! Only the camera's silence needs an alarm, and none is set while rows keep coming.

use core::cell::RefCell;
use core::task::Waker;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use critical_section::{CriticalSection, Mutex};
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

use crate::clock::{TICKS, read_timer};

/// Longest wait of SysTick, microseconds: 24 bits.
const LONGEST: u64 = (1 << 24) / TICKS - 1;

struct Inner {
    /// The timer's last value, and ticks so far.
    value: u32,
    ticks: u64,
    queue: Queue,
    systick: Option<SYST>,
}

struct TimeDriver(Mutex<RefCell<Inner>>);

embassy_time_driver::time_driver_impl!(static DRIVER: TimeDriver = TimeDriver(Mutex::new(RefCell::new(Inner {
    value: 0,
    ticks: 0,
    queue: Queue::new(),
    systick: None,
}))));

/// Gives the alarm its timer.
pub fn start(mut systick: SYST) {
    systick.set_clock_source(SystClkSource::Core);
    systick.enable_interrupt();
    critical_section::with(|cs| {
        let mut inner = DRIVER.0.borrow(cs).borrow_mut();
        inner.value = read_timer();
        inner.systick = Some(systick);
    });
}

impl Inner {
    fn now(&mut self) -> u64 {
        let value = read_timer();
        self.ticks += u64::from(self.value.wrapping_sub(value));
        self.value = value;
        self.ticks / TICKS
    }

    /// Wakes whoever is due, and sets the alarm for the next one.
    fn set_alarm(&mut self) {
        let now = self.now();
        let at = self.queue.next_expiration(now);
        let Some(systick) = &mut self.systick else { return };
        systick.disable_counter();
        if at == u64::MAX {
            return;
        }
        let wait = at.saturating_sub(now).clamp(1, LONGEST) * TICKS;
        systick.set_reload(u32::try_from(wait).unwrap_or(u32::MAX >> 8));
        systick.clear_current();
        systick.enable_counter();
    }
}

impl TimeDriver {
    fn with<T>(&self, cs: CriticalSection<'_>, act: impl FnOnce(&mut Inner) -> T) -> T {
        act(&mut self.0.borrow(cs).borrow_mut())
    }
}

impl Driver for TimeDriver {
    fn now(&self) -> u64 {
        critical_section::with(|cs| self.with(cs, Inner::now))
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|cs| {
            self.with(cs, |inner| {
                if inner.queue.schedule_wake(at, waker) {
                    inner.set_alarm();
                }
            });
        });
    }
}

#[cortex_m_rt::exception]
fn SysTick() {
    critical_section::with(|cs| DRIVER.with(cs, Inner::set_alarm));
}
