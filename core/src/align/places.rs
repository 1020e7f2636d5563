//! Row offsets by place: what the blocks of the last pass show in every part of the view.

use super::line::{Line, Plane};

/// Parts of the view across and down.
pub(super) const PARTS: [usize; 2] = [10, 6];
/// Weight of the blocks that a part needs to say anything: two that stand out entirely, or more that do less.
const LEAST_WEIGHT: u64 = 2 * 4095;
/// Weight of a part that counts half of what it could: lenses move all of its blocks alike, which no number of them makes up for.
const SATURATION: u64 = 8 * 4095;

/// Sums over the blocks of each part.
#[derive(Debug, Clone)]
pub(super) struct Places {
    parts: [[Part; PARTS[0]]; PARTS[1]],
}

#[derive(Debug, Clone, Copy, Default)]
struct Part {
    weight: u64,
    /// Weights times offsets, 1/65536 px.
    rows: i64,
    /// Weights times twice the distance from the middle, px, and times offsets from the ramp, 1/256 px.
    twice: [i64; 2],
    q8: i64,
}

impl Places {
    pub(super) const fn new() -> Self {
        Self { parts: [[Part { weight: 0, rows: 0, twice: [0; 2], q8: 0 }; PARTS[0]]; PARTS[1]] }
    }

    pub(super) fn clear(&mut self) {
        self.parts = Self::new().parts;
    }

    /// Adds a block at twice that distance from the middle of views of `size` px, with its row offset and how far it is from the
    /// ramp, 1/256 px.
    pub(super) fn add(&mut self, twice: [i32; 2], size: [u16; 2], (rows_q16, q8): (i32, i32), weight: u32) {
        let part = |j: usize| {
            let at = usize::try_from(twice[j] + i32::from(size[j])).unwrap_or(0);
            at * PARTS[j] / (2 * usize::from(size[j]))
        };
        if let Some(part) = self.parts.get_mut(part(1)).and_then(|row| row.get_mut(part(0))) {
            part.weight += u64::from(weight);
            let weight = i64::from(weight);
            part.rows += weight * i64::from(rows_q16);
            part.q8 += weight * i64::from(q8);
            for (sum, twice) in part.twice.iter_mut().zip(twice) {
                *sum += weight * i64::from(twice);
            }
        }
    }

    /// The plane through what the parts show, in which one full of texture counts little more than another; `None` without any.
    pub(super) fn solve(&self, size: [u16; 2]) -> Option<Plane> {
        let mut line = Line::default();
        for part in self.parts.iter().flatten().filter(|part| part.weight > 0) {
            let mean = |sum: i64| i32::try_from(sum / part.weight.cast_signed()).unwrap_or(0);
            let weight = 4095 * part.weight / (part.weight + SATURATION);
            line.add(part.twice.map(mean), mean(part.q8), u32::try_from(weight).unwrap_or(0));
        }
        line.solve(size)
    }

    /// The row offset of a part, 1/65536 px; `None` where too little is seen.
    pub(super) fn rows_q16(&self, [across, down]: [usize; 2]) -> Option<i32> {
        let part = self.parts.get(down)?.get(across).filter(|part| part.weight >= LEAST_WEIGHT)?;
        i32::try_from(part.rows / i64::try_from(part.weight).ok()?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_full_of_texture_counts_little_more_than_another() {
        let mut places = Places::new();
        for twice in [[-250, -150], [-250, 150], [250, -150], [250, 150]] {
            // In one of the corners the lens moves all by half a pixel.
            let (blocks, q8) = if twice == [250, 150] { (1000, 128) } else { (20, 0) };
            for _ in 0..blocks {
                places.add(twice, [320, 240], (0, q8), 4095);
            }
        }
        let found = places.solve([320, 240]).unwrap().q16[0];
        // An eighth of a pixel if all counted alike, nearly half a pixel if blocks did.
        assert!((7000..13_000).contains(&found), "{found}");
        assert_eq!(Places::new().solve([320, 240]), None);
    }
}
