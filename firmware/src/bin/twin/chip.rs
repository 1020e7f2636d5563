//! The program: the three tasks between two files.

use defmt_semihosting as _;
use embassy_executor::{Executor, Spawner};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::zerocopy_channel::Channel;
use embassy_time::Duration;
use haarline::obstacle::MAX_SECTORS;
use haarline::{Rectified, Setup, StereoMethod, Wiring, blocks_for};
use haarline_firmware::app::capture::Patience;
use haarline_firmware::app::lookout::Lookout;
use haarline_firmware::app::ring::{From, MAX_WIDTH, RAW_ROWS, RESULT_SLOTS, RawRow, ResultRows, SharedCounters, To};
use haarline_firmware::app::{capture, results, vision};
use haarline_firmware::stack;
use semihosting::fs::File;
use semihosting::{eprintln, process};
use static_cell::{ConstStaticCell, StaticCell};

use crate::clock::TwinClock;
use crate::options::Options;
use crate::sink::FileSink;
use crate::source::FileSource;
use crate::{file, methods, obstacles, tables, time};

/// A camera that delivers nothing for so long is silent: three frames at 30 a second.
pub const PATIENCE: Patience = Patience { within: Duration::from_millis(100), between: Duration::from_millis(100) };
/// The method behind rectification, with rows for every rig whose views fit.
type Behind = Rectified<&'static mut dyn StereoMethod, 64, MAX_WIDTH, &'static TwinClock>;

/// What happened to the camera's frames.
pub static COUNTERS: SharedCounters = SharedCounters::new();

static CLOCK: ConstStaticCell<TwinClock> = ConstStaticCell::new(TwinClock::new());
static RAW_RING: ConstStaticCell<[RawRow; RAW_ROWS]> = ConstStaticCell::new([RawRow::EMPTY; RAW_ROWS]);
static RESULT_RING: ConstStaticCell<[ResultRows; RESULT_SLOTS]> =
    ConstStaticCell::new([ResultRows::EMPTY; RESULT_SLOTS]);
static RAW: StaticCell<Channel<'static, CriticalSectionRawMutex, RawRow>> = StaticCell::new();
static RESULTS: StaticCell<Channel<'static, CriticalSectionRawMutex, ResultRows>> = StaticCell::new();
static BEHIND: StaticCell<Behind> = StaticCell::new();
static EXECUTOR: StaticCell<Executor> = StaticCell::new();

/// What start-up makes for the tasks.
struct Parts {
    options: Options,
    clock: &'static TwinClock,
    method: &'static mut dyn StereoMethod,
    source: FileSource,
    sink: FileSink,
    watch: Option<Watch>,
}

/// The rig's eyes, and where goes what they see.
struct Watch {
    setup: Setup<MAX_SECTORS>,
    file: File,
}

#[cortex_m_rt::entry]
fn main() -> ! {
    stack::paint();
    match start() {
        Ok(parts) => {
            // From here on it is the application's own depth that counts.
            stack::paint();
            EXECUTOR.init(Executor::new()).run(|spawner| spawn(spawner, parts))
        }
        Err(message) => {
            eprintln!("error: {message}");
            process::exit(1)
        }
    }
}

#[inline(never)]
fn start() -> Result<Parts, &'static str> {
    let args = semihosting::experimental::env::args::<1024>().map_err(|_| "no command line")?;
    let options = Options::parse((&args).into_iter().skip(1).filter_map(Result::ok))?;
    let clock: &'static TwinClock = CLOCK.take();
    clock.start()?;
    let core = cortex_m::Peripherals::take().ok_or("the peripherals are gone")?;
    time::start(core.SYST);
    let method = methods::build(&options, clock)?;
    let (method, watch): (&'static mut dyn StereoMethod, _) = match &options.plan {
        Some(plan) => {
            let rectification = tables::complete(plan.rectification, &options)?;
            let behind = Rectified::timed(method, plan.height, rectification, clock);
            let behind = behind.map_err(|_| "the rig's offset is out of range, or needs more than 64 rows")?;
            let setup = plan.setup().ok_or("the rig has too many sectors")?;
            (BEHIND.init(behind), Some(Watch { setup, file: file::create(file::OBSTACLES)? }))
        }
        None => (method, None),
    };
    let source = FileSource::open(&options)?;
    let sink = FileSink::create(&options, clock, stack::high_water())?;
    Ok(Parts { options, clock, method, source, sink, watch })
}

fn spawn(spawner: Spawner, parts: Parts) {
    let Parts { options, clock, method, source, sink, watch } = parts;
    let raw = RAW.init(Channel::new(RAW_RING.take()));
    let (raw_to, raw_from) = raw.split();
    let results = RESULTS.init(Channel::new(RESULT_RING.take()));
    let (results_to, results_from) = results.split();
    let size = [options.config.width, u16::try_from(options.height).unwrap_or(u16::MAX)];
    // Each is spawned once, at start-up.
    spawner.spawn(capture_task(source, raw_to, options).unwrap());
    spawner.spawn(vision_task(method, options.wiring, clock, watch, raw_from, results_to).unwrap());
    spawner.spawn(results_task(results_from, sink, size, clock).unwrap());
}

#[embassy_executor::task]
async fn capture_task(source: FileSource, ring: To<RawRow>, options: Options) {
    capture::capture(source, ring, &COUNTERS, PATIENCE, options.raw_len, options.height).await;
}

#[embassy_executor::task]
async fn vision_task(
    method: &'static mut dyn StereoMethod,
    wiring: Wiring,
    clock: &'static TwinClock,
    watch: Option<Watch>,
    raw: From<RawRow>,
    rows: To<ResultRows>,
) {
    let lookout = watch.map(|Watch { setup, mut file }| {
        let looking = Lookout::<MAX_SECTORS, { blocks_for(320) }, _>::new(&setup, move |sighting| {
            obstacles::note(&mut file, &sighting);
        });
        looking.unwrap_or_else(|_| {
            eprintln!("error: the rig's figures are out of range");
            process::exit(1)
        })
    });
    vision::vision(method, wiring, clock, lookout, raw, rows, &COUNTERS).await;
}

#[embassy_executor::task]
async fn results_task(rows: From<ResultRows>, sink: FileSink, size: [u16; 2], clock: &'static TwinClock) {
    results::results(rows, sink, size, clock).await;
}
