//! Whether a point stands on a surface: enough of the points around it have its disparity.
//!
//! Contours go on from row to row and the points on a surface lie close together, while wrong matches
//! scatter: each is refuted by the points around it.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "columns are below 1280")]

use crate::answer::merit::Merit;
use crate::front_end::camera_view::Row;
use crate::lanes::rows::load;
use crate::lanes::{ONES, difference, sad, select_ge, splat};
use crate::{Config, Disparity};

/// Columns of a margin of a row.
const MARGIN: usize = 4;
/// Columns around a point whose points are asked, in its row of points and in those above and below.
const COLUMNS: usize = 12;

/// What a point needs to be linked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Links {
    /// Least number of pixels of its disparity, its own ones included.
    pub(crate) least: u32,
    /// Of ten answered pixels around, so many must have its disparity.
    pub(crate) share: u32,
}

/// A point: one or two pixels of a row of points.
#[derive(Debug, Clone, Copy, Default)]
struct Point {
    first: u16,
    pixels: u8,
    confidence: u8,
    /// 1/16 px.
    bits: i16,
}

/// What was measured in a row of points: two rows of the image.
#[derive(Debug, Clone)]
struct Points<const WORDS: usize> {
    points: [[Point; 2]; WORDS],
    len: usize,
}

/// The newest rows of points: those that a row's links may lead to.
#[derive(Debug, Clone)]
pub struct PointRows<const WORDS: usize> {
    /// One more than the label of each pixel, at most 255; 0 where there is no point.
    labels: [Row<WORDS>; 3],
    points: [Points<WORDS>; 2],
    pushed: u32,
}

impl<const WORDS: usize> PointRows<WORDS> {
    pub(crate) const fn new() -> Self {
        Self {
            labels: [[0; WORDS]; 3],
            points: [const { Points { points: [[Point { first: 0, pixels: 0, confidence: 0, bits: 0 }; 2]; WORDS], len: 0 } };
                2],
            pushed: 0,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.labels = [[0; WORDS]; 3];
        self.pushed = 0;
    }

    /// Begins the next row of points, by giving up the oldest.
    pub(crate) fn begin(&mut self) {
        self.pushed += 1;
        self.labels[self.pushed as usize % 3] = [0; WORDS];
        self.points[self.pushed as usize % 2].len = 0;
    }

    /// Answers `pixels` pixels, one or two, from column `first` on, unless all of them have an answer: `bits` is the
    /// disparity, 1/16 px. A disparity out of the search range and one whose match lies outside the right view are none.
    pub(crate) fn add(&mut self, config: &Config, first: i32, pixels: u8, bits: i32, merit: impl FnOnce() -> Merit) {
        let whole = (bits + 8) >> 4;
        let width = i32::from(config.width);
        let (first, end) = (first.max(0).max(whole), (first + i32::from(pixels)).min(width).min(width + whole));
        if !config.contains(whole) || first >= end {
            return;
        }
        let label = ((whole - i32::from(config.min_disparity)) as u32 + 1).min(255);
        let labels = &mut self.labels[self.pushed as usize % 3];
        let mut is_new = false;
        for column in first as usize..end as usize {
            let (word, shift) = ((column + MARGIN) / 4, 8 * ((column + MARGIN) % 4));
            if labels[word] >> shift & 0xff == 0 {
                labels[word] |= label << shift;
                is_new = true;
            }
        }
        let row = &mut self.points[self.pushed as usize % 2];
        // One point for two columns, whatever the capacity.
        if !is_new || row.len >= usize::from(config.width).div_ceil(2) {
            return;
        }
        if let Some(point) = row.points.as_flattened_mut().get_mut(row.len) {
            let (merit, bits) = (merit(), bits as i16);
            *point = Point {
                first: first as u16,
                pixels: (end - first) as u8,
                confidence: merit.confidence(merit, 0),
                bits,
            };
            row.len += 1;
        }
    }

    /// Writes the row of points before the newest: all of its points, or only those with the `links` they need.
    pub(crate) fn write(
        &self,
        config: &Config,
        links: Option<Links>,
        disparity: &mut [[Disparity; 4]; WORDS],
        confidence: &mut [[u8; 4]; WORDS],
    ) {
        let words = usize::from(config.width).div_ceil(4);
        disparity[..words].fill([Disparity::UNKNOWN; 4]);
        confidence[..words].fill([0; 4]);
        let (disparity, confidence) = (disparity.as_flattened_mut(), confidence.as_flattened_mut());
        let row = &self.points[(self.pushed as usize + 1) % 2];
        // The first answer of a pixel stands.
        for point in row.points.as_flattened()[..row.len].iter().rev() {
            if links.is_some_and(|links| !self.is_linked(config, *point, links)) {
                continue;
            }
            for column in usize::from(point.first)..usize::from(point.first) + usize::from(point.pixels) {
                disparity[column] = Disparity::from_bits(point.bits);
                confidence[column] = point.confidence;
            }
        }
    }

    /// Whether the points around one of the row before the newest have its disparity, to a pixel.
    #[inline(always)]
    fn is_linked(&self, config: &Config, point: Point, links: Links) -> bool {
        let whole = (i32::from(point.bits) + 8) >> 4;
        let label = splat(((whole - i32::from(config.min_disparity)) as u32 + 1).min(255));
        let last = usize::from(config.width) + 2 * MARGIN - COLUMNS;
        let first = (usize::from(point.first) + MARGIN).saturating_sub(COLUMNS / 2 - 1).min(last);
        let (mut same, mut all) = (0, 0);
        for row in &self.labels {
            for byte in [first, first + 4, first + 8] {
                let word = load(row, byte);
                let known = select_ge(word, ONES, ONES, 0);
                all += known;
                same += select_ge(ONES, difference(word, label), known, 0);
            }
        }
        let (same, all) = (sad(same, 0), sad(all, 0));
        same >= links.least && 10 * same >= links.share * all
    }
}
