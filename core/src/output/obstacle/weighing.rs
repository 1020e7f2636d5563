//! What the rows of a sector tell: the nearest that is believed, and what may be nearer.
//!
//! A thing without texture, dark or saturated, has no sure answer but a few of its outline. What is sure in its sector is the
//! wall behind it, above it or beside it, and to tell that would be to tell that the way is free up to there. Its doubtful
//! answers are often wrong, but seldom as far as the wall: where enough of them adjoin, agree and are nearer, in enough rows
//! for what is sure to be outweighed, nothing is told. Nor is it where sure ones lead from the wall to something nearer, of which
//! too few agree: then they are means of the wall and of the thing's outline. Such a mean may lie in the sector beside that of
//! the doubt, or be told by a few rows of many; and where a thing hides all of its answers, what is left is a gap among those of
//! the wall.

use core::ops::Range;

use super::finder::SIZE;
use crate::Rig;

/// How high a row of blocks is at a distance, in baselines: as much as 4 px of its disparity.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowHeight {
    /// At 1 mm, as a fraction.
    numerator: u64,
    denominator: u64,
}

impl RowHeight {
    /// As a rig sees them.
    pub(super) fn of(rig: &Rig) -> Self {
        // 4 px x 1 mm / focal length / baseline, which are in 1/256 px and µm.
        let denominator = u64::from(rig.focal_px_q8()) * u64::from(rig.baseline_um());
        Self { numerator: SIZE as u64 * 256 * 1000, denominator }
    }

    /// Whether so many rows are that many baselines high at a distance of `mm`.
    fn reaches(self, rows: u64, mm: u32, baselines: u64) -> bool {
        rows * u64::from(mm) * self.numerator >= baselines * self.denominator
    }
}

/// What is told in a sector, in how many rows, and in how many something doubtful is, by its distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weighing {
    /// The nearest that is believed, mm.
    nearest_mm: u32,
    /// The nearest that sure blocks lead to without being of one surface, mm.
    led_to_mm: u32,
    /// Rows in which something is believed; and those of them that tell of the nearest.
    sure: u16,
    nearest_rows: u8,
    /// Rows one after another up to now in which nothing is sure over a wide gap; and the most of them.
    unseen: u8,
    most_unseen: u8,
    doubtful: [u8; Self::STEPS],
}

impl Weighing {
    pub(super) const NONE: Self = Self {
        nearest_mm: Self::UNKNOWN_MM,
        led_to_mm: Self::UNKNOWN_MM,
        sure: 0,
        nearest_rows: 0,
        unseen: 0,
        most_unseen: 0,
        doubtful: [0; Self::STEPS],
    };
    /// Nothing was found.
    const UNKNOWN_MM: u32 = u32::MAX;
    /// Steps of distance, eight to each doubling from 2^8 mm on.
    const STEPS: usize = 56;
    const FIRST: u32 = 8;
    /// By this part of its distance something must be nearer to be told from what is sure: half a step.
    const NEARER: u32 = 16;
    /// Least rows of doubt. Three outweigh fewer than five sure ones.
    const LEAST_ROWS: u32 = 2;
    /// Least rows of a gap that may hide something, and how high it is then at the distance of what is told, in baselines.
    const LEAST_UNSEEN: u8 = 3;
    const UNSEEN_BASELINES: u64 = 8;
    /// What fewer rows tell, when others tell something farther, may be a mean of an outline and what is behind it. Rows tell of
    /// the same up to this part of its distance.
    const FEW_ROWS: u8 = 3;
    const SAME: u32 = 6;

    /// Another row in which something is believed, at a distance of `mm`.
    pub(super) fn add_sure(&mut self, mm: u32) {
        self.sure = self.sure.saturating_add(1);
        let margin = self.nearest_mm / Self::SAME;
        if mm < self.nearest_mm - margin {
            self.nearest_rows = 0;
        }
        let is_same = mm <= self.nearest_mm.saturating_add(margin);
        self.nearest_rows = self.nearest_rows.saturating_add(u8::from(is_same));
        self.nearest_mm = self.nearest_mm.min(mm);
    }

    /// Sure blocks lead to a distance of `mm`.
    pub(super) fn lead_to(&mut self, mm: u32) {
        self.led_to_mm = self.led_to_mm.min(mm);
    }

