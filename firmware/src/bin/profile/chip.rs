//! One task: it works for 3 s without a pause, sleeps for 1 s, and goes on with the next method.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_executor::Spawner;
use embassy_time::{Duration, Instant, Timer};
use haarline::contour_stereo::rows_for;
use haarline::{ContourStereo, EnvelopeStereo, Full, Lite, StereoMethod, WaveletBlock};
use haarline_firmware::app::edge::{Work, WorkClock};
use haarline_firmware::board::cycles::CycleClock;
use haarline_firmware::board::this::start;
use haarline_firmware::board::this::start::Started;
use haarline_firmware::board::{idle, phases};
use haarline_firmware::selftest::picture::WIDTH;
use haarline_firmware::selftest::{BLOCKS, CONFIG, DISPARITIES, checksum, expected};
use haarline_firmware::stack;
use haarline_tests::sgm::words_for;
use haarline_tests::{BlockSettings, Sgm, StereoBm};

type Clock = &'static CycleClock;

/// How long each method works, and how long the chip sleeps then.
const WORK: Duration = Duration::from_secs(3);
const SLEEP: Duration = Duration::from_secs(1);
/// In their order.
const METHODS: [fn(Clock) -> Frames; 7] = [full, lite, wavelet_block, contour, envelope, block, sgm];

/// What a probe fetches: frames of each method's last segment, then frames of all segments that were not the host's.
#[expect(unsafe_code, reason = "a name that a probe's user finds")]
#[unsafe(no_mangle)]
static HAARLINE_FRAMES: [AtomicU32; METHODS.len() + 1] = [const { AtomicU32::new(0) }; _];

/// Frames of a segment.
struct Frames {
    all: u32,
    wrong: u32,
}

#[cortex_m_rt::entry]
fn main() -> ! {
    stack::paint();
    let Started { peripherals, mut core, clock } = start::start();
    phases::start(peripherals.PE9, peripherals.PE11);
    idle::run(&mut core.SCB, |spawner: Spawner| {
        // It is spawned once, here.
        spawner.spawn(profile_task(clock).unwrap());
    })
}

#[embassy_executor::task]
async fn profile_task(clock: Clock) {
    let [frames @ .., wrong] = &HAARLINE_FRAMES;
    loop {
        for (method, frames) in METHODS.into_iter().zip(frames) {
            Timer::after(SLEEP).await;
            let found = method(clock);
            frames.store(found.all, Ordering::Relaxed);
            wrong.fetch_add(found.wrong, Ordering::Relaxed);
        }
    }
}

/// Works for as long as it shall. The clock stays within the method's stages, so that the pins tell of no pause.
fn work(name: &str, method: &mut dyn StereoMethod, clock: Clock) -> Frames {
    let begun = Instant::now();
    let mut frames = Frames { all: 0, wrong: 0 };
    while begun.elapsed() < WORK {
        let sum = checksum(method, &clock, || {});
        frames.all += 1;
        frames.wrong += u32::from(expected(name) != Some(sum));
    }
    clock.rest(Work::FrameEnd);
    frames
}

// Functions of their own, so that each method has all of the stack for itself.

#[inline(never)]
fn full(clock: Clock) -> Frames {
    work("full", &mut defmt::unwrap!(Full::<BLOCKS, _>::timed(CONFIG, clock).ok()), clock)
}

#[inline(never)]
fn lite(clock: Clock) -> Frames {
    work("lite", &mut defmt::unwrap!(Lite::<BLOCKS, _>::timed(CONFIG, clock).ok()), clock)
}

#[inline(never)]
fn wavelet_block(clock: Clock) -> Frames {
    work("wavelet-block", &mut defmt::unwrap!(WaveletBlock::<BLOCKS, _>::timed(CONFIG, clock).ok()), clock)
}

#[inline(never)]
fn contour(clock: Clock) -> Frames {
    let method = ContourStereo::<BLOCKS, { rows_for(2) }, _>::timed(CONFIG, clock);
    work("contour", &mut defmt::unwrap!(method.ok()), clock)
}

#[inline(never)]
fn envelope(clock: Clock) -> Frames {
    work("envelope", &mut defmt::unwrap!(EnvelopeStereo::<BLOCKS, _>::timed(CONFIG, clock).ok()), clock)
}

#[inline(never)]
fn block(clock: Clock) -> Frames {
    let method = StereoBm::<{ WIDTH as usize }, DISPARITIES, 9, _>::timed(CONFIG, BlockSettings::default(), clock);
    work("block", &mut defmt::unwrap!(method.ok()), clock)
}

#[inline(never)]
fn sgm(clock: Clock) -> Frames {
    #[expect(clippy::cast_possible_truncation, reason = "32")]
    const WORDS: usize = words_for(DISPARITIES as u16);
    let method = Sgm::<{ WIDTH as usize }, WORDS, _>::timed(CONFIG, clock);
    work("sgm", &mut defmt::unwrap!(method.ok()), clock)
}
