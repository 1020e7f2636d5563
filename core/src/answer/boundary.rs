//! The boundary choice: at a jump each 2x2 quarter of a block decides which surface it belongs to.

use crate::count;
use crate::front_end::ring::MARGIN;
use crate::matching::block::{Block, SIZE, Source};
use crate::matching::cost::{ROWS, sad};

/// Side of the window around a quarter: one pixel more all around.
const WINDOW: usize = 4;

/// Chooses the sources of all quarters of a block row.
///
/// - `left`, `right`: feature rows from one row above the block row on, with margins.
pub(crate) fn choose_sources(
    row: &mut [Option<Block>],
    above: Option<&[Option<Block>]>,
    left: &[&[u8]; ROWS],
    right: &[&[u8]; ROWS],
) {
    // Two candidates of upper quarters, one of lower ones: whether their surfaces differ.
    count::subtractions(6 * row.len());
    count::comparisons(12 * row.len());
    for index in 0..row.len() {
        let at = |index: Option<usize>| row.get(index?).copied().flatten();
        let beside = [at(index.checked_sub(1)), at(index.checked_add(1))];
        let above = above.and_then(|blocks| blocks.get(index).copied().flatten());
        let Some(block) = row.get_mut(index).and_then(Option::as_mut) else { continue };
        for quarter in 0..4 {
            let (x, y) = (quarter % 2, quarter / 2);
            let candidates = [(Source::Beside, beside[x]), (Source::Above, above.filter(|_| y == 0))];
            let mut best = None;
            for (source, candidate) in candidates {
                let Some(other) = candidate.filter(|other| block.jumps_to(other) && !other.floor.blank) else {
                    continue;
                };
                let cost = |block: &Block| {
                    let column = SIZE * index + 2 * x + MARGIN - 1;
                    let shifted = usize::try_from(i32::try_from(column).ok()? - block.px()).ok()?;
                    sad::<WINDOW>(left.get(2 * y..2 * y + WINDOW)?, right.get(2 * y..2 * y + WINDOW)?, column, shifted)
                };
                // The own surface has the benefit of the doubt: its cost counts 4/5.
                let to_beat = best.or_else(|| cost(block).map(|own| own * 4 / 5));
                count::multiplications(2);
                count::comparisons(1);
                match (cost(&other), to_beat) {
                    (Some(cost), Some(to_beat)) if cost < to_beat => {
                        best = Some(cost);
                        block.sources.set(quarter, source);
                    }
                    _ => {}
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random features, one row like the other.
    fn feature(column: usize) -> u8 {
        u32::try_from(column).unwrap().wrapping_mul(2_654_435_761).to_be_bytes()[1] % 60
    }

    #[test]
    fn quarters_beyond_an_edge_go_to_the_block_that_knows_their_surface() {
        // Columns 6 and up of the view are at disparity 0, those before at 4, and the block in
        // columns 4 to 7 took the latter.
        const EDGE: usize = 6 + MARGIN;
        let left: [u8; 24] = core::array::from_fn(feature);
        let right: [u8; 24] = core::array::from_fn(|x| match x {
            x if x >= EDGE => feature(x),
            x if x + 4 < EDGE => feature(x + 4),
            x => feature(x + 100),
        });
        let at = |disparity| Some(Block { disparity, ..Block::default() });
        let mut row = [at(4), at(4), at(0), at(0)];
        choose_sources(&mut row, None, &[&left[..]; ROWS], &[&right[..]; ROWS]);
        let sources = row[1].unwrap().sources;
        let expected = [Source::Own, Source::Beside, Source::Own, Source::Beside];
        assert_eq!([0, 1, 2, 3].map(|quarter| sources.of(quarter)), expected);
        assert_eq!(row[0].unwrap().sources, row[3].unwrap().sources, "no jump, nothing to choose");
    }
}
