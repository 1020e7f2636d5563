//! A row's place in the other view, as far as an offset, a roll and a scale tell it.

/// Where the right view has the rows of the left one.
///
/// What the left view shows in row `y`, the right one shows in its column `x` in row
/// `y + rows + roll (x - cx) + scale (y - cy)`, where `cx`, `cy` is the middle of a view. All three are fixed
/// point, 1/65536.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Ramp {
    /// Row offset in the middle of the right view, 1/65536 px; within ±[`Ramp::MAX_ROWS_Q16`].
    pub rows_q16: i32,
    /// Rows a column, 1/65536: the tangent of the roll; positive where points to the right lie lower. Within
    /// ±[`Ramp::MAX_SLOPE_Q16`].
    pub roll_q16: i32,
    /// Rows a row, 1/65536: how much higher the right view is than the left one. Within ±[`Ramp::MAX_SLOPE_Q16`].
    pub scale_q16: i32,
}

impl Ramp {
    /// Greatest magnitude of the row offset: 16 px.
    pub const MAX_ROWS_Q16: i32 = 16 << 16;
    /// Greatest magnitude of roll and scale: 0.1.
    pub const MAX_SLOPE_Q16: i32 = 6554;

    /// A row offset alone, px.
    #[must_use]
    pub const fn whole(rows: i8) -> Self {
        Self { rows_q16: (rows as i32) << 16, roll_q16: 0, scale_q16: 0 }
    }

    /// Whether all three are in their range.
    #[must_use]
    pub const fn is_valid(&self) -> bool {
        self.rows_q16.unsigned_abs() <= Self::MAX_ROWS_Q16.unsigned_abs()
            && self.roll_q16.unsigned_abs() <= Self::MAX_SLOPE_Q16.unsigned_abs()
            && self.scale_q16.unsigned_abs() <= Self::MAX_SLOPE_Q16.unsigned_abs()
    }

    /// The rows between a point's two places, 1/65536 px; the point is told by twice its distance from the middle
    /// of the view, columns (of the right view) first.
    #[must_use]
    pub const fn displacement_q16(&self, twice: [i32; 2]) -> i32 {
        self.rows_q16 + (self.roll_q16 * twice[0] + self.scale_q16 * twice[1]) / 2
    }

    /// Whether nothing is displaced.
    #[must_use]
    pub const fn is_straight(&self) -> bool {
        self.rows_q16 == 0 && self.roll_q16 == 0 && self.scale_q16 == 0
    }

    /// Whether the left view's rows lie between two of the right view anywhere.
    #[must_use]
    pub const fn is_between_rows(&self) -> bool {
        self.rows_q16 & 0xffff != 0 || self.roll_q16 != 0 || self.scale_q16 != 0
    }

    /// Rows of both views together that must wait for each other: the capacity of a [`Rectifier`](super::Rectifier).
    #[must_use]
    pub const fn rows_needed(&self, size: [u16; 2]) -> usize {
        let [left, right] = self.rows_of_views(size);
        left + right
    }

    /// Rows that the rings of both views hold, the newest included.
    pub(super) const fn rows_of_views(&self, size: [u16; 2]) -> [usize; 2] {
        let [least, most] = self.extremes_q16(size);
        // Whole rows upwards and downwards.
        let (up, down) = (-((-most) >> 16), least >> 16);
        // Between rows the left view is softened by the rows above and below, and noise is measured on three of either view.
        let beside = self.is_between_rows() as i32;
        let waits = if up > beside { up } else { beside };
        let behind = if waits > down { waits - down } else { 0 };
        let right = behind.unsigned_abs() as usize + 1;
        [(waits + beside).unsigned_abs() as usize + 1, if beside > 0 && right < 3 { 3 } else { right }]
    }

    /// Least and greatest displacement within views of that size, 1/65536 px.
    #[must_use]
    pub const fn extremes_q16(&self, [width, height]: [u16; 2]) -> [i32; 2] {
        let (x, y) = (width as i32 - 1, height as i32 - 1);
        let beside = ((self.roll_q16 * x).abs() + (self.scale_q16 * y).abs()) / 2;
        [self.rows_q16 - beside, self.rows_q16 + beside]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extremes_lie_in_the_corners() {
        let ramp = Ramp { rows_q16: 5 << 16, roll_q16: -2000, scale_q16: 1000 };
        let corners = [[-319, -239], [319, -239], [-319, 239], [319, 239]].map(|twice| ramp.displacement_q16(twice));
        let extremes = ramp.extremes_q16([320, 240]);
        assert_eq!(extremes[0], *corners.iter().min().unwrap());
        assert_eq!(extremes[1], *corners.iter().max().unwrap());
        assert!(ramp.is_valid() && !Ramp { roll_q16: 7000, ..ramp }.is_valid());
    }
}
