//! Which of two views is the left one: what the disparities say, and how far they reach.

/// Disparities on each side of 0, px at half the size.
const SIDE: i32 = 256;

/// The disparities of blocks.
#[derive(Debug, Clone)]
pub(super) struct Disparities {
    /// Weight of each disparity from -256 on.
    histogram: [u32; 2 * SIDE as usize],
    /// Sums of weights, and of weights times disparity, row, and their products: dd, dy, yy.
    sums: [i64; 6],
}

impl Disparities {
    pub(super) const fn new() -> Self {
        Self { histogram: [0; 2 * SIDE as usize], sums: [0; 6] }
    }

    pub(super) fn clear(&mut self) {
        self.histogram.fill(0);
        self.sums = [0; 6];
    }

    /// Adds a block of that weight in a row (twice its distance from the middle, px of the full size), of views of which the right one
    /// is rolled: that changes disparities, px at half the size, from row to row, which is not the ground's doing.
    pub(super) fn add(&mut self, disparity: i16, row: i32, roll_q16: i32, weight: u32) {
        let index = usize::try_from(i32::from(disparity) + SIDE).unwrap_or(0);
        if let Some(bin) = self.histogram.get_mut(index) {
            *bin = bin.saturating_add(weight);
        }
        // In 1/16; half a px of the full size is a quarter at half the size.
        let d = 16 * i64::from(disparity) - ((i64::from(roll_q16) * i64::from(row)) >> 14);
        let (y, weight) = (i64::from(row), i64::from(weight));
        for (sum, term) in self.sums.iter_mut().zip([1, d, y, d * d, d * y, y * y]) {
            *sum += weight * term;
        }
    }

    /// The disparities that leave out so many per mille on each side; `None` without any.
    pub(super) fn between(&self, per_mille: u64) -> Option<[i32; 2]> {
        let total: u64 = self.histogram.iter().map(|&bin| u64::from(bin)).sum();
        if total == 0 {
            return None;
        }
        let limit = total * per_mille / 1000;
        let first = edge((0..).zip(&self.histogram), limit)?;
        let last = edge((0..2 * SIDE).rev().zip(self.histogram.iter().rev()), limit)?;
        Some([first, last.max(first)])
    }

    /// The correlation of disparity and row, percent: the ground is nearer below.
    pub(super) fn ground_percent(&self) -> i8 {
        let [n, d, y, dd, dy, yy] = self.sums.map(i128::from);
        let (dd, dy, yy) = (n * dd - d * d, n * dy - d * y, n * yy - y * y);
        let whole = dd.max(0).isqrt() * yy.max(0).isqrt();
        i8::try_from(dy * 100 / whole.max(1)).unwrap_or(0)
    }
}

/// The first bin with which the sum exceeds the limit, as a disparity.
fn edge<'a>(mut bins: impl Iterator<Item = (i32, &'a u32)>, limit: u64) -> Option<i32> {
    let mut sum = 0;
    let (at, _) = bins.find(|(_, bin)| {
        sum += u64::from(**bin);
        sum > limit
    })?;
    Some(at - SIDE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ground_and_range_change_with_the_order() {
        for (sign, wanted) in [(1, 100), (-1, -100)] {
            let mut found = Disparities::new();
            for row in -100..100_i16 {
                found.add(sign * (20 + row / 10), row.into(), 0, 3);
            }
            assert!((i32::from(found.ground_percent()) - wanted).abs() <= 2, "{}", found.ground_percent());
            let between = found.between(50).unwrap();
            assert_eq!(between, if sign > 0 { [11, 28] } else { [-28, -11] });
        }
        let none = Disparities::new();
        assert_eq!((none.ground_percent(), none.between(10)), (0, None));
    }

    #[test]
    fn a_roll_is_not_the_ground() {
        // A plane far away, rolled by 0.02: half a px of the full size in 50 rows of it.
        let mut found = Disparities::new();
        for row in (-240..=240).step_by(8) {
            let disparity = i16::try_from((20 * 65_536 + 1311 * row / 4) >> 16).unwrap();
            found.add(disparity, row, 1311, 3);
        }
        assert!(found.ground_percent().abs() < 30, "{}", found.ground_percent());
    }
}
