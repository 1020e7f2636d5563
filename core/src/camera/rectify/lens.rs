//! Where the pixels of rectified views lie in the views of the cameras: coarse tables, cubic between their nodes.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "a handful of rows, windows of some columns"
)]

use crate::lanes::lens_runs::{Across, Down, RUN, SEGMENT, advance, copy, mix, mix_run, mix_segment, places};

/// Distance of nodes, px, across and down.
pub const NODE_PX: usize = SEGMENT;
/// Rows between which places go straight.
pub(super) const KNOT_ROWS: usize = 8;
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
        let (step, t) = (i32::from(y) % 8, i32::from(x) % 32);
        let knot = y - y % 8;
        let [above, below] = [knot, knot + 8].map(|y| {
            let mut places = [[0; 2]; MAX_NODE_COLUMNS];
            self.row(y.into(), &mut places);
            let nodes = segment(&places, usize::from(x) / NODE_PX);
            [0, 1].map(|k| {
                let [a, b, c] = quadratic([0, 1, 2, 3].map(|i| nodes[i][k]));
                a + ((b * t) >> 5) + ((((c * t) >> 5) * t) >> 5)
            })
        });
        [0, 1].map(|k| above[k] + (((below[k] - above[k]) * step) >> 3))
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

/// Where the pixels of a segment lie: a parabola across and one down, and how much they move from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Segment {
    down: Down,
    across: Across,
}

impl Segment {
    /// Numbers of a segment.
    pub(super) const LEN: usize = 11;

    /// Of the four nodes around it.
    fn new(nodes: [Place; 4]) -> Self {
        /// To the nearest 1/16 px.
        const HALF: i32 = 1 << 11;
        let [a, b, c] = quadratic([0, 1, 2, 3].map(|i| nodes[i][0]));
        // The middles of runs lie at t = 1.5 / 32, 5.5 / 32, ..., their first columns 1.5 px further left.
        let across = [a + ((48 * b + 2 * c) >> 10) - (3 << 15) + HALF, (32 * b + 11 * c) >> 8, c >> 4, 0, 0];
        let [a, b, c] = quadratic([0, 1, 2, 3].map(|i| nodes[i][1]));
        let down = [a + ((48 * b + 2 * c) >> 10) + HALF, (32 * b + 7 * c) >> 8, c >> 5, 0, 0, 0];
        Self { down, across }
    }

    const fn unpack(numbers: &[i32; Self::LEN]) -> Self {
        let [a, b, c, d, e, f, g, h, i, j, k] = *numbers;
        Self { down: [a, b, c, d, e, f], across: [g, h, i, j, k] }
    }

    pub(super) const fn pack(&self, numbers: &mut [i32; Self::LEN]) {
        let Self { down: [a, b, c, d, e, f], across: [g, h, i, j, k] } = *self;
        *numbers = [a, b, c, d, e, f, g, h, i, j, k];
    }

    /// Goes on from this row so that after [`KNOT_ROWS`] rows it is `knot`.
    fn towards(&self, knot: &Self) -> Self {
        let growth = |from: i32, to: i32| (to - from) >> 3;
        let ([a, b, c, ..], [d, e, f, ..]) = (self.down, knot.down);
        let down = [a, b, c, growth(a, d), growth(b, e), growth(c, f)];
        let ([a, b, ..], [d, e, f, ..]) = (self.across, knot.across);
        Self { down, across: [a, b, f, growth(a, d), growth(b, e)] }
    }

    /// Least and greatest place down, 1/65536 px.
    fn reach(&self) -> [i32; 2] {
        let [at, step, bend, ..] = self.down;
        let end = at + 7 * step + 21 * bend;
        // Between both ends a parabola of seven steps bends away by six of its bends, and the rest is for rounding.
        let beyond = 7 * bend.abs();
        [at.min(end) - beyond, at.max(end) + beyond]
    }
}

/// Place of the middle of a segment's first run down, 1/65536 px.
pub(super) const fn first_down(numbers: &[i32; Segment::LEN]) -> i32 {
    numbers[0]
}

/// Both parts of a segment's numbers.
#[inline(always)]
fn parts(numbers: &mut [i32; Segment::LEN]) -> (&mut Down, &mut Across) {
    const NONE: &str = "a segment has six numbers down and five across";
    let (down, across) = numbers.split_at_mut(6);
    (down.try_into().expect(NONE), across.try_into().expect(NONE))
}

