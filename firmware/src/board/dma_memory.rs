//! Memory that DMA reaches: the section `.dma`, which nobody clears at start-up.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicBool, Ordering};

/// Room in the section `.dma`, which holds anything at start-up.
pub struct DmaMemory<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: a cell hands out its contents once, to whoever brought them: none goes from one thread to another.
#[expect(unsafe_code, reason = "shared by everybody, handed out once")]
unsafe impl<T> Sync for DmaMemory<T> {}

impl<T> DmaMemory<T> {
    /// Nothing in it.
    #[expect(clippy::new_without_default, reason = "a static needs it const")]
    #[must_use]
    pub const fn new() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }
}

/// Hands out memory of the section `.dma`, once. It lies in memory that is cleared, and so knows whether it did. Made by
/// [`dma_cell!`](crate::dma_cell) only.
pub struct DmaCell<T: 'static> {
    memory: &'static DmaMemory<T>,
    is_taken: AtomicBool,
}

impl<T> DmaCell<T> {
    /// The cell of `memory`.
    ///
    /// # Safety
    /// It is the only one of that memory.
    #[expect(unsafe_code, reason = "two cells would hand the memory out twice")]
    #[must_use]
    pub const unsafe fn new(memory: &'static DmaMemory<T>) -> Self {
        Self { memory, is_taken: AtomicBool::new(false) }
    }

    /// Hands the memory out as it is.
    ///
    /// # Panics
    /// If it was handed out before.
    #[expect(unsafe_code, reason = "handed out once")]
    pub fn uninit(&self) -> &'static mut MaybeUninit<T> {
        assert!(!self.is_taken.swap(true, Ordering::AcqRel), "handed out twice");
        // SAFETY: the only cell of this memory keeps everybody else away.
        unsafe { &mut *self.memory.0.get() }
    }
}

impl<T, const N: usize> DmaCell<[T; N]> {
    /// Fills the memory in place, so that it may be larger than the stack, and hands it out.
    ///
    /// # Panics
    /// If it was handed out before.
    #[expect(unsafe_code, reason = "written element by element")]
    pub fn fill(&self, value: impl Fn() -> T) -> &'static mut [T; N] {
        let array = self.uninit();
        let first: *mut T = array.as_mut_ptr().cast();
        for nth in 0..N {
            // SAFETY: the array has N of them.
            unsafe { first.add(nth).write(value()) };
        }
        // SAFETY: each was written.
        unsafe { array.assume_init_mut() }
    }
}

/// A [`DmaCell`] for a static, whose memory nobody else can name.
#[macro_export]
macro_rules! dma_cell {
    ($type:ty) => {{
        #[unsafe(link_section = ".dma")]
        #[expect(unsafe_code, reason = "a section of the linker script")]
        static MEMORY: $crate::board::dma_memory::DmaMemory<$type> = $crate::board::dma_memory::DmaMemory::new();
        #[expect(unsafe_code, reason = "the memory's name ends here")]
        // SAFETY: the memory is named in this block alone, and a static is built once.
        unsafe {
            $crate::board::dma_memory::DmaCell::new(&MEMORY)
        }
    }};
}
