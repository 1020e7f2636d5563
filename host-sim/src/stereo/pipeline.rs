//! Whole frames through a streaming method.

use std::time::{Duration, Instant};

use anyhow::{Result, ensure};
use haarline::{Config, DisparityRow, Offset, Paired, ScanlinePair, StereoMethod};

use crate::{DisparityMap, StereoPair};

/// What a method made of a frame.
#[derive(Debug, Clone)]
pub struct Run {
    /// Its disparities.
    pub map: DisparityMap,
    /// Time spent in the method alone, from the first row in to the last row out.
    pub elapsed: Duration,
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
    Ok(Run { map, elapsed })
}

/// Streams a frame of cameras that are displaced by `offset` through `method`.
///
/// # Errors
/// As [`run`], or if the offset is out of its range.
pub fn run_paired(method: &mut dyn StereoMethod, offset: Offset, pair: &StereoPair) -> Result<Run> {
    const ROWS: usize = Offset::MAX_ROWS.unsigned_abs() as usize;
    const WIDTH: usize = Config::MAX_WIDTH as usize;
    run(&mut Paired::<_, ROWS, WIDTH>::new(method, offset)?, pair)
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
