//! Obstacles: the nearest thing in each direction that stands in the way.
//!
//! Works on disparity rows as they come out of a method, and keeps nothing but one row of blocks. Of each
//! 4x4 block one pixel is looked at. It counts if it is certain enough and lies within a band of heights
//! over the ground, so that the ground itself does not count; and it is believed if blocks that adjoin it
//! agree, so that single wrong ones are not. Where nothing is believed the answer is unknown; so it is where many doubtful
//! ones adjoin and agree that something is nearer ([`Settings::doubtful_blocks`]). That a sector is free
//! is told only if it is asked for, and only of one that is measured nearly all over ([`Obstacles::free`]).
//!
//! ```
//! use haarline::obstacle::{Mounting, Obstacles, Sectors, Settings};
//! use haarline::{Disparity, DisparityRow, Rig, blocks_for};
//! let sectors = Sectors { // three of 20 degrees
//!     count: 3,
//!     left_q16: [-37837, -11556, 11556], // tangents of -30, -10 and 10 degrees
//!     right_q16: 37837,
//!     secant_q14: [17436, 16384, 17436],
//! };
//! let level = Mounting { height_mm: 300, sin_pitch_q14: 0, cos_pitch_q14: 1 << 14, lowest_mm: 50, highest_mm: 600 };
//! let rig = Rig::new(200 << 8, 60_000).unwrap(); // 200 px, 60 mm
//! let mut obstacles = Obstacles::<3, { blocks_for(320) }>::new([320, 240], rig, level, sectors, Settings::DEFAULT)?;
//! for y in 0..240 {
//!     obstacles.push(&DisparityRow { y, disparity: &[Disparity::from_px(8); 320], confidence: &[255; 320] });
//! }
//! // A wall at 1.5 m, at the sides a little more.
//! assert!(obstacles.nearest_mm().eq([Some(1596), Some(1500), Some(1596)]));
//! # Ok::<(), haarline::obstacle::ObstacleError>(())
//! ```

use core::fmt;

use crate::method::capacity::blocks_for;
use crate::{DisparityRow, Rig};

mod block;
mod doubt;
mod free;
mod lane;

use block::Block;
use doubt::{Gap, Weighing};
use free::Clearance;
use lane::{Camera, Directions, Lane};

/// Most sectors that anybody asks for: those of MAVLink's `OBSTACLE_DISTANCE`.
pub const MAX_SECTORS: usize = 72;
/// Columns and rows of a block of pixels of which one is looked at.
const SIZE: usize = 4;

/// How the left camera stands over the ground, and what is in the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mounting {
    /// Height of the camera over the ground, mm, within ±[`Mounting::MAX_MM`].
    pub height_mm: i32,
    /// Sine of its pitch, 1/16384; upwards is positive.
    pub sin_pitch_q14: i16,
    /// Cosine of its pitch, 1/16384, greater than 0.
    pub cos_pitch_q14: i16,
    /// Least height over the ground that is in the way, mm, within ±[`Mounting::MAX_MM`].
    pub lowest_mm: i32,
    /// Greatest height over the ground that is in the way, mm, greater than `lowest_mm`, within
    /// ±[`Mounting::MAX_MM`].
    pub highest_mm: i32,
}

impl Mounting {
    /// Greatest magnitude of any height, mm.
    pub const MAX_MM: i32 = 20_000;
    /// One, as a sine or cosine.
    const ONE: i16 = 1 << 14;

    fn is_valid(&self) -> bool {
        let Self { height_mm, sin_pitch_q14, cos_pitch_q14, lowest_mm, highest_mm } = *self;
        let fits = |mm: i32| mm.unsigned_abs() <= Self::MAX_MM.unsigned_abs();
        let is_angle =
            sin_pitch_q14.unsigned_abs() <= Self::ONE.unsigned_abs() && (1..=Self::ONE).contains(&cos_pitch_q14);
        is_angle && [height_mm, lowest_mm, highest_mm].into_iter().all(fits) && lowest_mm < highest_mm
    }
}

