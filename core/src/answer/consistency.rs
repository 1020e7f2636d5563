//! From blocks to answered pixels: texture test, confidence, left-right check, output rows.

use crate::answer::texture::{NO_EVIDENCE, Texture};
use crate::count;
use crate::matching::block::{Floor, Neighbourhood, SIZE, Source};
use crate::{Config, Disparity, DisparityRow};

/// Disparities of the two views that differ by more than this, px, are occluded or wrong
/// (OpenCV's `disp12MaxDiff`).
const LEFT_RIGHT_TOLERANCE: u16 = 3;
/// Pixels of a quarter's side.
const QUARTER: usize = SIZE / 2;

/// What one quarter answers, before the left-right check.
#[derive(Clone, Copy)]
struct Answer {
    disparity: i16,
    fraction: i8,
    cost: u16,
    confidence: u8,
    /// The pixels of the block that belong to a blank surface beside it: those without texture.
    blank: Floor,
}

/// Answers one block row: delivers its image rows `rows` through `sink`, those for which
/// `is_missing` holds as unknown.
pub(crate) fn answer<const BLOCKS: usize>(
    config: &Config,
    texture: Texture,
    mut blocks: Neighbourhood<'_>,
    rows: core::ops::Range<u32>,
    is_missing: impl Fn(u32) -> bool,
    sink: &mut dyn FnMut(DisparityRow<'_>),
) {
    judge_texture(&mut blocks, texture);
    rate_confidence(&mut blocks);
    let width = usize::from(config.width);
    let mut pixels = Pixels::<BLOCKS>::new();
    let mut claimed = None;
    for y in rows.clone() {
        let row = usize::try_from(y - rows.start).unwrap_or(0);
        if claimed != Some(row / QUARTER) {
            pixels.claim(&blocks, width, row / QUARTER);
            claimed = Some(row / QUARTER);
        }
        if is_missing(y) {
            pixels.forget();
        } else {
            pixels.check(&blocks, width, row);
        }
        let disparity = pixels.disparity.as_flattened().get(..width).unwrap_or(&[]);
        let confidence = pixels.confidence.as_flattened().get(..width).unwrap_or(&[]);
        sink(DisparityRow { y, disparity, confidence });
    }
}

/// A row of pixels, and who sees which column of the right view: scratch of one block row.
struct Pixels<const BLOCKS: usize> {
    /// For each column of the right view the least cost that claims it, and the disparity of it.
    claims: [[(u16, i16); SIZE]; BLOCKS],
    disparity: [[Disparity; SIZE]; BLOCKS],
    confidence: [[u8; SIZE]; BLOCKS],
}

impl<const BLOCKS: usize> Pixels<BLOCKS> {
    const fn new() -> Self {
        Self {
            claims: [[(u16::MAX, 0); SIZE]; BLOCKS],
            disparity: [[Disparity::UNKNOWN; SIZE]; BLOCKS],
            confidence: [[0; SIZE]; BLOCKS],
        }
    }

    /// Lets every pixel of a row of quarters claim its column in the right view.
    fn claim(&mut self, blocks: &Neighbourhood<'_>, width: usize, quarter_row: usize) {
        let claims = self.claims.as_flattened_mut();
        claims.fill((u16::MAX, 0));
        // Its claim, and the lesser confidence of each quarter.
        count::comparisons(width + width / QUARTER);
        for (x, answer) in quarters(blocks, width, quarter_row) {
            let Some(answer) = answer else { continue };
            for x in x..(x + QUARTER).min(width) {
                if let Some(claim) = column_seen(x, answer.disparity, width).and_then(|x| claims.get_mut(x))
                    && answer.cost < claim.0
                {
                    *claim = (answer.cost, answer.disparity);
                }
            }
        }
    }

    /// A row without any answer.
    fn forget(&mut self) {
        self.disparity.as_flattened_mut().fill(Disparity::UNKNOWN);
        self.confidence.as_flattened_mut().fill(0);
    }

    /// Writes out the pixels of a row of the blocks whose claim stands.
    fn check(&mut self, blocks: &Neighbourhood<'_>, width: usize, row: usize) {
        let (claims, disparity) = (self.claims.as_flattened(), self.disparity.as_flattened_mut());
        let confidence = self.confidence.as_flattened_mut();
        // The claim's disparity against its own, the blank pixel; the answer's fraction.
        count::subtractions(width);
        count::comparisons(3 * width + width / QUARTER);
        count::additions(width);
        for (x, answer) in quarters(blocks, width, row / QUARTER) {
            for x in x..(x + QUARTER).min(width) {
                let (Some(disparity), Some(confidence)) = (disparity.get_mut(x), confidence.get_mut(x)) else {
                    continue;
                };
                let stands = |answer: &Answer| {
                    let claim = column_seen(x, answer.disparity, width).and_then(|x| claims.get(x));
                    let agrees = |other: i16| other.abs_diff(answer.disparity) <= LEFT_RIGHT_TOLERANCE;
                    claim.is_some_and(|&(_, other)| agrees(other)) && !answer.blank.has_pixel(x % SIZE, row)
                };
                (*disparity, *confidence) = match answer.filter(stands) {
                    Some(a) => (Disparity::from_bits(16 * a.disparity + i16::from(a.fraction)), a.confidence),
                    None => (Disparity::UNKNOWN, 0),
                };
            }
        }
    }
}

/// Column of the right view that sees the left view's column `x`.
fn column_seen(x: usize, disparity: i16, width: usize) -> Option<usize> {
    let column = i32::try_from(x).ok()? - i32::from(disparity);
    usize::try_from(column).ok().filter(|&column| column < width)
}

/// The quarters of one row, left to right, with their first columns.
fn quarters<'a>(
    blocks: &'a Neighbourhood<'_>,
    width: usize,
    quarter_row: usize,
) -> impl Iterator<Item = (usize, Option<Answer>)> + 'a {
    (0..width).step_by(QUARTER).map(move |x| {
        let (index, side) = (x / SIZE, x / QUARTER % (SIZE / QUARTER));
        (x, quarter_answer(blocks, index, side, quarter_row))
    })
}

