//! The stereo methods, each with its place in memory. The sizes of these statics are what the host
//! reports as the methods' memory.

use haarline::contour_stereo::rows_for;
use haarline::{ConfigError, ContourStereo, EnvelopeStereo, Full, Lite, StereoMethod, WaveletBlock, blocks_for};
use haarline_firmware::app::ring::MAX_WIDTH;
use haarline_tests::sgm::words_for;
use haarline_tests::{BlockSettings, Sgm, StereoBm};
use static_cell::StaticCell;

use crate::clock::TwinClock;
use crate::options::{Method, Options};

const BLOCKS: usize = blocks_for(320);
/// Disparities that the references have room for.
const REFERENCE_DISPARITIES: u16 = 128;

type Clock = &'static TwinClock;

static METHOD_LITE: StaticCell<Lite<BLOCKS, Clock>> = StaticCell::new();
static METHOD_FULL: StaticCell<Full<BLOCKS, Clock>> = StaticCell::new();
static METHOD_WAVELET_BLOCK: StaticCell<WaveletBlock<BLOCKS, Clock>> = StaticCell::new();
static METHOD_CONTOUR: StaticCell<ContourStereo<BLOCKS, { rows_for(2) }, Clock>> = StaticCell::new();
static METHOD_ENVELOPE: StaticCell<EnvelopeStereo<BLOCKS, Clock>> = StaticCell::new();
static METHOD_BLOCK: StaticCell<StereoBm<MAX_WIDTH, { REFERENCE_DISPARITIES as usize }, 9, Clock>> = StaticCell::new();
static METHOD_SGM: StaticCell<Sgm<MAX_WIDTH, { words_for(REFERENCE_DISPARITIES) }, Clock>> = StaticCell::new();

/// Builds the method that is asked for.
#[inline(never)]
pub fn build(options: &Options, clock: Clock) -> Result<&'static mut dyn StereoMethod, &'static str> {
    let refused = |error: ConfigError| match error {
        ConfigError::DisparityCapacity { .. } => "block and sgm have room for 128 disparities",
        _ => "the disparities or the width are out of range",
    };
    Ok(match options.method {
        Method::Lite => METHOD_LITE.init(Lite::timed(options.config, clock).map_err(refused)?),
        Method::Full => METHOD_FULL.init(Full::timed(options.config, clock).map_err(refused)?),
        Method::WaveletBlock => METHOD_WAVELET_BLOCK.init(WaveletBlock::timed(options.config, clock).map_err(refused)?),
        Method::Contour => METHOD_CONTOUR.init(ContourStereo::timed(options.config, clock).map_err(refused)?),
        Method::Envelope => METHOD_ENVELOPE.init(EnvelopeStereo::timed(options.config, clock).map_err(refused)?),
        Method::Block => {
            METHOD_BLOCK.init(StereoBm::timed(options.config, BlockSettings::default(), clock).map_err(refused)?)
        }
        Method::Sgm => METHOD_SGM.init(Sgm::timed(options.config, clock).map_err(refused)?),
    })
}
