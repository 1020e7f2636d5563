//! The finder: chains of blocks while the rows of a frame pass, and what they tell of each sector.

use super::block::Block;
use super::free::Clearance;
use super::lane::{Camera, Directions, Lane};
use super::weighing::{RowHeight, Weighing};
use super::{Mounting, ObstacleError, Sectors, Settings};
use crate::answer::confidence::MEASURED;
use crate::method::capacity::blocks_for;
use crate::{DisparityRow, Rig};

/// Columns and rows of a block of pixels of which one is looked at.
pub(super) const SIZE: usize = 4;

/// Finds the nearest obstacle of each sector while the rows of a frame pass.
///
/// `SECTORS` is the capacity for sectors, `BLOCKS` that for the width: [`blocks_for`] it. Of the same rows
/// every capacity makes the same answer. A row costs nothing, one in four a division or two for each sector and
/// two comparisons for each block.
#[derive(Debug, Clone)]
pub struct Obstacles<const SECTORS: usize, const BLOCKS: usize> {
    camera: Camera,
    sectors: Sectors<SECTORS>,
    settings: Settings,
    /// The block row looked at last.
    blocks: [Block; BLOCKS],
    /// What they tell of each sector.
    weighings: [Weighing; SECTORS],
    clearance: [Clearance; SECTORS],
}

impl<const SECTORS: usize, const BLOCKS: usize> Obstacles<SECTORS, BLOCKS> {
    /// The row of each block row that is looked at.
    const SAMPLE: usize = SIZE / 2;
    /// So many blocks side by side none of which is sure may hide something.
    const WIDE_GAP: usize = 4;

    /// For views of width and height `size`.
    ///
    /// # Errors
    /// Names the first argument that is out of its range.
    pub fn new(
        size: [u16; 2],
        rig: Rig,
        mounting: Mounting,
        sectors: Sectors<SECTORS>,
        settings: Settings,
    ) -> Result<Self, ObstacleError> {
        let blocks = blocks_for(size[0]);
        if blocks > BLOCKS {
            let max_width = u16::try_from(SIZE * BLOCKS.saturating_sub(blocks_for(0))).unwrap_or(u16::MAX);
            return Err(ObstacleError::Capacity { max_width });
        }
        if !mounting.is_valid() {
            return Err(ObstacleError::Mounting);
        }
        if !sectors.is_valid() {
            return Err(ObstacleError::Sectors);
        }
        let camera = Camera::new(size, rig, mounting)?;
        Ok(Self {
            camera,
            sectors,
            settings,
            blocks: [Block::NONE; BLOCKS],
            weighings: [Weighing::NONE; SECTORS],
            clearance: [Clearance::NONE; SECTORS],
        })
    }

    /// Begins a frame. The first row of one does the same.
    pub fn start(&mut self) {
        self.blocks.fill(Block::NONE);
        self.weighings.fill(Weighing::NONE);
        self.clearance.fill(Clearance::NONE);
    }

    /// Takes the next row of a frame. One whose width differs is taken as far as it goes.
    pub fn push(&mut self, row: &DisparityRow<'_>) {
        if row.y == 0 {
            self.start();
        }
        if row.y as usize % SIZE != Self::SAMPLE {
            return;
        }
        match self.camera.lane(row.y, self.settings.doubt) {
            Some(lane) => {
                self.look(&lane, row);
                if self.settings.free_beyond_mm > 0 {
                    self.clear(&lane, row);
                }
            }
            None => self.blocks = [Block::NONE; BLOCKS],
        }
    }

    /// Counts what is measured to be free in a row.
    fn clear(&mut self, lane: &Lane, row: &DisparityRow<'_>) {
        let Some(reach) = lane.reach(self.settings.free_beyond_mm) else { return };
        let samples = row.disparity.iter().zip(row.confidence).take(self.camera.width());
        let mut directions = Directions::new(lane, &self.sectors);
        for (index, (disparity, &confidence)) in samples.enumerate().skip(Self::SAMPLE).step_by(SIZE) {
            let Some(sector) = directions.sector_of(index) else { continue };
            let sure = disparity.known().filter(|_| confidence >= self.settings.min_confidence);
            let sure = sure.map(|bits| i32::from(bits) + self.camera.rig().doffs_bits());
            if let Some(clearance) = self.clearance.get_mut(sector) {
                clearance.add(&reach, sure.map(|bits| reach.is_clear(lane, bits, self.settings.doubt)));
            }
        }
    }

    /// Distance over the ground to the nearest obstacle of each sector, mm, rounded down; `None` is unknown. Whole once the
    /// last row of the frame is in.
    pub fn nearest_mm(&self) -> impl Iterator<Item = Option<u32>> {
        let height = RowHeight::of(self.camera.rig());
        self.with_beside().map(move |(weighing, beside)| weighing.told_mm(beside, height))
    }

