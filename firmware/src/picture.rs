//! A picture without a camera: a textured wall, and a nearer textured box before it.

/// Columns of the picture.
pub const WIDTH: u16 = 320;
/// Rows of the picture.
pub const HEIGHT: u32 = 240;

const WALL_DISPARITY: u32 = 8;
const BOX_DISPARITY: u32 = 20;

/// Row `y` of the left and the right view.
#[must_use]
pub fn rows(y: u32) -> ([u8; WIDTH as usize], [u8; WIDTH as usize]) {
    let (mut left, mut right) = ([0; WIDTH as usize], [0; WIDTH as usize]);
    for ((x, left), right) in (0u32..).zip(&mut left).zip(&mut right) {
        let in_box = |x: u32| (120..200).contains(&x) && (80..160).contains(&y);
        *left = if in_box(x) { texture(x + 1000, y) } else { texture(x, y) };
        // Column x of the right view shows what the left one has a disparity further right.
        let (wall, front) = (x + WALL_DISPARITY, x + BOX_DISPARITY);
        *right = if in_box(front) { texture(front + 1000, y) } else { texture(wall, y) };
    }
    (left, right)
}

/// A fixed random texture, two pixels fine.
fn texture(x: u32, y: u32) -> u8 {
    let cell = (x / 2).wrapping_mul(0x9E37_79B1) ^ (y / 2).wrapping_mul(0x85EB_CA77);
    let mixed = (cell ^ cell >> 15).wrapping_mul(0x2C1B_3C6D);
    (mixed >> 24).to_le_bytes()[0]
}
