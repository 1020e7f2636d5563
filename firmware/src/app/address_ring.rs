//! A ring of words that DMA fills, and out of which rows are read.

use core::sync::atomic::{AtomicU32, Ordering, fence};

/// Bytes of a word.
const WORD: u32 = 4;

/// The ring, and how far it was read.
pub struct AddressRing<'a> {
    words: &'a [AtomicU32],
    /// The first word's address, as DMA has it.
    base: u32,
    /// Words read since DMA's start, wrapping around, and the place of the next one: the ring's length need not divide what
    /// a counter holds.
    read: u32,
    next: usize,
}

impl<'a> AddressRing<'a> {
    /// A ring of which nothing was read; `base` is the address of its first word.
    ///
    /// # Panics
    /// If it has no word.
    #[must_use]
    pub const fn new(words: &'a [AtomicU32], base: u32) -> Self {
        assert!(!words.is_empty());
        Self { words, base, read: 0, next: 0 }
    }

    /// DMA begins anew at the first word.
    pub const fn restart(&mut self) {
        (self.read, self.next) = (0, 0);
    }

    /// The place in words of an address at which DMA stores next. Behind the last word it stands until it begins anew, which
    /// is the same place.
    #[must_use]
    pub fn position(&self, address: u32) -> u32 {
        address.wrapping_sub(self.base) / WORD % self.len()
    }

    /// Reads the words, little-endian, that were stored from the one numbered `at` on, and passes those before it; whether
    /// they were there, and none of them overwritten meanwhile. `stored` tells how many DMA has stored since its start;
    /// numbers wrap around, and never go back.
    pub fn read(&mut self, at: u32, to: &mut [[u8; 4]], mut stored: impl FnMut() -> u32) -> bool {
        let count = u32::try_from(to.len()).unwrap_or(u32::MAX);
        let is_there = stored().wrapping_sub(at) >= count;
        self.pass(at.wrapping_sub(self.read));
        let (upper, lower) = self.words.split_at_checked(self.next).unwrap_or((&[], self.words));
        // From the place on to the ring's end, and what is left from its beginning on: of more than a ring, nothing.
        let (to, rest) = to.split_at_mut(to.len().min(lower.len()));
        copy(lower, to);
        copy(upper, rest);
        self.pass(count);
        fence(Ordering::SeqCst);
        // A word of the ring is spared: DMA may be at it while its address still says that it will be.
        is_there && stored().wrapping_sub(at) < self.len()
    }

    /// Goes on by so many words.
    fn pass(&mut self, words: u32) {
        self.read = self.read.wrapping_add(words);
        self.next = (self.next + words as usize) % self.words.len();
    }

    fn len(&self) -> u32 {
        u32::try_from(self.words.len()).unwrap_or(u32::MAX)
    }
}

/// Copies as many words as both have, eight at a time: so it takes hardly more than a load and a store for each.
fn copy(from: &[AtomicU32], to: &mut [[u8; 4]]) {
    let load = |word: &AtomicU32| word.load(Ordering::Relaxed).to_le_bytes();
    let len = from.len().min(to.len());
    let (Some(from), Some(to)) = (from.get(..len), to.get_mut(..len)) else { return };
    let (from_eights, from) = from.as_chunks::<8>();
    let (to_eights, to) = to.as_chunks_mut::<8>();
    for (to, from) in to_eights.iter_mut().zip(from_eights) {
        *to = from.each_ref().map(load);
    }
    for (to, from) in to.iter_mut().zip(from) {
        *to = load(from);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const BASE: u32 = 0x2004_0000;
    const WORDS: usize = 29;

    /// DMA that stores the numbers of its words.
    struct Dma {
        memory: [AtomicU32; WORDS],
        stored: u32,
        at: usize,
    }

    impl Dma {
        fn new() -> Self {
            Self { memory: [const { AtomicU32::new(u32::MAX) }; WORDS], stored: 0, at: 0 }
        }

        fn store(&mut self, words: usize) {
            for _ in 0..words {
                self.memory[self.at].store(self.stored, Ordering::Relaxed);
                (self.stored, self.at) = (self.stored.wrapping_add(1), (self.at + 1) % WORDS);
            }
        }
    }

    #[test]
    fn an_address_is_a_place() {
        let memory = [const { AtomicU32::new(0) }; WORDS];
        let ring = AddressRing::new(&memory, BASE);
        for (bytes, place) in [(0, 0), (4, 1), (112, 28), (116, 0)] {
            assert_eq!(ring.position(BASE + bytes), place, "{bytes} bytes on");
        }
    }

    #[test]
    fn what_is_overwritten_while_it_is_read_is_not_taken() {
        let mut dma = Dma::new();
        dma.store(WORDS - 4);
        let memory = dma.memory.each_ref().map(|word| AtomicU32::new(word.load(Ordering::Relaxed)));
        for (meanwhile, is_good) in [(0, true), (3, true), (4, false), (9, false)] {
            let mut ring = AddressRing::new(&memory, BASE);
            let mut looks = [dma.stored, dma.stored + meanwhile].into_iter();
            assert_eq!(ring.read(0, &mut [[0; 4]; 4], || looks.next().unwrap()), is_good, "{meanwhile} words");
        }
    }

    proptest! {
        /// Reads of any length, some words passed before each, between stores of any length: what is called good is the words
        /// in their order, and it is called so exactly if all of them were there and DMA has not come around.
        #[test]
        fn what_is_read_is_what_was_stored(
            steps in prop::collection::vec((0..2 * WORDS, 0..3_u32, 0..WORDS), 1..40),
            wraps in any::<bool>(),
        ) {
            let mut dma = Dma::new();
            // As after so many words that the counter is about to begin anew, at another place of the ring than that would be.
            let (begun, place) = if wraps { (u32::MAX - 20, 7) } else { (0, 0) };
            (dma.stored, dma.at) = (begun, place);
            let mut position = (begun, place);
            for (store, passed, read) in steps {
                dma.store(store);
                let ring = &mut AddressRing { words: &dma.memory, base: BASE, read: position.0, next: position.1 };
                let (from, mut to) = (ring.read.wrapping_add(passed), vec![[0; 4]; read]);
                let is_good = ring.read(from, &mut to, || dma.stored);
                let waiting = dma.stored.wrapping_sub(from).cast_signed();
                let is_there = usize::try_from(waiting).is_ok_and(|waiting| (read..WORDS).contains(&waiting));
                prop_assert_eq!(is_good, is_there);
                if is_good {
                    let stored: Vec<_> = (0_u32..).take(read).map(|nth| from.wrapping_add(nth).to_le_bytes()).collect();
                    prop_assert_eq!(to, stored);
                    position = (ring.read, ring.next);
                } else {
                    // Whoever reads begins anew where DMA is.
                    position = (dma.stored, dma.at);
                }
            }
        }
    }
}
