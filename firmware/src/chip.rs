//! The tasks between the cameras and the serial ports, and the board they run on.

mod prompt;

use core::sync::atomic::AtomicBool;

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_futures::join::join;
use embassy_stm32::gpio::{Flex, OutputType, Speed};
use embassy_stm32::interrupt::{self, InterruptExt, Priority};
use embassy_stm32::peripherals::{DMA1_CH0, DMA1_CH1, DMA1_CH2, IWDG1, TIM3};
use embassy_stm32::rcc::{Mco, Mco1Source, McoConfig, McoPrescaler};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::CountingMode;
use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm};
use embassy_stm32::usart::{self, UartTx};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Peripherals, bind_interrupts, dma, i2c};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::zerocopy_channel::Channel;
use embassy_time::{Duration, Instant, Ticker};
use haarline::frame_figures::FrameFigures;
use haarline::{ConfigError, Full, Lite, Rectified, Setup, Stage, StereoMethod, Untimed, blocks_for};
use haarline_firmware::autopilot::Sightings;
use haarline_firmware::capture::Patience;
use haarline_firmware::h743::camera::{Camera, Pins, PortHandler};
use haarline_firmware::h743::cycles::CycleClock;
use haarline_firmware::h743::dma_memory::DmaMemory;
use haarline_firmware::h743::serial::Serial;
use haarline_firmware::h743::settings::{self, Method};
use haarline_firmware::h743::{clock, idle, reset, sensors};
use haarline_firmware::lookout::Lookout;
use haarline_firmware::rig::{PLAN, SECTORS};
use haarline_firmware::ring::{From, RAW_ROWS, RESULT_PAIRS, RawRow, ResultRows, SharedCounters, To};
use haarline_firmware::{autopilot, capture, results, stack, vision};
use static_cell::{ConstStaticCell, StaticCell};

bind_interrupts!(struct Irqs {
    DCMI => PortHandler;
    DMA1_STREAM0 => PortHandler, dma::InterruptHandler<DMA1_CH0>;
    DMA1_STREAM1 => dma::InterruptHandler<DMA1_CH1>;
    DMA1_STREAM2 => dma::InterruptHandler<DMA1_CH2>;
});

const BLOCKS: usize = blocks_for(settings::WIDTH);
/// The row packets' port. Two rows of 320 px have 150 bytes or so, a quarter of a millisecond; at 5 frames a second they come
/// every 1.5 ms.
const ROWS_BAUD: u32 = 6_000_000;
/// Bytes of row packets that one transfer takes.
const ROWS_CHUNK: usize = 1088;
/// MAVLink's port: a message has 179 bytes, and comes with each frame.
const MAVLINK_BAUD: u32 = 115_200;
/// The chip begins anew when the vision task stood still for so long, us.
const WATCHDOG: u32 = 2_000_000;
/// A camera is silent that sends no row for 16 lines' time, or no frame for half a frame's longer than it should.
const PATIENCE: Patience = Patience {
    within: Duration::from_micros(16 * settings::LINE_US as u64),
    between: Duration::from_micros(1_500_000 / settings::FRAME_RATE as u64),
};

type Clock = &'static CycleClock;
/// The method behind rectification, with the rows that the rig needs.
type Behind = Rectified<&'static mut dyn StereoMethod, { PLAN.waiting_rows() }, { settings::WIDTH as usize }, Clock>;

/// What happened to the camera's frames.
static COUNTERS: SharedCounters = SharedCounters::new();
static CLOCK: ConstStaticCell<CycleClock> = ConstStaticCell::new(CycleClock::new());
static METHOD_FULL: StaticCell<Full<BLOCKS, Clock>> = StaticCell::new();
static METHOD_LITE: StaticCell<Lite<BLOCKS, Clock>> = StaticCell::new();
static BEHIND: StaticCell<Behind> = StaticCell::new();
static RAW_RING: ConstStaticCell<[RawRow; RAW_ROWS]> = ConstStaticCell::new([RawRow::EMPTY; RAW_ROWS]);
static RAW: StaticCell<Channel<'static, CriticalSectionRawMutex, RawRow>> = StaticCell::new();
static RESULTS: StaticCell<Channel<'static, CriticalSectionRawMutex, ResultRows>> = StaticCell::new();
static SIGHTINGS: Sightings<SECTORS> = Sightings::new();

