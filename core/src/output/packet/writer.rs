//! Bytes as they are written and read, one after the other.

/// Room that fills up.
pub(super) struct Writer<'a> {
    room: &'a mut [u8],
    used: usize,
}

impl<'a> Writer<'a> {
    pub(super) const fn new(room: &'a mut [u8]) -> Self {
        Self { room, used: 0 }
    }

    /// Adds some bytes; `None` if there is no more room.
    #[inline(always)]
    pub(super) fn push<const N: usize>(&mut self, bytes: [u8; N]) -> Option<()> {
        *self.room.get_mut(self.used..)?.first_chunk_mut()? = bytes;
        self.used += N;
        Some(())
    }

    /// Room for so many bytes more, if there is; [`Self::add`] tells how many of them were written.
    pub(super) fn room(&mut self, count: usize) -> Option<&mut [u8]> {
        self.room.get_mut(self.used..)?.get_mut(..count)
    }

    /// So many bytes of [`Self::room`] were written.
    pub(super) const fn add(&mut self, count: usize) {
        self.used += count;
    }

    /// How many bytes there are.
    pub(super) const fn count(&self) -> usize {
        self.used
    }
}

/// Takes the next bytes off; `None` if there are not so many.
pub(super) fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (&taken, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(taken)
}
