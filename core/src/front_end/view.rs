//! One camera's view: raw rows in, smoothed rows and feature rows out.

use crate::count;
use crate::front_end::exposure::Gain;
use crate::front_end::haar::{pair_sum, sum_121, sum_12221};
use crate::front_end::noise::{NoiseHistogram, SmoothingLevel};
use crate::front_end::reading::Reading;
use crate::front_end::ring::{MARGIN, RowRing, replicate_borders};

/// Features are clipped to +-`CLIP` grey levels and stored with that offset.
pub(crate) const CLIP: i32 = 31;

/// Rows by which the smoothed rows lag behind the camera: half of the widest vertical filter.
pub(crate) const SMOOTH_LAG: u32 = 2;

/// What is kept of one view: 5 rows as they came, `SMOOTH_ROWS` smoothed, `FEATURE_ROWS` of features.
#[derive(Debug, Clone)]
pub(crate) struct View<const FEATURE_ROWS: usize, const BLOCKS: usize, const SMOOTH_ROWS: usize = 4> {
    pub(crate) raw: RowRing<5, BLOCKS>,
    pub(crate) smooth: RowRing<SMOOTH_ROWS, BLOCKS>,
    /// Even rows hold the gradient across, `[1 2 1]` down x `[-1 0 1]` across; odd rows the gradient
    /// down. Both views have the same parity, so sums of differences need no care.
    pub(crate) features: RowRing<FEATURE_ROWS, BLOCKS>,
    pub(crate) noise: NoiseHistogram,
}

impl<const FEATURE_ROWS: usize, const BLOCKS: usize, const SMOOTH_ROWS: usize> View<FEATURE_ROWS, BLOCKS, SMOOTH_ROWS> {
    pub(crate) const fn new() -> Self {
        Self { raw: RowRing::new(), smooth: RowRing::new(), features: RowRing::new(), noise: NoiseHistogram::new() }
    }

    pub(crate) fn clear(&mut self) {
        self.raw.clear();
        self.smooth.clear();
        self.features.clear();
        self.noise.clear();
    }

    /// Takes the newest raw row into the noise histogram.
    pub(crate) fn measure_noise(&mut self, width: usize) {
        if self.raw.len() >= 3 {
            let [a, b, c] = self.raw.window(i64::from(self.raw.len()) - 3);
            self.noise.add(a, b, c, width);
        }
    }

    /// Makes the next smoothed row, two rows behind the newest raw one.
    pub(crate) fn smooth_row(&mut self, level: SmoothingLevel, gain: Gain, width: usize) {
        let rows = self.raw.window(i64::from(self.smooth.len()) - 2);
        let out = self.smooth.push();
        // The filter, rounding; saturation.
        count::additions(width * level.additions());
        count::comparisons(width);
        match level {
            SmoothingLevel::Off => copy(rows[2], gain, out),
            SmoothingLevel::Light => smooth_light([rows[1], rows[2], rows[3]], gain, out),
            SmoothingLevel::Medium => smooth_wide::<BLOCKS>(rows, gain, out, false),
            SmoothingLevel::Strong => smooth_wide::<BLOCKS>(rows, gain, out, true),
        }
        replicate_borders(out, width);
    }

    /// Makes the next feature row, one row behind the newest smoothed one.
    pub(crate) fn feature_row(&mut self, reading: Reading, width: usize) {
        let y = i64::from(self.features.len());
        let rows = self.smooth.window(y - 1);
        let out = self.features.push();
        // Of a gradient two `[1 2 1]`, of a mean the columns that come and go; the offset, clipping.
        let (additions, subtractions) = match reading {
            Reading::Intensity => (9, 2),
            Reading::Haar => (7, 1),
        };
        count::additions(width * additions);
        count::subtractions(width * subtractions);
        count::comparisons(2 * width);
        match reading {
            Reading::Intensity => less_mean(rows, out, width),
            Reading::Haar if y % 2 == 0 => gradient_across(rows, out),
            Reading::Haar => gradient_down(rows, out),
        }
        replicate_borders(out, width);
    }
}

/// The row as it came.
fn copy(row: &[u8], gain: Gain, out: &mut [u8]) {
    for (&pixel, out) in row.iter().zip(out) {
        *out = gain.scale(u16::from(pixel), 0);
    }
}

/// `[1 2 1]` down and across.
fn smooth_light(rows: [&[u8]; 3], gain: Gain, out: &mut [u8]) {
    let columns = rows[0].windows(3).zip(rows[1].windows(3)).zip(rows[2].windows(3));
    for (((a, b), c), out) in columns.zip(out.iter_mut().skip(1)) {
        let [l, m, r] = [0, 1, 2].map(|x| sum_121(a[x], b[x], c[x]));
        *out = gain.scale(pair_sum(pair_sum(l, m), pair_sum(m, r)), 4);
    }
}

/// `[1 2 2 2 1]` down and the same across, or `[1 2 2 2 2 2 2 2 1]` across if `wider`.
///
/// Across it is the cascade of pair sums at distances 1, 1, 2 (and 4): the Haar scaling function of
/// the next scale, undecimated, made symmetric by one more pair sum.
fn smooth_wide<const BLOCKS: usize>(rows: [&[u8]; 5], gain: Gain, out: &mut [u8], wider: bool) {
    let mut line = [[0u16; 4]; BLOCKS];
    let line = line.as_flattened_mut();
    let [a, b, c, d, e] = rows;
    for (((((sum, &a), &b), &c), &d), &e) in line.iter_mut().zip(a).zip(b).zip(c).zip(d).zip(e) {
        *sum = sum_12221(a, b, c, d, e);
    }
    add_shifted(line, 1);
    add_shifted(line, 1);
    add_shifted(line, 2);
    let (reach, shift) = if wider {
        add_shifted(line, 4);
        (4, 7)
    } else {
        (2, 6)
    };
    for (out, &sum) in out.iter_mut().skip(reach).zip(line.iter()) {
        *out = gain.scale(sum, shift);
    }
}