    /// Whether each sector is measured and free up to [`Settings::free_beyond_mm`]: nothing was found in it, nor may be there,
    /// of the samples whose ray runs within the band of heights at that distance 80 percent are sure and lie beyond,
    /// and of those whose ray crosses the band before, 80 percent are sure, too (and see the ground, or what is
    /// above the band). Whole once the last row of the frame is in; never true where that distance is 0.
    pub fn free(&self) -> impl Iterator<Item = bool> {
        let (limit, height) = (self.settings.free_beyond_mm, RowHeight::of(self.camera.rig()));
        let used = self.with_beside().zip(&self.clearance);
        used.map(move |((weighing, beside), clearance)| clearance.is_free() && weighing.is_free(limit, beside, height))
    }

    /// What was weighed in each sector, and in those left and right of it.
    fn with_beside(&self) -> impl Iterator<Item = (&Weighing, [Option<&Weighing>; 2])> {
        let used = self.weighings.get(..self.sectors.count).unwrap_or(&[]);
        let at = |sector: Option<usize>| sector.and_then(|sector| used.get(sector));
        used.iter()
            .enumerate()
            .map(move |(sector, weighing)| (weighing, [at(sector.checked_sub(1)), at(sector.checked_add(1))]))
    }

    /// Extends the chains by a row of blocks, and reports those that are believed.
    fn look(&mut self, lane: &Lane, row: &DisparityRow<'_>) {
        let width = self.camera.width().min(row.disparity.len()).min(row.confidence.len());
        let count = ((width + SIZE - 1 - Self::SAMPLE) / SIZE).min(BLOCKS);
        if self.settings.doubtful_blocks > 0 {
            self.note_gaps(lane, row, count);
        }
        if self.extend(lane, row, count) {
            self.report(lane, row, count);
        }
    }

    /// Notes in which sectors nothing is sure of the first `count` blocks of a row over so many of them that something may be
    /// hidden there.
    #[inline(never)]
    fn note_gaps(&mut self, lane: &Lane, row: &DisparityRow<'_>, count: usize) {
        let mut directions = Directions::new(lane, &self.sectors);
        let mut is_unseen = [false; SECTORS];
        let mut note = |gap: core::ops::Range<usize>| {
            if gap.len() < Self::WIDE_GAP {
                return;
            }
            let mut before = None;
            for index in gap {
                let sector = directions.sector_of(SIZE * index + Self::SAMPLE);
                // With one block a gap only touches a sector.
                if let Some(unseen) = sector.filter(|_| sector == before).and_then(|sector| is_unseen.get_mut(sector)) {
                    *unseen = true;
                }
                before = sector;
            }
        };
        let mut first = 0;
        let confidences = row.confidence.as_chunks::<SIZE>().0;
        for (index, confidences) in confidences.iter().take(count).enumerate() {
            if confidences[Self::SAMPLE] >= self.settings.min_confidence {
                note(first..index);
                first = index + 1;
            }
        }
        note(first..count);
        for (weighing, &is_unseen) in self.weighings.iter_mut().zip(&is_unseen) {
            weighing.add_row(is_unseen);
        }
    }

    /// Extends the chains by the first `count` blocks of a row; whether one of them may be believed or in doubt.
    #[inline(never)]
    fn extend(&mut self, lane: &Lane, row: &DisparityRow<'_>, count: usize) -> bool {
        let Self { camera, settings, blocks, .. } = self;
        let (doffs, tolerance) = (camera.rig().doffs_bits(), settings.tolerance);
        let (sure, fringe) = (settings.min_confidence, settings.fringe());
        let least = fringe.min(MEASURED);
        let samples = row.disparity.as_chunks::<SIZE>().0.iter().zip(row.confidence.as_chunks::<SIZE>().0);
        let blocks = blocks.get_mut(..count).unwrap_or(&mut []);
        // A block is written when nobody asks any more for the one that it relieves. At the border of the view one is made of
        // one side only, in noise it is wrong by more: there is none.
        let (mut left, mut is_told) = (Block::NONE, false);
        for (index, (disparities, confidences)) in (0..count.saturating_sub(2)).zip(samples.skip(1)) {
            let Some([above_left, above, above_right]) =
                blocks.get_mut(index..).and_then(|rest| rest.first_chunk_mut())
            else {
                break;
            };
            let confidence = confidences[Self::SAMPLE];
            if confidence >= least
                && let Some(bits) = disparities[Self::SAMPLE].known()
                && let bits = i32::from(bits) + doffs
                && lane.holds(bits)
            {
                let weight = if confidence >= sure { Settings::SURE_WEIGHT } else { u8::from(confidence >= fringe) };
                let above = [&*above_left, above, above_right];
                let block = Block::grow(bits.unsigned_abs(), weight, &left, above, tolerance);
                *above_left = left;
                left = block;
                is_told |= left.is_of_rows();
            } else {
                left.hand_over(above_left);
            }
        }
        if let [.., last_but_one, last] = blocks {
            left.hand_over(last_but_one);
            left.hand_over(last);
        }
        is_told
    }

