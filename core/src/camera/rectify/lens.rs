//! Where the pixels of rectified views lie in the views of the cameras: coarse tables, cubic between their nodes.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "a handful of rows, windows of some columns"
)]

use crate::lanes::lens_runs::KNOT_BITS;
pub(super) use crate::lanes::lens_runs::KNOT_ROWS;
use crate::lanes::lens_runs::{
    Curve, RUN, SEGMENT, Segment, View, aim, beside, copy, curves, make, mix, mix_run, places, skip, start,
};

/// Distance of nodes, px, across and down.
pub const NODE_PX: usize = SEGMENT;
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

    /// The places at the node columns of row `y`, of the view or [`KNOT_ROWS`] below it at most.
    pub(super) fn row(&self, y: u32, places: &mut [Place; MAX_NODE_COLUMNS]) {
        let columns = node_count(self.size[0]);
        // The last row below the view is the end of the segment above it.
        let segments = usize::from(self.size[1]).div_ceil(NODE_PX);
        let segment = (y as usize / NODE_PX).min(segments.saturating_sub(1));
        let (above, step) = (segment * columns, y as usize - segment * NODE_PX);
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
        const ROWS: u16 = 1 << KNOT_BITS;
        let (step, t) = (i32::from(y % ROWS), i32::from(x) % 32);
        let knot = y - y % ROWS;
        let [above, below] = [knot, knot + ROWS].map(|y| {
            let mut places = [[0; 2]; MAX_NODE_COLUMNS];
            self.row(y.into(), &mut places);
            let nodes = segment(&places, usize::from(x) / NODE_PX);
            [0, 1].map(|k| {
                let [a, b, c] = quadratic([0, 1, 2, 3].map(|i| nodes[i][k]));
                a + ((b * t) >> 5) + ((((c * t) >> 5) * t) >> 5)
            })
        });
        [0, 1].map(|k| above[k] + (((below[k] - above[k]) * step) >> KNOT_BITS))
    }
}

/// Catmull-Rom's weights at so many 32nds from the second to the third node, 1/16384.
const fn cubic_q14(step: usize) -> [i32; 4] {
    #[expect(clippy::cast_possible_wrap, clippy::cast_possible_truncation, reason = "at most 36")]
    let t = step as i32;
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

/// The four nodes around a segment.
#[inline(always)]
pub(super) fn segment(places: &[Place; MAX_NODE_COLUMNS], index: usize) -> [Place; 4] {
    let mut nodes = [[0; 2]; 4];
    if let Some(found) = places.get(index..index + 4) {
        nodes.copy_from_slice(found);
    }
    nodes
}

/// Where the runs of a segment lie across and down, of the four nodes around it.
fn curves_of(nodes: [Place; 4]) -> [Curve; 2] {
    /// To the nearest 1/16 px.
    const HALF: i32 = 1 << 11;
    let curve = |k: usize| {
        let [a, b, c] = quadratic([0, 1, 2, 3].map(|i| nodes[i][k]));
        // The middles of runs lie at t = 1.5 / 32, 5.5 / 32, ...
        [a + ((3 * b) >> 6) + (c >> 9) + HALF, (b >> 3) + ((11 * c) >> 8), c >> 4]
    };
    let [x, step, bend] = curve(0);
    // Their first columns lie 1.5 px further left.
    [[x - (3 << 15), step, bend], curve(1)]
}

/// Least and greatest place of runs, 1/65536 px.
#[inline(always)]
fn reach(down: Curve) -> [i32; 2] {
    beside(down).map(|beside| down[0] + beside)
}

/// The segments of a row of one view, and how far down they reach.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// Least and greatest place down of all segments of the row, 1/65536 px: bounds that are not exceeded.
    at: [i32; 2],
    growth: [i32; 2],
}

impl Reach {
    /// Of nothing.
    pub(super) const NONE: Self = Self { at: [0; 2], growth: [0; 2] };

    /// Of row 0; `take` takes its segments' curves.
    pub(super) fn start(table: &LensTable, mut take: impl FnMut(usize, [Curve; 2])) -> Self {
        let at = knot(table, 0, &mut take);
        Self { at, growth: [0; 2] }
    }

    /// At a row that [`KNOT_ROWS`] divides: goes on towards the next such row; `take` takes the curves of that
    /// one's segments.
    pub(super) fn aim(&mut self, table: &LensTable, y: u32, mut take: impl FnMut(usize, [Curve; 2])) {
        let next = knot(table, y + KNOT_ROWS as u32, &mut take);
        // The greatest of what goes straight is at most what lies straight between the greatest at both ends.
        self.growth = [(next[0] - self.at[0]) >> KNOT_BITS, (next[1] - self.at[1] + KNOT_ROWS as i32 - 1) >> KNOT_BITS];
    }

