//! Where the pixels of rectified views lie in the views of the cameras: coarse tables, cubic between their nodes.

/// Distance of nodes, px, across and down.
pub const NODE_PX: usize = 32;
/// Columns that share a place and weights.
pub(super) const RUN: usize = 4;
/// Runs between two nodes.
const RUNS: usize = NODE_PX / RUN;
/// Node columns of the widest view.
pub(super) const MAX_NODE_COLUMNS: usize = node_count(1280);

/// Nodes along a side of so many pixels: one before the first pixel, two after the last one.
#[must_use]
pub const fn node_count(px: u16) -> usize {
    (px as usize).div_ceil(NODE_PX) + 3
}

/// Where one camera saw what a rectified view shows.
///
/// Node (i, j), at `nodes[j * node_count(width) + i]`, is that of the rectified pixel in column `32 (i - 1)` and row `32 (j - 1)`: how much
/// further right and further down it lies in the camera's view, 1/64 px. Between nodes it is Catmull-Rom's cubic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LensTable {
    nodes: &'static [[i16; 2]],
    size: [u16; 2],
}

/// A place in the camera's view, 1/65536 px: column, row.
pub(super) type Place = [i32; 2];

impl LensTable {
    /// Most that a node may be displaced, 1/64 px: 500 px.
    pub const MAX_NODE: u16 = 32_000;

    /// For rectified views of `size` px; `None` unless there are [`node_count`] of the width times of the height nodes, each
    /// within ±[`LensTable::MAX_NODE`].
    #[must_use]
    pub const fn new(size: [u16; 2], nodes: &'static [[i16; 2]]) -> Option<Self> {
        if nodes.len() != node_count(size[0]) * node_count(size[1]) || size[0] > 1280 {
            return None;
        }
        let mut i = 0;
        while i < nodes.len() {
            if nodes[i][0].unsigned_abs() > Self::MAX_NODE || nodes[i][1].unsigned_abs() > Self::MAX_NODE {
                return None;
            }
            i += 1;
        }
        Some(Self { nodes, size })
    }

    /// Columns and rows of the views, px.
    #[must_use]
    pub const fn size(&self) -> [u16; 2] {
        self.size
    }

    /// The nodes, row by row.
    #[must_use]
    pub const fn nodes(&self) -> &'static [[i16; 2]] {
        self.nodes
    }

    /// The places of row `y` at the node columns.
    pub(super) fn row(&self, y: u32, places: &mut [Place; MAX_NODE_COLUMNS]) {
        let columns = node_count(self.size[0]);
        let (above, step) = ((y as usize / NODE_PX) * columns, y as usize % NODE_PX);
        let weights = cubic_q14(step);
        let rows = [0, 1, 2, 3].map(|j| self.nodes.get(above + j * columns..).unwrap_or(&[]));
        let base = i32::try_from(y).unwrap_or(0) << 16;
        let nodes = rows[0].iter().zip(rows[1]).zip(rows[2]).zip(rows[3]);
        let mut x = -(1 << 21);
        for (place, (((a, b), c), d)) in places.iter_mut().take(columns).zip(nodes) {
            let mix = |k: usize| {
                i32::from(a[k]) * weights[0]
                    + i32::from(b[k]) * weights[1]
                    + i32::from(c[k]) * weights[2]
                    + i32::from(d[k]) * weights[3]
            };
            // 1/64 px by 1/16384.
            *place = [x + (mix(0) >> 4), base + (mix(1) >> 4)];
            x += 1 << 21;
        }
    }

    /// Where the camera saw the pixel in column `x` and row `y`, 1/65536 px, as [`Rectifier`](super::Rectifier) takes it.
    #[must_use]
    pub fn place_q16(&self, [x, y]: [u16; 2]) -> [i32; 2] {
        let mut places = [[0; 2]; MAX_NODE_COLUMNS];
        self.row(y.into(), &mut places);
        let at = usize::from(x) / NODE_PX;
        let t = i32::from(x) % 32;
        [0, 1].map(|k| {
            let [a, b, c] = quadratic([0, 1, 2, 3].map(|i| places.get(at + i).map_or(0, |place| place[k])));
            a + ((b * t) >> 5) + ((((c * t) >> 5) * t) >> 5)
        })
    }
}

/// Catmull-Rom's weights at so many 32nds between the second and the third node, 1/16384.
const fn cubic_q14(step: usize) -> [i32; 4] {
    #[expect(clippy::cast_possible_wrap, clippy::cast_possible_truncation, reason = "below 32")]
    let t = (step % NODE_PX) as i32;
    let (square, cube) = (t * t, t * t * t);
    let a = (64 * square - 1024 * t - cube) / 4;
    let c = (1024 * t + 128 * square - 3 * cube) / 4;
    let d = (cube - 32 * square) / 4;
    [a, 16_384 - a - c - d, c, d]
}

