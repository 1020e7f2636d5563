//! Whether a rig has bent, as it works: how far the right view lies lower than the left one, behind whatever rectification
//! there is. A running figure, cheap enough for a chip.
//!
//! Of every second frame one band of rows is kept, each time another one. Of its blocks of 8 x 4 px whose answers are sure and
//! alike, what the right view shows at the answer is compared with what the left one shows, by the step of Lucas and
//! Kanade ("An iterative image registration technique", 1981): the shift, along rows and across, that explains the difference
//! of the two by their gradients. The shift along rows is what the disparity leaves; the one across is the row error. Blocks
//! are averaged by how well their texture determines it, those of older frames less and less.
//!
//! Of nine recorded scenes a prototype with this arithmetic was mostly within 0.15 px, at worst 0.33, from -1 to 1 px of error up
//! to noise 5. Farther off little is sure, and the frame as a whole does not match
//! ([`Input::Mismatch`](super::frame_figures::Input)). One block is compared with each row that comes.
#![allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "a few rows and pixels")]

use crate::answer::confidence::SURE;
use crate::lanes::lens_runs::copy;
use crate::{DisparityRow, ScanlinePair};

/// Columns and rows of a block.
const SIDES: [usize; 2] = [8, 4];
/// Rows above and below a band that smoothing and gradients need.
const BESIDE: usize = 2;
/// Rows that are kept.
const ROWS: usize = SIDES[1] + 2 * BESIDE;
/// Blocks of the widest view.
const BLOCKS: usize = crate::Config::MAX_WIDTH as usize / SIDES[0];
/// Most that answers of a block may differ, 1/16 px.
const ALIKE: i32 = 16;
/// Stands for a block whose answers are not.
const NONE: i16 = i16::MIN;
/// From one band to the next, rows.
const STRIDE: u32 = 28;
/// Rows above the first band, and from the first row of the last one to the view's end.
const MARGIN: u32 = 4;
const BELOW: u32 = SIDES[1] as u32 + 4;
/// Added where bands begin again at the top: with the stride it has no divisor but 1.
const SKIP: u32 = 9;

/// Sum of the squares of a block's gradients across rows that is needed, 16 times that of the view's grey levels.
const LEAST_GRADIENT: i64 = 400 * 32;
/// Variance of a block's offset beside that of its noise, 1/256 px^2.
const VARIANCE: i64 = 10;
/// A block that is certain weighs so much.
const WHOLE: i64 = 2560 / VARIANCE;
/// Farther off a block says nothing but the sign, 1/256 px.
const MOST_Q8: i64 = 512;
/// Gradients over two pixels of a smoothed view are too small: of eighths of what they make of an offset, seven are right.
const GAIN: [i64; 2] = [7, 8];
/// A band takes one of so many parts of what was known before.
const FORGET: i64 = 16;
/// Weight without which nothing is told: some hundred usual blocks.
const LEAST_WEIGHT: i64 = 8000;

/// A block of a view and a pixel on each side.
type Smooth = [[i16; SIDES[0] + 2]; SIDES[1] + 2];

/// Watches over a rig's rows.
#[derive(Debug, Clone)]
pub struct RowWatch<const WIDTH: usize> {
    width: usize,
    height: u32,
    /// The rows of the band, left and right.
    rows: [[[u8; WIDTH]; ROWS]; 2],
    /// First row of the band.
    top: u32,
    /// Rows of the frame that came or were lost.
    came: u32,
    state: State,
    /// Disparity of each block of the band, 1/16 px, or [`NONE`].
    blocks: [i16; BLOCKS],
    /// Sums of weights, and of weights times offsets, 1/256 px.
    weight: i64,
    offsets: i64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// The band's rows and answers are taken.
    Gathering,
    /// The next block to compare.
    Comparing(usize),
    /// Until the frame's end.
    Done,
    /// Until the next frame's end, too.
    Resting,
}

impl<const WIDTH: usize> RowWatch<WIDTH> {
    /// Of views of `size` px, no wider than `WIDTH`.
    #[must_use]
    pub fn new([width, height]: [u16; 2]) -> Self {
        let mut watch = Self {
            width: usize::from(width).min(WIDTH),
            height: u32::from(height),
            rows: [[[0; WIDTH]; ROWS]; 2],
            top: MARGIN,
            came: 0,
            state: State::Gathering,
            blocks: [NONE; BLOCKS],
            weight: 0,
            offsets: 0,
        };
        watch.start();
        watch
    }

