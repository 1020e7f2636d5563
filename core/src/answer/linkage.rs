//! Whether a point stands on a surface: enough of the points around it have its disparity.
//!
//! Contours go on from row to row and the points on a surface lie close together, while wrong matches
//! scatter: each is refuted by the points around it.

use crate::answer::confidence::Merit;
use crate::count;
use crate::{Config, Disparity};

/// Rows above and below whose points are asked.
pub(crate) const LINK_REACH: usize = 2;
/// Rows that are kept.
const ROWS: usize = 2 * LINK_REACH + 1;
/// Columns on either side whose points are asked, one in [`STRIDE`] of them.
const COLUMNS: usize = 6;
/// Points come in pairs, the pixels on either side of a contour: one of them will do.
const STRIDE: usize = 2;
/// Points within one px have the same disparity, 1/16 px.
const TOLERANCE: u16 = 16;

/// What a point needs to be linked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Links {
    /// Least number of points of its disparity.
    pub(crate) least: u16,
    /// Of ten points around, so many must have its disparity.
    pub(crate) share: u16,
}

/// What was measured in a row.
#[derive(Debug, Clone)]
pub struct Answers<const BLOCKS: usize> {
    pub(crate) disparity: [[Disparity; 4]; BLOCKS],
    pub(crate) confidence: [[u8; 4]; BLOCKS],
}

impl<const BLOCKS: usize> Answers<BLOCKS> {
    pub(crate) const UNKNOWN: Self =
        Self { disparity: [[Disparity::UNKNOWN; 4]; BLOCKS], confidence: [[0; 4]; BLOCKS] };

    pub(crate) fn clear(&mut self) {
        self.disparity.as_flattened_mut().fill(Disparity::UNKNOWN);
        self.confidence.as_flattened_mut().fill(0);
    }

    /// Answers a pixel that has no answer yet: `bits` is the disparity, 1/16 px. A disparity out of the
    /// search range and one whose match lies outside the right view are none.
    pub(crate) fn add(&mut self, config: &Config, x: i32, bits: i32, merit: Merit) {
        count::additions(1);
        count::subtractions(1);
        count::comparisons(6);
        let whole = (bits + 8) >> 4;
        let width = 0..i32::from(config.width);
        if !config.contains(whole) || !width.contains(&x) || !width.contains(&(x - whole)) {
            return;
        }
        let (Ok(x), Ok(bits)) = (usize::try_from(x), i16::try_from(bits)) else { return };
        if let (Some(disparity), Some(confidence)) =
            (self.disparity.as_flattened_mut().get_mut(x), self.confidence.as_flattened_mut().get_mut(x))
            && !disparity.is_known()
        {
            (*disparity, *confidence) = (Disparity::from_bits(bits), merit.confidence(merit, 0));
        }
    }
}

/// The newest rows of answers: those that a row's links may lead to.
#[derive(Debug, Clone)]
pub(crate) struct AnswerRing<const BLOCKS: usize> {
    rows: [Answers<BLOCKS>; ROWS],
    pushed: usize,
}

impl<const BLOCKS: usize> AnswerRing<BLOCKS> {
    pub(crate) const fn new() -> Self {
        Self { rows: [const { Answers::UNKNOWN }; ROWS], pushed: 0 }
    }

    pub(crate) fn clear(&mut self) {
        self.rows.iter_mut().for_each(Answers::clear);
        self.pushed = 0;
    }

    /// Makes room for the next row by giving up the oldest: unknown everywhere.
    pub(crate) fn push(&mut self) -> &mut Answers<BLOCKS> {
        let slot = self.pushed % ROWS;
        self.pushed = (self.pushed + 1) % ROWS;
        let row = &mut self.rows[slot];
        row.clear();
        row
    }

    /// Copies the row in the middle to `out`: all of its points, or only those with the `links` they need.
    pub(crate) fn answer(&self, width: usize, links: Option<Links>, out: &mut Answers<BLOCKS>) {
        let middle = &self.rows[(self.pushed + LINK_REACH) % ROWS];
        out.clone_from(middle);
        let Some(links) = links else { return };
        let pixels = out.disparity.as_flattened_mut().iter_mut().zip(out.confidence.as_flattened_mut());
        for (x, (disparity, confidence)) in pixels.enumerate().take(width) {
            if let Some(bits) = disparity.known()
                && !self.is_linked(x, bits, links)
            {
                (*disparity, *confidence) = (Disparity::UNKNOWN, 0);
            }
        }
    }

    /// Whether the points around a column of the row in the middle have its disparity, 1/16 px.
    fn is_linked(&self, x: usize, bits: i16, links: Links) -> bool {
        let columns = x.saturating_sub(COLUMNS)..x + COLUMNS + 1;
        let (mut same, mut all) = (0, 0);
        for row in &self.rows {
            let row = row.disparity.as_flattened();
            let around = row.get(columns.clone()).unwrap_or(row.get(columns.start..).unwrap_or(&[]));
            for other in around.iter().step_by(STRIDE).filter_map(|d| d.known()) {
                all += 1;
                same += u16::from(other.abs_diff(bits) <= TOLERANCE);
            }
        }
        // A difference's magnitude, the tolerance and two counts of each; the two limits.
        count::subtractions(usize::from(all));
        count::additions(2 * usize::from(all));
        count::comparisons(ROWS * (2 * COLUMNS / STRIDE + 1) + 2 * usize::from(all) + 2);
        same >= links.least && 10 * same >= links.share * all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIG: Config = Config { width: 32, min_disparity: 0, num_disparities: 16 };

    /// The disparities of a row whose middle one is wrong by `error` / 16 px, after the check.
    fn checked(rows: usize, error: i32, linked_only: bool) -> [Option<i16>; 3] {
        let mut ring = AnswerRing::<10>::new();
        for y in 0..ROWS {
            let row = ring.push();
            for x in (10..24).filter(|_| y >= ROWS - rows) {
                let wrong = if (x, y) == (17, LINK_REACH) { error } else { 0 };
                row.add(&CONFIG, x, 5 * 16 + wrong, Merit::default());
            }
        }
        let mut out = Answers::UNKNOWN;
        ring.answer(32, linked_only.then_some(Links { least: 7, share: 9 }), &mut out);
        [9, 17, 20].map(|x| out.disparity.as_flattened()[x].known())
    }

    #[test]
    fn a_point_that_differs_from_those_around_it_goes_and_they_stay() {
        assert_eq!(checked(5, 16, true), [None, Some(96), Some(80)]);
        assert_eq!(checked(5, 17, true), [None, None, Some(80)]);
        assert_eq!(checked(5, 17, false), [None, Some(97), Some(80)]);
    }

    #[test]
    fn a_disparity_out_of_range_or_out_of_view_is_no_answer() {
        let mut row = Answers::<10>::UNKNOWN;
        for (x, bits) in [(5, 6 * 16), (20, 16 * 16), (20, -9), (32, 16), (-1, 16)] {
            row.add(&CONFIG, x, bits, Merit::default());
        }
        assert!(row.disparity.as_flattened().iter().all(|d| !d.is_known()));
        row.add(&CONFIG, 5, 5 * 16, Merit::default());
        row.add(&CONFIG, 5, 4 * 16, Merit::default());
        assert_eq!(row.disparity.as_flattened()[5], Disparity::from_px(5), "the first answer stands");
    }
}
