//! Synthetic scenes with known disparity, by integer arithmetic.

use std::ops::Range;

use super::content::{hash, texture};
use super::frame::Frame;

/// A surface of the left view, its disparity the same along each row.
#[derive(Clone)]
pub struct Surface {
    /// Where it is in the left view.
    pub columns: Range<i32>,
    pub rows: Range<i32>,
    /// Disparity in row 0, and what each row adds, 1/16 px.
    pub disparity: i32,
    pub slope: i32,
    /// Whether it has texture; grey otherwise.
    pub has_texture: bool,
}

/// Surfaces from the nearest to the farthest, and the noise of the sensors.
#[derive(Clone)]
pub struct Scene {
    pub width: usize,
    pub height: usize,
    pub surfaces: Vec<Surface>,
    /// Standard deviation, grey levels.
    pub noise: i32,
}

/// Far beyond the image, for surfaces that do not end in it.
const FAR: i32 = 10_000;

impl Surface {
    /// A textured plane that faces the cameras and covers those columns, `disparity` px.
    pub const fn facing(columns: Range<i32>, disparity: i32) -> Self {
        Self { columns, rows: -FAR..FAR, disparity: 16 * disparity, slope: 0, has_texture: true }
    }

    /// A textured plane behind everything.
    pub const fn background(disparity: i32) -> Self {
        Self::facing(-FAR..FAR, disparity)
    }

    /// The part within those rows.
    pub fn in_rows(self, rows: Range<i32>) -> Self {
        Self { rows, ..self }
    }

    /// The same surface, but blank.
    pub fn blank(self) -> Self {
        Self { has_texture: false, ..self }
    }

    /// The same surface, each row `slope` / 16 px nearer than the one above.
    pub fn sloping(self, slope: i32) -> Self {
        Self { slope, ..self }
    }

    /// Disparity in a row, 1/16 px.
    fn disparity_in(&self, y: i32) -> i32 {
        self.disparity + self.slope * y
    }

    fn covers(&self, x: i32, y: i32) -> bool {
        self.columns.contains(&x) && self.rows.contains(&y)
    }
}

impl Scene {
    /// Both views.
    pub fn render(&self) -> Frame {
        let left = |x: i32, y: i32| {
            let index = self.surfaces.iter().position(|s| s.covers(x, y));
            self.grey(index.unwrap(), 16 * x, y, 1, x)
        };
        let right = |x: i32, y: i32| {
            let seen_at = |s: &Surface| 16 * x + s.disparity_in(y);
            let index = self.surfaces.iter().position(|s| s.covers(seen_at(s) >> 4, y)).unwrap();
            self.grey(index, seen_at(&self.surfaces[index]), y, 2, x)
        };
        Frame::from_fn(self.width, self.height, left, right)
    }

    /// Disparity of a pixel of the left view, 1/16 px; `None` on a blank surface.
    pub fn truth(&self, x: usize, y: usize) -> Option<i32> {
        let (x, y) = (i32::try_from(x).unwrap(), i32::try_from(y).unwrap());
        let surface = self.surfaces.iter().find(|s| s.covers(x, y)).unwrap();
        surface.has_texture.then(|| surface.disparity_in(y))
    }

    /// Grey level of a surface at column `x_q4` of the left view, 1/16 px, as a camera sees it in its
    /// column `x`.
    fn grey(&self, surface: usize, x_q4: i32, y: i32, camera: u32, x: i32) -> u8 {
        let seed = u32::try_from(surface).unwrap();
        let grey = if self.surfaces[surface].has_texture { texture(seed, x_q4, y) } else { 120 };
        // The sum of four random bytes has a standard deviation of 148.
        let sum: i32 = (0..4).map(|i| i32::from(hash(1000 * camera + i, x, y)) - 128).sum();
        u8::try_from((i32::from(grey) + sum * self.noise / 148).clamp(0, 255)).unwrap()
    }
}

/// A near and a far plane that meet in the middle.
pub fn two_planes() -> Scene {
    Scene { width: 96, height: 64, surfaces: vec![Surface::facing(-FAR..48, 12), Surface::background(4)], noise: 0 }
}

/// A slanted ground below a textured and a blank wall, a thin post before them, and a little noise.
pub fn street() -> Scene {
    Scene {
        width: 96,
        height: 64,
        surfaces: vec![
            Surface::facing(30..36, 16).in_rows(8..56),
            Surface::background(2).sloping(4).in_rows(28..64),
            Surface::facing(56..FAR, 9).blank(),
            Surface::background(9),
        ],
        noise: 1,
    }
}

/// The street under strong noise, in rows that end within a block, as a toed-in rig sees it: all of
/// it 9 px farther.
pub fn noisy_street() -> Scene {
    let mut scene = street();
    for surface in &mut scene.surfaces {
        surface.disparity -= 16 * 9;
    }
    Scene { width: 93, height: 62, noise: 10, ..scene }
}