/// Bearing sectors from left to right, each beginning where the one before it ends. A bearing is the angle
/// in the ground plane, clockwise from straight ahead. `N` is the capacity; what lies beyond `count` does not
/// count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sectors<const N: usize> {
    /// How many there are, 1 to `N`.
    pub count: usize,
    /// Tangent of each one's left border, 1/65536, rising, within ±16.
    pub left_q16: [i32; N],
    /// Tangent of the last one's right border, 1/65536, within ±16.
    pub right_q16: i32,
    /// 1 / cosine of each one's middle, 1/16384, 1 to 16: what makes a range of a distance ahead.
    pub secant_q14: [u32; N],
}

impl<const N: usize> Sectors<N> {
    const MAX_TANGENT: i32 = 16 << 16;
    const SECANTS: core::ops::RangeInclusive<u32> = 1 << 14..=16 << 14;

    /// Tangents of the right borders.
    fn right_borders(&self) -> impl Iterator<Item = i32> {
        let used = self.left_q16.get(1..self.count).unwrap_or(&[]);
        used.iter().copied().chain([self.right_q16])
    }

    fn is_valid(&self) -> bool {
        if !(1..=N).contains(&self.count) {
            return false;
        }
        let fits = |tangent: i32| tangent.unsigned_abs() <= Self::MAX_TANGENT.unsigned_abs();
        let borders = self.left_q16.iter().zip(self.right_borders());
        let secants = self.secant_q14.iter().take(self.count);
        borders.into_iter().all(|(&left, right)| fits(left) && fits(right) && left < right)
            && secants.into_iter().all(|secant| Self::SECANTS.contains(secant))
    }
}

/// What it takes to be believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Blocks in a chain that adjoin and agree, from two block rows at least; half of them, rounded up, must be of one
    /// surface: no more than 3/4 of the tolerance nearer than the farthest of these. Those whose surface is sure, but not where it
    /// ends ([`Settings::FRINGE`]), count by a half. What is near is large: from 30 px on it must be a block for each 6 px,
    /// which side by side would be 2/3 as long as the baseline, and from 32 px on two of them side by side. Where it is not, the
    /// sector is unknown.
    pub agreeing_blocks: u8,
    /// Difference of disparity up to which two blocks agree, 1/16 px.
    pub tolerance: u8,
    /// By how much a disparity may be wrong without ground being taken for something that stands on it,
    /// 1/16 px.
    pub doubt: u8,
    /// Least confidence of a block.
    pub min_confidence: u8,
    /// So many blocks in a chain of measured answers, sure or not, may be something. Where that is nearer by a sixteenth than
    /// what is sure, in two rows of blocks and in more than three for each five in which something is sure, the sector is
    /// unknown, and so are those of the blocks beside it that are not sure: so that a dark or blank thing is not told as far
    /// as the wall behind it. 0: never.
    pub doubtful_blocks: u8,
    /// From this distance over the ground on, mm, a sector in which nothing is in the way may be told to be free
    /// ([`Obstacles::free`]); 0: never.
    pub free_beyond_mm: u32,
}

impl Settings {
    /// From this confidence on an answer is sure. Only sure ones make an obstacle.
    pub const SURE: u8 = 64;

    /// From this confidence on an answer is sure but for where its surface ends: it lies beside a contour, where hardly
    /// anything else is to be seen. The outline of a thing without texture is made of these.
    pub const FRINGE: u8 = 56;

    /// From this confidence on an answer is measured; less is a guess.
    const MEASURED: u8 = 16;

    /// Five sure blocks within 1 px, half a pixel of doubt; four doubtful ones.
    pub const DEFAULT: Self = Self {
        agreeing_blocks: 5,
        tolerance: 16,
        doubt: 8,
        min_confidence: Self::SURE,
        doubtful_blocks: 4,
        free_beyond_mm: 0,
    };
}

impl Settings {
    /// Weight of a sure block in a chain; that of a fringe is half of it.
    const SURE_WEIGHT: u8 = 2;

    /// From which confidence on a block weighs something in a chain. If another confidence than what is sure is asked for,
    /// there is no fringe.
    fn fringe(&self) -> u8 {
        if self.min_confidence == Self::SURE { Self::FRINGE } else { self.min_confidence }
    }
}

