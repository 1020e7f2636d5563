//! The program: random rows through the method, and then how deep the stack went.

// Its critical section.
use cortex_m as _;
use defmt_semihosting as _;
use haarline::{Config, DisparityRow, ScanlinePair, StereoMethod};
#[cfg(footprint = "null")]
use haarline::{Disparity, RowError};
use haarline_firmware::stack;
use semihosting::{println, process};
use static_cell::StaticCell;

const WIDTH: usize = 320;
const CONFIG: Config = Config { width: 320, min_disparity: 0, num_disparities: 48 };
/// Rows of a frame: more than any method keeps.
const ROWS: usize = 64;

/// Takes rows and knows nothing.
#[cfg(footprint = "null")]
struct Null;

#[cfg(footprint = "null")]
impl StereoMethod for Null {
    fn config(&self) -> &Config {
        &CONFIG
    }

    fn start(&mut self) {}

    fn push(&mut self, _: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        self.miss(sink);
        Ok(())
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        static UNKNOWN: [Disparity; WIDTH] = [Disparity::UNKNOWN; WIDTH];
        static CONFIDENCE: [u8; WIDTH] = [0; WIDTH];
        sink(DisparityRow { y: 0, disparity: &UNKNOWN, confidence: &CONFIDENCE });
    }

    fn finish(&mut self, _: &mut dyn FnMut(DisparityRow<'_>)) {}
}

#[cfg(footprint = "null")]
type Method = Null;
#[cfg(footprint = "lite")]
type Method = haarline::Lite<{ haarline::blocks_for(320) }>;
#[cfg(footprint = "full")]
type Method = haarline::Full<{ haarline::blocks_for(320) }>;
#[cfg(footprint = "block")]
type Method = haarline_tests::StereoBm<WIDTH, 48>;
#[cfg(footprint = "sgm")]
type Method = haarline_tests::Sgm<WIDTH, { haarline_tests::sgm::words_for(48) }>;

static METHOD: StaticCell<Method> = StaticCell::new();

#[inline(never)]
fn build() -> Option<&'static mut Method> {
    #[cfg(footprint = "null")]
    let method = Some(Null);
    #[cfg(any(footprint = "lite", footprint = "full", footprint = "sgm"))]
    let method = Method::new(CONFIG).ok();
    #[cfg(footprint = "block")]
    let method = Method::new(CONFIG, haarline_tests::BlockSettings::default()).ok();
    Some(METHOD.init(method?))
}

#[cortex_m_rt::entry]
fn main() -> ! {
    let Some(method) = build() else { process::exit(1) };
    // The pushes' own depth counts.
    stack::paint();
    let seen = frame(method);
    println!("state {} stack {} rows {seen}", size_of::<Method>(), stack::high_water());
    process::exit(0)
}

/// Random rows, so that every part of a method has work.
#[inline(never)]
fn frame(method: &mut dyn StereoMethod) -> usize {
    let (mut left, mut right, mut state) = ([0; WIDTH], [0; WIDTH], 1_u32);
    let mut seen = 0;
    let mut sink = |row: DisparityRow<'_>| seen += usize::from(row.disparity.len() == WIDTH);
    for _ in 0..ROWS {
        for byte in left.iter_mut().chain(&mut right) {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            [.., *byte] = state.to_le_bytes();
        }
        let _ = method.push(ScanlinePair { left: &left, right: &right }, &mut sink);
    }
    seen
}
