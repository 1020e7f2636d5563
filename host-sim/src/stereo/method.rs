//! The registry of the stereo methods: the one place that knows them all by name.

use std::fmt;
use std::thread::{self, ScopedJoinHandle};

use anyhow::{Result, bail};
use clap::ValueEnum;
use haarline::contour_stereo::rows_for;
use haarline::frame_figures::FrameFigures;
use haarline::{
    Config, ConfigError, ContourSettings, ContourStereo, DisparityRow, EnvelopeStereo, Full, Lite, RowError, Scales,
    ScanlinePair, StereoMethod, WaveletBlock, blocks_for,
};
use haarline_tests::sgm::words_for;
use haarline_tests::{BlockSettings, Ncc, Sgm, Ssd, StereoBm};

/// Columns that every method here has room for.
const MAX_WIDTH: usize = Config::MAX_WIDTH as usize;
/// Stack for building the largest of them.
const BUILD_STACK_BYTES: usize = 64 << 20;
/// Disparities that every method here has room for.
const MAX_DISPARITIES: usize = Config::MAX_DISPARITIES as usize;
/// Smoothed rows for contours of every scale.
const CONTOUR_ROWS: usize = rows_for(Scales::MAX_HALF_SUPPORT);

/// A stereo method, by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodKind {
    /// Contour seeds, a few labels a block and their agreement: the most accurate
    Full,
    /// Contour seeds and greedy blocks: the cheapest method that holds up under noise
    Lite,
    /// Block matching as in OpenCV's StereoBM, for reference
    Block,
    /// The same with squared differences (SSD), for reference
    Ssd,
    /// The same with the normalised cross-correlation (NCC), for reference
    Ncc,
    /// Semi-global matching of census transforms over three paths, for reference: every pixel is answered
    Sgm,
    /// Block matching whose disparities an extremum search finds
    WaveletBlock,
    /// Contours of both views matched: sparse, answers beside contours only
    Contour,
    /// Peaks, troughs and slopes of grey levels matched: sparse, what the paper puts in the place of blocks
    Envelope,
}

impl MethodKind {
    /// Whether its answers of less confidence than 16 are guesses.
    #[must_use]
    pub const fn has_guesses(self) -> bool {
        matches!(self, Self::Full | Self::Lite | Self::WaveletBlock)
    }
}

/// A method and its settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Method {
    /// Which one.
    pub kind: MethodKind,
    /// Which contours [`MethodKind::Contour`] looks for.
    pub contours: ContourSettings,
}

impl From<MethodKind> for Method {
    /// The method as it is meant to be used.
    fn from(kind: MethodKind) -> Self {
        Self { kind, contours: ContourSettings::DEFAULT }
    }
}

impl Method {
    /// The name on the command line and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.kind.name()
    }

    /// An instance for rows of up to [`Config::MAX_WIDTH`] px.
    ///
    /// # Errors
    /// If the configuration or a setting is refused.
    pub fn build(self, config: Config) -> Result<Box<dyn StereoMethod + Send>, ConfigError> {
        on_large_stack(|| self.kind.build_here(config, self.contours))
    }
}

/// A method on the heap, to be put behind something.
pub struct OwnMethod(pub Box<dyn StereoMethod + Send>);

impl StereoMethod for OwnMethod {
    fn config(&self) -> &Config {
        self.0.config()
    }

    fn start(&mut self) {
        self.0.start();
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        self.0.push(pair, sink)
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.0.miss(sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.0.finish(sink);
    }

    fn figures(&self) -> Option<FrameFigures> {
        self.0.figures()
    }

    fn cell_height(&self) -> u32 {
        self.0.cell_height()
    }
}

impl MethodKind {
    /// The best there is, the default of every command.
    pub const BEST: Self = Self::Full;

