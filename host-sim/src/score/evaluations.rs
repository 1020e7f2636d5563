//! How many costs a method works out, as a build with the feature `count` counts them.

use anyhow::Result;

/// What `work` on `pixels` pixels returns, and how many costs it worked out for each. The counter is of the process, so
/// everything runs in one thread.
///
/// # Errors
/// If the thread cannot be had.
#[cfg(feature = "count")]
pub fn evaluations<T: Send>(pixels: usize, work: impl FnOnce() -> T + Send) -> Result<(T, Option<f64>)> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    haarline::count::take();
    let result = pool.install(work);
    Ok((result, Some(haarline::count::take() as f64 / pixels as f64)))
}

/// What `work` returns; nothing is counted.
///
/// # Errors
/// Never.
#[cfg(not(feature = "count"))]
pub fn evaluations<T>(_pixels: usize, work: impl FnOnce() -> T) -> Result<(T, Option<f64>)> {
    Ok((work(), None))
}
