//! The methods one after the other, again and again, so that a profiler sees where cycles go. Nobody sleeps, and no
//! watchdog is started: nothing but the probe stops the counter.

use core::fmt::Write;

use defmt_rtt as _;
use haarline::contour_stereo::rows_for;
use haarline::{ContourStereo, EnvelopeStereo, Full, Lite, Stage, StereoMethod, WaveletBlock};
use haarline_firmware::app::edge::{Work, WorkClock};
use haarline_firmware::app::statistics::StageTotals;
use haarline_firmware::board::cycles::CycleClock;
use haarline_firmware::board::this::{CACHES, SERIES, clock, start};
use haarline_firmware::selftest::picture::{HEIGHT, WIDTH};
use haarline_firmware::selftest::{BLOCKS, CONFIG, DISPARITIES, checksum, expected};
use haarline_firmware::stack;
use haarline_tests::{BlockSettings, StereoBm};

type Clock = &'static CycleClock;
/// A line of the table. defmt pads numbers with zeros only and texts not at all, so it is put together here.
type Line = heapless::String<192>;

#[cortex_m_rt::entry]
fn main() -> ! {
    let cycles: Clock = start::start().clock;
    loop {
        head();
        let mut passed = true;
        for method in [full, lite, wavelet_block, contour, envelope, block] {
            // Each has all of the stack for itself.
            stack::paint();
            passed &= method(cycles);
        }
        if passed {
            defmt::info!("self test passed");
        } else {
            defmt::error!("self test FAILED");
        }
        // Time for a probe to fetch the log.
        cortex_m::asm::delay(clock::CORE / 100);
    }
}

#[inline(never)]
fn full(clock: Clock) -> bool {
    test("full", &mut defmt::unwrap!(Full::<BLOCKS, _>::timed(CONFIG, clock).ok()), clock)
}

#[inline(never)]
fn lite(clock: Clock) -> bool {
    test("lite", &mut defmt::unwrap!(Lite::<BLOCKS, _>::timed(CONFIG, clock).ok()), clock)
}

#[inline(never)]
fn wavelet_block(clock: Clock) -> bool {
    test("wavelet-block", &mut defmt::unwrap!(WaveletBlock::<BLOCKS, _>::timed(CONFIG, clock).ok()), clock)
}

#[inline(never)]
fn contour(clock: Clock) -> bool {
    let method = ContourStereo::<BLOCKS, { rows_for(2) }, _>::timed(CONFIG, clock);
    test("contour", &mut defmt::unwrap!(method.ok()), clock)
}

#[inline(never)]
fn envelope(clock: Clock) -> bool {
    test("envelope", &mut defmt::unwrap!(EnvelopeStereo::<BLOCKS, _>::timed(CONFIG, clock).ok()), clock)
}

#[inline(never)]
fn block(clock: Clock) -> bool {
    let method = StereoBm::<{ WIDTH as usize }, DISPARITIES, 9, _>::timed(CONFIG, BlockSettings::default(), clock);
    test("block", &mut defmt::unwrap!(method.ok()), clock)
}

/// All that must be known to read the table, and the names of its columns.
fn head() {
    let revision = start::revision();
    defmt::info!(
        "self test of Haarline {=str}: {=str} (revision {=str}, {=u16:#06x}) at {=u32} MHz, {=str}",
        env!("CARGO_PKG_VERSION"),
        SERIES,
        revision.name(),
        revision.0,
        clock::core_hz(revision) / 1_000_000,
        CACHES
    );
    defmt::info!(
        "cycles for {=u16}x{=u32} px, {=usize} disparities, to take the checksum counts as output; stack of {=usize} B",
        WIDTH,
        HEIGHT,
        DISPARITIES,
        stack::size()
    );
    let mut line = Line::new();
    let _ = write!(line, "{:13}", "method");
    for stage in Stage::ALL {
        let _ = write!(line, " {:>1$}", stage.name(), width(stage));
    }
    let _ = write!(line, " | {:>9} {:>7} {:>7} checksum", "total", "a pixel", "stack");
    defmt::info!("{=str}", line);
}

/// Runs one method, and prints its line: whether its checksum is the host's.
fn test(name: &str, method: &mut dyn StereoMethod, clock: Clock) -> bool {
    let before = Stage::ALL.map(|stage| clock.of(stage));
    let sum = checksum(method, &clock, || clock.rest(Work::Row));
    let stack = stack::high_water();
    let mut line = Line::new();
    let _ = write!(line, "{name:13}");
    let mut total = 0;
    for (stage, before) in Stage::ALL.into_iter().zip(before) {
        let cycles = clock.of(stage) - before;
        total += cycles;
        let _ = write!(line, " {:>1$}", cycles, width(stage));
    }
    let passed = expected(name) == Some(sum);
    let pixels = u64::from(WIDTH) * u64::from(HEIGHT);
    let verdict = if passed { "ok" } else { "WRONG" };
    let _ = write!(line, " | {total:>9} {:>7} {stack:>7} {sum:08x} {verdict}", total / pixels);
    defmt::info!("{=str}", line);
    passed
}

/// Characters of a stage's column.
fn width(stage: Stage) -> usize {
    stage.name().len().max(9)
}