    /// The same of the row below.
    pub(super) const fn advance(&mut self) {
        self.at = [self.at[0] + self.growth[0], self.at[1] + self.growth[1]];
    }

    /// First and last row of the camera, of `height` rows, that are needed.
    pub(super) fn rows(&self, height: u32) -> [u32; 2] {
        let clamp = |row: i32| u32::try_from(row).unwrap_or(0).min(height.saturating_sub(1));
        [clamp(self.at[0] >> 16), clamp((self.at[1] >> 16) + 1)]
    }
}

/// Hands out the curves of a row's segments by their number; how far down they reach, with some room for rounding.
fn knot(table: &LensTable, y: u32, take: &mut impl FnMut(usize, [Curve; 2])) -> [i32; 2] {
    // Growth rounded down from knot to knot, in a step's and a bend's share of the last run.
    const ROOM: i32 = 64 << KNOT_BITS;
    let mut places = [[0; 2]; MAX_NODE_COLUMNS];
    table.row(y, &mut places);
    let mut bounds = [i32::MAX, i32::MIN];
    for index in 0..usize::from(table.size[0]).div_ceil(NODE_PX) {
        let found = curves_of(segment(&places, index));
        let [least, most] = reach(found[1]);
        bounds = [bounds[0].min(least - ROOM), bounds[1].max(most + ROOM)];
        take(index, found);
    }
    bounds
}

/// Makes a row of `segments`, which become those of the row below, of a camera's rows as far as they came.
#[inline(always)]
pub(super) fn render<const WIDTH: usize>(
    segments: &mut [Segment],
    view: View<'_, WIDTH>,
    width: u16,
    out: &mut [u8; WIDTH],
) {
    let Some(out) = out.get_mut(..usize::from(width)) else { return };
    let (mut out, part) = out.as_chunks_mut::<SEGMENT>();
    let mut segments = segments;
    loop {
        let made = make(segments, view, out);
        let Some((segment, left)) = segments.get_mut(made..).and_then(<[_]>::split_first_mut) else { return };
        let Some((pixels, room)) = out.get_mut(made..).and_then(<[_]>::split_first_mut) else {
            by_runs(curves(segment), view, width, part);
            return skip(segment);
        };
        if !in_windows(curves(segment), view, width, pixels) {
            by_runs(curves(segment), view, width, pixels);
        }
        skip(segment);
        (segments, out) = (left, room);
    }
}

/// The row of that number; the view's borders are repeated.
fn row<'a, const WIDTH: usize>(View { rows, first: _, last }: View<'a, WIDTH>, y: i32) -> &'a [u8; WIDTH] {
    const { assert!(WIDTH > 0) }
    let place = usize::try_from(y.min(last)).unwrap_or(0).checked_rem(rows.len());
    place.and_then(|place| rows.get(place)).unwrap_or(&[0; WIDTH])
}

/// A segment that reaches beyond the view's borders, which are repeated; whether it reaches no further than there is room for.
#[inline(never)]
fn in_windows<const WIDTH: usize>(
    [mut across, mut down]: [Curve; 2],
    view: View<'_, WIDTH>,
    width: u16,
    out: &mut [u8; SEGMENT],
) -> bool {
    const ROOM: usize = 48;
    const ROWS: usize = 6;
    let [least, most] = reach(down).map(|place| place >> 16);
    let rows = usize::try_from(most - least + 2).unwrap_or(0);
    let from = across[0] >> 16;
    let mut windows = [[0; ROOM]; ROWS];
    let Some(windows) = windows.get_mut(..rows) else { return false };
    // Columns of the room that lie before the view, and from which on they lie behind it.
    let room = |at: i32| usize::try_from(at).unwrap_or(0).min(ROOM);
    let (before, behind) = (room(-from), room(i32::from(width) - from));
    for (y, window) in (least..).zip(&mut *windows) {
        let row = row(view, y);
        let row = row.get(..usize::from(width)).unwrap_or(row);
        let (left, right) = (row.first().copied().unwrap_or(0), row.last().copied().unwrap_or(0));
        if let Some((border, part)) = window.split_at_mut_checked(before) {
            border.fill(left);
            if let Some((part, border)) = part.split_at_mut_checked(behind.saturating_sub(before)) {
                copy(row.get(usize::try_from(from).unwrap_or(0)..).unwrap_or(&[]), part);
                border.fill(right);
            }
        }
    }
    across[0] -= from << 16;
    down[0] -= least << 16;
    let mut segment = [start([across, down])];
    aim::<ROOM>(&mut segment[0], [across, down], ROOM as u16 - 1);
    make(&mut segment, View { rows: windows, first: 0, last: rows as i32 - 1 }, core::slice::from_mut(out)) == 1
}