    /// Reports what is believed of the first `count` blocks of a row, and what is in doubt.
    #[inline(never)]
    fn report(&mut self, lane: &Lane, row: &DisparityRow<'_>, count: usize) {
        let Settings { agreeing_blocks, min_confidence, doubtful_blocks, .. } = self.settings;
        let agreeing_blocks = u32::from(agreeing_blocks.max(2));
        let [least_weight, least_of_surface] = [agreeing_blocks, agreeing_blocks.div_ceil(2)]
            .map(|blocks| (blocks * u32::from(Settings::SURE_WEIGHT)).min(255));
        let mut directions = Directions::new(lane, &self.sectors);
        // Of blocks that were passed already.
        let mut passed = directions.clone();
        let (mut gap, mut doubtful) = (Gap { first: 0, bits: 0 }, [0; SECTORS]);
        let mut report = Report::of(None);
        // No chain is so long.
        let doubtful_blocks = if doubtful_blocks == 0 { u32::MAX } else { doubtful_blocks.into() };
        let confidences = row.confidence.as_chunks::<SIZE>().0;
        // There is none at the border of the view.
        for (index, confidences) in (1..count.saturating_sub(1)).zip(confidences.iter().skip(1)) {
            let Some(&block) = self.blocks.get(index) else { break };
            let is_sure = confidences[Self::SAMPLE] >= min_confidence;
            // Mostly there is nothing.
            if block.is_none() && gap.bits == 0 {
                if is_sure {
                    gap.first = index + 1;
                }
                continue;
            }
            let is_chain = block.is_chain(least_weight);
            let is_believed = is_chain && block.is_of_surface(least_of_surface) && block.is_large();
            if is_chain {
                let sector = directions.sector_of(SIZE * index + Self::SAMPLE);
                if sector != report.sector {
                    self.note(lane, report);
                    report = Report::of(sector);
                }
                let bits = if is_believed { &mut report.believed } else { &mut report.led_to };
                *bits = (*bits).max(block.told(is_sure));
            }
            let bits = block.doubtful(doubtful_blocks);
            if !is_sure {
                gap.bits = gap.bits.max(bits);
            } else {
                if gap.bits > 0 {
                    self.doubt(&mut passed, gap, index, &mut doubtful);
                }
                gap = Gap { first: index + 1, bits: 0 };
                if bits > 0 && !is_believed {
                    self.doubt(&mut passed, Gap { first: index, bits }, index + 1, &mut doubtful);
                }
            }
        }
        self.note(lane, report);
        if gap.bits > 0 {
            self.doubt(&mut passed, gap, BLOCKS, &mut doubtful);
        }
        for ((&bits, &secant), weighing) in doubtful.iter().zip(&self.sectors.secant_q14).zip(&mut self.weighings) {
            if bits > 0 {
                weighing.add_doubtful(lane.range_mm(bits, secant));
            }
        }
    }

    /// Notes what may be in the sectors of the blocks of a gap, up to the block `end`.
    #[inline(never)]
    fn doubt(&self, passed: &mut Directions<SECTORS>, gap: Gap, end: usize, doubtful: &mut [u32; SECTORS]) {
        passed.rewind();
        for index in gap.first..end.min(self.camera.width().div_ceil(SIZE)) {
            let sector = passed.sector_of(SIZE * index + Self::SAMPLE);
            if let Some(bits) = sector.and_then(|sector| doubtful.get_mut(sector)) {
                *bits = (*bits).max(gap.bits);
            }
        }
    }

    #[inline(never)]
    fn note(&mut self, lane: &Lane, Report { sector, believed, led_to }: Report) {
        let Some(sector) = sector else { return };
        let (Some(&secant), Some(weighing)) = (self.sectors.secant_q14.get(sector), self.weighings.get_mut(sector))
        else {
            return;
        };
        if believed > 0 {
            weighing.add_sure(lane.range_mm(believed, secant));
        }
        if led_to > believed {
            weighing.lead_to(lane.range_mm(led_to, secant));
        }
    }
}

/// Blocks side by side none of which is sure, and what may be there.
#[derive(Debug, Clone, Copy)]
struct Gap {
    /// The first block.
    first: usize,
    /// The greatest disparity of a long enough chain in it, 1/16 px; 0: none.
    bits: u32,
}

/// What chains of blocks end at in a sector of a row: greatest disparities, 1/16 px, 0 for none.
#[derive(Debug, Clone, Copy)]
struct Report {
    sector: Option<usize>,
    /// Of one surface.
    believed: u32,
    /// Of more than one.
    led_to: u32,
}

impl Report {
    const fn of(sector: Option<usize>) -> Self {
        Self { sector, believed: 0, led_to: 0 }
    }
}