/// The parabola through Catmull-Rom's cubic at both ends and in the middle of a segment: `a + b t + c t^2`, `t` from 0 to 1.
const fn quadratic([p0, p1, p2, p3]: [i32; 4]) -> [i32; 3] {
    let c = (p0 - p1 - p2 + p3) >> 2;
    [p1, p2 - p1 - c, c]
}

/// Places of the runs of a segment: the first one and its differences.
#[derive(Clone, Copy)]
pub(super) struct Steps {
    pub(super) at: i32,
    pub(super) step: i32,
    pub(super) bend: i32,
}

impl Steps {
    /// Of a segment's four nodes, in the middle of each run of four columns.
    #[inline(always)]
    pub(super) const fn new(nodes: [i32; 4]) -> Self {
        let [a, b, c] = quadratic(nodes);
        // At t = 1.5 / 32, 5.5 / 32, ...
        Self { at: a + ((48 * b + 2 * c) >> 10), step: (32 * b + 7 * c) >> 8, bend: c >> 5 }
    }

    #[inline(always)]
    pub(super) const fn advance(&mut self) {
        self.at += self.step;
        self.step += self.bend;
    }
}

/// The four nodes around a segment.
#[inline(always)]
pub(super) fn segment(places: &[Place; MAX_NODE_COLUMNS], index: usize) -> [Place; 4] {
    let mut nodes = [[0; 2]; 4];
    if let Some(found) = places.get(index..index + 4) {
        nodes.copy_from_slice(found);
    }
    nodes
}

/// Least and greatest row of the places of all runs of a row of `width` px, 1/65536 px: bounds that no run exceeds.
pub(super) fn reach(places: &[Place; MAX_NODE_COLUMNS], width: usize) -> [i32; 2] {
    let mut reach = [i32::MAX, i32::MIN];
    let segments = width.div_ceil(NODE_PX);
    for nodes in places.get(..segments + 3).unwrap_or(&[]).windows(4) {
        let [a, b, c, d] = [nodes[0][1], nodes[1][1], nodes[2][1], nodes[3][1]];
        // A parabola rises over its ends by a quarter of its square term; the rest is for rounding.
        let beyond = (((a - b - c + d) >> 4).abs()) + 64;
        reach = [reach[0].min(b.min(c) - beyond), reach[1].max(b.max(c) + beyond)];
    }
    reach
}

/// Makes a row: four columns at a time by one place and one pair of weights of 1/16, from two rows of the camera.
///
/// `row` finds a row of the camera by its number, clamped to those that there are.
#[inline(always)]
pub(super) fn render<'a, const WIDTH: usize>(
    places: &[Place; MAX_NODE_COLUMNS],
    row: impl Fn(i32) -> &'a [u8; WIDTH],
    width: usize,
    out: &mut [u8; WIDTH],
) {
    /// To the nearest 1/16 px.
    const HALF: i32 = 1 << 11;
    let limit = u32::try_from(width.min(WIDTH).saturating_sub(RUN + 1)).unwrap_or(0);
    let mut at = i32::MIN;
    let (mut above, mut below) = (row(0), row(0));
    let Some(out) = out.get_mut(..width) else { return };
    for (index, pixels) in out.chunks_mut(NODE_PX).enumerate() {
        let nodes = segment(places, index);
        let mut across = Steps::new([0, 1, 2, 3].map(|i| nodes[i][0]));
        let mut down = Steps::new([0, 1, 2, 3].map(|i| nodes[i][1]));
        // From the middle of a run to its first column.
        across.at += HALF - (3 << 15);
        down.at += HALF;
        let (runs, rest) = pixels.as_chunks_mut::<RUN>();
        debug_assert!(runs.len() <= RUNS, "a segment has so many");
        for run in runs {
            if down.at >> 16 != at {
                at = down.at >> 16;
                (above, below) = (row(at), row(at + 1));
            }
            *run = four(above, below, [across.at, down.at], limit);
            across.advance();
            down.advance();
        }
        if !rest.is_empty() {
            let at = down.at >> 16;
            let mixed = four(row(at), row(at + 1), [across.at, down.at], limit);
            rest.iter_mut().zip(mixed).for_each(|(pixel, mixed)| *pixel = mixed);
        }
    }
}

