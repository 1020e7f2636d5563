//! A pair without a camera, rendered when this is compiled: a textured wall with a blank patch, ground that comes
//! nearer from row to row by fractions of a pixel, and a box that stands on it. So that no stage is idle.

use haarline::Wiring;
use haarline::wiring::{First, Kind};

/// Columns of a view.
pub const WIDTH: u16 = 160;
/// Rows of a view.
pub const HEIGHT: u32 = 120;
/// How the views lie in [`RAW`].
pub const WIRING: Wiring = Wiring::new(Kind::PixelInterleaved, First::Left);
/// Bytes of a raw row.
const ROW_BYTES: usize = WIRING.row_bytes(WIDTH);

/// The raw rows, as two cameras on one port would deliver them.
pub static RAW: [[u8; ROW_BYTES]; HEIGHT as usize] = render();

/// Disparity of the wall, 1/16 px, and how much more each row of the ground has.
const WALL: u32 = 8 << 4;
const SLOPE: u32 = 4;
/// The ground's first row.
const HORIZON: u32 = 72;
/// Disparity of the box, px; nearer than the ground everywhere beside it.
const BOX: u32 = 20;
const BLANK_GREY: u32 = 110;
/// Sensor noise of up to so many grey levels, so that there is something to smooth.
const NOISE: u32 = 2;

const fn is_box(x: u32, y: u32) -> bool {
    64 <= x && x < 104 && 40 <= y && y < 100
}

const fn is_blank(x: u32, y: u32) -> bool {
    112 <= x && x < 152 && 12 <= y && y < 52
}

const fn render() -> [[u8; ROW_BYTES]; HEIGHT as usize] {
    let mut raw = [[0; ROW_BYTES]; HEIGHT as usize];
    let mut y = 0;
    while y < HEIGHT {
        let background = if y < HORIZON { WALL } else { WALL + SLOPE * (y - HORIZON) };
        let mut x = 0;
        while x < WIDTH as u32 {
            let left = if is_box(x, y) { texture((x << 4) + BOX_FROM, y) } else { behind(x << 4, y) };
            // Column x of the right view shows what the left one has a disparity further right.
            let right = if is_box(x + BOX, y) {
                texture(((x + BOX) << 4) + BOX_FROM, y)
            } else {
                behind((x << 4) + background, y)
            };
            let at = 2 * x as usize;
            raw[y as usize][at] = noisy(left, 2 * x, y);
            raw[y as usize][at + 1] = noisy(right, 2 * x + 1, y);
            x += 1;
        }
        y += 1;
    }
    raw
}

/// Where in the texture the box is cut out, 1/16 px.
const BOX_FROM: u32 = 1 << 14;

/// What is behind the box at column `x` of the left view, 1/16 px.
const fn behind(x: u32, y: u32) -> u32 {
    if is_blank(x >> 4, y) { BLANK_GREY } else { texture(x, y) }
}

/// A fixed random texture of cells of 4x4 px with soft borders, at column `x`, 1/16 px: 32 to 223.
const fn texture(x: u32, y: u32) -> u32 {
    let (column, row) = (x >> 6, y >> 2);
    let (right, below) = (x & 63, y & 3);
    let upper = random(column, row) * (64 - right) + random(column + 1, row) * right;
    let lower = random(column, row + 1) * (64 - right) + random(column + 1, row + 1) * right;
    32 + (upper * (4 - below) + lower * below) * 3 / (4 * 4 * 64)
}

const fn noisy(grey: u32, x: u32, y: u32) -> u8 {
    let noise = random(x + 5000, y) % (2 * NOISE + 1);
    (grey + noise - NOISE).to_le_bytes()[0]
}

/// 0 to 255, the same for the same place.
const fn random(x: u32, y: u32) -> u32 {
    let place = x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77);
    let mixed = (place ^ place >> 15).wrapping_mul(0x2C1B_3C6D);
    mixed >> 24
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selftest::{BLOCKS, CONFIG};
    use core::ops::Range;
    use haarline::{Disparity, Full, ScanlinePair, StereoMethod};

    #[test]
    fn wall_ground_and_box_are_where_they_should_be() {
        let mut full = Full::<BLOCKS>::new(CONFIG).unwrap();
        let mut map: Vec<Vec<Disparity>> = Vec::new();
        let (mut left, mut right) = ([0; WIDTH as usize], [0; WIDTH as usize]);
        for raw in &RAW {
            WIRING.unpack(raw, &mut left, &mut right).unwrap();
            full.push(ScanlinePair { left: &left, right: &right }, &mut |row| map.push(row.disparity.to_vec()))
                .unwrap();
        }
        full.finish(&mut |row| map.push(row.disparity.to_vec()));
        // Of a part of the map the percentage that is unknown, and of the rest that within 1 px of what is expected.
        let part = |columns: Range<usize>, rows: Range<usize>, expected: fn(i16) -> i16| {
            let pixels = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
            let (mut all, mut known, mut right) = (0, 0, 0);
            for (x, y) in pixels {
                all += 1;
                if let Some(bits) = map[y][x].known() {
                    known += 1;
                    right += u32::from(bits.abs_diff(expected(y.try_into().unwrap())) <= 16);
                }
            }
            (100 * (all - known) / all, 100 * right / known.max(1))
        };
        // The wall's columns beside the box lie behind it in the right view.
        let wall = part(32..50, 4..68, |_| 8 << 4);
        let ground = part(32..50, 76..116, |y| (8 << 4) + 4 * (y - 72));
        let front = part(68..100, 44..96, |_| 20 << 4);
        for seen in [wall, ground, front] {
            assert!(seen.0 < 10 && seen.1 > 95, "wall {wall:?}, ground {ground:?}, box {front:?}");
        }
    }
}
