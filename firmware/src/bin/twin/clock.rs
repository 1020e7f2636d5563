//! Counts executed instructions by stage.
//!
//! QEMU with `-icount shift=6,sleep=off` lets each instruction take 64 ns of its virtual time, and the
//! machine's timer ticks every 40 or 50 ns of it: 8 ticks are 5 instructions, or 32 are 25. A single reading is
//! rounded to whole ticks, but those are less than an instruction, so each reading belongs to one number of
//! instructions, and numbers are what is added up.

use core::cell::Cell;
use core::sync::atomic::{Ordering, compiler_fence};

use haarline::{Stage, StageClock};
use haarline_firmware::app::edge::{Work, WorkClock};

/// Whether the machine is `mps2-an505`, of which this is the secure side.
const IS_AN505: bool = cfg!(machine = "an505");
/// Base of the CMSDK dual timer, of which the first one is used.
const TIMER: usize = if IS_AN505 { 0x5000_2000 } else { 0x4000_2000 };
/// Its ticks, and SysTick's, a microsecond.
pub const TICKS: u64 = if IS_AN505 { 20 } else { 25 };
/// So many ticks are so many instructions of 64 ns.
const RATIO: (u64, u64) = if IS_AN505 { (32, 25) } else { (8, 5) };
/// Its value, which counts down.
const VALUE: *const u32 = (TIMER + 0x4) as *const u32;
const CONTROL: *mut u32 = (TIMER + 0x8) as *mut u32;
/// Enabled, free running, no interrupt, no prescaler, 32 bits.
const FREE_RUNNING: u32 = 1 << 7 | 1 << 1;

/// Where time goes that is no stage's.
const REST: usize = Stage::COUNT;

/// Instructions of the stages, and of the rows.
pub struct TwinClock {
    /// The timer's last value.
    value: Cell<u32>,
    /// Ticks since the start.
    ticks: Cell<u64>,
    /// Instructions since the start.
    now: Cell<u64>,
    current: Cell<usize>,
    spent: [Cell<u64>; Stage::COUNT + 1],
    /// Times that each was entered.
    entered: [Cell<u64>; Stage::COUNT + 1],
    /// Instructions that going from one stage to the next costs.
    own: Cell<u64>,
    /// Rounds a reading.
    phase: Cell<u64>,
    /// What was spent up to the last row.
    before: Cell<u64>,
    pub rows: Rows,
}

/// What rows cost.
#[derive(Default)]
pub struct Rows {
    pub count: Cell<u64>,
    pub sum: Cell<u64>,
    pub worst: Cell<u64>,
    /// Of the ends of frames.
    pub ends: Cell<u64>,
}

impl TwinClock {
    /// Not started.
    pub const fn new() -> Self {
        Self {
            value: Cell::new(0),
            ticks: Cell::new(0),
            now: Cell::new(0),
            current: Cell::new(REST),
            spent: [const { Cell::new(0) }; _],
            entered: [const { Cell::new(0) }; _],
            own: Cell::new(0),
            phase: Cell::new(0),
            before: Cell::new(0),
            rows: Rows { count: Cell::new(0), sum: Cell::new(0), worst: Cell::new(0), ends: Cell::new(0) },
        }
    }

    /// Starts the timer, and finds out what counting costs.
    ///
    /// # Errors
    /// If the emulator does not count instructions.
    pub fn start(&self) -> Result<(), &'static str> {
        start_timer();
        self.value.set(read_timer());
        // How a reading is rounded depends on when the timer was started: the right way makes equal work equal.
        let phase = (0..RATIO.0).find(|&phase| {
            self.phase.set(phase);
            let [a, b, c, d, e, f] = [(); 6].map(|()| self.trial());
            self.own.set(a);
            [b, c, d, e, f] == [a; 5] && (10..500).contains(&a)
        });
        phase.map(|_| ()).ok_or("the timer counts no instructions: QEMU needs -icount shift=6,sleep=off")?;
        self.go_to(REST);
        for cell in self.spent.iter().chain(&self.entered) {
            cell.set(0);
        }
        Ok(())
    }

    /// Instructions of an empty stage.
    #[inline(never)]
    fn trial(&self) -> u64 {
        self.enter(Stage::Unpack);
        self.enter(Stage::Features);
        let before = self.spent[Stage::Features.index()].get();
        self.enter(Stage::Unpack);
        self.spent[Stage::Features.index()].get() - before
    }

    /// Instructions that each change of stage costs, subtracted from every figure.
    pub fn own(&self) -> u64 {
        self.own.get()
    }

    /// Instructions of a stage.
    pub fn of(&self, stage: Stage) -> u64 {
        self.net(stage.index())
    }

    fn net(&self, index: usize) -> u64 {
        self.spent[index].get().saturating_sub(self.entered[index].get() * self.own.get())
    }

    /// Instructions of all stages of the method: packets are told apart.
    pub fn total(&self) -> u64 {
        (0..Stage::COUNT).filter(|&index| index != Stage::Packets.index()).map(|index| self.net(index)).sum()
    }

    /// Adds what was executed since the last change to the stage that ends.
    #[inline(never)]
    fn go_to(&self, next: usize) {
        let value = read_timer();
        let ticks = self.ticks.get() + u64::from(self.value.replace(value).wrapping_sub(value));
        self.ticks.set(ticks);
        let now = (RATIO.1 * ticks + self.phase.get()) / RATIO.0;
        let spent = now - self.now.replace(now);
        let current = self.current.replace(next);
        self.spent[current % (Stage::COUNT + 1)].update(|sum| sum + spent);
        self.entered[next % (Stage::COUNT + 1)].update(|count| count + 1);
    }
}

impl StageClock for TwinClock {
    #[inline(always)]
    fn enter(&self, stage: Stage) {
        self.go_to(stage.index());
    }
}

impl WorkClock for TwinClock {
    fn rest(&self, work: Work) {
        self.go_to(REST);
        let total = self.total();
        let spent = total - self.before.replace(total);
        match work {
            Work::Row => {
                self.rows.count.update(|count| count + 1);
                self.rows.sum.update(|sum| sum + spent);
                self.rows.worst.update(|worst| worst.max(spent));
            }
            Work::FrameEnd => self.rows.ends.update(|sum| sum + spent),
        }
    }

    fn swap(&self, stage: Option<Stage>) -> Option<Stage> {
        let before = Stage::ALL.get(self.current.get()).copied();
        self.go_to(stage.map_or(REST, Stage::index));
        before
    }
}

#[expect(unsafe_code, reason = "a register of the machine")]
fn start_timer() {
    // SAFETY: a register of the machine this program is linked for; nothing else writes it.
    unsafe { CONTROL.write_volatile(FREE_RUNNING) }
}

/// The timer's value, which goes down by [`TICKS`] a microsecond.
#[expect(unsafe_code, reason = "a register of the machine")]
pub fn read_timer() -> u32 {
    // What is measured stays on its side.
    compiler_fence(Ordering::SeqCst);
    // SAFETY: a register of the machine this program is linked for; reading has no side effect.
    let value = unsafe { VALUE.read_volatile() };
    compiler_fence(Ordering::SeqCst);
    value
}
