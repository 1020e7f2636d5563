//! The methods one after the other, again and again, so that a profiler sees where cycles go.

use defmt_rtt as _;
use haarline::{Full, Lite, Stage, StereoMethod};
use haarline_firmware::edge::{Work, WorkClock};
use haarline_firmware::h743::clock;
use haarline_firmware::h743::cycles::CycleClock;
use haarline_firmware::picture::{HEIGHT, WIDTH};
use haarline_firmware::selftest::{BLOCKS, CONFIG, DISPARITIES, checksum, expected};
use haarline_firmware::stack;
use haarline_tests::{BlockSettings, StereoBm};
use static_cell::ConstStaticCell;

type Clock = &'static CycleClock;

static CLOCK: ConstStaticCell<CycleClock> = ConstStaticCell::new(CycleClock::new());

#[cortex_m_rt::entry]
fn main() -> ! {
    stack::paint();
    let _p = embassy_stm32::init(clock::config());
    let cycles: Clock = CLOCK.take();
    if let Some(mut core) = cortex_m::Peripherals::take() {
        core.SCB.enable_icache();
        cycles.start(&mut core.DCB, &mut core.DWT);
    }
    defmt::info!("self test of Haarline: {=u16}x{=u32} px at {=u32} MHz", WIDTH, HEIGHT, clock::CORE / 1_000_000);
    loop {
        let passed = [full(cycles), lite(cycles), block(cycles)];
        if passed == [true; 3] {
            defmt::info!("self test passed; stack at most {=usize} B", stack::high_water());
        } else {
            defmt::error!("self test FAILED");
        }
        // Time for a probe to fetch the log.
        cortex_m::asm::delay(clock::CORE / 100);
    }
}

// Each has all of the stack for itself, one after the other.

#[inline(never)]
fn full(clock: Clock) -> bool {
    test("full", &mut defmt::unwrap!(Full::<BLOCKS, _>::timed(CONFIG, clock).ok()), clock)
}

#[inline(never)]
fn lite(clock: Clock) -> bool {
    test("lite", &mut defmt::unwrap!(Lite::<BLOCKS, _>::timed(CONFIG, clock).ok()), clock)
}

#[inline(never)]
fn block(clock: Clock) -> bool {
    let method = StereoBm::<{ WIDTH as usize }, DISPARITIES, 9, _>::timed(CONFIG, BlockSettings::default(), clock);
    test("block", &mut defmt::unwrap!(method.ok()), clock)
}

/// One method: whether its checksum is the host's.
fn test(name: &str, method: &mut dyn StereoMethod, clock: Clock) -> bool {
    let before = Stage::ALL.map(|stage| clock.of(stage));
    let sum = checksum(method, || clock.rest(Work::Row));
    let mut total = 0;
    for (stage, before) in Stage::ALL.into_iter().zip(before) {
        let cycles = clock.of(stage) - before;
        total += cycles;
        defmt::info!("{=str} {=str}: {=u64} cycles", name, stage.name(), cycles);
    }
    let pixels = u64::from(WIDTH) * u64::from(HEIGHT);
    let passed = expected(name) == Some(sum);
    defmt::info!(
        "{=str}: {=u64} cycles, {=u64} a pixel; checksum {=u32:#010x} {=str}",
        name,
        total,
        total / pixels,
        sum,
        if passed { "as on the host" } else { "NOT as on the host" }
    );
    passed
}
