//! Small stereo pairs and scenes with known truth.

use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, Luma};

use crate::files::encode;
use crate::tool::Bench;

/// Columns of a usual pair.
pub const WIDTH: usize = 96;
/// Rows of a usual pair.
pub const HEIGHT: usize = 40;

/// Rectified views of the same size.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    pub width: usize,
    pub height: usize,
    pub left: Vec<u8>,
    pub right: Vec<u8>,
}

/// A texture that repeats nowhere, smooth over about 3 px in a row.
pub fn texture(x: i64, y: i64, seed: u64) -> u8 {
    let noise = |x: i64| {
        let mut hash = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (y as u64).rotate_left(32) ^ (seed << 13);
        for _ in 0..3 {
            hash = (hash ^ (hash >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        }
        (hash >> 56) as u32
    };
    ((noise(x - 1) + 2 * noise(x) + noise(x + 1)) / 4) as u8
}

impl Pair {
    /// A textured plane at `shift` px: the right view shows each point that far to the left.
    pub fn shifted(width: usize, height: usize, shift: i64) -> Self {
        let view = |shift: i64| {
            let pixels = (0..width * height).map(|index| [index % width, index / width]);
            pixels.map(|[x, y]| texture(x as i64 + shift, y as i64, 1)).collect()
        };
        Self { width, height, left: view(0), right: view(shift) }
    }

    /// Two views without any texture.
    pub fn blank(width: usize, height: usize) -> Self {
        Self { width, height, left: vec![120; width * height], right: vec![120; width * height] }
    }

    pub fn left_image(&self) -> DynamicImage {
        grey_image(self.width, self.height, &self.left)
    }

    pub fn right_image(&self) -> DynamicImage {
        grey_image(self.width, self.height, &self.right)
    }

    /// Writes `left.png` and `right.png`.
    pub fn write(&self, bench: &Bench) {
        self.write_as(bench, "left.png", "right.png");
    }

    pub fn write_as(&self, bench: &Bench, left: &str, right: &str) {
        bench.write(left, encode(&self.left_image(), ImageFormat::Png));
        bench.write(right, encode(&self.right_image(), ImageFormat::Png));
    }
}

pub fn grey_image(width: usize, height: usize, luma: &[u8]) -> DynamicImage {
    GrayImage::from_raw(width as u32, height as u32, luma.to_vec()).unwrap().into()
}

pub fn grey16_image(width: usize, height: usize, luma: &[u16]) -> DynamicImage {
    let image = ImageBuffer::<Luma<u16>, _>::from_raw(width as u32, height as u32, luma.to_vec());
    DynamicImage::ImageLuma16(image.unwrap())
}

/// A bench with the usual pair of a plane at `shift` px in it.
pub fn bench_with_plane(shift: i64) -> Bench {
    let bench = Bench::new();
    Pair::shifted(WIDTH, HEIGHT, shift).write(&bench);
    bench
}

/// A scene with truth: a back plane with a box before it.
#[derive(Debug, Clone)]
pub struct Scene {
    pub name: &'static str,
    pub family: &'static str,
    pub num_disparities: usize,
    pub pair: Pair,
    /// True disparity x 256; 0 = unknown.
    pub truth: Vec<u16>,
    /// 255 where both cameras see the point.
    pub nonocc: Vec<u8>,
}

impl Scene {
    /// Renders it. Part of the truth is unknown, and part of it is wrong on purpose, by 1.3 and by 4.2 px, so
    /// that every figure is far from 0.
    pub fn new(name: &'static str, family: &'static str, [width, height]: [usize; 2], [back, front]: [i64; 2]) -> Self {
        let is_box = |x: i64, y: i64| {
            let (w, h) = (width as i64, height as i64);
            (w / 2..w * 3 / 4).contains(&x) && (h / 4..h).contains(&y)
        };
        let seed = name.len() as u64;
        let disparity = |x: i64, y: i64| if is_box(x, y) { front } else { back };
        let left = |x: i64, y: i64| texture(x, y, seed + u64::from(is_box(x, y)));
        let hidden = |x: i64, y: i64| is_box(x - back + front, y);
        let right = |x: i64, y: i64| if is_box(x + front, y) { left(x + front, y) } else { texture(x + back, y, seed) };
        let truth = |x: i64, y: i64| match (x * 7 + y * 3) % 16 {
            0 => 0,
            1 | 2 => disparity(x, y) * 256 + 333,
            3 => disparity(x, y) * 256 + 1075,
            _ => disparity(x, y) * 256 + 20,
        };
        let nonocc = |x: i64, y: i64| if !is_box(x, y) && hidden(x, y) || x < disparity(x, y) { 0 } else { 255 };
        let pixels: Vec<[i64; 2]> =
            (0..width * height).map(|index| [(index % width) as i64, (index / width) as i64]).collect();
        let pair = Pair {
            width,
            height,
            left: pixels.iter().map(|&[x, y]| left(x, y)).collect(),
            right: pixels.iter().map(|&[x, y]| right(x, y)).collect(),
        };
        let truth = pixels.iter().map(|&[x, y]| truth(x, y) as u16).collect();
        let nonocc = pixels.iter().map(|&[x, y]| nonocc(x, y)).collect();
        Self { name, family, num_disparities: 16, pair, truth, nonocc }
    }

    /// Writes its folder in the folder `scenes`.
    pub fn write(&self, bench: &Bench, scenes: &str) {
        let file = |name: &str| format!("{scenes}/{}/{name}", self.name);
        let Pair { width, height, .. } = self.pair;
        self.pair.write_as(bench, &file("left.png"), &file("right.png"));
        bench.write(&file("truth.png"), encode(&grey16_image(width, height, &self.truth), ImageFormat::Png));
        bench.write(&file("nonocc.png"), encode(&grey_image(width, height, &self.nonocc), ImageFormat::Png));
        let meta = serde_json::json!({
            "name": self.name,
            "num_disparities": self.num_disparities,
            "family": self.family,
            "source": "a test",
        });
        bench.write(&file("meta.json"), meta.to_string());
    }
}

/// Three scenes of two families, of different sizes.
pub fn three_scenes() -> [Scene; 3] {
    [
        Scene::new("alcove", "indoor", [WIDTH, HEIGHT], [3, 9]),
        Scene::new("bench", "indoor", [80, 33], [2, 12]),
        Scene::new("crossing", "street", [112, 48], [5, 7]),
    ]
}

/// A bench with these scenes in the folder `scenes`.
pub fn bench_with_scenes() -> Bench {
    let bench = Bench::new();
    three_scenes().iter().for_each(|scene| scene.write(&bench, "scenes"));
    bench
}
