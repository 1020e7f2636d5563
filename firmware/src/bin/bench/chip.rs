//! The serial port of the debugger, and one method after the other.

use core::mem::MaybeUninit;

use defmt_rtt as _;
use embassy_stm32::usart;
use haarline::{Config, Full, Lite, StereoMethod, WaveletBlock, blocks_for};
use haarline_firmware::board::cycles::CycleClock;
use haarline_firmware::board::dma_memory::DmaCell;
use haarline_firmware::board::this::start::Started;
use haarline_firmware::board::this::{debugger_port, start};
use haarline_firmware::dma_cell;
use haarline_link::message::{DISPARITIES, KEPT, Method, WIDTH};
use haarline_link::server::Server;
use haarline_tests::sgm::words_for;
use haarline_tests::{BlockSettings, Sgm, StereoBm};

use crate::port::Port;
use crate::work::{Begin, Row, Work};

type Clock = &'static CycleClock;

const BAUD: u32 = 921_600;
#[expect(clippy::cast_possible_truncation, reason = "48")]
const SEARCHED: u16 = DISPARITIES as u16;
#[expect(clippy::cast_possible_truncation, reason = "320")]
const BLOCKS: usize = blocks_for(WIDTH as u16);

type LargeSgm = Sgm<WIDTH, { words_for(SEARCHED) }, Clock>;

static ROWS: DmaCell<[Row; KEPT]> = dma_cell!([Row; KEPT]);
static SGM: DmaCell<LargeSgm> = dma_cell!(LargeSgm);

/// The port, and what it asks for.
struct Bench {
    port: Port,
    server: Server,
    work: Work,
    clock: Clock,
    /// Where `sgm` lies.
    sgm: Option<&'static mut MaybeUninit<LargeSgm>>,
}

#[cortex_m_rt::entry]
fn main() -> ! {
    let Started { peripherals: p, mut core, clock } = start::start();
    let mut config = usart::Config::default();
    config.baudrate = BAUD;
    let Ok(uart) = debugger_port::open(p, config) else { defmt::panic!("the clock gives 921,600 baud") };
    let port = Port::new(uart, &mut core.SCB);
    let rows = ROWS.fill(|| Row::EMPTY);
    let mut bench =
        Bench { port, server: Server::default(), work: Work::new(rows, clock), clock, sgm: Some(SGM.uninit()) };
    defmt::info!("bench: waiting for `haarline silicon` at {=u32} baud", BAUD);
    let mut begin = bench.serve(None, 0, 0);
    loop {
        let config = Config { width: begin.width, min_disparity: begin.min_disparity, num_disparities: SEARCHED };
        let run = match begin.method {
            Method::Full => full,
            Method::Lite => lite,
            Method::WaveletBlock => wavelet_block,
            Method::Block => block,
            Method::Sgm => sgm,
        };
        begin = run(&mut bench, config);
    }
}

impl Bench {
    /// Does what is asked for, until another frame is to begin.
    fn serve(&mut self, mut method: Option<&mut dyn StereoMethod>, width: u16, state: usize) -> Begin {
        self.work.begin(usize::from(width), state);
        let Self { port, server, work, .. } = self;
        loop {
            let byte = port.take();
            let method = method.as_mut().map(|method| &mut **method as &mut dyn StereoMethod);
            let execute = |request: &[u8], answer: &mut _| work.execute(request, method, answer);
            server.take(byte, |bytes| port.put(bytes), execute);
            if let Some(begin) = work.next.take() {
                return begin;
            }
        }
    }

    /// Serves with a method of its own, if it takes the configuration.
    fn with<M: StereoMethod, E>(&mut self, method: Result<M, E>, config: Config) -> Begin {
        match method {
            Ok(mut method) => self.serve(Some(&mut method), config.width, size_of::<M>()),
            Err(_) => self.serve(None, 0, 0),
        }
    }
}

// Each has all of the stack for itself.

#[inline(never)]
fn full(bench: &mut Bench, config: Config) -> Begin {
    bench.with(Full::<BLOCKS, _>::timed(config, bench.clock), config)
}

#[inline(never)]
fn lite(bench: &mut Bench, config: Config) -> Begin {
    bench.with(Lite::<BLOCKS, _>::timed(config, bench.clock), config)
}

#[inline(never)]
fn wavelet_block(bench: &mut Bench, config: Config) -> Begin {
    bench.with(WaveletBlock::<BLOCKS, _>::timed(config, bench.clock), config)
}

#[inline(never)]
fn block(bench: &mut Bench, config: Config) -> Begin {
    let method = StereoBm::<WIDTH, DISPARITIES, 9, _>::timed(config, BlockSettings::default(), bench.clock);
    bench.with(method, config)
}

/// Its state of 60 KB would leave the stack less than building it takes: it lies in DMA's memory.
#[inline(never)]
fn sgm(bench: &mut Bench, config: Config) -> Begin {
    let Some(place) = bench.sgm.take() else { defmt::panic!("one frame at a time") };
    let begin = match Sgm::timed(config, bench.clock) {
        Ok(method) => bench.serve(Some(place.write(method)), config.width, size_of::<LargeSgm>()),
        Err(_) => bench.serve(None, 0, 0),
    };
    bench.sgm = Some(place);
    begin
}
