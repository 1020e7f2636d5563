//! A plane through the row offsets of blocks: offset, roll and scale by weighted least squares, in integers.

/// Bits of the largest sum when the equations are solved: products of three stay within 128 bits.
const BITS: u32 = 36;

/// Weighted sums over blocks. Places are twice their distance from the middle, px.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Line {
    /// Weights, and weights times x, y, xx, xy, yy.
    weights: [i64; 6],
    /// Weights times the offset (1/256 px), and that times x and y.
    offsets: [i64; 3],
    /// Weights times the square of the offset; squares of the weights.
    squares: [i64; 2],
    pub(super) blocks: u32,
}

/// A plane of offsets and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Plane {
    /// Offset in the middle, px, and its change a column and a row; 1/65536.
    pub(super) q16: [i32; 3],
    /// Standard errors of these.
    pub(super) errors_q16: [u32; 3],
}

impl Line {
    /// Adds a block of that weight, up to 4095, whose offset is `q8` / 256 px.
    pub(super) fn add(&mut self, [x, y]: [i32; 2], q8: i32, weight: u32) {
        let (x, y, q8, weight) = (i64::from(x), i64::from(y), i64::from(q8), i64::from(weight));
        for (sum, term) in self.weights.iter_mut().zip([1, x, y, x * x, x * y, y * y]) {
            *sum += weight * term;
        }
        for (sum, term) in self.offsets.iter_mut().zip([1, x, y]) {
            *sum += weight * term * q8;
        }
        self.squares[0] += weight * q8 * q8;
        self.squares[1] += weight * weight;
        self.blocks += 1;
    }

    /// The plane over views of `size` px; `None` without blocks.
    ///
    /// Slopes are damped as if a hundredth of the weight lay at the border and had none: where the blocks do not tell
    /// them they stay, and their errors tell.
    pub(super) fn solve(&self, size: [u16; 2]) -> Option<Plane> {
        let [w, x, y, xx, xy, yy] = self.weights;
        if w <= 0 {
            return None;
        }
        let damping = |j: usize| w / 100 * (i64::from(size[j]) * i64::from(size[j]) / 3);
        let (xx, yy) = (xx + damping(0), yy + damping(1));
        let largest = [w, xx, yy].into_iter().chain(self.offsets).map(i64::unsigned_abs).max()?;
        let shift = (u64::BITS - largest.leading_zeros()).saturating_sub(BITS);
        let [w, x, y, xx, xy, yy] = [w, x, y, xx, xy, yy].map(|sum| i128::from(sum >> shift));
        let o = self.offsets.map(|sum| i128::from(sum >> shift));
        // The matrix's cofactors: it is symmetric.
        let c = [
            [xx * yy - xy * xy, y * xy - x * yy, x * xy - y * xx],
            [y * xy - x * yy, w * yy - y * y, x * y - w * xy],
            [x * xy - y * xx, x * y - w * xy, w * xx - x * x],
        ];
        let det = w * c[0][0] + x * c[0][1] + y * c[0][2];
        if det <= 0 {
            return None;
        }
        let solved = c.map(|c| (c[0] * o[0] + c[1] * o[1] + c[2] * o[2]) * 256 / det);
        // The weighted variance of the offsets about 0, 1/65536 px^2: about the plane once passes have converged.
        let variance = i128::from(self.squares[0]) / i128::from(self.weights[0]);
        let mean_weight = i128::from(self.squares[1]) / i128::from(self.weights[0]).max(1);
        let error = |j: usize, scale: i128| {
            // 1/2^32 of a squared px, or slope.
            let share = (c[j][j] << 40) / det;
            let square = ((variance << 16) * mean_weight.max(1) * share * scale * scale) >> 40 >> shift;
            u32::try_from(square.max(0).isqrt()).unwrap_or(u32::MAX)
        };
        let q16 = |j: usize, scale: i128| i32::try_from(solved[j] * scale).unwrap_or(0);
        Some(Plane { q16: [q16(0, 1), q16(1, 2), q16(2, 2)], errors_q16: [error(0, 1), error(1, 2), error(2, 2)] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_is_found_again() {
        let (rows, roll, scale) = (0.7, -0.02, 0.011);
        let mut line = Line::default();
        for x in (-312..320).step_by(16) {
            for y in (-232..240).step_by(16) {
                let at = rows + (roll * f64::from(x) + scale * f64::from(y)) / 2.0;
                #[expect(clippy::cast_possible_truncation, reason = "small")]
                line.add([x, y], (at * 256.0).round() as i32, 700 + (x + y).unsigned_abs());
            }
        }
        let plane = line.solve([320, 240]).unwrap();
        for ((found, wanted), most) in plane.q16.into_iter().zip([rows, roll, scale]).zip([0.01, 0.001, 0.001]) {
            assert!((f64::from(found) / 65_536.0 - wanted).abs() < most, "{plane:?}");
        }
        assert_eq!(Line::default().solve([320, 240]), None);
    }

    #[test]
    fn errors_shrink_with_the_blocks_and_tell_what_a_column_of_blocks_cannot() {
        let errors = |xs: core::ops::Range<i32>, times: i32| {
            let mut line = Line::default();
            for i in 0..times {
                for x in xs.clone().step_by(16) {
                    for y in (-232..240).step_by(16) {
                        line.add([x, y], if (x / 16 + y / 16 + i) % 2 == 0 { 40 } else { -40 }, 500);
                    }
                }
            }
            line.solve([320, 240]).unwrap().errors_q16
        };
        let (one, many) = (errors(-312..320, 1), errors(-312..320, 16));
        assert!((3 * many[0]..5 * many[0]).contains(&one[0]), "{one:?} {many:?}");
        // 40 / 256 px, 1200 blocks.
        let wanted = 40.0 * 256.0 / f64::from(1200_u16).sqrt();
        assert!((f64::from(one[0]) / wanted - 1.0).abs() < 0.05, "{one:?} {wanted}");
        assert!(errors(-8..8, 1)[1] > 4 * one[1]);
    }
}