/// What a quarter answers; `None` if it is unknown.
fn quarter_answer(blocks: &Neighbourhood<'_>, index: usize, side: usize, quarter_row: usize) -> Option<Answer> {
    let block = blocks.row.get(index)?.as_ref().filter(|block| !block.floor.blank)?;
    let [left, right, above, below] = blocks.around(index);
    let beside = if side == 0 { left } else { right };
    let next = if quarter_row == 0 { above } else { below };
    let touches_blank = [beside, next].into_iter().flatten().any(|other| other.floor.blank);
    let quarter = QUARTER * quarter_row + side;
    let source = match block.sources.of(quarter) {
        Source::Own => Some(block),
        Source::Beside => beside,
        Source::Above => above,
    };
    let source = source.filter(|source| !source.floor.blank)?;
    Some(Answer {
        disparity: source.disparity,
        fraction: source.fraction,
        cost: source.cost,
        confidence: source.confidence.min(block.confidence),
        blank: if touches_blank { block.floor } else { Floor::default() },
    })
}

/// Decides which blocks are blank. The row below keeps its provisional verdict.
///
/// A block whose window is within the noise is judged by the mismatch of all blocks around it. One
/// that has a textured edge in its window but none of its own matches well for the edge's sake, so it
/// is judged by those around it that are within the noise.
fn judge_texture(blocks: &mut Neighbourhood<'_>, texture: Texture) {
    // Mismatches of nine blocks, twice; the verdict.
    count::additions(4 * 9 * blocks.row.len());
    count::comparisons(blocks.row.len());
    count::multiplications(blocks.row.len());
    for index in 0..blocks.row.len() {
        let span = index.saturating_sub(1)..index + 2;
        let (mut all, mut at_floor) = ((0, 0), (0, 0));
        for row in [blocks.above, Some(&*blocks.row), blocks.below].into_iter().flatten() {
            for block in row.get(span.start..span.end.min(row.len())).unwrap_or(&[]) {
                let mismatch = u16::from(block.map_or(NO_EVIDENCE, |block| block.mismatch));
                all = (all.0 + mismatch, all.1 + 1);
                if block.is_some_and(|block| block.floor.window) {
                    at_floor = (at_floor.0 + mismatch, at_floor.1 + 1);
                }
            }
        }
        if let Some(Some(block)) = blocks.row.get_mut(index) {
            let blank = if block.floor.window {
                texture.is_blank(all.0, all.1)
            } else {
                block.floor.has_block() && at_floor.1 > 0 && texture.is_blank(at_floor.0, at_floor.1)
            };
            block.floor.blank = blank;
        }
    }
}

