//! The method `wavelet-block`: block matching whose disparities the extremum search finds, the paper's own pipeline.

use crate::method::deciding::Searching;
use crate::method::tile_pipeline::Tiled;
use crate::stage::Untimed;
#[cfg(feature = "ablation")]
use crate::{Config, ConfigError, Parts, Reading};

/// `StereoBM`'s steps, blocks, comparison and disparity, but for the exhaustive search: the paper's wavelet-modified block
/// matching (section 5).
///
/// Contours of both views, extrema of the Haar response along the rows (section 3, eq. 1), are matched and seed the search.
/// Each block of 8 x 4 px starts at the best of at most four disparities: the nearest contours' and those of the blocks left
/// and above, since neighbours have similar disparities. From there the extremum search of section 4 goes on with its
/// shortest support, two samples; where the cost rises by A_1 on both sides the extremum is registered. Elsewhere it begins
/// again with a long support and shortens it (eq. 6 to 9), and the better of its end and the nearest minimum is taken.
///
/// At most 64 costs a block, whatever the range; see [`Reading`](crate::Reading) for what is compared. The rows that go out are smoothed and
/// rated like those of [`Lite`](crate::Lite).
///
/// # Examples
/// ```
/// use haarline::{Config, StereoMethod, WaveletBlock, blocks_for};
/// let config = Config { num_disparities: 48, ..Config::for_width(320) };
/// let method = WaveletBlock::<{ blocks_for(320) }>::new(config)?;
/// assert_eq!(method.config(), &config);
/// # Ok::<(), haarline::ConfigError>(())
/// ```
pub type WaveletBlock<const BLOCKS: usize, C = Untimed> = Tiled<Searching, BLOCKS, C>;

#[cfg(feature = "ablation")]
impl<const BLOCKS: usize> WaveletBlock<BLOCKS> {
    /// Builds the method of that reading; [`Tiled::new`] takes the default one. Of the feature `ablation`.
    ///
    /// # Errors
    /// If the configuration is invalid or the width over the capacity.
    pub fn with_reading(config: Config, reading: Reading) -> Result<Self, ConfigError> {
        Self::with_parts(config, Parts { reading, ..Parts::ALL })
    }
}