/// Four pixels from `place` on; `limit` is the last column from which five can be read.
#[inline(always)]
fn four<const WIDTH: usize>(above: &[u8; WIDTH], below: &[u8; WIDTH], place: Place, limit: u32) -> [u8; RUN] {
    let x = (place[0] >> 16).cast_unsigned();
    let weights = place.map(|q16| (q16 >> 12 & 15).cast_unsigned());
    if x <= limit
        && let (Some(above), Some(below)) = (five(above, x), five(below, x))
    {
        return mix(above, below, weights);
    }
    let edge = |row: &[u8; WIDTH]| {
        let last = i64::from(limit) + 4;
        let first = i64::from(place[0] >> 16);
        let at = |i: i64| row.get(usize::try_from((first + i).clamp(0, last)).unwrap_or(0)).copied().unwrap_or(0);
        let four = |first: i64| u32::from_le_bytes([0, 1, 2, 3].map(|i| at(first + i)));
        [four(0), four(1)]
    };
    mix(edge(above), edge(below), weights)
}

/// Columns `x` to `x + 3` and the same one further right.
#[inline(always)]
fn five<const WIDTH: usize>(row: &[u8; WIDTH], x: u32) -> Option<[u32; 2]> {
    let five = row.get(x as usize..)?.first_chunk::<{ RUN + 1 }>()?;
    let [a, b, c, d, e] = *five;
    Some([u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([b, c, d, e])])
}

/// Four pixels between two rows and between columns, two in the lanes of a word at once.
#[inline(always)]
const fn mix(above: [u32; 2], below: [u32; 2], [across, down]: [u32; 2]) -> [u8; RUN] {
    const LANES: u32 = 0x00FF_00FF;
    const HALF: u32 = 0x0080_0080;
    let up = 16 - down;
    // Columns 0 and 2, 1 and 3, 2 and 4; at most 255 * 16 in a lane.
    let first = (above[0] & LANES) * up + (below[0] & LANES) * down;
    let second = (above[0] >> 8 & LANES) * up + (below[0] >> 8 & LANES) * down;
    let third = (above[1] >> 8 & LANES) * up + (below[1] >> 8 & LANES) * down;
    // At most 255 * 256 + 128, below 2^16.
    let back = 16 - across;
    let even = first * back + second * across + HALF;
    let odd = second * back + third * across + HALF;
    (even >> 8 & LANES | odd & !LANES).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_and_hit_the_nodes() {
        assert_eq!(cubic_q14(0), [0, 16_384, 0, 0]);
        assert_eq!(cubic_q14(16), [-1024, 9216, 9216, -1024]);
        for step in 0..NODE_PX {
            assert_eq!(cubic_q14(step).iter().sum::<i32>(), 16_384);
        }
    }

    #[test]
    fn steps_follow_the_parabola() {
        let nodes = [0, 30 << 16, 61 << 16, 93 << 16];
        let [a, b, c] = quadratic(nodes);
        let mut steps = Steps::new(nodes);
        for run in 0..8 {
            let t = (1.5 + 4.0 * f64::from(run)) / 32.0;
            let wanted = f64::from(a) + f64::from(b) * t + f64::from(c) * t * t;
            assert!((f64::from(steps.at) - wanted).abs() < 40.0, "{run}: {} {wanted}", steps.at);
            steps.advance();
        }
    }

    #[test]
    fn pixels_are_mixed_bilinearly() {
        let (above, below) = ([10, 20, 40, 80, 160, 7, 7, 7], [110, 120, 140, 180, 255, 7, 7, 7]);
        for (across, down) in [(0, 0), (8, 0), (0, 8), (5, 11), (15, 15)] {
            let found = four(&above, &below, [across << 12, down << 12], 3);
            for (i, &found) in found.iter().enumerate() {
                let row = |row: &[u8; 8]| {
                    f64::from(row[i]) + (f64::from(row[i + 1]) - f64::from(row[i])) * f64::from(across) / 16.0
                };
                let wanted = row(&above) + (row(&below) - row(&above)) * f64::from(down) / 16.0;
                assert!((f64::from(found) - wanted).abs() <= 0.5, "{i}: {found} {wanted}");
            }
        }
        // Beyond the borders these repeat.
        assert_eq!(four(&above, &below, [-(2 << 16), 0], 3), [10, 10, 10, 20]);
        assert_eq!(four(&above, &below, [6 << 16, 0], 3), [7; 4]);
    }

    #[test]
    fn tables_of_another_size_are_none() {
        const FLAT: [[i16; 2]; 13 * 11] = [[0; 2]; 13 * 11];
        assert!(LensTable::new([320, 240], &FLAT).is_some());
        assert!(LensTable::new([320, 260], &FLAT).is_none());
        assert!(LensTable::new([320, 240], &[[i16::MIN; 2]; 13 * 11]).is_none());
        assert_eq!(LensTable::new([320, 240], &FLAT).unwrap().place_q16([77, 130]), [77 << 16, 130 << 16]);
    }
}