    /// Another row in which something may be at a distance of `mm`.
    pub(super) fn add_doubtful(&mut self, mm: u32) {
        if let Some(rows) = self.doubtful.get_mut(Self::step(mm)) {
            *rows = rows.saturating_add(1);
        }
    }

    /// Another row, and whether nothing is sure over a wide gap in it.
    pub(super) fn add_row(&mut self, is_unseen: bool) {
        self.unseen = if is_unseen { self.unseen.saturating_add(1) } else { 0 };
        self.most_unseen = self.most_unseen.max(self.unseen);
    }

    /// Distance of the nearest that is believed, mm, if nothing may be nearer. `beside` are the sectors left and right of it.
    pub(super) fn told_mm(&self, beside: [Option<&Self>; 2], height: RowHeight) -> Option<u32> {
        let mm = self.nearest_mm;
        (mm != Self::UNKNOWN_MM && !self.may_hold_nearer(mm, beside, height)).then_some(mm)
    }

    /// Whether nothing was found up to `mm`, nor may be there.
    pub(super) fn is_free(&self, mm: u32, beside: [Option<&Self>; 2], height: RowHeight) -> bool {
        self.nearest_mm >= mm && !self.may_hold_nearer(mm, beside, height)
    }

    /// Whether something may be nearer than `mm`, which is no farther than the nearest that is believed.
    fn may_hold_nearer(&self, mm: u32, beside: [Option<&Self>; 2], height: RowHeight) -> bool {
        self.is_in_doubt(mm) || self.may_hide(mm, height) || self.may_be_outline(mm, beside, height)
    }

    /// Whether it is in doubt that nothing is nearer than `mm`.
    fn is_in_doubt(&self, mm: u32) -> bool {
        self.may_hold(0..mm - mm / Self::NEARER)
    }

    /// Whether what is at `mm` may be a mean of the outline of something and of what is behind that: of something in the sector
    /// beside it, an eighth to a half nearer; or few rows tell of it, and a sector beside it is unknown, or it is so far away
    /// that outline and wall are hardly two surfaces.
    fn may_be_outline(&self, mm: u32, beside: [Option<&Self>; 2], height: RowHeight) -> bool {
        // Surfaces whose disparities differ by less than a block are not told apart: from 4 px down; hardly from 3.5 px.
        if !height.reaches(1, mm, 1) {
            return false;
        }
        let is_of_few = self.nearest_rows < Self::FEW_ROWS && u16::from(self.nearest_rows) < self.sure;
        is_of_few && height.reaches(7, mm, 8)
            || beside
                .into_iter()
                .flatten()
                .any(|beside| beside.may_hold(mm / 2..mm - mm / 8) || is_of_few && beside.is_unknown(height))
    }

    /// Whether something nearer than what is believed, if anything is, may be there.
    fn is_unknown(&self, height: RowHeight) -> bool {
        self.is_in_doubt(self.nearest_mm) || self.may_hide(self.nearest_mm, height)
    }

    /// Whether something may be at one of the distances, mm.
    fn may_hold(&self, distances: Range<u32>) -> bool {
        if distances.contains(&self.led_to_mm) {
            return true;
        }
        let doubtful = self.doubtful.iter().take(Self::step(distances.end)).skip(Self::step(distances.start));
        let rows = doubtful.map(|&rows| u32::from(rows)).sum::<u32>();
        rows >= Self::LEAST_ROWS && 5 * rows > 3 * u32::from(self.sure)
    }

    /// Whether a gap in what is sure may hide something nearer than `mm`: it is of as many rows as tell of something, and higher
    /// than things are whose outline alone is seen.
    fn may_hide(&self, mm: u32, height: RowHeight) -> bool {
        self.most_unseen >= Self::LEAST_UNSEEN
            && u16::from(self.most_unseen) >= self.sure
            && height.reaches(self.most_unseen.into(), mm, Self::UNSEEN_BASELINES)
    }

    fn step(mm: u32) -> usize {
        let mm = mm.max(1 << Self::FIRST);
        let octave = mm.ilog2();
        let eighth = mm >> (octave - 3) & 7;
        ((octave - Self::FIRST) * 8 + eighth) as usize
    }
}
