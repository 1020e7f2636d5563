//! The two phase pins: PE9 the low one (D6 on both Nucleos), PE11 the high one (D5). In use with the feature `measure` only.

use core::cell::Cell;

use critical_section::Mutex;
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::{Peri, pac, peripherals};

use super::this::clock;
use crate::app::phase::{Activities, Activity, Phase};

/// Whether they are in use.
const ARE_USED: bool = cfg!(feature = "measure");
/// How long a phase between two others lasts: longer than a slow pin's edge, and less than a sample of most meters, 100 ns.
const BETWEEN: u32 = clock::CORE / 10_000_000;
/// Their numbers on port E.
const LOW: usize = 9;
const HIGH: usize = 11;

static ACTIVITIES: Mutex<Cell<Activities>> = Mutex::new(Cell::new(Activities::NONE));

/// Takes the pins: both low, which is idle.
pub fn start(low: Peri<'static, peripherals::PE9>, high: Peri<'static, peripherals::PE11>) {
    if ARE_USED {
        // Outputs for ever.
        core::mem::forget(Output::new(low, Level::Low, Speed::Low));
        core::mem::forget(Output::new(high, Level::Low, Speed::Low));
    }
}

/// Something begins or ends.
pub fn tell(activity: Activity, is_on: bool) {
    if ARE_USED {
        critical_section::with(|cs| {
            let mut activities = ACTIVITIES.borrow(cs).get();
            let before = activities.phase();
            if let Some(phase) = activities.set(activity, is_on) {
                if let Some(between) = before.between(phase) {
                    show(between);
                    cortex_m::asm::delay(BETWEEN);
                }
                show(phase);
            }
            ACTIVITIES.borrow(cs).set(activities);
        });
    }
}

fn show(phase: Phase) {
    let [low, high] = phase.pins();
    pac::GPIOE.bsrr().write(|w| {
        for (pin, is_high) in [(LOW, low), (HIGH, high)] {
            if is_high { w.set_bs(pin, true) } else { w.set_br(pin, true) }
        }
    });
}
