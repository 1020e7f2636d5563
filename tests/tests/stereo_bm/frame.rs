//! Small frames of both views, and what a method makes of them.

use haarline::{Disparity, ScanlinePair, StereoMethod};

/// A frame of both views.
#[derive(Debug, Clone)]
pub struct Frame {
    pub width: usize,
    pub left: Vec<u8>,
    pub right: Vec<u8>,
}

impl Frame {
    /// A frame from its pixels, left and right, by column and row.
    pub fn from_fn(width: usize, height: usize, pixel: impl Fn(usize, usize) -> (u8, u8)) -> Self {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let (left, right) = pixels.map(|(x, y)| pixel(x, y)).unzip();
        Self { width, left, right }
    }

    /// Texture without repetition and of full contrast, everywhere at that disparity.
    pub fn textured(width: usize, height: usize, disparity: i32) -> Self {
        Self::from_fn(width, height, |x, y| {
            let x = i32::try_from(x).unwrap();
            (texture(x, y), texture(x + disparity, y))
        })
    }

    pub fn height(&self) -> usize {
        self.left.len() / self.width
    }

    pub fn rows(&self) -> impl Iterator<Item = ScanlinePair<'_>> {
        let rows = self.left.chunks(self.width).zip(self.right.chunks(self.width));
        rows.map(|(left, right)| ScanlinePair { left, right })
    }
}

/// A hash of the place, by an integer mixer.
fn texture(x: i32, y: usize) -> u8 {
    let place = u32::try_from(x + 1000).unwrap() * 2_477 + u32::try_from(y).unwrap() * 40_503;
    let mixed = (place ^ (place >> 7)).wrapping_mul(0x85EB_CA6B);
    (mixed ^ (mixed >> 13)).wrapping_mul(0xC2B2_AE35).to_be_bytes()[0]
}

/// The rows that were delivered, one after the other.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Map {
    pub disparity: Vec<Disparity>,
    pub confidence: Vec<u8>,
    pub rows: u32,
}

impl Map {
    /// Collects rows, and checks that they come in order and each once.
    pub fn sink(&mut self) -> impl FnMut(haarline::DisparityRow<'_>) {
        |row| {
            assert_eq!(row.y, self.rows);
            assert_eq!(row.disparity.len(), row.confidence.len());
            self.rows += 1;
            self.disparity.extend(row.disparity);
            self.confidence.extend(row.confidence);
        }
    }

    /// The disparities of the pixels that have one, 1/16 px.
    pub fn known(&self) -> Vec<i16> {
        self.disparity.iter().filter_map(|d| d.known()).collect()
    }

    /// Whether there is none in row `y`.
    pub fn is_row_unknown(&self, y: usize, width: usize) -> bool {
        self.disparity[y * width..][..width].iter().all(|d| !d.is_known())
    }
}

/// Runs a whole frame through a method.
pub fn run(method: &mut impl StereoMethod, frame: &Frame) -> Map {
    run_with_losses(method, frame, &[])
}

/// Runs a whole frame through a method, but for the rows in `lost`.
pub fn run_with_losses(method: &mut impl StereoMethod, frame: &Frame, lost: &[usize]) -> Map {
    let mut map = Map::default();
    for (y, pair) in frame.rows().enumerate() {
        if lost.contains(&y) {
            method.miss(&mut map.sink());
        } else {
            method.push(pair, &mut map.sink()).unwrap();
        }
    }
    method.finish(&mut map.sink());
    assert_eq!(map.rows as usize, frame.height());
    map
}