// Not for DMA, but to leave the fast memory to the pipeline and the stack.
#[unsafe(link_section = ".dma")]
#[expect(unsafe_code, reason = "a section of the linker script")]
static RESULT_RING: DmaMemory<[ResultRows; RESULT_PAIRS]> = DmaMemory::new();
static RESULT_RING_TAKEN: AtomicBool = AtomicBool::new(false);
#[unsafe(link_section = ".dma")]
#[expect(unsafe_code, reason = "a section of the linker script")]
static ROWS_MEMORY: DmaMemory<[u8; ROWS_CHUNK]> = DmaMemory::new();
static ROWS_MEMORY_TAKEN: AtomicBool = AtomicBool::new(false);
#[unsafe(link_section = ".dma")]
#[expect(unsafe_code, reason = "a section of the linker script")]
static MAVLINK_MEMORY: DmaMemory<[u8; haarline_telemetry::MAX_BYTES]> = DmaMemory::new();
static MAVLINK_MEMORY_TAKEN: AtomicBool = AtomicBool::new(false);

#[cortex_m_rt::entry]
fn main() -> ! {
    stack::paint();
    let p = embassy_stm32::init(clock::config());
    let Some(mut core) = cortex_m::Peripherals::take() else { defmt::panic!("the core's peripherals are gone") };
    // The data cache stays off: the pipeline lives in DTCM, which has none, and DMA's memory must not be cached.
    core.SCB.enable_icache();
    let clock = CLOCK.take();
    clock.start(&mut core.DCB, &mut core.DWT);
    defmt::info!(
        "Haarline on board-h743: {=u16}x{=u32} px, disparities {=i16} to {=i16}, {=u32} frames a second; started by {=str}",
        settings::WIDTH,
        settings::HEIGHT,
        settings::CONFIG.min_disparity,
        settings::CONFIG.min_disparity.saturating_add_unsigned(settings::CONFIG.num_disparities - 1),
        settings::FRAME_RATE,
        reset::cause()
    );
    idle::run(&mut core.SCB, |spawner| {
        start(spawner, clock, p);
        defmt::info!("stack at start-up at most {=usize} of {=usize} B", stack::high_water(), stack::size());
        // From here on it is the tasks' own depth that counts.
        stack::paint();
    })
}