/// Pixels of a segment of which only a part is wanted, or that reaches far beyond the camera's view or lies between many rows.
#[inline(never)]
fn by_runs<const WIDTH: usize>([across, down]: [Curve; 2], view: View<'_, WIDTH>, width: u16, out: &mut [u8]) {
    for ((run, at), place) in out.chunks_mut(RUN).zip(places(across)).zip(places(down)) {
        let [above, below] = [0, 1].map(|k| row(view, (place >> 16) + k).get(..usize::from(width)).unwrap_or(&[]));
        let down = place.cast_unsigned() >> 12 & 15;
        let mixed = mix_run(above, below, at, down)
            .unwrap_or_else(|| mix(at_border(above, at), at_border(below, at), [at.cast_unsigned() >> 12 & 15, down]));
        run.iter_mut().zip(mixed).for_each(|(pixel, mixed)| *pixel = mixed);
    }
}

/// Four pixels from a place on and the same one further right, the row's borders repeated.
#[inline(never)]
fn at_border(row: &[u8], place: i32) -> [u32; 2] {
    let at = |i: i32| {
        let x = usize::try_from((place >> 16) + i).unwrap_or(0).min(row.len().saturating_sub(1));
        row.get(x).copied().unwrap_or(0)
    };
    let four = |first: i32| u32::from_le_bytes([0, 1, 2, 3].map(|i| at(first + i)));
    [four(0), four(1)]
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
    fn runs_follow_the_parabola() {
        let nodes = [0, 30 << 16, 61 << 16, 93 << 16];
        let [a, b, c] = quadratic(nodes);
        let [across, down] = curves_of(nodes.map(|node| [node; 2])).map(places);
        for (run, (x, y)) in (0..8).zip(across.into_iter().zip(down)) {
            let t = (4.0 * f64::from(run) + 1.5) / 32.0;
            let place = f64::from(a) + f64::from(b) * t + f64::from(c) * t * t + 2048.0;
            assert!((f64::from(y) - place).abs() < 2000.0, "{run}: {y} {place}");
            assert!((f64::from(x) - place + 1.5 * 65_536.0).abs() < 2000.0, "{run}: {x} {place}");
        }
    }

    #[test]
    fn borders_are_repeated() {
        let (above, below) = ([10, 20, 40, 80, 160, 7, 7, 7], [110, 120, 140, 180, 255, 7, 7, 7]);
        let mixed =
            |at: i32, down| mix(at_border(&above, at), at_border(&below, at), [at.cast_unsigned() >> 12 & 15, down]);
        assert_eq!(mixed(-(2 << 16), 0), [10, 10, 10, 20]);
        assert_eq!(mixed(6 << 16, 0), [7; 4]);
        assert_eq!(mixed(1 << 15, 8), [65, 80, 110, 169]);
    }

    #[test]
    fn between_knots_nothing_reaches_beyond_the_bounds() {
        const BENT: [[i16; 2]; 6 * 6] = {
            let mut nodes = [[0; 2]; 36];
            let mut i = 0;
            while i < 36 {
                nodes[i][1] = (i * i * 7 % 401) as i16 - 200;
                i += 1;
            }
            nodes
        };
        let table = LensTable::new([96, 96], &BENT).unwrap();
        let mut segments = [start([[0; 3]; 2]); 3];
        let mut bounds = Reach::start(&table, |i, curves| segments[i] = start(curves));
        for y in 0..96 {
            if y % KNOT_ROWS as u32 == 0 {
                bounds.aim(&table, y, |i, curves| aim::<96>(&mut segments[i], curves, 95));
            }
            for (i, segment) in segments.iter_mut().enumerate() {
                let down = curves(segment)[1];
                let [least, most] = reach(down);
                assert!(bounds.at[0] <= least && bounds.at[1] >= most, "{y}: {:?} {least} {most}", bounds.at);
                let x = 32 * u16::try_from(i).unwrap() + 2;
                let place =
                    [x - 1, x].map(|x| table.place_q16([x, u16::try_from(y).unwrap()])[1]).iter().sum::<i32>() / 2;
                let found = down[0] - 2048;
                assert!((place - found).abs() < 400, "{x}, {y}: {place} {found}");
                skip(segment);
            }
            bounds.advance();
        }
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
