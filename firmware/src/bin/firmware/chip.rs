//! The tasks between the cameras and the serial ports.

#[cfg(not(feature = "measure"))]
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_futures::join::join;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::zerocopy_channel::Channel;
use embassy_time::Duration;
use haarline::{ConfigError, Full, Lite, Rectified, Setup, StereoMethod, blocks_for};
use haarline_firmware::app::autopilot::Sightings;
use haarline_firmware::app::capture::Patience;
use haarline_firmware::app::lookout::Lookout;
use haarline_firmware::app::ring::{From, RESULT_SLOTS, RawRow, ResultRows, SharedCounters, To};
use haarline_firmware::app::settings::{self, Method};
use haarline_firmware::app::shown::{ShownPackets, ShownSink, ShownSource};
use haarline_firmware::app::{alive, autopilot, capture, measuring, results, statistics, vision};
use haarline_firmware::board::camera::Camera;
use haarline_firmware::board::cycles::CycleClock;
use haarline_firmware::board::dma_memory::DmaCell;
use haarline_firmware::board::pair::LINE_US;
use haarline_firmware::board::sensors::{Ready, Sensors};
use haarline_firmware::board::serial::Serial;
use haarline_firmware::board::this::parts::Parts;
use haarline_firmware::board::this::start::Started;
use haarline_firmware::board::this::{NAME, RAW_ROWS, clock, reset, start};
use haarline_firmware::board::watchdog::{self, Watchdog};
use haarline_firmware::board::{idle, phases, prompt, sensors};
use haarline_firmware::rig::{PLAN, SECTORS};
use haarline_firmware::{dma_cell, stack};
use static_cell::StaticCell;

const BLOCKS: usize = blocks_for(settings::WIDTH);
/// A camera is silent that sends no row for 16 lines' time, or no frame for half a frame's longer than it should.
const PATIENCE: Patience = Patience {
    within: Duration::from_micros(16 * LINE_US as u64),
    between: Duration::from_micros(1_500_000 / settings::FRAME_RATE as u64),
};

type Clock = &'static CycleClock;
/// The method behind rectification, with the rows that the rig needs.
type Behind = Rectified<&'static mut dyn StereoMethod, { PLAN.waiting_rows() }, { settings::WIDTH as usize }, Clock>;

/// What a probe fetches when a current was measured.
#[expect(unsafe_code, reason = "a name that a probe's user finds")]
#[unsafe(no_mangle)]
static HAARLINE_MEASURED: measuring::Words = measuring::Words::new();
/// What happened to the camera's frames.
static COUNTERS: SharedCounters = SharedCounters::new();
/// The sensors are set up.
static READY: Ready = Ready::new();
static METHOD_FULL: StaticCell<Full<BLOCKS, Clock>> = StaticCell::new();
static METHOD_LITE: StaticCell<Lite<BLOCKS, Clock>> = StaticCell::new();
static BEHIND: StaticCell<Behind> = StaticCell::new();
static RAW: StaticCell<Channel<'static, CriticalSectionRawMutex, RawRow>> = StaticCell::new();
static RESULTS: StaticCell<Channel<'static, CriticalSectionRawMutex, ResultRows>> = StaticCell::new();
static SIGHTINGS: Sightings<SECTORS> = Sightings::new();
// Not for DMA, but to leave the fast memory to the pipeline and the stack.
static RAW_RING: DmaCell<[RawRow; RAW_ROWS]> = dma_cell!([RawRow; RAW_ROWS]);
static RESULT_RING: DmaCell<[ResultRows; RESULT_SLOTS]> = dma_cell!([ResultRows; RESULT_SLOTS]);

#[cortex_m_rt::entry]
fn main() -> ! {
    stack::paint();
    let Started { peripherals, mut core, clock } = start::start();
    defmt::info!(
        "Haarline on {=str}: {=u16}x{=u32} px, disparities {=i16} to {=i16}, {=u32} frames a second; started by {=str}",
        NAME,
        settings::WIDTH,
        settings::HEIGHT,
        settings::CONFIG.min_disparity,
        settings::CONFIG.min_disparity.saturating_add_unsigned(settings::CONFIG.num_disparities - 1),
        settings::FRAME_RATE,
        reset::cause()
    );
    idle::run(&mut core.SCB, |spawner| {
        spawn(spawner, clock, Parts::new(peripherals));
        defmt::info!("stack at start-up at most {=usize} of {=usize} B", stack::high_water(), stack::size());
        // From here on it is the tasks' own depth that counts.
        stack::paint();
    })
}