/// Starts the cameras, the ports and the tasks.
#[inline(never)]
fn start(spawner: Spawner, clock: Clock, p: Peripherals) {
    // The sensors' master clock comes before anything is asked of them. It stays on.
    let mut mco = McoConfig::default();
    (mco.prescaler, mco.speed) = (McoPrescaler::DIV1, Speed::Medium);
    let _master_clock = Mco::new(p.MCO1, p.PA8, Mco1Source::HSE, mco);
    let pin = PwmPin::new(p.PB4, OutputType::PushPull);
    let rate = Hertz(settings::FRAME_RATE);
    let trigger = SimplePwm::new(p.TIM3, Some(pin), None, None, None, rate, CountingMode::EdgeAlignedUp);
    let mut config = i2c::Config::default();
    config.frequency = Hertz::khz(400);
    config.timeout = Duration::from_millis(5);
    let first = i2c::I2c::new_blocking(p.I2C1, p.PB8, p.PB9, config);
    let second = i2c::I2c::new_blocking(p.I2C2, p.PF1, p.PF0, config);

    let data = [
        Flex::new(p.PC6),
        Flex::new(p.PC7),
        Flex::new(p.PC8),
        Flex::new(p.PC9),
        Flex::new(p.PE4),
        Flex::new(p.PD3),
        Flex::new(p.PE5),
        Flex::new(p.PE6),
    ];
    let pins = Pins::new(data, [Flex::new(p.PA6), Flex::new(p.PA4), Flex::new(p.PG9)]);
    let camera = Camera::start(p.DCMI, p.DMA1_CH0, Irqs, pins);

    let mut config = usart::Config::default();
    config.baudrate = ROWS_BAUD;
    let Ok(rows) = UartTx::new(p.USART1, p.PB6, p.DMA1_CH1, Irqs, config) else {
        defmt::panic!("120 MHz give 6 Mbaud")
    };
    let rows = Serial::new(rows, ROWS_MEMORY.take(&ROWS_MEMORY_TAKEN, [0; _]));
    config.baudrate = MAVLINK_BAUD;
    let Ok(mavlink) = UartTx::new(p.UART7, p.PE8, p.DMA1_CH2, Irqs, config) else {
        defmt::panic!("120 MHz give 115,200 baud")
    };
    let mavlink = Serial::new(mavlink, MAVLINK_MEMORY.take(&MAVLINK_MEMORY_TAKEN, [0; _]));
    let watchdog = IndependentWatchdog::new(p.IWDG1, WATCHDOG);
    let Some(setup) = PLAN.setup() else { defmt::panic!("the rig has more sectors than it says") };

    let (raw_to, raw_from) = RAW.init(Channel::new(RAW_RING.take())).split();
    let (results_to, results_from) = RESULTS.init(Channel::new(result_ring())).split();
    // Each is spawned once, here.
    interrupt::UART4.set_priority(Priority::P6);
    let prompt = prompt::EXECUTOR.start(interrupt::UART4);
    prompt.spawn(capture_task(camera, raw_to).unwrap());
    prompt.spawn(results_task(results_from, rows).unwrap());
    prompt.spawn(autopilot_task(mavlink).unwrap());
    spawner.spawn(vision_task(clock, behind_offset(clock), setup, raw_from, results_to, watchdog).unwrap());
    spawner.spawn(sensors_task([first, second], trigger).unwrap());
    spawner.spawn(statistics_task(clock).unwrap());
}

// Functions of their own, so that what they need of the stack is needed one after the other and at start-up only.

#[inline(never)]
fn result_ring() -> &'static mut [ResultRows; RESULT_PAIRS] {
    RESULT_RING.take(&RESULT_RING_TAKEN, [ResultRows::EMPTY; _])
}

/// Builds the method.
#[inline(never)]
fn method(clock: Clock) -> Result<&'static mut dyn StereoMethod, ConfigError> {
    Ok(match settings::METHOD {
        Method::Full => METHOD_FULL.init(Full::timed(settings::CONFIG, clock)?),
        Method::Lite => METHOD_LITE.init(Lite::timed(settings::CONFIG, clock)?),
    })
}

/// Builds it behind rectification.
fn behind_offset(clock: Clock) -> &'static mut Behind {
    match method(clock).and_then(|method| Rectified::timed(method, PLAN.height, PLAN.rectification, clock)) {
        Ok(behind) => BEHIND.init(behind),
        Err(error) => defmt::panic!("the rig: {}", defmt::Display2Format(&error)),
    }
}

#[embassy_executor::task]
async fn capture_task(camera: Camera, ring: To<RawRow>) {
    let raw_len = settings::WIRING.row_bytes(settings::WIDTH);
    capture::capture(camera, ring, &COUNTERS, PATIENCE, raw_len, settings::HEIGHT).await;
}

#[embassy_executor::task]
async fn vision_task(
    clock: Clock,
    method: &'static mut Behind,
    setup: Setup<SECTORS>,
    raw: From<RawRow>,
    rows: To<ResultRows>,
    watchdog: IndependentWatchdog<'static, IWDG1>,
) {
    let lookout = match Lookout::<SECTORS, BLOCKS, _>::new(&setup, |sighting| SIGHTINGS.signal(sighting)) {
        Ok(lookout) => lookout,
        Err(error) => defmt::panic!("the rig: {}", defmt::Display2Format(&error)),
    };
    let work = vision::vision(method, settings::WIRING, clock, Some(lookout), raw, rows, &COUNTERS);
    join(work, feed(clock, watchdog)).await;
}

