//! From blocks to answered pixels: texture test, confidence, left-right check, output rows.

use crate::block::{Neighbourhood, SIZE, Source};
use crate::texture::{NO_EVIDENCE, Texture};
use crate::{Config, Disparity, DisparityRow};

/// Disparities of the two views that differ by more than this, px, are occluded or wrong
/// (OpenCV's `disp12MaxDiff`).
const LEFT_RIGHT_TOLERANCE: i32 = 3;
/// Pixels of a quarter's side.
const QUARTER: usize = SIZE / 2;

/// What one quarter answers, before the left-right check.
#[derive(Clone, Copy)]
struct Answer {
    disparity: i16,
    fraction: i8,
    cost: u16,
    confidence: u8,
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
    let mut written = None;
    for y in rows.clone() {
        let quarter_row = usize::try_from(y - rows.start).unwrap_or(0) / QUARTER;
        if is_missing(y) {
            pixels = Pixels::new();
            written = None;
        } else if written != Some(quarter_row) {
            pixels.claim(&blocks, width, quarter_row);
            pixels.check(&blocks, width, quarter_row);
            written = Some(quarter_row);
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

    /// Writes out the pixels of a row of quarters whose claim stands.
    fn check(&mut self, blocks: &Neighbourhood<'_>, width: usize, quarter_row: usize) {
        let (claims, disparity) = (self.claims.as_flattened(), self.disparity.as_flattened_mut());
        let confidence = self.confidence.as_flattened_mut();
        for (x, answer) in quarters(blocks, width, quarter_row) {
            for x in x..(x + QUARTER).min(width) {
                let (Some(disparity), Some(confidence)) = (disparity.get_mut(x), confidence.get_mut(x)) else {
                    continue;
                };
                let stands = |answer: &Answer| {
                    column_seen(x, answer.disparity, width).and_then(|x| claims.get(x)).is_some_and(|claim| {
                        (i32::from(claim.1) - i32::from(answer.disparity)).abs() <= LEFT_RIGHT_TOLERANCE
                    })
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
        let (index, side) = (x / SIZE, x / QUARTER % QUARTER);
        (x, quarter_answer(blocks, index, side, quarter_row))
    })
}

/// What a quarter answers; `None` if it is unknown.
fn quarter_answer(blocks: &Neighbourhood<'_>, index: usize, side: usize, quarter_row: usize) -> Option<Answer> {
    let block = blocks.row.get(index)?.as_ref().filter(|block| !block.floor.is_blank())?;
    let [left, right, above, below] = blocks.around(index);
    let beside = if side == 0 { left } else { right };
    let next = if quarter_row == 0 { above } else { below };
    let quarter = QUARTER * quarter_row + side;
    // A quarter without texture beside a blank block is part of the blank surface, not of this one.
    let touches_blank = [beside, next].into_iter().flatten().any(|other| other.floor.is_blank());
    if touches_blank && block.floor.has_quarter(quarter) {
        return None;
    }
    let source = match block.sources.of(quarter) {
        Source::Own => Some(block),
        Source::Beside => beside,
        Source::Above => above,
    };
    let source = source.filter(|source| !source.floor.is_blank())?;
    Some(Answer {
        disparity: source.disparity,
        fraction: source.fraction,
        cost: source.cost,
        confidence: source.confidence.min(block.confidence),
    })
}

/// Decides which blocks are blank. The row below keeps its provisional verdict.
fn judge_texture(blocks: &mut Neighbourhood<'_>, texture: Texture) {
    for index in 0..blocks.row.len() {
        let span = index.saturating_sub(1)..index + 2;
        let (mut sum, mut count) = (0, 0);
        for row in [blocks.above, Some(&*blocks.row), blocks.below].into_iter().flatten() {
            for block in row.get(span.start..span.end.min(row.len())).unwrap_or(&[]) {
                sum += u16::from(block.map_or(NO_EVIDENCE, |block| block.mismatch));
                count += 1;
            }
        }
        if let Some(Some(block)) = blocks.row.get_mut(index) {
            block.floor.set_blank(block.floor.has_whole() && texture.is_blank(sum, count));
        }
    }
}

/// Rates each block of the row among its four neighbours.
fn rate_confidence(blocks: &mut Neighbourhood<'_>) {
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
