//! Operations of a pixel, as the code counts them with the feature `count`.

use anyhow::Result;

/// What was done for a pixel, in the mean.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Operations {
    /// Costs worked out.
    pub evaluations: f64,
    /// Additions.
    pub additions: f64,
    /// Subtractions.
    pub subtractions: f64,
    /// Comparisons.
    pub comparisons: f64,
    /// Multiplications and divisions.
    pub multiplications: f64,
}

impl Operations {
    /// All of them, each as one; evaluations consist of them.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.additions + self.subtractions + self.comparisons + self.multiplications
    }

    /// What `work` on `pixels` pixels returns, and what it took. The counters are of the process, so
    /// everything runs in one thread.
    ///
    /// # Errors
    /// If the thread cannot be had.
    #[cfg(feature = "count")]
    pub fn count<T: Send>(pixels: usize, work: impl FnOnce() -> T + Send) -> Result<(T, Option<Self>)> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
        haarline::count::take();
        let result = pool.install(work);
        let counts = haarline::count::take();
        let per_pixel = |count: u64| count as f64 / pixels as f64;
        let operations = Self {
            evaluations: per_pixel(counts.evaluations),
            additions: per_pixel(counts.additions),
            subtractions: per_pixel(counts.subtractions),
            comparisons: per_pixel(counts.comparisons),
            multiplications: per_pixel(counts.multiplications),
        };
        Ok((result, Some(operations)))
    }

    /// What `work` returns; nothing is counted.
    ///
    /// # Errors
    /// Never.
    #[cfg(not(feature = "count"))]
    pub fn count<T>(_pixels: usize, work: impl FnOnce() -> T) -> Result<(T, Option<Self>)> {
        Ok((work(), None))
    }
}
