//! Tiles of 8 x 4 px, compared with windows.
#![expect(unsafe_code, reason = "eight bytes at byte offsets, without a check for each")]

use super::quad::Quad;
use crate::lanes::array;

/// A tile, or a window as large: its upper and its lower two rows, four columns of the one and then of the other in turn.
#[derive(Clone, Copy)]
pub(crate) struct TileQuads([Quad; 2]);

impl TileQuads {
    /// What begins at a byte of four rows.
    ///
    /// # Safety
    /// They must have eight bytes from there on.
    #[inline(always)]
    pub(crate) unsafe fn load<const BLOCKS: usize>(rows: &[[u32; BLOCKS]; 4], byte: usize) -> Self {
        // SAFETY: as the caller promises.
        let [a, b, c, d] = rows.each_ref().map(|row| unsafe { Quad::load_two(row, byte) });
        Self([a.in_turn(b), c.in_turn(d)])
    }

    /// Sums of absolute differences of the four cells, two in a word: the upper and the lower ones.
    #[inline(always)]
    pub(crate) fn sad(self, Self([upper, lower]): Self) -> [u32; 2] {
        self.0[0].sad(upper).sums_as_halves(self.0[1].sad(lower))
    }
}

/// Those of a tile at so many windows, each a byte further right.
///
/// - `left`: first word of the tile; `right`: first byte of the first window.
///
/// # Safety
/// The rows must have two words from `left` and eight bytes from the last window's first on.
#[inline(always)]
pub(crate) unsafe fn tile_sads<const WINDOWS: usize, const BLOCKS: usize>(
    left_rows: &[[u32; BLOCKS]; 4],
    left: usize,
    right_rows: &[[u32; BLOCKS]; 4],
    right: usize,
) -> [[u32; 2]; WINDOWS] {
    // SAFETY: as the caller promises.
    let tile = unsafe { TileQuads::load(left_rows, 4 * left) };
    // SAFETY: as the caller promises.
    array(|step| tile.sad(unsafe { TileQuads::load(right_rows, right + step) }))
}
