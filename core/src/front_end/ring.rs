//! The newest few rows of an image: all that is ever kept of it.

/// Columns kept on either side of a row, replicating its border pixel, so that a window may
/// overhang the image by as much.
pub(crate) const MARGIN: usize = 4;

/// Ring of the newest `ROWS` rows, each of `4 * BLOCKS` bytes: [`MARGIN`] columns, the image's,
/// and at least [`MARGIN`] again.
#[derive(Debug, Clone)]
pub(crate) struct RowRing<const ROWS: usize, const BLOCKS: usize> {
    rows: [[[u8; 4]; BLOCKS]; ROWS],
    pushed: u32,
}

impl<const ROWS: usize, const BLOCKS: usize> RowRing<ROWS, BLOCKS> {
    pub(crate) const fn new() -> Self {
        Self { rows: [[[0; 4]; BLOCKS]; ROWS], pushed: 0 }
    }

    /// Forgets all rows.
    pub(crate) fn clear(&mut self) {
        self.pushed = 0;
    }

    /// Rows pushed since the ring was cleared.
    pub(crate) const fn len(&self) -> u32 {
        self.pushed
    }

    /// Makes room for the next row by giving up the oldest, and hands that room out to be filled.
    pub(crate) fn push(&mut self) -> &mut [u8] {
        let slot = self.slot(self.pushed);
        self.pushed += 1;
        self.rows[slot].as_flattened_mut()
    }

    /// Pushes a row of the image and replicates its borders.
    pub(crate) fn push_pixels(&mut self, pixels: &[u8]) {
        let row = self.push();
        for (to, &from) in row.iter_mut().skip(MARGIN).zip(pixels) {
            *to = from;
        }
        replicate_borders(row, pixels.len());
    }

    /// Pushes the newest row once more; mid-grey if there is none.
    pub(crate) fn push_again(&mut self) {
        if self.pushed == 0 {
            self.push().fill(128);
            return;
        }
        let newest = self.rows[self.slot(self.pushed.saturating_sub(1))];
        self.push().copy_from_slice(newest.as_flattened());
    }

    /// Row `y` of the image, with its margins. Rows above the first and below the newest are the
    /// first and the newest.
    pub(crate) fn row(&self, y: i64) -> &[u8] {
        let y = y.clamp(0, i64::from(self.pushed.saturating_sub(1)));
        let y = u32::try_from(y).unwrap_or(0);
        self.rows[self.slot(y)].as_flattened()
    }

    /// `N` consecutive rows from `first` on.
    pub(crate) fn window<const N: usize>(&self, first: i64) -> [&[u8]; N] {
        let mut y = first - 1;
        [(); N].map(|()| {
            y += 1;
            self.row(y)
        })
    }

    #[expect(clippy::unused_self, reason = "ROWS is the instance's")]
    const fn slot(&self, y: u32) -> usize {
        y as usize % ROWS
    }
}

/// Fills the margins of a row of `width` image columns with its first and last pixel.
pub(crate) fn replicate_borders(row: &mut [u8], width: usize) {
    let Some((margin, rest)) = row.split_at_mut_checked(MARGIN) else { return };
    margin.fill(rest.first().copied().unwrap_or(0));
    let last = width.checked_sub(1).and_then(|x| rest.get(x)).copied().unwrap_or(0);
    if let Some(margin) = rest.get_mut(width..) {
        margin.fill(last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_outside_the_image_are_its_first_and_newest() {
        let mut ring = RowRing::<3, 4>::new();
        for y in 0..5 {
            ring.push_pixels(&[10 * y, 10 * y + 1, 10 * y + 2, 10 * y + 3, 10 * y + 4]);
        }
        assert_eq!(ring.row(4)[MARGIN], 40);
        assert_eq!(ring.row(9)[MARGIN], 40);
        assert_eq!(ring.row(2), [20, 20, 20, 20, 20, 21, 22, 23, 24, 24, 24, 24, 24, 24, 24, 24]);
        ring.clear();
        ring.push_pixels(&[7; 5]);
        assert_eq!(ring.row(-3)[0], 7);
    }
}
