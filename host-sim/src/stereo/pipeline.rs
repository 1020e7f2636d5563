//! Whole frames through a streaming method.

use std::time::{Duration, Instant};

use anyhow::{Result, ensure};
use haarline::frame_figures::FrameFigures;
use haarline::{Config, DisparityRow, Rectification, Rectified, RectifiedRow, Rectifier, ScanlinePair, StereoMethod};

use crate::{DisparityMap, Frame, StereoPair};

/// Rows in the ring of rectification: enough for every rig.
pub const RECTIFY_ROWS: usize = 256;
const WIDTH: usize = Config::MAX_WIDTH as usize;

/// What a method made of a frame.
#[derive(Debug, Clone)]
pub struct Run {
    /// Its disparities.
    pub map: DisparityMap,
    /// Time spent in the method alone, from the first row in to the last row out.
    pub elapsed: Duration,
    /// What the method tells of the frame as a whole.
    pub figures: Option<FrameFigures>,
}

/// Streams a frame through `method`, row by row.
///
/// # Errors
/// If the frame is not as wide as the method was configured for, or the method breaks the contract
/// of one disparity row for each row pushed.
pub fn run(method: &mut dyn StereoMethod, pair: &StereoPair) -> Result<Run> {
    let mut map = DisparityMap::with_capacity(pair.width(), pair.height());
    let begin = Instant::now();
    let in_order = stream(method, pair, &mut map)?;
    let elapsed = begin.elapsed();
    ensure!(
        in_order && map.height == pair.height() && map.disparity.len() == pair.left.luma.len(),
        "the method delivered {} disparity rows for a frame of {} rows",
        map.height,
        pair.height()
    );
    Ok(Run { map, elapsed, figures: method.figures() })
}

/// The row of the right view, of `size` px, that shows in its column `x` what lies in row `y`.
#[must_use]
pub fn right_row(rig: &Rectification, [x, y]: [usize; 2], size: [usize; 2]) -> Option<usize> {
    let twice = [0, 1].map(|j| 2 * [x, y][j] as i32 + 1 - size[j] as i32);
    let rows = (rig.ramp.displacement_q16(twice) + (1 << 15)) >> 16;
    usize::try_from(y as i64 + i64::from(rows)).ok().filter(|&row| row < size[1])
}

/// Streams a frame of a rig's cameras through `method`.
///
/// # Errors
/// As [`run`], or if the displacement is out of its range.
pub fn run_rectified(method: &mut dyn StereoMethod, rig: &Rectification, pair: &StereoPair) -> Result<Run> {
    let height = u16::try_from(pair.height()).unwrap_or(u16::MAX);
    let mut behind = Box::new(Rectified::<_, RECTIFY_ROWS, WIDTH>::new(method, height, *rig)?);
    run(&mut *behind, pair)
}

/// The views that disparities are those of: by lens tables the rectified ones, else the views as they came. And what is
/// still to be put right of them.
///
/// # Errors
/// If the tables are those of another size.
pub fn seen_views(rig: &Rectification, pair: StereoPair) -> Result<(StereoPair, Rectification)> {
    if rig.lenses.is_none() {
        return Ok((pair, *rig));
    }
    Ok((rectified_views(rig, &pair)?, Rectification::default()))
}

/// Both views rectified, as the core does it; black where a row needs what no camera saw.
///
/// # Errors
/// If a figure is out of its range.
pub fn rectified_views(rig: &Rectification, pair: &StereoPair) -> Result<StereoPair> {
    let size = [pair.width() as u16, pair.height() as u16];
    let mut rectifier = Box::new(Rectifier::<RECTIFY_ROWS, WIDTH>::new(size, *rig)?);
    let mut views = [Vec::new(), Vec::new()];
    let mut take = |row: RectifiedRow<'_>| {
        for (view, rows) in views.iter_mut().zip(row.pair.map_or([None; 2], |pair| [Some(pair.left), Some(pair.right)]))
        {
            match rows {
                Some(row) => view.extend_from_slice(row),
                None => view.resize(view.len() + pair.width(), 0),
            }
        }
    };
    for y in 0..pair.height() {
        rectifier.push(ScanlinePair { left: pair.left.row(y), right: pair.right.row(y) }, &mut take)?;
    }
    rectifier.finish(&mut take);
    let [left, right] = views.map(|luma| Frame::from_luma(pair.width(), pair.height(), luma));
    Ok(StereoPair { left, right })
}

/// Pushes every row and collects into `map`; whether the rows came complete and in order.
fn stream(method: &mut dyn StereoMethod, pair: &StereoPair, map: &mut DisparityMap) -> Result<bool> {
    let mut in_order = true;
    let mut sink = |row: DisparityRow<'_>| {
        let complete = row.disparity.len() == map.width && row.confidence.len() == map.width;
        in_order &= complete && row.y as usize == map.height;
        map.push_row(&row);
    };
    method.start();
    for y in 0..pair.height() {
        method.push(ScanlinePair { left: pair.left.row(y), right: pair.right.row(y) }, &mut sink)?;
    }
    method.finish(&mut sink);
    Ok(in_order)
}
