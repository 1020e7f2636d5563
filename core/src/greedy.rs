//! The greedy search of one block row: few hypotheses a block, the cheapest wins.

use crate::Config;
use crate::block::{Block, Floor, JUMP, SIZE};
use crate::confidence::Merit;
use crate::cost::{energy, sad};
use crate::extremum::descend;
use crate::seed::Seeds;
use crate::texture::{Texture, mismatch};

/// Columns of a block's window; two more than the block on either side.
const WIDTH: usize = 8;
/// Rows of a block's window, from one row above the block.
pub(crate) const ROWS: usize = 6;
const PIXELS: u8 = 8 * 6;
const _: () = assert!(PIXELS as usize == WIDTH * ROWS);
/// Most disparities that one block evaluates: 7 hypotheses, and 4 by the walk.
const CAPACITY: usize = 11;
/// What a hypothesis pays for being one step off the block left or above, and for being more off.
const NEAR_BIAS: i32 = 50;
const FAR_BIAS: i32 = 200;

/// Feature rows of both views from one row above the block row on, and the search's bounds.
pub(crate) struct Greedy<'a, const BLOCKS: usize> {
    pub(crate) config: &'a Config,
    pub(crate) texture: Texture,
    pub(crate) left: [&'a [u8]; ROWS],
    pub(crate) right: [&'a [u8]; ROWS],
    pub(crate) seeds: &'a Seeds<BLOCKS>,
}

/// The disparities of one block that were evaluated, with their costs.
#[derive(Default)]
struct Evaluated {
    list: [(i32, i32); CAPACITY],
    len: usize,
}

impl Evaluated {
    fn entries(&self) -> &[(i32, i32)] {
        self.list.get(..self.len).unwrap_or(&[])
    }

    fn find(&self, disparity: i32) -> Option<i32> {
        self.entries().iter().find(|(d, _)| *d == disparity).map(|&(_, cost)| cost)
    }

    fn push(&mut self, disparity: i32, cost: i32) {
        if let Some(entry) = self.list.get_mut(self.len) {
            *entry = (disparity, cost);
            self.len += 1;
        }
    }
}

impl<const BLOCKS: usize> Greedy<'_, BLOCKS> {
    /// Finds the disparities of a block row, left to right.
    pub(crate) fn fill(&self, row: &mut [Option<Block>], above: Option<&[Option<Block>]>) {
        let mut left = None;
        let above_at = |block: Option<usize>| above?.get(block?)?.as_ref().map(Block::px);
        for (index, block) in row.iter_mut().enumerate() {
            let around = [Some(index), index.checked_sub(1), Some(index + 1)].map(above_at);
            *block = self.block(index, left, around);
            left = block.as_ref().map(Block::px);
        }
    }

    /// One block: the least biased cost among the hypotheses, then the walk to the minimum.
    ///
    /// `above` are the disparities of the blocks above, above left and above right.
    fn block(&self, index: usize, left: Option<i32>, above: [Option<i32>; 3]) -> Option<Block> {
        let (seed_left, seed_right) = self.seeds.nearest(index);
        let mean = seed_left.zip(seed_right).map(|(a, b)| (a + b).div_euclid(2));
        let mut evaluated = Evaluated::default();
        let mut best: Option<(i32, i32, i32)> = None;
        for disparity in [seed_left, seed_right, mean, above[0], above[1], above[2], left].into_iter().flatten() {
            if evaluated.find(disparity).is_some() {
                continue;
            }
            let Some(cost) = self.cost(index, disparity) else { continue };
            evaluated.push(disparity, cost);
            // Where nothing else tells, the nearer one wins: a vehicle had better brake.
            let biased = cost + bias(disparity, left) + bias(disparity, above[0]) - (disparity >> 2);
            if best.is_none_or(|(least, ..)| biased < least) {
                best = Some((biased, disparity, cost));
            }
        }
        let (_, start, cost) = best?;
        let minimum = descend(start, cost, 1, |disparity| {
            evaluated.find(disparity).or_else(|| {
                let cost = self.cost(index, disparity)?;
                evaluated.push(disparity, cost);
                Some(cost)
            })
        });
        let rivals = evaluated.entries().iter().filter(|(d, _)| (d - minimum.at).abs() > JUMP);
        let rival = rivals.map(|&(_, cost)| cost).min();
        let mut block = self.examine(index, minimum.at, minimum.cost)?;
        block.fraction = i8::try_from(minimum.refine_subpixel()).unwrap_or(0);
        block.merit = Merit::new(minimum.cost, rival);
        Some(block)
    }

    /// The block of that disparity with its texture.
    fn examine(&self, index: usize, disparity: i32, cost: i32) -> Option<Block> {
        let (left_column, right_column) = columns(index, disparity)?;
        let energies = (energy::<WIDTH>(&self.left, left_column)?, energy::<WIDTH>(&self.right, right_column)?);
        let mean = i32::midpoint(energies.0, energies.1);
        let at_floor = self.texture.is_at_floor(mean, u32::from(PIXELS));
        let mismatch = mismatch(cost, energies.0, energies.1, i32::from(PIXELS));
        let mut quarters = 0;
        for quarter in 0..4 {
            // Rows and columns of the quarter within the window.
            let (x, y) = (2 + 2 * (quarter % 2), 1 + 2 * (quarter / 2));
            let energy = energy::<2>(self.left.get(y..y + 2)?, left_column + x)?;
            quarters |= u8::from(self.texture.quarter_is_at_floor(energy)) << quarter;
        }
        let mut floor = Floor::new(quarters, at_floor);
        // Until the blocks around it are known, it speaks for itself.
        floor.set_blank(at_floor && self.texture.is_blank(u16::from(mismatch), 1));
        Some(Block {
            disparity: i16::try_from(disparity).ok()?,
            cost: u16::try_from(cost).ok()?,
            mismatch,
            floor,
            ..Block::default()
        })
    }

    /// SAD of the block's window at that disparity; `None` outside the search range or where the
    /// right window would leave the view.
    fn cost(&self, index: usize, disparity: i32) -> Option<i32> {
        if !self.config.contains(disparity) {
            return None;
        }
        let (left_column, right_column) = columns(index, disparity)?;
        if right_column > SIZE * usize::from(self.config.width).div_ceil(SIZE) {
            return None;
        }
        sad::<WIDTH>(&self.left, &self.right, left_column, right_column)
    }
}

/// First columns of the block's window in both views, margins counted.
fn columns(index: usize, disparity: i32) -> Option<(usize, usize)> {
    let left = SIZE * index + crate::ring::MARGIN - (WIDTH - SIZE) / 2;
    let right = i32::try_from(left).ok()? - disparity;
    Some((left, usize::try_from(right).ok()?))
}

/// What a hypothesis pays for not being the neighbour's disparity.
fn bias(disparity: i32, neighbour: Option<i32>) -> i32 {
    match neighbour.map(|other| (other - disparity).abs()) {
        None | Some(0) => 0,
        Some(1) => NEAR_BIAS,
        Some(_) => FAR_BIAS,
    }
}
