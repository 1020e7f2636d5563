//! StereoBM, and the same with other costs, by their definition: the whole frame at once, and every window summed anew.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "frames of a few dozen pixels"
)]

use haarline::{Config, Disparity};
use haarline_tests::BlockSettings;

use crate::frame::Frame;

/// What a window costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    Absolute,
    Squared,
    Correlation,
}

/// The slow method, prepared for one frame. Disparities, places and costs are all `i32`.
pub struct Oracle {
    cost: Cost,
    width: i32,
    height: i32,
    min: i32,
    max: i32,
    radius: i32,
    texture_threshold: i32,
    uniqueness_ratio: i32,
    /// The prefilter's response, without the cap added.
    left: Vec<i32>,
    right: Vec<i32>,
}

impl Oracle {
    pub fn new(frame: &Frame, config: &Config, settings: &BlockSettings, window: usize, cost: Cost) -> Self {
        let min = i32::from(config.min_disparity);
        let cap = i32::from(settings.prefilter_cap);
        Self {
            cost,
            width: frame.width as i32,
            height: frame.height() as i32,
            min,
            max: min + i32::from(config.num_disparities) - 1,
            radius: window as i32 / 2,
            texture_threshold: settings.texture_threshold as i32,
            uniqueness_ratio: i32::from(settings.uniqueness_ratio),
            left: prefiltered(&frame.left, frame.width as i32, frame.height() as i32, cap),
            right: prefiltered(&frame.right, frame.width as i32, frame.height() as i32, cap),
        }
    }

    pub fn map(&self) -> Vec<Disparity> {
        let places = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        let to_disparity = |bits: Option<i32>| bits.map_or(Disparity::UNKNOWN, |b| Disparity::from_bits(b as i16));
        places.map(|(x, y)| to_disparity(self.match_pixel(x, y))).collect()
    }

    /// The pixel's disparity in 1/16 px.
    fn match_pixel(&self, x: i32, y: i32) -> Option<i32> {
        if !self.is_inside(x, y) || self.texture(x, y) < self.texture_threshold {
            return None;
        }
        let costs: Vec<(i32, i32)> = (self.min..=self.max).rev().map(|d| (self.cost(x, y, d), d)).collect();
        let (best, disparity) = *costs.iter().min_by_key(|(cost, _)| *cost).unwrap();
        let limit = best + best * self.uniqueness_ratio / 100;
        let is_rival = |&(cost, d): &(i32, i32)| (d - disparity).abs() > 1 && cost <= limit;
        if self.uniqueness_ratio > 0 && costs.iter().any(is_rival) {
            return None;
        }
        let mut q8 = disparity * 256;
        if self.min < disparity && disparity < self.max {
            let (lower, upper) = (self.cost(x, y, disparity - 1), self.cost(x, y, disparity + 1));
            let slope = lower + upper - 2 * best + (lower - upper).abs();
            q8 += if slope == 0 { 0 } else { (lower - upper) * 256 / slope };
        }
        Some((q8 + 15).div_euclid(16))
    }

    /// Whether the window lies in the left view, and the search range of its centre in the right
    /// one. A window keeps a positive range too.
    fn is_inside(&self, x: i32, y: i32) -> bool {
        let margin = self.radius;
        let whole_window = margin <= x && x < self.width - margin && margin <= y && y < self.height - margin;
        whole_window && x - margin >= self.max && x - self.min < self.width
    }

    fn texture(&self, x: i32, y: i32) -> i32 {
        self.window(x, y).map(|(u, v)| self.left[(v * self.width + u) as usize].abs()).sum()
    }

    /// What the window costs there. A pixel whose search range leaves the right view at its right
    /// edge is compared with the last range that does not.
    fn cost(&self, x: i32, y: i32, disparity: i32) -> i32 {
        let last = self.width - 1 - (self.max - self.min);
        let pair = |(u, v): (i32, i32)| {
            let other = (u - self.max).min(last) + self.max - disparity;
            let row = v * self.width;
            (i64::from(self.left[(row + u) as usize]), i64::from(self.right[(row + other) as usize]))
        };
        let sum = |term: fn((i64, i64)) -> i64| self.window(x, y).map(|place| term(pair(place))).sum::<i64>();
        let cost = match self.cost {
            Cost::Absolute => sum(|(l, r)| (l - r).abs()),
            Cost::Squared => sum(|(l, r)| (l - r).pow(2)),
            Cost::Correlation => {
                let (product, energies) = (sum(|(l, r)| l * r), sum(|(l, _)| l * l) * sum(|(_, r)| r * r));
                // Towards zero, in both directions.
                (1 << 15) - if energies == 0 { 0 } else { ((product * product.abs()) << 15) / energies }
            }
        };
        cost as i32
    }

    fn window(&self, x: i32, y: i32) -> impl Iterator<Item = (i32, i32)> {
        let radius = self.radius;
        (y - radius..=y + radius).flat_map(move |v| (x - radius..=x + radius).map(move |u| (u, v)))
    }
}

/// The capped horizontal Sobel response of a view, flat at the left and right edge and in a last
/// row without partner, mirrored at the upper and lower edge.
fn prefiltered(view: &[u8], width: i32, height: i32, cap: i32) -> Vec<i32> {
    let pixel = |x: i32, y: i32| {
        let mirrored = (height - 1) - (height - 1 - y.abs()).abs();
        i32::from(view[(mirrored * width + x) as usize])
    };
    let response = |x: i32, y: i32| {
        let is_last_without_partner = y == height - 1 && height % 2 == 1;
        if x == 0 || x == width - 1 || is_last_without_partner {
            return 0;
        }
        let dx = |y| pixel(x + 1, y) - pixel(x - 1, y);
        (dx(y - 1) + 2 * dx(y) + dx(y + 1)).clamp(-cap, cap)
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| response(x, y)).collect()
}
