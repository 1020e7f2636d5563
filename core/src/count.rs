//! How many costs the methods work out, for studies on the host.
//!
//! With the feature `count`; without it [`evaluations`] is empty and `take` is not there. The counter is global: run one
//! pipeline at a time.

#[cfg(feature = "count")]
use core::sync::atomic::{AtomicU64, Ordering::Relaxed};

#[cfg(feature = "count")]
static EVALUATIONS: AtomicU64 = AtomicU64::new(0);

/// Counts costs worked out: of one disparity of a pixel, a block or a tile, or of one template or contour against another.
#[inline(always)]
pub fn evaluations(count: usize) {
    #[cfg(feature = "count")]
    EVALUATIONS.fetch_add(count as u64, Relaxed);
    let _ = count;
}

/// Reads the counter and sets it to zero.
#[cfg(feature = "count")]
pub fn take() -> u64 {
    EVALUATIONS.swap(0, Relaxed)
}
