//! A frame that is coming in.

use std::collections::BTreeMap;

use haarline::frame_figures::FrameFigures;
use haarline::{Counters, Disparity, DisparityRow};

use super::ReceivedFrame;
use crate::DisparityMap;

/// What came of a frame so far.
#[derive(Debug, Clone)]
pub(super) struct OpenFrame {
    pub(super) number: u32,
    pub(super) counters: Counters,
    pub(super) figures: Option<FrameFigures>,
    /// Columns and rows that its beginning told.
    begun: Option<[u16; 2]>,
    rows: BTreeMap<u32, (Vec<Disparity>, Vec<u8>)>,
}

impl OpenFrame {
    pub(super) fn new(number: u32) -> Self {
        Self { number, counters: Counters::ZERO, figures: None, begun: None, rows: BTreeMap::new() }
    }

    /// Its beginning. Takes out the rows that came before and do not fit; how many these are.
    pub(super) fn begin(&mut self, width: u16, height: u16) -> u64 {
        self.begun = Some([width, height]);
        let before = self.rows.len();
        self.rows.retain(|&y, (disparity, _)| y < height.into() && disparity.len() == usize::from(width));
        (before - self.rows.len()) as u64
    }

    /// Adds a row; false if it does not fit.
    pub(super) fn add(&mut self, y: u32, disparity: Vec<Disparity>, confidence: Vec<u8>) -> bool {
        let is_within = self.begun.is_none_or(|[_, height]| y < height.into());
        let fits = is_within && self.width().is_none_or(|width| disparity.len() == width);
        if fits {
            self.rows.insert(y, (disparity, confidence));
        }
        fits
    }

    fn width(&self) -> Option<usize> {
        let of_rows = || self.rows.values().next().map(|(disparity, _)| disparity.len());
        self.begun.map(|[width, _]| usize::from(width)).or_else(of_rows)
    }

    /// The frame as far as it came, `None` if no row did; `told` are the rows that its end told.
    pub(super) fn close(self, told: Option<u32>) -> Option<ReceivedFrame> {
        let width = self.width().filter(|&width| width > 0)?;
        let seen = self.rows.last_key_value().map(|(y, _)| y + 1)?;
        let height = told.or(self.begun.map(|[_, height]| height.into())).unwrap_or(0).max(seen);
        let (unknown, none) = (vec![Disparity::UNKNOWN; width], vec![0; width]);
        let mut map = DisparityMap::with_capacity(width, height as usize);
        let mut missing_rows = Vec::new();
        for y in 0..height {
            if let Some((disparity, confidence)) = self.rows.get(&y) {
                map.push_row(&DisparityRow { y, disparity, confidence });
            } else {
                missing_rows.push(y);
                map.push_row(&DisparityRow { y, disparity: &unknown, confidence: &none });
            }
        }
        let is_whole = self.begun.is_some() && told == Some(height) && missing_rows.is_empty();
        let Self { number, counters, figures, .. } = self;
        Some(ReceivedFrame { number, map, counters, figures, missing_rows, is_whole })
    }
}