/// Feeds the watchdog inside of the vision task: not while that one is busy for ever, nor while it leaves
/// the camera's frames where they are.
async fn feed(clock: Clock, mut watchdog: IndependentWatchdog<'static, IWDG1>) {
    watchdog.unleash();
    let mut ticker = Ticker::every(Duration::from_micros(u64::from(WATCHDOG / 4)));
    let (mut rows, mut frames) = (0, 0);
    loop {
        let (rows_before, frames_before) = (rows, frames);
        (rows, frames) = (clock.rows(), COUNTERS.get().frames);
        if rows != rows_before || frames == frames_before {
            watchdog.pet();
        }
        ticker.next().await;
    }
}

#[embassy_executor::task]
async fn results_task(rows: From<ResultRows>, serial: Serial) {
    // In interrupts: its cycles are in those of the stages that it comes in.

    results::results(rows, serial, [settings::WIDTH, PLAN.height], &Untimed).await;
}

#[embassy_executor::task]
async fn autopilot_task(serial: Serial) {
    autopilot::autopilot(&SIGHTINGS, &PLAN.reach, settings::MAVLINK_SYSTEM, serial).await;
}

#[embassy_executor::task]
async fn sensors_task(buses: [sensors::Bus; 2], trigger: SimplePwm<'static, TIM3>) {
    sensors::run(buses, trigger).await;
}

/// Once a second: what came, what was lost and why, and what it cost. A stage's cycles hold those of the
/// interrupts that came meanwhile.
#[embassy_executor::task]
async fn statistics_task(clock: Clock) {
    let mut ticker = Ticker::every(Duration::from_secs(1));
    let mut before = [0; Stage::COUNT];
    let (mut told, mut slept) = (Instant::now(), 0);
    loop {
        ticker.next().await;
        let counters = COUNTERS.get();
        defmt::info!(
            "frames {=u32}, rows {=u32}; lost rows {=u32}, late frames {=u32}, overruns {=u32}, DMA errors {=u32}, short {=u32}, long {=u32}, silences {=u32}",
            counters.frames,
            counters.rows,
            counters.dropped_rows,
            counters.dropped_frames,
            counters.overruns,
            counters.dma_errors,
            counters.short,
            counters.long,
            counters.stalled
        );
        let last = COUNTERS.last_frame();
        if let Some(FrameFigures { input, mismatch, sure }) = last.figures {
            defmt::info!(
                "input {=str}, mismatch {=u16} per mille, sure {=u16} per mille; frames not sent {=u32}",
                input.name(),
                mismatch.unwrap_or(0),
                sure,
                last.unsent_frames
            );
        }
        let now = Stage::ALL.map(|stage| clock.of(stage));
        let [unpack, rectify, features, contours, seeds, blocks, agreement, consistency, output, _]: [u64;
            Stage::COUNT] = core::array::from_fn(|nth| now[nth] - before[nth]);
        before = now;
        defmt::info!(
            "cycles: unpack {=u64}, rectify {=u64}, features {=u64}, contours {=u64}, seeds {=u64}, blocks {=u64}, agreement {=u64}, consistency {=u64}, output {=u64}",
            unpack,
            rectify,
            features,
            contours,
            seeds,
            blocks,
            agreement,
            consistency,
            output
        );
        let (slept_before, told_before) = (slept, told);
        (slept, told) = (idle::slept_us(), Instant::now());
        let share = 100 * (slept - slept_before) / (told - told_before).as_micros().max(1);
        defmt::info!("asleep {=u64} percent, stack at most {=usize} B", share, stack::high_water());
    }
}
