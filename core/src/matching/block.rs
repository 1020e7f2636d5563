//! Blocks: 4 x 4 pixels that share a disparity, and the rows of them that are kept.

use crate::answer::confidence::Merit;

/// Columns and rows of a block.
pub(crate) const SIZE: usize = 4;
/// The same, to count rows of the image with.
pub(crate) const SIZE_U32: u32 = 4;
/// Disparities of neighbours that differ by more than this, px, are a jump between surfaces.
pub(crate) const JUMP: i32 = 1;

/// Where a 2x2 quarter of a block takes its disparity from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    /// Its own block.
    Own,
    /// The block beside it: left of the left quarters, right of the right ones.
    Beside,
    /// The block above, for the upper quarters.
    Above,
}

/// What is known of a block whose disparity was found.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Block {
    /// Whole disparity, px.
    pub(crate) disparity: i16,
    /// What the extremum lies after it, 1/16 px.
    pub(crate) fraction: i8,
    /// How badly the match fits, percent (see [`crate::answer::texture::mismatch`]).
    pub(crate) mismatch: u8,
    /// SAD of the match.
    pub(crate) cost: u16,
    /// How far the match stands out.
    pub(crate) merit: Merit,
    /// The confidence it is answered with.
    pub(crate) confidence: u8,
    /// What of it is within the noise.
    pub(crate) floor: Floor,
    /// Where the quarters take their disparity from.
    pub(crate) sources: Sources,
}

/// What of a block is no stronger than noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Floor {
    /// The pixels whose feature is, as bits, row by row from the upper left.
    pub(crate) pixels: u16,
    /// Whether the block's whole window is.
    pub(crate) window: bool,
    /// Verdict of the texture test; provisional until the row below is known.
    pub(crate) blank: bool,
}

impl Floor {
    /// Whether the pixel in that column and row of the block is within the noise.
    pub(crate) const fn has_pixel(self, column: usize, row: usize) -> bool {
        self.pixels >> (SIZE * row + column) & 1 == 1
    }

    /// Whether all but a stray pixel of the block itself are, whatever else its window sees.
    pub(crate) const fn has_block(self) -> bool {
        self.pixels.count_ones() >= 15
    }
}

/// The sources of a block's quarters, upper left first, two bits each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Sources(u8);

impl Sources {
    pub(crate) const fn of(self, quarter: usize) -> Source {
        match self.0 >> (2 * quarter) & 3 {
            1 => Source::Beside,
            2 => Source::Above,
            _ => Source::Own,
        }
    }

    pub(crate) const fn set(&mut self, quarter: usize, source: Source) {
        let code = match source {
            Source::Own => 0,
            Source::Beside => 1,
            Source::Above => 2,
        };
        self.0 = self.0 & !(3 << (2 * quarter)) | code << (2 * quarter);
    }
}

impl Block {
    /// Disparity of the match, px.
    pub(crate) fn px(&self) -> i32 {
        i32::from(self.disparity)
    }

    /// Whether the surfaces of the two differ.
    pub(crate) fn jumps_to(&self, other: &Self) -> bool {
        (self.px() - other.px()).abs() > JUMP
    }
}

/// A row of blocks; `None` where nothing is known.
pub(crate) type BlockRow<const BLOCKS: usize> = [Option<Block>; BLOCKS];

/// The block row that is answered next, with the ones above and below it.
#[derive(Debug, Clone)]
pub struct BlockRows<const BLOCKS: usize> {
    rows: [BlockRow<BLOCKS>; 3],
    started: u32,
}

/// The row that was just begun, with those above it.
pub(crate) struct Begun<'a> {
    pub(crate) row: &'a mut [Option<Block>],
    pub(crate) above: Option<&'a mut [Option<Block>]>,
}

/// The row that is answered, with those above and below it.
pub(crate) struct Neighbourhood<'a> {
    pub(crate) above: Option<&'a [Option<Block>]>,
    pub(crate) row: &'a mut [Option<Block>],
    pub(crate) below: Option<&'a [Option<Block>]>,
}