    /// The name on the command line and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Lite => "lite",
            Self::Block => "block",
            Self::Ssd => "ssd",
            Self::Ncc => "ncc",
            Self::Sgm => "sgm",
            Self::WaveletBlock => "wavelet-block",
            Self::Contour => "contour",
            Self::Envelope => "envelope",
        }
    }

    /// An instance for rows of up to [`Config::MAX_WIDTH`] px.
    ///
    /// # Errors
    /// If the configuration is refused.
    pub fn build(self, config: Config) -> Result<Box<dyn StereoMethod + Send>, ConfigError> {
        Method::from(self).build(config)
    }

    fn build_here(
        self,
        config: Config,
        contours: ContourSettings,
    ) -> Result<Box<dyn StereoMethod + Send>, ConfigError> {
        Ok(match self {
            Self::Full => Box::new(Full::<{ blocks_for(Config::MAX_WIDTH) }>::new(config)?),
            Self::Lite => Box::new(Lite::<{ blocks_for(Config::MAX_WIDTH) }>::new(config)?),
            Self::Contour => {
                type Contours = ContourStereo<{ blocks_for(Config::MAX_WIDTH) }, CONTOUR_ROWS>;
                Box::new(Contours::with_settings(config, contours)?)
            }
            Self::Envelope => Box::new(EnvelopeStereo::<{ blocks_for(Config::MAX_WIDTH) }>::new(config)?),
            Self::WaveletBlock => Box::new(WaveletBlock::<{ blocks_for(Config::MAX_WIDTH) }>::new(config)?),
            Self::Block | Self::Ssd | Self::Ncc | Self::Sgm => {
                return self.build_reference(config, BlockSettings::default());
            }
        })
    }

    /// A reference with its gates set; another method as ever.
    ///
    /// # Errors
    /// If the configuration is refused.
    pub fn build_gated(
        self,
        config: Config,
        settings: BlockSettings,
    ) -> Result<Box<dyn StereoMethod + Send>, ConfigError> {
        match self {
            Self::Block | Self::Ssd | Self::Ncc => on_large_stack(|| self.build_reference(config, settings)),
            _ => self.build(config),
        }
    }

    /// Sums take 2 or 4 bytes a column and disparity, so a small instance for narrow rows.
    fn build_reference(
        self,
        config: Config,
        settings: BlockSettings,
    ) -> Result<Box<dyn StereoMethod + Send>, ConfigError> {
        const D: usize = MAX_DISPARITIES;
        let is_narrow = config.width <= 320;
        Ok(match self {
            Self::Ssd if is_narrow => Box::new(Ssd::<320, D>::new(config, settings)?),
            Self::Ssd => Box::new(Ssd::<MAX_WIDTH, D>::new(config, settings)?),
            Self::Ncc if is_narrow => Box::new(Ncc::<320, D>::new(config, settings)?),
            Self::Ncc => Box::new(Ncc::<MAX_WIDTH, D>::new(config, settings)?),
            Self::Sgm if is_narrow => Box::new(Sgm::<320, { words_for(Config::MAX_DISPARITIES) }>::new(config)?),
            Self::Sgm => Box::new(Sgm::<MAX_WIDTH, { words_for(Config::MAX_DISPARITIES) }>::new(config)?),
            _ if is_narrow => Box::new(StereoBm::<320, D>::new(config, settings)?),
            _ => Box::new(StereoBm::<MAX_WIDTH, D>::new(config, settings)?),
        })
    }
}

/// Builds on a large stack: an instance of up to 2 MB is moved into its box a few times, more than a
/// thread's usual one can take.
pub(crate) fn on_large_stack<T: Send>(build: impl Fn() -> T + Sync) -> T {
    thread::scope(|scope| {
        let builder = thread::Builder::new().stack_size(BUILD_STACK_BYTES);
        match builder.spawn_scoped(scope, &build).map(ScopedJoinHandle::join) {
            Ok(Ok(built)) => built,
            // Without a thread to spare, or with a panic to hand on, this one has to do.
            Ok(Err(_)) | Err(_) => build(),
        }
    })
}

impl fmt::Display for MethodKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Checks a configuration and says what is wrong in the user's words; `num_name` is what the number of
/// disparities is called where it comes from.
///
/// # Errors
/// If [`Config::check`] refuses it.
pub fn check_config(config: &Config, num_name: &str) -> Result<()> {
    let Config { width, min_disparity, num_disparities } = config;
    match config.check() {
        Ok(()) => Ok(()),
        Err(ConfigError::NumDisparities) => bail!("{num_name} {num_disparities}: must be 1 to 256"),
        Err(ConfigError::DisparitiesOverWidth) => {
            bail!("{num_name} {num_disparities}: must not be more than the images are wide, {width} px")
        }
        Err(ConfigError::MinDisparity) => bail!("--min-disparity {min_disparity}: must be -128 to 128 px"),
        Err(error) => bail!("the images are {width} px wide: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_takes_the_smallest_and_the_largest_configuration() {
        let smallest = Config { width: Config::MIN_WIDTH, min_disparity: -128, num_disparities: 1 };
        let largest = Config { width: Config::MAX_WIDTH, min_disparity: 128, num_disparities: Config::MAX_DISPARITIES };
        for &method in MethodKind::value_variants() {
            assert_eq!(method.to_possible_value().map(|value| value.get_name() == method.name()), Some(true));
            for config in [smallest, Config::for_width(320), Config::for_width(321), largest] {
                assert_eq!(method.build(config).map(|method| *method.config()).ok(), Some(config), "{method}");
            }
        }
    }

    #[test]
    fn refusals_name_the_option_and_the_range() {
        let config = Config::for_width(64);
        let refusal = |config: Config| check_config(&config, "--num-disparities").unwrap_err().to_string();
        let cases = [
            (Config { num_disparities: 0, ..config }, "--num-disparities 0: must be 1 to 256"),
            (Config { num_disparities: 65, ..config }, "--num-disparities 65: must not be more"),
            (Config { min_disparity: -129, ..config }, "--min-disparity -129: must be -128 to 128 px"),
            (Config { width: 31, ..config }, "the images are 31 px wide: "),
        ];
        for (config, wanted) in cases {
            let told = refusal(config);
            assert!(told.starts_with(wanted), "{told}");
        }
    }
}
