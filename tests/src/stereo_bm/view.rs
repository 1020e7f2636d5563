//! The last rows of one view, raw and prefiltered.

use super::prefilter::sobel_x;

/// Raw rows that the prefilter looks at.
const RAW_ROWS: usize = 3;
/// What stands in for a first row that was lost, grey level.
const MID_GREY: u8 = 128;

/// The rows of one view that the window still needs.
#[derive(Debug, Clone)]
pub(super) struct View<const WIDTH: usize, const WINDOW: usize> {
    /// The last raw rows, row `y` at `y % RAW_ROWS`.
    raw: [[u8; WIDTH]; RAW_ROWS],
    /// The prefiltered rows of the window, row `y` at `y % WINDOW`.
    prefiltered: [[u8; WIDTH]; WINDOW],
    /// The prefiltered row that enters the window.
    entering: [u8; WIDTH],
}

impl<const WIDTH: usize, const WINDOW: usize> View<WIDTH, WINDOW> {
    /// A view without rows; `reset` before use.
    pub const fn new() -> Self {
        Self { raw: [[0; WIDTH]; RAW_ROWS], prefiltered: [[0; WIDTH]; WINDOW], entering: [0; WIDTH] }
    }

    /// Forgets all rows: the window is over flat ones, whose response is `cap`.
    pub fn reset(&mut self, cap: u8) {
        self.prefiltered.as_flattened_mut().fill(cap);
    }

    /// Keeps raw row `y`.
    pub fn take(&mut self, y: u32, line: &[u8]) {
        self.raw[y as usize % RAW_ROWS][..line.len()].copy_from_slice(line);
    }

    /// Keeps the row before as raw row `y`, or mid-grey if there is none.
    pub fn stand_in(&mut self, y: u32) {
        self.raw[y as usize % RAW_ROWS] = match y.checked_sub(1) {
            Some(before) => self.raw[before as usize % RAW_ROWS],
            None => [MID_GREY; WIDTH],
        };
    }

    /// Prefilters row `y`, whose lower neighbour is already kept or, if it is the frame's `last`
    /// row, does not exist. The frame is mirrored at its first and last row.
    pub fn prefilter(&mut self, y: u32, width: usize, last: bool, cap: u8) {
        let entering = &mut self.entering[..width];
        // OpenCV filters rows in pairs and leaves a last one without partner flat.
        if last && y.is_multiple_of(2) {
            entering.fill(cap);
            return;
        }
        let above = if y == 0 { 1 } else { y - 1 };
        let below = if last { above } else { y + 1 };
        let rows = [above, y, below].map(|y| &self.raw[y as usize % RAW_ROWS][..width]);
        sobel_x(rows, cap, entering);
    }

    /// The prefiltered row that enters the window.
    pub fn entering(&self) -> &[u8] {
        &self.entering
    }

    /// The prefiltered row that leaves the window when row `y` enters.
    pub fn leaving(&self, y: u32) -> &[u8] {
        &self.prefiltered[y as usize % WINDOW]
    }

    /// Puts the entering row `y` into the place of the leaving one.
    pub fn advance(&mut self, y: u32) {
        self.prefiltered[y as usize % WINDOW] = self.entering;
    }
}