/// Goes on to the row below where that one was not made.
pub(super) fn skip(numbers: &mut [i32; Segment::LEN]) {
    let [a, b, c, d, e, f, g, h, _, j, k] = numbers;
    for (number, growth) in [(a, d), (b, e), (c, f), (g, j), (h, k)] {
        *number += *growth;
    }
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

    /// Of row 0; `packed` takes its segments.
    pub(super) fn start(table: &LensTable, mut take: impl FnMut(usize, Segment)) -> Self {
        let at = knot(table, 0, &mut take);
        Self { at, growth: [0; 2] }
    }

    /// At a row that [`KNOT_ROWS`] divides: goes on towards the next such row; `take` takes that one's segments.
    pub(super) fn aim(&mut self, table: &LensTable, y: u32, mut take: impl FnMut(usize, Segment)) {
        let next = knot(table, y + KNOT_ROWS as u32, &mut take);
        // The greatest of what goes straight is at most what lies straight between the greatest at both ends.
        self.growth = [(next[0] - self.at[0]) >> 3, (next[1] - self.at[1] + 7) >> 3];
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

/// Hands out the segments of a row by their number; how far down they reach, with some room for rounding.
fn knot(table: &LensTable, y: u32, take: &mut impl FnMut(usize, Segment)) -> [i32; 2] {
    // Eight rows of growth rounded down, in a step's and a bend's share of the last run.
    const ROOM: i32 = 512;
    let mut places = [[0; 2]; MAX_NODE_COLUMNS];
    table.row(y, &mut places);
    let mut reach = [i32::MAX, i32::MIN];
    for index in 0..usize::from(table.size[0]).div_ceil(NODE_PX) {
        let found = Segment::new(segment(&places, index));
        let [least, most] = found.reach();
        reach = [reach[0].min(least - ROOM), reach[1].max(most + ROOM)];
        take(index, found);
    }
    reach
}

/// Goes on towards the segment of the next knot.
pub(super) fn aim(numbers: &mut [i32; Segment::LEN], knot: &Segment) {
    Segment::unpack(numbers).towards(knot).pack(numbers);
}

/// Makes a row of the segments in `numbers`, which become those of the row below.
///
/// `row` finds a row of the camera by its number, clamped to those that there are.
#[inline(always)]
pub(super) fn render<'a, const WIDTH: usize>(
    numbers: &mut [[i32; Segment::LEN]],
    row: impl Fn(i32) -> &'a [u8; WIDTH],
    width: u16,
    out: &mut [u8; WIDTH],
) {
    let Some(out) = out.get_mut(..usize::from(width)) else { return };
    let last = width.saturating_sub(1);
    // The two rows that the pixels lie between, and the number of the upper one.
    let (mut rows, mut at) = ([row(0), row(1)], 0);
    let (whole, part) = out.as_chunks_mut::<SEGMENT>();
    let mut whole = whole.iter_mut();
    for numbers in numbers {
        let (down, across) = parts(numbers);
        let before = *down;
        let Some(pixels) = whole.next() else {
            by_runs(before, *across, &row, width, part);
            skip(numbers);
            return;
        };
        let (first, weights, differ) = advance(down);
        if first >> 16 != at {
            at = first >> 16;
            rows = [row(at), row(at + 1)];
        }
        let (mut switch, mut then) = (0, rows);
        let mut is_simple = true;
        if differ != 0 {
            let places = places(before);
            let mut changes = 0;
            for (nth, &place) in (0..).zip(&places) {
                if place >> 16 != at {
                    (at, switch) = (place >> 16, nth);
                    changes += 1;
                }
            }
            is_simple = changes == 1;
            then = [row(at), row(at + 1)];
        }
        let of_row = *across;
        let is_made = mix_segment(rows, (switch, then), across, last, weights, pixels);
        if !is_made && is_simple && beside_border(rows, (switch, then), of_row, last, weights, pixels) {
            rows = then;
            continue;
        }
        if !is_made || !is_simple {
            by_runs(before, of_row, &row, width, pixels);
        }
        rows = then;
    }
}

/// A segment that reaches beyond the view's borders, which are repeated; whether it reaches no further than it has room for.
#[inline(never)]
fn beside_border<const WIDTH: usize>(
    first: [&[u8; WIDTH]; 2],
    (switch, then): (u32, [&[u8; WIDTH]; 2]),
    mut across: Across,
    last: u16,
    weights: u32,
    out: &mut [u8; SEGMENT],
) -> bool {
    const ROOM: usize = 48;
    let from = across[0] >> 16;
    across[0] &= 0xffff;
    // Columns of the room that lie before the view, and from which on they lie behind it.
    let room = |at: i32| usize::try_from(at).unwrap_or(0).min(ROOM);
    let (before, behind) = (room(-from), room(i32::from(last) + 1 - from));
    let window = |row: &[u8; WIDTH]| {
        let row = row.get(..=usize::from(last)).unwrap_or(row);
        let mut window = [row.first().copied().unwrap_or(0); ROOM];
        if let Some(part) = window.get_mut(before..behind) {
            copy(row.get(usize::try_from(from).unwrap_or(0)..).unwrap_or(&[]), part);
        }
        if let Some(part) = window.get_mut(behind..) {
            part.fill(row.last().copied().unwrap_or(0));
        }
        window
    };
    let first = first.map(window);
    let then = if switch == 0 { first } else { then.map(window) };
    mix_segment([&first[0], &first[1]], (switch, [&then[0], &then[1]]), &mut across, ROOM as u16 - 1, weights, out)
}

/// Pixels of a segment that reaches beyond the camera's view, of which only a part is wanted, or that lies between many rows.
#[inline(never)]
fn by_runs<'a, const WIDTH: usize>(
    down: Down,
    [mut at, mut step, bend, ..]: Across,
    row: &impl Fn(i32) -> &'a [u8; WIDTH],
    width: u16,
    out: &mut [u8],
) {
    for (nth, (run, place)) in out.chunks_mut(RUN).zip(places(down)).enumerate() {
        let [above, below] = [0, 1].map(|k| row((place >> 16) + k).get(..usize::from(width)).unwrap_or(&[]));
        let down = place.cast_unsigned() >> 12 & 15;
        let mixed = mix_run(above, below, at, down)
            .unwrap_or_else(|| mix(at_border(above, at), at_border(below, at), [at.cast_unsigned() >> 12 & 15, down]));
        run.iter_mut().zip(mixed).for_each(|(pixel, mixed)| *pixel = mixed);
        at += step;
        step += if nth % 2 == 1 { bend } else { 0 };
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
        let segment = Segment::new(nodes.map(|node| [node; 2]));
        let ([mut x, mut step, bend, ..], downs) = (segment.across, places(segment.down));
        for (run, y) in (0..8).zip(downs) {
            let t = (4.0 * f64::from(run) + 1.5) / 32.0;
            let place = f64::from(a) + f64::from(b) * t + f64::from(c) * t * t + 2048.0;
            assert!((f64::from(y) - place).abs() < 200.0, "{run}: {y} {place}");
            assert!((f64::from(x) - place + 1.5 * 65_536.0).abs() < 2000.0, "{run}: {x} {place}");
            x += step;
            step += if run % 2 == 1 { bend } else { 0 };
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
        let mut numbers = [[0; Segment::LEN]; 3];
        let mut reach = Reach::start(&table, |i, segment| segment.pack(&mut numbers[i]));
        for y in 0..96 {
            if y % 8 == 0 {
                reach.aim(&table, y, |i, segment| aim(&mut numbers[i], &segment));
            }
            for (i, numbers) in numbers.iter_mut().enumerate() {
                let segment = Segment::unpack(numbers);
                let [least, most] = segment.reach();
                assert!(reach.at[0] <= least && reach.at[1] >= most, "{y}: {:?} {least} {most}", reach.at);
                let x = 32 * u16::try_from(i).unwrap() + 2;
                let place =
                    [x - 1, x].map(|x| table.place_q16([x, u16::try_from(y).unwrap()])[1]).iter().sum::<i32>() / 2;
                let found = segment.down[0] - 2048;
                assert!((place - found).abs() < 400, "{x}, {y}: {place} {found}");
                skip(numbers);
            }
            reach.advance();
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