    /// A frame begins, whatever came before.
    pub fn start(&mut self) {
        self.came = 0;
        if self.state == State::Done {
            self.state = State::Resting;
        } else if self.state == State::Resting {
            self.top += STRIDE;
            if self.top + BELOW > self.height {
                // Other rows than the last time.
                self.top = MARGIN + (self.top + SKIP) % STRIDE;
            }
            self.state = State::Gathering;
        }
        if self.top + BELOW > self.height {
            self.state = State::Done;
        }
    }

    /// Takes the next rows as a method gets them; `None` where they are lost.
    pub fn push(&mut self, pair: Option<ScanlinePair<'_>>) {
        match self.state {
            State::Gathering => self.keep(pair),
            State::Comparing(nth) => self.compare(nth),
            State::Done | State::Resting => {}
        }
        self.came += 1;
    }

    fn keep(&mut self, pair: Option<ScanlinePair<'_>>) {
        let first = self.top - BESIDE as u32;
        let Some(nth) = self.came.checked_sub(first).and_then(|nth| usize::try_from(nth).ok()) else { return };
        let [left, right] = &mut self.rows;
        let (Some(left), Some(right)) = (left.get_mut(nth), right.get_mut(nth)) else { return };
        let Some(pair) = pair else {
            self.state = State::Done;
            return;
        };
        copy(pair.left, left);
        copy(pair.right, right);
    }

    /// Takes a row that the method answers, before it is corrected.
    pub fn answer(&mut self, row: &DisparityRow<'_>) {
        if self.state != State::Gathering {
            return;
        }
        let Some(nth) = row.y.checked_sub(self.top).filter(|&nth| nth < SIDES[1] as u32) else { return };
        let disparities = row.disparity.chunks_exact(SIDES[0]);
        let answers = disparities.zip(row.confidence.chunks_exact(SIDES[0]));
        for (block, (disparities, confidences)) in self.blocks.iter_mut().zip(answers) {
            let first = disparities.first().and_then(|disparity| disparity.known());
            let of_block = if nth == 0 { first.unwrap_or(NONE) } else { *block };
            let is_alike =
                |found: Option<i16>| found.is_some_and(|found| (i32::from(found) - i32::from(of_block)).abs() <= ALIKE);
            let is_sure = confidences.iter().all(|&confidence| confidence >= SURE);
            let are_alike = is_sure && disparities.iter().all(|disparity| is_alike(disparity.known()));
            *block = if are_alike { of_block } else { NONE };
        }
        if nth + 1 == SIDES[1] as u32 {
            // Methods answer some rows after a row came; else the band is not whole.
            let is_whole = self.came >= self.top + (SIDES[1] + BESIDE) as u32;
            self.state = if is_whole { State::Comparing(0) } else { State::Done };
        }
    }

    /// Compares the next block that has an answer, of those from `nth` on.
    #[inline(never)]
    fn compare(&mut self, nth: usize) {
        let blocks = self.width / SIDES[0];
        let of_band = self.blocks.iter().take(blocks).enumerate().skip(nth);
        let found = of_band.clone().find(|(_, disparity)| **disparity != NONE);
        let Some((block, &disparity)) = found else {
            self.weight -= self.weight / FORGET;
            self.offsets -= self.offsets / FORGET;
            self.state = State::Done;
            return;
        };
        self.state = State::Comparing(block + 1);
        let whole = (i32::from(disparity) + 8) >> 4;
        let column = block * SIDES[0];
        let there = i32::try_from(column).ok().and_then(|column| usize::try_from(column - whole).ok());
        let Some((offset_q8, weight)) = there.and_then(|there| self.offset([column, there])) else { return };
        self.weight += weight;
        self.offsets += weight * offset_q8;
    }