/// Pair sums of the values `distance` apart, in place; the last ones stay as they are.
fn add_shifted(line: &mut [u16], distance: usize) {
    for x in 0..line.len().saturating_sub(distance) {
        line[x] = pair_sum(line[x], line[x + distance]);
    }
}

/// `[1 2 1]` down, `[-1 0 1]` across.
fn gradient_across(rows: [&[u8]; 3], out: &mut [u8]) {
    let columns = rows[0].windows(3).zip(rows[1].windows(3)).zip(rows[2].windows(3));
    for (((a, b), c), out) in columns.zip(out.iter_mut().skip(1)) {
        *out = clipped(i32::from(sum_121(a[2], b[2], c[2])) - i32::from(sum_121(a[0], b[0], c[0])));
    }
}

/// `[-1 0 1]` down, `[1 2 1]` across.
fn gradient_down(rows: [&[u8]; 3], out: &mut [u8]) {
    let columns = rows[0].windows(3).zip(rows[2].windows(3));
    for ((a, c), out) in columns.zip(out.iter_mut().skip(1)) {
        *out = clipped(i32::from(sum_121(c[0], c[1], c[2])) - i32::from(sum_121(a[0], a[1], a[2])));
    }
}

/// Twice what a pixel differs from the mean around it, `[1 2 1]` down and 16 columns across, by a running sum.
fn less_mean(rows: [&[u8]; 3], out: &mut [u8], width: usize) {
    const REACH: usize = 8;
    let [a, b, c] = rows;
    // Beside the view its border pixel goes on, however far.
    let last = (width + 2 * MARGIN).saturating_sub(1);
    let column = |x: usize| {
        let at = |row: &[u8]| row.get(x.min(last)).copied().unwrap_or(0);
        i32::from(sum_121(at(a), at(b), at(c)))
    };
    let first = MARGIN;
    let mut sum: i32 = (0..2 * REACH).map(|x| column((first + x).saturating_sub(REACH))).sum();
    for ((x, &pixel), out) in (first..).zip(b.iter().skip(first)).zip(out.iter_mut().skip(first)).take(width) {
        // 64 times the pixel less 64 times the mean.
        *out = clipped((64 * i32::from(pixel) - sum + 16) >> 5);
        sum += column(x + REACH) - column(x.saturating_sub(REACH));
    }
}

fn clipped(gradient: i32) -> u8 {
    u8::try_from(gradient.clamp(-CLIP, CLIP) + CLIP).unwrap_or(0)
}

/// Four rows summed: the line in which contours are looked for. With margins.
pub(crate) fn sum_rows(rows: [&[u8]; 4], sums: &mut [u16]) {
    let [a, b, c, d] = rows;
    for ((((sum, &a), &b), &c), &d) in sums.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        let [a, b, c, d] = [a, b, c, d].map(u16::from);
        *sum = pair_sum(pair_sum(a, b), pair_sum(c, d));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    const WIDTH: usize = 40;

    fn smoothed(level: SmoothingLevel, pixels: impl Fn(usize, usize) -> u8) -> Vec<Vec<u8>> {
        let mut view = View::<6, 12>::new();
        let mut out = Vec::new();
        for y in 0..12 {
            let row: Vec<u8> = (0..WIDTH).map(|x| pixels(x, y)).collect();
            view.raw.push_pixels(&row);
            if y >= 2 {
                view.smooth_row(level, Gain::default(), WIDTH);
                out.push(view.smooth.row(i64::from(view.smooth.len()) - 1)[MARGIN..][..WIDTH].to_vec());
            }
        }
        out
    }

    #[test]
    fn smoothing_keeps_a_flat_view_and_the_place_of_a_bright_point() {
        for level in [SmoothingLevel::Off, SmoothingLevel::Light, SmoothingLevel::Medium, SmoothingLevel::Strong] {
            for grey in [0, 1, 128, 255] {
                assert!(smoothed(level, |_, _| grey).iter().flatten().all(|&v| v == grey), "{level:?} {grey}");
            }
            let rows = smoothed(level, |x, y| if (x, y) == (20, 5) { 255 } else { 0 });
            let brightest = rows.iter().flatten().max().unwrap();
            assert_eq!(rows[5][20], *brightest, "{level:?}");
            for reach in 1..=4 {
                assert_eq!(rows[5][20 - reach], rows[5][20 + reach], "{level:?} {reach}");
                assert_eq!(rows[5 - reach.min(3)][20], rows[5 + reach.min(3)][20], "{level:?} {reach}");
            }
        }
    }

    #[test]
    fn a_vertical_edge_shows_on_even_rows_and_a_horizontal_one_on_odd_rows() {
        let mut view = View::<6, 12>::new();
        for y in 0..9u32 {
            let row: Vec<u8> = (0..WIDTH).map(|x| if x >= 20 { 3 } else { 0 }).collect();
            view.raw.push_pixels(&row);
            if y >= 2 {
                view.smooth_row(SmoothingLevel::Off, Gain::default(), WIDTH);
            }
            if y >= 3 {
                view.feature_row(Reading::Haar, WIDTH);
            }
        }
        let feature = |y: i64, x: usize| i32::from(view.features.row(y)[MARGIN + x]) - CLIP;
        assert_eq!([18, 19, 20, 21].map(|x| feature(4, x)), [0, 12, 12, 0]);
        assert_eq!([18, 19, 20, 21].map(|x| feature(3, x)), [0, 0, 0, 0]);
    }
}
