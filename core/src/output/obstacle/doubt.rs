//! What may be nearer than what is sure: chains of measured answers, doubtful ones among them.
//!
//! A thing without texture, dark or saturated, has no sure answer but a few of its outline. What is sure in its sector is the
//! wall behind it, above it or beside it, and to tell that would be to tell that the way is free up to there. Its doubtful
//! answers are often wrong, but seldom as far as the wall: where enough of them adjoin, agree and are nearer, in enough rows
//! for what is sure to be outweighed, nothing is told. Nor is it where sure ones lead from the wall to something nearer, of which
//! too few agree: then they are means of the wall and of the thing's outline. Such a mean may lie in the sector beside that of
//! the doubt; and where a thing hides all of its answers, what is left is a gap among those of the wall.

use core::ops::Range;

/// Blocks side by side none of which is sure, and what may be there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap {
    /// The first block.
    pub(super) first: usize,
    /// The greatest disparity of a long enough chain in it, 1/16 px; 0: none.
    pub(super) bits: u32,
}

/// In how many rows what is sure was seen in a sector, and in how many something doubtful, by its distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weighing {
    /// The nearest that sure blocks lead to without being of one surface, mm.
    led_to_mm: Option<u32>,
    sure: u16,
    /// Rows one after another up to now in which nothing is sure over a wide gap; and the most of them.
    unseen: u8,
    most_unseen: u8,
    doubtful: [u8; Self::STEPS],
}

impl Weighing {
    pub(super) const NONE: Self =
        Self { led_to_mm: None, sure: 0, unseen: 0, most_unseen: 0, doubtful: [0; Self::STEPS] };
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

    /// Another row in which something is sure.
    pub(super) fn add_sure(&mut self) {
        self.sure = self.sure.saturating_add(1);
    }

    /// Sure blocks lead to a distance of `mm`.
    pub(super) fn lead_to(&mut self, mm: u32) {
        self.led_to_mm = Some(self.led_to_mm.map_or(mm, |least| least.min(mm)));
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

    /// Whether it is in doubt that nothing is nearer than `mm`.
    pub(super) fn is_in_doubt(&self, mm: u32) -> bool {
        self.may_hold(0..mm - mm / Self::NEARER)
    }

    /// Whether what is at `mm` may be the outline of something in the sector beside it, and what is behind that: it is an eighth
    /// to a half nearer.
    pub(super) fn may_reach_beside(&self, mm: u32) -> bool {
        self.may_hold(mm / 2..mm - mm / 8)
    }

    /// Whether something may be at one of the distances, mm.
    fn may_hold(&self, distances: Range<u32>) -> bool {
        if self.led_to_mm.is_some_and(|mm| distances.contains(&mm)) {
            return true;
        }
        let doubtful = self.doubtful.iter().take(Self::step(distances.end)).skip(Self::step(distances.start));
        let rows = doubtful.map(|&rows| u32::from(rows)).sum::<u32>();
        rows >= Self::LEAST_ROWS && 5 * rows > 3 * u32::from(self.sure)
    }

    /// Whether a gap in what is sure may hide something nearer than `mm`: it is of as many rows as tell of something, and higher
    /// than things are whose outline alone is seen.
    ///
    /// - `row_mm`: how high a row of blocks is at 1 mm, in baselines, as a fraction.
    pub(super) fn may_hide(&self, mm: u32, row_mm: [u64; 2]) -> bool {
        let [numerator, denominator] = row_mm;
        let rows = u64::from(self.most_unseen);
        self.most_unseen >= Self::LEAST_UNSEEN
            && u16::from(self.most_unseen) >= self.sure
            && rows * u64::from(mm) * numerator >= Self::UNSEEN_BASELINES * denominator
    }

    fn step(mm: u32) -> usize {
        let mm = mm.max(1 << Self::FIRST);
        let octave = mm.ilog2();
        let eighth = mm >> (octave - 3) & 7;
        ((octave - Self::FIRST) * 8 + eighth) as usize
    }
}
