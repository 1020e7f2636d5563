//! The method `full`: the paper's contours and shortest-support search, and neighbours that agree.

use crate::method::deciding::Agreeing;
use crate::method::tile_pipeline::Tiled;
use crate::stage::Untimed;

/// Stereo by contours, extremum search and agreement: the most accurate method.
///
/// Haar contours that both views see seed a handful of hypotheses for each tile of 8 x 4 px. From the best of them the
/// extremum search goes one step downhill by its shortest support (the paper's section 4). The tile keeps four of the
/// disparities tried; its cells of 4 x 2 px agree with their neighbours on them, in the manner of semi-global matching.
///
/// # Examples
/// ```
/// use haarline::{Config, Full, ScanlinePair, StereoMethod, blocks_for};
/// let mut full = Full::<{ blocks_for(320) }>::new(Config::for_width(320))?;
/// assert!(size_of_val(&full) <= 24 * 1024);
/// let mut rows = 0;
/// for _ in 0..240 {
///     let (left, right) = ([0; 320], [0; 320]); // from the cameras
///     full.push(ScanlinePair { left: &left, right: &right }, &mut |_| rows += 1).unwrap();
/// }
/// full.finish(&mut |_| rows += 1);
/// assert_eq!(rows, 240);
/// # Ok::<(), haarline::ConfigError>(())
/// ```
pub type Full<const BLOCKS: usize, C = Untimed> = Tiled<Agreeing, BLOCKS, C>;
