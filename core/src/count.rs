//! Counts of what the methods' cost is made of, for studies on the host.
//!
//! With the feature `count`; without it every function here is empty and `take` is not there.
//! The counters are global: run one pipeline at a time.
//!
//! An operation is one on a value of a pixel, a response or a cost; addresses and loops do not count.
//! A difference's magnitude is a subtraction and a comparison, the least of two values a comparison.

#[cfg(feature = "count")]
use core::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// What was counted.
#[cfg(feature = "count")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Comparisons of four pixels with four others.
    pub sad_words: u64,
    /// Terms of the agreement: one label of a block against one of its neighbour's.
    pub label_pairs: u64,
    /// Costs worked out: one block, template or contour against another.
    pub evaluations: u64,
    /// Additions.
    pub additions: u64,
    /// Subtractions.
    pub subtractions: u64,
    /// Comparisons.
    pub comparisons: u64,
    /// Multiplications and divisions, which only the references have.
    pub multiplications: u64,
}

macro_rules! counters {
    ($($(#[$doc:meta])* $counter:ident;)*) => {
        #[cfg(feature = "count")]
        mod counters {
            use super::AtomicU64;
            $(#[allow(non_upper_case_globals, reason = "named as the function that counts")]
            pub(super) static $counter: AtomicU64 = AtomicU64::new(0);)*
        }

        /// Reads the counters and sets them to zero.
        #[cfg(feature = "count")]
        pub fn take() -> Counts {
            Counts { $($counter: counters::$counter.swap(0, Relaxed)),* }
        }

        $($(#[$doc])*
        #[inline]
        pub fn $counter(count: usize) {
            #[cfg(feature = "count")]
            counters::$counter.fetch_add(count as u64, Relaxed);
            let _ = count;
        })*
    };
}

counters! {
    /// Counts words of four pixels.
    sad_words;
    /// Counts pairs of labels.
    label_pairs;
    /// Counts costs worked out.
    evaluations;
    /// Counts additions.
    additions;
    /// Counts subtractions.
    subtractions;
    /// Counts comparisons.
    comparisons;
    /// Counts multiplications and divisions.
    multiplications;
}
