//! Cycles of the pipeline's stages, by the core's own counter.

use core::cell::Cell;

use cortex_m::peripheral::{DCB, DWT};
use haarline::{Stage, StageClock};

use super::phases;
use crate::app::edge::{Work, WorkClock};
use crate::app::phase::Activity;
use crate::app::statistics::StageTotals;

/// Where time goes that is no stage's.
const REST: usize = Stage::COUNT;

/// Counts cycles by stage. The counter wraps around after 9 s or more, a stage never lasts as long.
pub struct CycleClock {
    last: Cell<u32>,
    current: Cell<usize>,
    spent: [Cell<u64>; Stage::COUNT + 1],
    rows: Cell<u32>,
}

impl CycleClock {
    /// Nothing counted.
    #[expect(clippy::new_without_default, reason = "a static needs it const")]
    #[must_use]
    pub const fn new() -> Self {
        Self { last: Cell::new(0), current: Cell::new(REST), spent: [const { Cell::new(0) }; _], rows: Cell::new(0) }
    }

    /// Starts the core's counter.
    pub fn start(&self, dcb: &mut DCB, dwt: &mut DWT) {
        dcb.enable_trace();
        DWT::unlock();
        dwt.enable_cycle_counter();
        self.last.set(DWT::cycle_count());
    }

    fn go_to(&self, next: usize) {
        phases::tell(Activity::Compute, next != REST);
        let now = DWT::cycle_count();
        let spent = now.wrapping_sub(self.last.replace(now));
        if let Some(sum) = self.spent.get(self.current.replace(next)) {
            sum.set(sum.get() + u64::from(spent));
        }
    }
}

impl StageTotals for CycleClock {
    fn of(&self, stage: Stage) -> u64 {
        self.spent.get(stage.index()).map_or(0, Cell::get)
    }

    fn rows(&self) -> u32 {
        self.rows.get()
    }
}

impl StageClock for CycleClock {
    fn enter(&self, stage: Stage) {
        self.go_to(stage.index());
    }
}

impl WorkClock for CycleClock {
    fn rest(&self, _: Work) {
        self.go_to(REST);
        self.rows.set(self.rows.get().wrapping_add(1));
    }

    fn swap(&self, stage: Option<Stage>) -> Option<Stage> {
        let before = Stage::ALL.get(self.current.get()).copied();
        self.go_to(stage.map_or(REST, Stage::index));
        before
    }
}