/// Starts the tasks.
#[inline(never)]
fn spawn(spawner: Spawner, clock: Clock, parts: Parts) {
    let Some(setup) = PLAN.setup() else { defmt::panic!("the rig has more sectors than it says") };
    let (raw_to, raw_from) = RAW.init(Channel::new(RAW_RING.fill(|| RawRow::EMPTY))).split();
    let (results_to, results_from) = RESULTS.init(Channel::new(RESULT_RING.fill(|| ResultRows::EMPTY))).split();
    // Each is spawned once, here.
    let prompt = prompt::start();
    prompt.spawn(capture_task(parts.camera, raw_to).unwrap());
    prompt.spawn(results_task(results_from, parts.rows).unwrap());
    prompt.spawn(autopilot_task(parts.mavlink).unwrap());
    let method = method(clock);
    spawner
        .spawn(vision_task(clock, behind_offset(method, clock), setup, raw_from, results_to, parts.watchdog).unwrap());
    spawner.spawn(sensors_task(parts.sensors).unwrap());
    spawner.spawn(statistics_task(clock).unwrap());
}

// Functions of their own, so that what they need of the stack is needed one after the other and at start-up only.

/// Builds the method.
#[inline(never)]
fn method(clock: Clock) -> Result<&'static mut dyn StereoMethod, ConfigError> {
    Ok(match settings::METHOD {
        Method::Full => METHOD_FULL.uninit().write(Full::timed(settings::CONFIG, clock)?),
        Method::Lite => METHOD_LITE.uninit().write(Lite::timed(settings::CONFIG, clock)?),
    })
}

/// Puts it behind rectification.
#[inline(never)]
fn behind_offset(method: Result<&'static mut dyn StereoMethod, ConfigError>, clock: Clock) -> &'static mut Behind {
    let method = method.unwrap_or_else(|error| refuse(error));
    BEHIND.init_with(|| {
        Rectified::timed(method, PLAN.height, PLAN.rectification, clock).unwrap_or_else(|error| refuse(error))
    })
}

fn refuse(error: ConfigError) -> ! {
    defmt::panic!("the rig: {}", defmt::Display2Format(&error))
}

#[embassy_executor::task]
async fn capture_task(mut camera: Camera, ring: To<RawRow>) {
    READY.wait().await;
    camera.begin();
    let raw_len = settings::WIRING.row_bytes(settings::WIDTH);
    let camera = ShownSource::new(camera, phases::tell);
    capture::capture(camera, ring, &COUNTERS, PATIENCE, raw_len, settings::HEIGHT).await;
}

#[embassy_executor::task]
async fn vision_task(
    clock: Clock,
    method: &'static mut Behind,
    setup: Setup<SECTORS>,
    raw: From<RawRow>,
    rows: To<ResultRows>,
    watchdog: Watchdog,
) {
    let lookout = match Lookout::<SECTORS, BLOCKS, _>::new(&setup, |sighting| SIGHTINGS.signal(sighting)) {
        Ok(lookout) => lookout,
        Err(error) => defmt::panic!("the rig: {}", defmt::Display2Format(&error)),
    };
    let work = vision::vision(method, settings::WIRING, clock, Some(lookout), raw, rows, &COUNTERS);
    let period = Duration::from_micros(u64::from(watchdog::PERIOD / 4));
    join(work, alive::feed(clock, &COUNTERS, watchdog, period)).await;
}

#[embassy_executor::task]
async fn results_task(rows: From<ResultRows>, serial: Serial) {
    // In interrupts: its cycles are in those of the stages that it comes in.
    let (serial, packets) = (ShownSink::new(serial, phases::tell), ShownPackets(phases::tell));
    results::results(rows, serial, [settings::WIDTH, PLAN.height], &packets).await;
}

#[embassy_executor::task]
async fn autopilot_task(serial: Serial) {
    autopilot::autopilot(&SIGHTINGS, &PLAN.reach, settings::MAVLINK_SYSTEM, serial).await;
}

#[embassy_executor::task]
async fn sensors_task(sensors: Sensors) {
    sensors::run(sensors, &READY).await;
}

#[embassy_executor::task]
async fn statistics_task(clock: Clock) {
    if cfg!(feature = "measure") {
        let (hz, size) = (clock::core_hz(start::revision()), [settings::WIDTH, PLAN.height]);
        measuring::measuring(clock, &COUNTERS, idle::slept_us, hz, size, &HAARLINE_MEASURED).await;
    }
    statistics::statistics(clock, &COUNTERS, idle::slept_us).await;
}
