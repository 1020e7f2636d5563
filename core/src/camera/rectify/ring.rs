//! A view's part of the ring of rows that wait.

/// Where the newest rows of a view lie.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ring {
    pub(super) first: usize,
    len: usize,
    /// Which of the places hold a row, a bit each.
    present: [u32; Self::MAX_ROWS / 32],
}

impl Ring {
    /// Most rows of a view.
    pub(super) const MAX_ROWS: usize = 128;

    /// `len` rows, 1 or more, from place `first` on.
    pub(super) const fn new(first: usize, len: usize) -> Self {
        Self { first, len, present: [0; Self::MAX_ROWS / 32] }
    }

    pub(super) fn clear(&mut self) {
        self.present = [0; Self::MAX_ROWS / 32];
    }

    pub(super) const fn place(&self, y: u32) -> usize {
        y as usize % self.len
    }

    /// Puts in a row, or nothing where it was lost.
    pub(super) fn set(&mut self, y: u32, is_there: bool) {
        let place = self.place(y);
        if let Some(word) = self.present.get_mut(place / 32) {
            let bit = 1 << (place % 32);
            *word = if is_there { *word | bit } else { *word & !bit };
        }
    }

    pub(super) fn has(&self, y: u32) -> bool {
        let place = self.place(y);
        self.present.get(place / 32).is_some_and(|word| word >> (place % 32) & 1 == 1)
    }

    /// All places.
    pub(super) fn rows<'a, const WIDTH: usize>(&self, rows: &'a [[u8; WIDTH]]) -> &'a [[u8; WIDTH]] {
        rows.get(self.first..self.first + self.len).unwrap_or(&[])
    }

    pub(super) fn row<'a, const WIDTH: usize>(&self, rows: &'a [[u8; WIDTH]], y: u32, width: usize) -> &'a [u8] {
        rows.get(self.first + self.place(y)).and_then(|row| row.get(..width)).unwrap_or(&[])
    }
}