/// Why obstacles cannot be looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ObstacleError {
    /// The size must be 32 px or more, and at most 4096 rows.
    Size,
    /// The width is over this instance's capacity.
    Capacity {
        /// Greatest width this instance can hold, px.
        max_width: u16,
    },
    /// The focal length must be at most 16384 px, and the baseline at most 16 m.
    Rig,
    /// A height is over 20 m, the band of heights is empty, or the pitch is no angle within ±90 degrees.
    Mounting,
    /// No sector, more than there is room for, borders that do not rise, or an angle of more than 86 degrees.
    Sectors,
}

impl fmt::Display for ObstacleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size => f.write_str("the views must be 32 px wide or more, and at most 4096 rows high"),
            Self::Capacity { max_width } => write!(f, "the width is over this instance's capacity of {max_width} px"),
            Self::Rig => f.write_str("the focal length must be at most 16384 px, and the baseline at most 16 m"),
            Self::Mounting => {
                f.write_str("heights must be within 20 m, the lowest under the highest, the pitch under 90 degrees")
            }
            Self::Sectors => {
                f.write_str("the sectors must be 1 to the capacity, with borders that rise, within 86 degrees")
            }
        }
    }
}

impl core::error::Error for ObstacleError {}

/// Nothing was found.
const UNKNOWN_MM: u32 = u32::MAX;

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
    nearest_mm: [u32; SECTORS],
    /// What may be nearer.
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
            nearest_mm: [UNKNOWN_MM; SECTORS],
            weighings: [Weighing::NONE; SECTORS],
            clearance: [Clearance::NONE; SECTORS],
        })
    }

    /// Begins a frame. The first row of one does the same.
    pub fn start(&mut self) {
        self.blocks = [Block::NONE; BLOCKS];
        (self.nearest_mm, self.weighings) = ([UNKNOWN_MM; SECTORS], [Weighing::NONE; SECTORS]);
        self.clearance = [Clearance::NONE; SECTORS];
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
        (0..self.sectors.count).map(|sector| self.told_mm(sector))
    }

    /// What is told of a sector.
    fn told_mm(&self, sector: usize) -> Option<u32> {
        let (&mm, weighing) = (self.nearest_mm.get(sector)?, self.weighings.get(sector)?);
        if mm == UNKNOWN_MM || weighing.is_in_doubt(mm) {
            return None;
        }
        let rig = self.camera.rig();
        // 4 px x 1 mm / focal length / baseline, which is in 1/256 px and µm.
        let row_mm = [SIZE as u64 * 256 * 1000, u64::from(rig.focal_px_q8()) * u64::from(rig.baseline_um())];
        let [numerator, denominator] = row_mm;
        let used = self.weighings.get(..self.sectors.count)?;
        let beside = [sector.checked_sub(1), sector.checked_add(1)].into_iter().flatten();
        // Surfaces whose disparities differ by less than a block are not told apart.
        let may_be_outline = u64::from(mm) * numerator >= denominator
            && beside.filter_map(|beside| used.get(beside)).any(|beside| beside.may_reach_beside(mm));
        (!may_be_outline && !weighing.may_hide(mm, row_mm)).then_some(mm)
    }

    /// Whether each sector is measured and free up to [`Settings::free_beyond_mm`]: nothing was found in it, nor may be there,
    /// of the samples whose ray runs within the band of heights at that distance 80 percent are sure and lie beyond,
    /// and of those whose ray crosses the band before, 80 percent are sure, too (and see the ground, or what is
    /// above the band). Whole once the last row of the frame is in; never true where that distance is 0.
    pub fn free(&self) -> impl Iterator<Item = bool> {
        let limit = self.settings.free_beyond_mm;
        let used = self.nearest_mm.iter().zip(&self.weighings).zip(&self.clearance).take(self.sectors.count);
        used.map(move |((&mm, weighing), clearance)| mm >= limit && !weighing.is_in_doubt(limit) && clearance.is_free())
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
        let least = fringe.min(Settings::MEASURED);
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
        let secant = self.sectors.secant_q14.get(sector);
        let (Some(&secant), Some(nearest), Some(weighing)) =
            (secant, self.nearest_mm.get_mut(sector), self.weighings.get_mut(sector))
        else {
            return;
        };
        if believed > 0 {
            *nearest = (*nearest).min(lane.range_mm(believed, secant));
            weighing.add_sure();
        }
        if led_to > believed {
            weighing.lead_to(lane.range_mm(led_to, secant));
        }
    }
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

#[cfg(test)]
mod tests;
