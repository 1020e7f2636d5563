//! Counts of the two operations that the methods' cost is made of, for studies on the host.
//!
//! With the feature `count`; without it every function here is empty and `take` is not there.
//! The counters are global: run one pipeline at a time.

#[cfg(feature = "count")]
use core::sync::atomic::{AtomicU64, Ordering::Relaxed};

#[cfg(feature = "count")]
static SAD_WORDS: AtomicU64 = AtomicU64::new(0);
#[cfg(feature = "count")]
static LABEL_PAIRS: AtomicU64 = AtomicU64::new(0);

/// What was counted.
#[cfg(feature = "count")]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counts {
    /// Comparisons of four pixels with four others.
    pub sad_words: u64,
    /// Terms of the agreement: one label of a block against one of its neighbour's.
    pub label_pairs: u64,
}

/// Reads the counters and sets them to zero.
#[cfg(feature = "count")]
pub fn take() -> Counts {
    Counts { sad_words: SAD_WORDS.swap(0, Relaxed), label_pairs: LABEL_PAIRS.swap(0, Relaxed) }
}

/// Counts words of four pixels.
#[inline]
pub(crate) fn sad_words(words: usize) {
    #[cfg(feature = "count")]
    SAD_WORDS.fetch_add(words as u64, Relaxed);
    let _ = words;
}

/// Counts pairs of labels.
#[inline]
pub(crate) fn label_pairs(pairs: usize) {
    #[cfg(feature = "count")]
    LABEL_PAIRS.fetch_add(pairs as u64, Relaxed);
    let _ = pairs;
}