    /// The row offset of a block of either view, from these columns on, 1/256 px, and what it weighs; `None` where the view
    /// ends, or texture does not tell.
    fn offset(&self, columns: [usize; 2]) -> Option<(i64, i64)> {
        let (mut left, mut right) = (Smooth::default(), Smooth::default());
        self.smooth(0, columns[0], &mut left)?;
        self.smooth(1, columns[1], &mut right)?;
        let (mut sums, mut products) = ([0_i32; 3], [0_i32; 6]);
        for y in 1..=SIDES[1] {
            for x in 1..=SIDES[0] {
                let across = |view: &Smooth| i32::from(view[y][x + 1]) - i32::from(view[y][x - 1]);
                let down = |view: &Smooth| i32::from(view[y + 1][x]) - i32::from(view[y - 1][x]);
                let (u, v) = (across(&left) + across(&right), down(&left) + down(&right));
                let difference = i32::from(right[y][x]) - i32::from(left[y][x]);
                for (sum, term) in sums.iter_mut().zip([u, v, difference]) {
                    *sum += term;
                }
                let terms = [u * u, u * v, v * v, u * difference, v * difference, difference * difference];
                products.iter_mut().zip(terms).for_each(|(product, term)| *product += term);
            }
        }
        let [u, v, t] = sums.map(i64::from);
        let pixels = (SIDES[0] * SIDES[1]) as i64;
        // Without what all pixels have in common, as an exposure makes it.
        let means = [u * u, u * v, v * v, u * t, v * t, t * t];
        let mut centred = [0; 6];
        for ((centred, product), mean) in centred.iter_mut().zip(products).zip(means) {
            *centred = i64::from(product) - mean / pixels;
        }
        let [uu, uv, vv, ut, vt, tt] = centred;
        // What no shift along the row explains.
        let strength = vv - uv * uv / (uu + 1);
        let slope = vt - uv * ut / (uu + 1);
        if strength < LEAST_GRADIENT {
            return None;
        }
        let rest = (tt - ut * ut / (uu + 1) - slope * slope / strength).max(0);
        // Gradients are four times those of a pixel; an eighth of a grey level is rounded.
        let variance_q8 = 256 * 16 * (rest / (pixels - 4) + 16) / strength;
        let offset_q8 = -4 * 256 * GAIN[0] * slope / (strength * GAIN[1]);
        Some((offset_q8.clamp(-MOST_Q8, MOST_Q8), WHOLE * VARIANCE / (variance_q8 + VARIANCE)))
    }

    /// Smooths a block of a view and a pixel on each side, 1/4 grey level; `None` where the view ends.
    fn smooth(&self, view: usize, column: usize, smooth: &mut Smooth) -> Option<()> {
        let rows = self.rows.get(view)?;
        let columns = column.checked_sub(BESIDE)?..column + SIDES[0] + BESIDE;
        if columns.end > self.width {
            return None;
        }
        let mut along = [[0_i16; 10]; ROWS];
        for (along, row) in along.iter_mut().zip(rows) {
            let pixels: &[u8; 12] = row.get(columns.clone())?.try_into().ok()?;
            for (x, sum) in along.iter_mut().enumerate() {
                *sum = i16::from(pixels[x]) + 2 * i16::from(pixels[x + 1]) + i16::from(pixels[x + 2]);
            }
        }
        for (y, smooth) in smooth.iter_mut().enumerate() {
            for (x, sum) in smooth.iter_mut().enumerate() {
                *sum = (along[y][x] + 2 * along[y + 1][x] + along[y + 2][x]) >> 2;
            }
        }
        Some(())
    }

    /// How far the right view lies lower, 1/256 px; `None` where too little was sure of late.
    #[must_use]
    pub fn row_error_q8(&self) -> Option<i16> {
        let is_known = self.weight >= LEAST_WEIGHT;
        is_known.then(|| i16::try_from(self.offsets / self.weight).unwrap_or(0))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::rectify::Ramp;
    use crate::{Config, Full, Lite, Rectified, StereoMethod, blocks_for};
    use std::vec::Vec;

    const WIDTH: u16 = 160;
    const ROWS: u16 = 96;

    /// A texture that is smooth between pixels and never repeats itself: random grey levels at the nodes of two grids.
    fn texture(x: f64, y: f64) -> f64 {
        let node = |i: f64, j: f64| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small whole numbers")]
            let seed = (i as i32 as u32).wrapping_mul(0x9e37_79b1) ^ (j as i32 as u32).wrapping_mul(0xc2b2_ae35);
            let mixed = (seed ^ seed >> 15).wrapping_mul(0x2c1b_3c6d);
            f64::from((mixed ^ mixed >> 13) & 0xff) / 255.0 - 0.5
        };
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let grid = |side: f64| {
            let (x, y) = (x / side, y / side);
            let (left, top) = (x.floor(), y.floor());
            let (right, below) = (smooth(x - left), smooth(y - top));
            let row = |j: f64| node(left, j) * (1.0 - right) + node(left + 1.0, j) * right;
            row(top) * (1.0 - below) + row(top + 1.0) * below
        };
        128.0 + 130.0 * grid(4.7) + 80.0 * grid(11.3)
    }

