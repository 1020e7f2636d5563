//! Memory that DMA reaches: the section `.dma`, which nobody clears at start-up.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicBool, Ordering};

/// Room in the section `.dma`, with its mark that it was taken elsewhere: that has to be cleared.
pub struct DmaMemory<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: `take` hands out its contents once.
#[expect(unsafe_code, reason = "shared by everybody, handed out once")]
unsafe impl<T: Send> Sync for DmaMemory<T> {}

impl<T: Send> DmaMemory<T> {
    /// Nothing in it.
    #[expect(clippy::new_without_default, reason = "a static needs it const")]
    #[must_use]
    pub const fn new() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }

    /// Fills it and hands it out.
    ///
    /// # Panics
    /// If `taken`, which belongs to it alone, says that it was handed out before.
    #[expect(unsafe_code, reason = "handed out once")]
    #[expect(clippy::mut_from_ref, reason = "handed out once")]
    pub fn take(&'static self, taken: &'static AtomicBool, value: T) -> &'static mut T {
        assert!(!taken.swap(true, Ordering::AcqRel), "handed out twice");
        // SAFETY: the mark above keeps everybody else away.
        unsafe { (*self.0.get()).write(value) }
    }
}
