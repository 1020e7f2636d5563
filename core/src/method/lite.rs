//! The method `lite`: [`full`](crate::full) without agreement.

use crate::method::deciding::Lonely;
use crate::method::tile_pipeline::Tiled;
use crate::stage::Untimed;

/// Stereo by contours and extremum search, every cell for itself: the cheapest method.
///
/// The same tiles, labels and answers as [`Full`](crate::Full), but cells of 4 x 4 px, as high as a tile: half as many to
/// answer. A cell takes the label of its least cost, shared in part with its tile, and pays a little for one that its left and
/// upper neighbours have not.
///
/// # Examples
/// ```
/// use haarline::{Config, Lite, ScanlinePair, StereoMethod, blocks_for};
/// let mut lite = Lite::<{ blocks_for(320) }>::new(Config::for_width(320))?;
/// let mut rows = 0;
/// for _ in 0..240 {
///     let (left, right) = ([0; 320], [0; 320]); // from the cameras
///     lite.push(ScanlinePair { left: &left, right: &right }, &mut |_| rows += 1).unwrap();
/// }
/// lite.finish(&mut |_| rows += 1);
/// assert_eq!(rows, 240);
/// # Ok::<(), haarline::ConfigError>(())
/// ```
pub type Lite<const BLOCKS: usize, C = Untimed> = Tiled<Lonely, BLOCKS, C>;