    /// The running row error after frames of a scene whose right view lies so much lower, px.
    fn watched(method: &mut dyn StereoMethod, rows: f64, frames: u32) -> Option<f64> {
        for frame in 0..frames {
            for y in 0..ROWS {
                let view = |up: f64, to_left: f64| -> Vec<u8> {
                    // Other texture in every frame.
                    let (left, top) = (f64::from(13 * frame), f64::from(7 * frame));
                    let at = |x: u16| texture(f64::from(x) + to_left + left, f64::from(y) - up + top);
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 18 to 238")]
                    (0..WIDTH).map(|x| at(x).round() as u8).collect()
                };
                let (left, right) = (view(0.0, 0.0), view(rows, 7.3));
                method.push(ScanlinePair { left: &left, right: &right }, &mut |_| ()).unwrap();
            }
            method.finish(&mut |_| ());
        }
        method.figures().unwrap().row_error_q8.map(|error| f64::from(error) / 256.0)
    }

    fn behind<M: StereoMethod>(method: M, ramp: Ramp) -> Rectified<M, 8, { WIDTH as usize }> {
        Rectified::new(method, ROWS, ramp.into()).unwrap()
    }

    fn full() -> Full<{ blocks_for(WIDTH) }> {
        Full::new(Config { num_disparities: 32, ..Config::for_width(WIDTH) }).unwrap()
    }

    #[test]
    fn a_row_error_is_found_to_a_tenth_of_a_pixel() {
        for rows in [-0.8, -0.3, 0.0, 0.25, 0.5, 1.0] {
            let found = watched(&mut behind(full(), Ramp::default()), rows, 60).unwrap();
            assert!((found - rows).abs() < 0.1, "{rows}: {found}");
        }
        let lite: Lite<{ blocks_for(WIDTH) }> = Lite::new(*full().config()).unwrap();
        let found = watched(&mut behind(lite, Ramp::default()), -0.5, 30).unwrap();
        assert!((found + 0.5).abs() < 0.1, "{found}");
    }

    #[test]
    fn what_rectification_takes_away_is_none() {
        let ramp = Ramp { rows_q16: 3 << 15, ..Ramp::default() };
        let found = watched(&mut behind(full(), ramp), 1.5, 24).unwrap();
        assert!(found.abs() < 0.1, "{found}");
        let found = watched(&mut behind(full(), ramp), 2.1, 24).unwrap();
        assert!((found - 0.6).abs() < 0.15, "{found}");
    }

    #[test]
    fn it_follows_a_rig_that_bends_and_knows_nothing_in_the_dark() {
        let mut method = behind(full(), Ramp::default());
        assert_eq!(watched(&mut method, 0.0, 1), None, "one band says too little");
        assert!(watched(&mut method, 0.0, 30).unwrap().abs() < 0.1);
        assert!(watched(&mut method, 0.7, 90).unwrap() > 0.55);
        let dark = [20; WIDTH as usize];
        for _ in 0..120 {
            for _ in 0..ROWS {
                method.push(ScanlinePair { left: &dark, right: &dark }, &mut |_| ()).unwrap();
            }
            method.finish(&mut |_| ());
        }
        assert_eq!(method.figures().unwrap().row_error_q8, None);
    }

    #[test]
    fn lost_rows_and_views_without_room_are_no_matter() {
        let mut method = behind(full(), Ramp::default());
        for _ in 0..3 {
            (0..ROWS).for_each(|_| method.miss(&mut |_| ()));
            method.finish(&mut |_| ());
        }
        assert!(watched(&mut method, 0.4, 30).unwrap() > 0.3);
        let mut low = RowWatch::<32>::new([32, 9]);
        low.start();
        low.push(None);
        assert_eq!((low.state, low.row_error_q8()), (State::Done, None));
    }
}
