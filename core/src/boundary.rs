//! The boundary choice: at a jump each 2x2 quarter of a block decides which surface it belongs to.

use crate::block::{Block, SIZE, Source};
use crate::cost::{ROWS, sad};
use crate::ring::MARGIN;

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
                let Some(other) = candidate.filter(|other| block.jumps_to(other) && !other.floor.is_blank()) else {
                    continue;
                };
                let cost = |block: &Block| {
                    let column = SIZE * index + 2 * x + MARGIN - 1;
                    let shifted = usize::try_from(i32::try_from(column).ok()? - block.px()).ok()?;
                    sad::<WINDOW>(left.get(2 * y..2 * y + WINDOW)?, right.get(2 * y..2 * y + WINDOW)?, column, shifted)
                };
                // The own surface has the benefit of the doubt: its cost counts 4/5.
                let to_beat = best.or_else(|| cost(block).map(|own| own * 4 / 5));
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