impl<const BLOCKS: usize> BlockRows<BLOCKS> {
    pub(crate) const fn new() -> Self {
        Self { rows: [[None; BLOCKS]; 3], started: 0 }
    }

    pub(crate) fn clear(&mut self) {
        self.started = 0;
    }

    /// Block rows begun in this frame.
    pub(crate) const fn len(&self) -> u32 {
        self.started
    }

    /// Begins a row of `count` blocks, empty.
    pub(crate) fn begin(&mut self, count: usize) -> Begun<'_> {
        self.rows.rotate_left(1);
        let started = self.started;
        self.started += 1;
        let [_, above, row] = &mut self.rows;
        row.fill(None);
        Begun { row: row.get_mut(..count).unwrap_or(&mut []), above: above.get_mut(..count).filter(|_| started > 0) }
    }

    /// The row of `count` blocks that can be answered: the last but one, or at the end of the frame
    /// the last one.
    pub(crate) fn neighbourhood(&mut self, count: usize, at_end: bool) -> Option<Neighbourhood<'_>> {
        let [first, second, third] = &mut self.rows;
        let (above, row, below, least) =
            if at_end { (second, third, None, 1) } else { (first, second, Some(third), 2) };
        if self.started < least {
            return None;
        }
        Some(Neighbourhood {
            above: above.get(..count).filter(|_| self.started > least),
            row: row.get_mut(..count)?,
            below: below.and_then(|row| row.get(..count)),
        })
    }
}

impl Neighbourhood<'_> {
    /// The blocks left, right, above and below of a block.
    pub(crate) fn around(&self, block: usize) -> [Option<&Block>; 4] {
        let beside = |index: Option<usize>| self.row.get(index?)?.as_ref();
        [
            beside(block.checked_sub(1)),
            beside(block.checked_add(1)),
            self.above.and_then(|blocks| blocks.get(block)?.as_ref()),
            self.below.and_then(|blocks| blocks.get(block)?.as_ref()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_quarter_keeps_its_own_source() {
        let mut sources = Sources::default();
        assert_eq!([0, 1, 2, 3].map(|quarter| sources.of(quarter)), [Source::Own; 4]);
        for (quarter, source) in [(0, Source::Above), (1, Source::Beside), (3, Source::Beside), (1, Source::Above)] {
            sources.set(quarter, source);
        }
        let expected = [Source::Above, Source::Above, Source::Own, Source::Beside];
        assert_eq!([0, 1, 2, 3].map(|quarter| sources.of(quarter)), expected);
        sources.set(0, Source::Own);
        assert_eq!((sources.of(0), sources.of(1)), (Source::Own, Source::Above));
    }

    #[test]
    fn a_row_is_answered_when_the_one_below_is_there_and_the_last_one_at_the_end() {
        // Row number `n` is marked by disparity `n` in its first block.
        let mut rows = BlockRows::<2>::new();
        let mark = |row: Option<&[Option<Block>]>| row.map(|row| row[0].map(|block| block.px()));
        let answer = |rows: &mut BlockRows<2>, at_end| {
            let found = rows.neighbourhood(1, at_end)?;
            Some([mark(found.above), mark(Some(found.row)), mark(found.below)])
        };
        for frame in 0..2 {
            assert_eq!(answer(&mut rows, true), None, "frame {frame}");
            for n in 0..3 {
                rows.begin(1).row[0] = Some(Block { disparity: n, ..Block::default() });
                let before = |back: i16| (n >= back).then(|| Some(i32::from(n - back)));
                let expected = (n > 0).then(|| [before(2), before(1), before(0)]);
                assert_eq!(answer(&mut rows, false), expected, "row {n} of frame {frame}");
                assert_eq!(answer(&mut rows, true), Some([before(1), before(0), None]), "row {n} of frame {frame}");
            }
            rows.clear();
        }
    }
}
