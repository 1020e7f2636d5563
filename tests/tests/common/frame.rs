//! Frames of both views.

use haarline::ScanlinePair;

use super::content::Content;

/// A frame of both views.
#[derive(Clone)]
pub struct Frame {
    pub width: usize,
    pub height: usize,
    pub left: Vec<u8>,
    pub right: Vec<u8>,
}

impl Frame {
    /// A frame of the pixels that `left` and `right` give for a column and a row.
    pub fn from_fn(width: usize, height: usize, left: impl Fn(i32, i32) -> u8, right: impl Fn(i32, i32) -> u8) -> Self {
        let render = |pixel: &dyn Fn(i32, i32) -> u8| {
            let columns = i32::try_from(width).unwrap();
            let rows = i32::try_from(height).unwrap();
            (0..rows).flat_map(|y| (0..columns).map(move |x| pixel(x, y))).collect()
        };
        Self { width, height, left: render(&left), right: render(&right) }
    }

    /// The same content in both views, everywhere at that disparity, px.
    pub fn shifted(width: usize, height: usize, content: Content, disparity: i32) -> Self {
        Self::from_fn(width, height, |x, y| content.at(x, y), |x, y| content.at(x + disparity, y))
    }

    /// The rows, from the top.
    pub fn rows(&self) -> impl Iterator<Item = ScanlinePair<'_>> {
        let rows = self.left.chunks(self.width).zip(self.right.chunks(self.width));
        rows.map(|(left, right)| ScanlinePair { left, right })
    }

    /// The frame with each view's pixels changed.
    pub fn map(&self, left: impl Fn(u8) -> u8, right: impl Fn(u8) -> u8) -> Self {
        Self {
            left: self.left.iter().map(|&v| left(v)).collect(),
            right: self.right.iter().map(|&v| right(v)).collect(),
            ..*self
        }
    }

    /// The frame upside down.
    pub fn flipped(&self) -> Self {
        let flip = |view: &[u8]| view.chunks(self.width).rev().flatten().copied().collect();
        Self { left: flip(&self.left), right: flip(&self.right), ..*self }
    }

    /// The frame in a mirror, where the right camera becomes the left one.
    pub fn mirrored(&self) -> Self {
        let mirror = |view: &[u8]| view.chunks(self.width).flat_map(|row| row.iter().rev()).copied().collect();
        Self { left: mirror(&self.right), right: mirror(&self.left), ..*self }
    }
}
