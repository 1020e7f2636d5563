//! The first pass: what every row offset costs in every part of the view, and the search of their minimum.

use super::blocks::MAX_OFFSETS;
use crate::matching::extremum::{FRAC_BITS, Method, Settings};

/// Parts of the view across and down.
const ACROSS: usize = 10;
const DOWN: usize = 6;
/// A step of the search along the roll, 1/65536: 0.0025.
const ROLL_STEP_Q16: i32 = 164;
/// Steps on each side of the search along row offset and roll.
const REACH: [i32; 2] = [9, 20];
/// Evaluations at most, 77 are usual: the search ends where it is then, as the next pass looks wider than its last
/// steps.
const MOST_EVALUATIONS: u32 = 100;

/// Costs of row offsets by place.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    cells: [Cell; ACROSS * DOWN],
}

#[derive(Debug, Clone, Copy, Default)]
struct Cell {
    costs: [u32; MAX_OFFSETS],
    /// Sums of the blocks' places, twice their distance from the middle, and their number.
    place: [i64; 2],
    blocks: u32,
}

/// What the search found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Coarse {
    /// Row offset, rows of the pass; 1/65536.
    pub(super) rows_q16: i32,
    /// Rows a column, 1/65536.
    pub(super) roll_q16: i32,
    /// How often the cost was asked for.
    pub(super) evaluations: u32,
}

impl Cells {
    pub(super) const fn new() -> Self {
        Self { cells: [Cell { costs: [0; MAX_OFFSETS], place: [0; 2], blocks: 0 }; ACROSS * DOWN] }
    }

    pub(super) fn clear(&mut self) {
        self.cells.fill(Cell::default());
    }

    /// Adds a block at twice that distance from the middle of views of `size` px.
    pub(super) fn add(&mut self, twice: [i32; 2], size: [u16; 2], profile: &[u16]) {
        let part = |j: usize, parts: usize| {
            let at = i64::from(twice[j]) + i64::from(size[j]);
            let part = at * i64::try_from(parts).unwrap_or(1) / (2 * i64::from(size[j]));
            usize::try_from(part).unwrap_or(0).min(parts - 1)
        };
        let cell = &mut self.cells[part(1, DOWN) * ACROSS + part(0, ACROSS)];
        for (cost, &sum) in cell.costs.iter_mut().zip(profile) {
            *cost = cost.saturating_add(sum.into());
        }
        cell.place[0] += i64::from(twice[0]);
        cell.place[1] += i64::from(twice[1]);
        cell.blocks += 1;
    }

    /// Looks for row offset and roll: the displacement of the left view's rows, which is what profiles tell.
    ///
    /// The paper's search in two dimensions from [1; 1], gamma 0.9 and 8 samples on each side; `None` where nothing
    /// was compared.
    pub(super) fn search(&self) -> Option<Coarse> {
        let whole = |steps: i32| steps << FRAC_BITS;
        let total: u64 =
            self.cells.iter().map(|cell| cell.costs.iter().map(|&c| u64::from(c)).max().unwrap_or(0)).sum();
        // So that a cost fits 31 bits.
        let shift = (u64::BITS - total.leading_zeros()).saturating_sub(30);
        let settings = Settings {
            start: [whole(1); 2],
            first_support: 16,
            ..Settings::new(REACH.map(|steps| whole(-steps)), REACH.map(whole))
        };
        let mut evaluations = 0;
        let found = settings.build().ok()?.run(Method::Proposed, |&[rows, roll]| {
            if evaluations == MOST_EVALUATIONS {
                return None;
            }
            evaluations += 1;
            let roll_q16 = i64::from(roll) * i64::from(ROLL_STEP_Q16);
            let cost: u64 = self.cells.iter().map(|cell| cell.cost(rows, roll_q16 >> FRAC_BITS)).sum();
            i32::try_from(cost >> shift).ok()
        });
        let roll = i64::from(found.at[1]) * i64::from(ROLL_STEP_Q16);
        let roll_q16 = i32::try_from(roll >> FRAC_BITS).ok()?;
        (total > 0).then_some(Coarse { rows_q16: found.at[0], roll_q16, evaluations })
    }
}

impl Cell {
    /// The cost of a row offset and a roll, both 1/65536: between two whole offsets linear.
    fn cost(&self, rows_q16: i32, roll_q16: i64) -> u64 {
        if self.blocks == 0 {
            return 0;
        }
        let twice = self.place[0] / i64::from(self.blocks);
        // Columns are those of the full size, rows those of the pass, which are twice as high.
        let offset = i64::from(rows_q16) + roll_q16 * twice / 4;
        let middle = i64::try_from(MAX_OFFSETS / 2).unwrap_or(0);
        let at = (offset + (middle << 16)).clamp(0, (2 * middle) << 16);
        let (index, weight) = (usize::try_from(at >> 16).unwrap_or(0), u64::try_from(at & 0xFFFF).unwrap_or(0));
        let of = |index: usize| u64::from(self.costs.get(index).copied().unwrap_or(0));
        (of(index) * (65_536 - weight) + of(index + 1) * weight) >> 16
    }
}