/// Rates each block of the row among its four neighbours.
fn rate_confidence(blocks: &mut Neighbourhood<'_>) {
    // Four neighbours, then the confidence.
    count::additions(6 * blocks.row.len());
    count::subtractions(7 * blocks.row.len());
    count::comparisons(14 * blocks.row.len());
    count::multiplications(3 * blocks.row.len());
    for index in 0..blocks.row.len() {
        let Some(Some(block)) = blocks.row.get(index).copied() else { continue };
        let (mut least, mut jumps) = (block.merit, 0);
        for other in blocks.around(index).into_iter().flatten() {
            if block.jumps_to(other) {
                jumps += 1;
            } else {
                least = least.min(other.merit);
            }
        }
        if let Some(Some(block)) = blocks.row.get_mut(index) {
            block.confidence = block.merit.confidence(least, jumps);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matching::block::{Block, BlockRows};
    extern crate std;
    use std::vec::Vec;

    /// The disparities, px, that four blocks of one row answer as (disparity, cost), by image row.
    fn answers(blocks: [Option<(i16, u16)>; 4], missing: Option<u32>) -> Vec<Vec<Option<i16>>> {
        let config = Config { width: 14, min_disparity: -8, num_disparities: 32 };
        let mut rows = BlockRows::<6>::new();
        for (to, from) in rows.begin(4).row.iter_mut().zip(blocks) {
            *to = from.map(|(disparity, cost)| Block { disparity, cost, ..Block::default() });
        }
        let mut found = Vec::new();
        let is_missing = |y| Some(y) == missing;
        answer::<6>(&config, Texture::OFF, rows.neighbourhood(4, true).unwrap(), 8..12, is_missing, &mut |row| {
            assert_eq!((row.y, row.confidence.len()), (8 + u32::try_from(found.len()).unwrap(), 14));
            found.push(row.disparity.iter().map(|d| d.known().map(|bits| bits / 16)).collect());
        });
        found
    }

    #[test]
    fn of_two_blocks_that_see_one_place_the_costlier_is_unknown() {
        // The third block at 8 px sees the columns of the first one at 0 px.
        let rows = answers([Some((0, 10)), None, Some((8, 5)), None], None);
        assert_eq!(rows.len(), 4);
        for row in rows {
            assert_eq!((row[0], row[3], row[4], row[8], row[11]), (None, None, None, Some(8), Some(8)));
        }
        let rows = answers([Some((0, 4)), None, Some((8, 5)), None], None);
        assert_eq!((rows[0][0], rows[0][8]), (Some(0), None));
        // Within the tolerance they are one surface.
        let rows = answers([Some((0, 10)), Some((3, 5)), None, None], None);
        assert_eq!((rows[0][1], rows[0][3], rows[0][4]), (Some(0), Some(0), Some(3)));
    }

    #[test]
    fn pixels_whose_match_lies_outside_the_right_view_are_unknown() {
        let row = answers([Some((2, 5)), None, None, Some((-1, 5))], None).remove(0);
        assert_eq!(row[..4], [None, None, Some(2), Some(2)]);
        assert_eq!(row[12..], [Some(-1), None]);
    }

    #[test]
    fn a_missing_row_is_unknown_and_the_next_one_is_not() {
        for missing in 8..12 {
            for (y, row) in (8..).zip(answers([None, Some((0, 5)), None, None], Some(missing))) {
                assert_eq!(row[5], (y != missing).then_some(0), "row {y} without {missing}");
            }
        }
    }
}
