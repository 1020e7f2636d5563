//! Prototype of the tile pipeline.
#![allow(missing_docs, dead_code, unused, clippy::all)]

use crate::front_end::exposure::Exposure;
use crate::front_end::noise::{Noise, SmoothingLevel};
use crate::front_end::ring::{MARGIN, RowRing, replicate_borders};
use crate::front_end::view::{SMOOTH_LAG, View};
use crate::lanes;
use crate::tuning::t;
use crate::{Config, ConfigError, Disparity, DisparityRow, RowError, ScanlinePair, StereoMethod};

const FLIP: u32 = 0x8080_8080;
const NONE: i16 = i16::MIN;

#[inline]
fn word(row: &[u8], at: usize) -> u32 {
    row.get(at..at + 4).and_then(|s| s.first_chunk::<4>()).map_or(0, |&b| u32::from_le_bytes(b))
}

#[derive(Clone, Copy, Default, Debug)]
pub struct Cell {
    /// disparity - min, 1/256
    pub disp: u16,
    /// margin - 2 cost
    pub merit: i16,
    /// curvature weight
    pub weight: u8,
}

#[derive(Clone, Copy, Default)]
struct Contour {
    column: u16,
    strength: u16,
}

pub struct Tiles<const BLOCKS: usize> {
    pub full: bool,
    config: Config,
    left: View<12, BLOCKS>,
    right: View<12, BLOCKS>,
    exposure: Exposure,
    noise: Noise,
    from_left: [i16; BLOCKS],
    from_right: [i16; BLOCKS],
    labels: [u32; BLOCKS],
    labels_above: [u32; BLOCKS],
    costs: [[u32; BLOCKS]; 2],
    lefts: [[u32; BLOCKS]; 2],
    top: [u32; BLOCKS],
    s3: [u32; BLOCKS],
    cost_above: [u32; BLOCKS],
    /// Ring of cell rows, by index % 8.
    cells: [[Cell; BLOCKS]; 8],
    feature_len: u32,
    tile_rows: u32,
    rows: u32,
    answered: u32,
    pub evals: u64,
    pub tiles_done: u64,
}

fn clip2(g: u32, c1: i32, c2: i32) -> u32 {
    let clip = |c: i32| {
        let s = |v: i32| lanes::splat(v as u32 & 0xff);
        let x = lanes::signed_add(g, s(127 - c));
        let x = lanes::signed_sub(x, s(127));
        lanes::signed_sub(x, s(128 - 2 * c)) ^ FLIP
    };
    clip(c1).wrapping_add(if c2 > 0 { clip(c2) } else { 0 })
}

impl<const BLOCKS: usize> Tiles<BLOCKS> {
    pub fn new(config: Config, full: bool) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self {
            full,
            config,
            left: View::new(),
            right: View::new(),
            exposure: Exposure::new(),
            noise: Noise::default(),
            from_left: [NONE; BLOCKS],
            from_right: [NONE; BLOCKS],
            labels: [0; BLOCKS],
            labels_above: [0; BLOCKS],
            costs: [[0; BLOCKS]; 2],
            lefts: [[0; BLOCKS]; 2],
            top: [0; BLOCKS],
            s3: [0; BLOCKS],
            cost_above: [0; BLOCKS],
            cells: [[Cell::default(); BLOCKS]; 8],
            feature_len: 0,
            tile_rows: 0,
            rows: 0,
            answered: 0,
            evals: 0,
            tiles_done: 0,
        })
    }

    fn noisy(&self) -> bool {
        self.noise.level >= SmoothingLevel::Medium
    }

    fn feature_row(view: &mut View<12, BLOCKS>, noisy: bool, width: usize) {
        let y = i64::from(view.features.len());
        let s: [&[u8]; 3] = view.smooth.window(y - 1);
        let out = view.features.push();
        let (c1, c2) = if noisy { (t(2, 31), t(3, 0)) } else { (t(0, 15), t(1, 4)) };
        let wide = if noisy { t(8, 0) } else { t(4, 0) };
        let n = width.div_ceil(4);
        for i in 1..=n {
            let at = 4 * i;
            let w = |r: usize, d: usize| word(s[r], at + d - 1) ^ FLIP;
            let g = if y % 2 == 0 {
                let d = |r| lanes::signed_sub(w(r, 2), w(r, 0));
                match wide {
                    1 => lanes::signed_add(lanes::signed_add(d(1), d(1)), lanes::signed_add(d(0), d(2))),
                    _ => lanes::signed_add(d(1), d(2)),
                }
            } else {
                let d = |c| lanes::signed_sub(w(2, c), w(0, c));
                match wide {
                    1 => lanes::signed_add(lanes::signed_add(d(1), d(1)), lanes::signed_add(d(0), d(2))),
                    _ => lanes::signed_add(d(1), d(2)),
                }
            };
            out[at..at + 4].copy_from_slice(&clip2(g, c1, c2).to_le_bytes());
        }
        replicate_borders(out, width);
    }

    /// The strongest contour of one polarity in each 8 columns.
    fn contours(view: &View<12, BLOCKS>, first: i64, tiles: usize, flip: bool, noisy: bool, strong: bool, out: &mut [Contour; BLOCKS], n: &mut usize) {
        let s: [&[u8]; 4] = view.smooth.window(first);
        *n = 0;
        let four = t(13, 0) != 0 || strong && t(63, 1) != 0;
        let threshold = if noisy { t(16, 4) } else { t(10, 2) } as u32;
        for k in 0..tiles {
            let mut best = (0u32, 0usize);
            for h in 0..2 {
                let at = MARGIN + 8 * k + 4 * h;
                // response at column x: sum of x, x+1 less sum of x-2, x-1
                let m = |o: usize| { let w = |r: usize| word(s[r], at + o - 2);
                    let m = lanes::halved_sum(w(1), w(2));
                    if four { lanes::halved_sum(m, lanes::halved_sum(w(0), w(3))) } else { m } };
                let before = lanes::halved_sum(m(0), m(1));
                let after = lanes::halved_sum(m(2), m(3));
                let r = if flip { lanes::sub(before, after) } else { lanes::sub(after, before) };
                for lane in 0..4 {
                    let v = lanes::lane(r, lane);
                    if v > best.0 {
                        best = (v, 8 * k + 4 * h + lane as usize);
                    }
                }
            }
            if best.0 >= threshold {
                out[*n] = Contour { column: best.1 as u16, strength: best.0 as u16 };
                *n += 1;
            }
        }
    }

    fn find_seeds(&mut self, tile_row: u32) {
        let width = usize::from(self.config.width);
        let tiles = width.div_ceil(8);
        let first = i64::from(4 * tile_row);
        let flip = tile_row % 2 == 1;
        let (mut lc, mut rc) = ([Contour::default(); BLOCKS], [Contour::default(); BLOCKS]);
        let (mut ln, mut rn) = (0, 0);
        Self::contours(&self.left, first, tiles, flip, self.noisy(), self.noise.level == SmoothingLevel::Strong, &mut lc, &mut ln);
        Self::contours(&self.right, first, tiles, flip, self.noisy(), self.noise.level == SmoothingLevel::Strong, &mut rc, &mut rn);
        self.from_left = [NONE; BLOCKS];
        self.from_right = [NONE; BLOCKS];
        let (lf, rf): ([&[u8]; 2], [&[u8]; 2]) =
            (self.left.features.window(first + 1), self.right.features.window(first + 1));
        let min = i32::from(self.config.min_disparity);
        let range = i32::from(self.config.num_disparities);
        let mut suitor = [(u32::MAX, 0usize); BLOCKS];
        let mut choice = [(usize::MAX, 0u32); BLOCKS];
        let ratio = t(11, 200) as u32;
        for i in 0..ln {
            let l = lc[i];
            let (mut best, mut second, mut at) = (u32::MAX, u32::MAX, usize::MAX);
            for j in 0..rn {
                let r = rc[j];
                let d = i32::from(l.column) - i32::from(r.column) - min;
                if d < 0 || d >= range {
                    continue;
                }
                let (a, b) = (u32::from(l.strength), u32::from(r.strength));
                if 100 * a > ratio * b || 100 * b > ratio * a {
                    continue;
                }
                let (lo, ro) = (usize::from(l.column), usize::from(r.column));
                let mut cost = 0;
                for row in 0..2 {
                    for h in 0..2 {
                        cost = lanes::sad_add(word(lf[row], lo + 4 * h), word(rf[row], ro + 4 * h), cost);
                    }
                }
                if cost < best {
                    second = best;
                    best = cost;
                    at = j;
                } else if cost < second {
                    second = cost;
                }
                if cost < suitor[j].0 {
                    suitor[j] = (cost, i);
                }
            }
            let uniq = t(12, 60) as u32;
            if at != usize::MAX && (second == u32::MAX || 100 * second > (100 + uniq) * best) {
                choice[i] = (at, best);
            }
        }
        for i in 0..ln {
            let (j, _) = choice[i];
            if j != usize::MAX && suitor[j].1 == i {
                let d = (i32::from(lc[i].column) - i32::from(rc[j].column) - min) as i16;
                let tile = usize::from(lc[i].column) / 8;
                self.from_left[tile] = d;
                self.from_right[tile] = d;
            }
        }
        let mut last = NONE;
        for k in 0..tiles {
            if self.from_left[k] == NONE { self.from_left[k] = last } else { last = self.from_left[k] }
        }
        let mut last = NONE;
        for k in (0..tiles).rev() {
            if self.from_right[k] == NONE { self.from_right[k] = last } else { last = self.from_right[k] }
        }
    }

    /// Labels and their costs, left paths.
    fn lists(&mut self, tile_row: u32) {
        let width = usize::from(self.config.width);
        let tiles = width.div_ceil(8);
        let wide = 4 * width.div_ceil(4);
        let first = i64::from(4 * tile_row);
        let (lf, rf): ([&[u8]; 4], [&[u8]; 4]) = (self.left.features.window(first), self.right.features.window(first));
        let min = i32::from(self.config.min_disparity);
        let range = i32::from(self.config.num_disparities);
        let shift = if self.noisy() { t(22, 2) } else { t(21, 1) };
        let mix = if !self.full { if self.noisy() { t(44, 4) } else { t(45, 4) } } else if self.noisy() { t(14, 0) } else { t(15, 0) } as i32;
        let mix = mix as u32;
        let strong = self.noise.level == SmoothingLevel::Strong;
        let (near, far) = if strong { (t(17, 16), t(18, 96)) } else if self.noisy() { (t(19, 6), t(20, 24)) } else { (t(24, 4), t(25, 24)) };
        let above_row = self.cells[(2 * tile_row as usize + 7) % 8];
        let has_above = tile_row > 0;
        let mut left_best: Option<i32> = None;
        for k in 0..tiles {
            let x0 = 8 * k as i32;
            // offset of the right window: MARGIN + x0 - d - min in 0..=wide
            let lo = 0.max(x0 + 4 - min - wide as i32);
            let hi = (range - 1).min(x0 + 4 - min);
            let mut list: [(i32, i32, u32); 16] = [(0, 0, 0); 16];
            let mut n = 0;
            let mut evals = 0u64;
            let mut eval = |list: &mut [(i32, i32, u32); 16], n: &mut usize, d: i32| -> Option<i32> {
                if d < lo || d > hi {
                    return None;
                }
                for e in list.iter().take(*n) {
                    if e.0 == d {
                        return Some(e.1);
                    }
                }
                evals += 1;
                let l = MARGIN + 8 * k;
                let r = (4 + x0 - d - min) as usize;
                let mut c = [0u32; 4];
                for row in 0..4 {
                    for h in 0..2 {
                        let i = row / 2 * 2 + h;
                        c[i] = lanes::sad_add(word(lf[row], l + 4 * h), word(rf[row], r + 4 * h), c[i]);
                    }
                }
                let sum = c[0] + c[1] + c[2] + c[3];
                let b = |v: u32| ((v * (16 - mix) + sum * mix / 4) / 16 >> shift).min(255);
                let packed = b(c[0]) | b(c[1]) << 8 | b(c[2]) << 16 | b(c[3]) << 24;
                list[*n] = (d, sum as i32, packed);
                *n += 1;
                Some(sum as i32)
            };
            let mut above = [None; 4];
            if has_above {
                let at = |c: usize| i32::from(above_row[c].disp >> 8);
                above[0] = Some(at(2 * k));
                above[1] = Some(at(2 * k + 1));
                if k > 0 && t(26, 1) != 0 {
                    above[2] = Some(at(2 * k - 1));
                }
                if k + 1 < tiles && t(26, 1) != 0 {
                    above[3] = Some(at(2 * k + 2));
                }
            }
            for a in above.into_iter().flatten() {
                eval(&mut list, &mut n, a);
            }
            if let Some(l) = left_best {
                eval(&mut list, &mut n, l);
            }
            let (a, b) = (self.from_left[k], self.from_right[k]);
            if a != NONE {
                eval(&mut list, &mut n, i32::from(a));
            }
            if b != NONE {
                eval(&mut list, &mut n, i32::from(b));
            }
            if a != NONE && b != NONE && t(27, 0) != 0 {
                eval(&mut list, &mut n, (i32::from(a) + i32::from(b)) / 2);
            }
            if n == 0 {
                let d = (range / 4).clamp(lo, hi.max(lo));
                eval(&mut list, &mut n, d);
            }
            let bias = |d: i32| {
                let mut b = 0;
                let one = |a: Option<i32>| match a {
                    None => 0,
                    Some(a) => match (a - d).abs() { 0 => 0, 1 => near, _ => far },
                };
                b += one(left_best);
                b += one(above[0]);
                b
            };
            let mut best = (0, i32::MAX);
            for e in list.iter().take(n) {
                let s = e.1 + bias(e.0);
                if s < best.1 {
                    best = (e.0, s);
                }
            }
            if n > 0 {
                let start = best.0;
                let mut step = 0;
                loop {
                    let at = best.0;
                    for d in [at - 1, at + 1] {
                        if let Some(s) = eval(&mut list, &mut n, d) {
                            let s = s + bias(d);
                            if s < best.1 {
                                best = (d, s);
                            }
                        }
                    }
                    step += 1;
                    if best.0 == at || step > t(28, 1) {
                        break;
                    }
                }
            }
            let w = best.0;
            left_best = if n > 0 { Some(w) } else { None };
            // Four labels: the best, the two beside, the cheapest other.
            let mut keep = [(0, 0i32, 0u32); 4];
            let mut m = 0;
            for d in [w - 1, w, w + 1] {
                if let Some(e) = list[..n].iter().find(|e| e.0 == d) {
                    keep[m] = *e;
                    m += 1;
                }
            }
            while m < 4 {
                let mut other: Option<(i32, i32, u32)> = None;
                for e in &list[..n] {
                    if keep[..m].iter().all(|q| q.0 != e.0) && other.is_none_or(|o| e.1 < o.1) {
                        other = Some(*e);
                    }
                }
                let Some(o) = other else { break };
                keep[m] = o;
                m += 1;
            }
            keep[..m].sort_unstable_by_key(|e| e.0);
            let (mut labels, mut cost) = (0u32, [0u32; 4]);
            for i in 0..4 {
                let e = if i < m { keep[i] } else { (if m > 0 { keep[m - 1].0 } else { 0 }, 0, u32::MAX) };
                labels |= (e.0 as u32) << (8 * i);
                for (j, c) in cost.iter_mut().enumerate() {
                    *c |= lanes::lane(e.2, j as u32) << (8 * i);
                }
            }
            self.labels[k] = labels;
            self.costs[0][2 * k] = cost[0];
            self.costs[0][2 * k + 1] = cost[1];
            self.costs[1][2 * k] = cost[2];
            self.costs[1][2 * k + 1] = cost[3];
            self.evals += evals;
            self.tiles_done += 1;
        }
    }

    fn greedy(&mut self, tile_row: u32) {
        let width = usize::from(self.config.width);
        let cells = 2 * width.div_ceil(8);
        let (p1, p2) = if self.noisy() { (t(48, 2), t(49, 10)) } else { (t(46, 2), t(47, 6)) };
        let price = |labels: u32, d: u32| {
            let ad = lanes::difference(labels, lanes::splat(d));
            lanes::min(lanes::select_ge(lanes::ONES, ad, (ad & lanes::ONES).wrapping_mul(p1 as u32), !0), lanes::splat(p2 as u32))
        };
        for r in 0..2 {
            let row = 2 * tile_row as usize + r;
            let above = self.cells[(row + 7) % 8];
            let mut left = None;
            for c in 0..cells {
                let labels = self.labels[c / 2];
                let mut s = self.costs[r][c];
                if let Some(l) = left { s = lanes::add(s, price(labels, l)); }
                if row > 0 { s = lanes::add(s, price(labels, u32::from(above[c].disp >> 8))); }
                let cell = winner(s, labels, self.costs[r][c]);
                left = Some(u32::from(cell.disp >> 8));
                self.cells[row % 8][c] = cell;
            }
        }
    }

    fn penalties(&self) -> (u32, u32) {
        if self.noisy() { (t(32, 7) as u32, t(33, 34) as u32) } else { (t(30, 4) as u32, t(31, 24) as u32) }
    }

    fn paths(&mut self, tile_row: u32) {
        let width = usize::from(self.config.width);
        let tiles = width.div_ceil(8);
        let cells = 2 * tiles;
        let (p1, p2) = self.penalties();
        let (p1w, p2w) = (lanes::splat(p1), lanes::splat(p2));
        // Left.
        for r in 0..2 {
            let mut prev = 0u32;
            let mut prev_labels = self.labels[0];
            for c in 0..cells {
                let k = c / 2;
                let m = message(prev, prev_labels, self.labels[k], p1w, p2w);
                prev = step(self.costs[r][c], m);
                if c == 0 { prev = step(self.costs[r][c], 0); }
                prev_labels = self.labels[k];
                self.lefts[r][c] = prev;
            }
        }
        // Right, top, below.
        let mut right = [0u32; 2];
        let use_below = t(34, 1);
        let cell_row = 2 * tile_row as usize;
        for c in (0..cells).rev() {
            let k = c / 2;
            let mine = self.labels[k];
            let mut along = [0u32; 2];
            let mut sums = [0u32; 2];
            for r in 0..2 {
                let cost = self.costs[r][c];
                let m = if c + 1 == cells { 0 } else { message(right[r], self.labels[(c + 1) / 2], mine, p1w, p2w) };
                right[r] = step(cost, m);
                along[r] = lanes::add(self.lefts[r][c], lanes::sub(right[r], if t(35, 0) != 0 { cost } else { 0 }));
            }
            let same = |a: u32, b: u32| if a == b { 1 } else { 0 };
            // top, cell row 0
            let tree = t(36, 0) != 0;
            let (above_labels, above_top) = (self.labels_above[k], self.top[c]);
            let m0 = if tile_row == 0 { 0 } else { message(above_top, above_labels, mine, p1w, p2w) };
            let top0 = if tree { step(along[0], m0) } else { step(self.costs[0][c], m0) };
            let m1 = message(top0, mine, mine, p1w, p2w);
            let top1 = if tree { step(along[1], m1) } else { step(self.costs[1][c], m1) };
            for r in 0..2 {
                let top = [m0, m1][r];
                // along holds cost once if t35, tops message only adds
                sums[r] = lanes::add(along[r], top);
                if t(37, 1) == 1 {
                    // plain sum of path costs
                    sums[r] = lanes::add(lanes::add(self.lefts[r][c], right[r]), [top0, top1][r]);
                }
                sums[r] = lanes::sub(sums[r], lanes::least(sums[r]));
            }
            // below: the row above gets this row's along
            let up = |r: usize| {
                let a = if t(38, 0) == 1 { self.costs[r][c] } else { along[r] };
                lanes::sub(a, lanes::least(a))
            };
            let cost_above = self.cost_above[c];
            if tile_row > 0 {
                let s = if use_below != 0 {
                    let m = message(up(0), mine, above_labels, p1w, p2w);
                    lanes::add(self.s3[c], m)
                } else {
                    self.s3[c]
                };
                self.cells[(cell_row + 7) % 8][c] = winner(s, above_labels, cost_above);
            }
            let s = if use_below != 0 { lanes::add(sums[0], message(up(1), mine, mine, p1w, p2w)) } else { sums[0] };
            self.cells[cell_row % 8][c] = winner(s, mine, self.costs[0][c]);
            self.cells[(cell_row + 1) % 8][c] = winner(sums[1], mine, self.costs[1][c]);
            self.s3[c] = sums[1];
            self.top[c] = top1;
            self.cost_above[c] = self.costs[1][c];
        }
        self.labels_above = self.labels;
    }

    /// Delivers image rows of cell rows that are final: up to (exclusive) cell row `end`.
    fn deliver(&mut self, end: u32, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = usize::from(self.config.width);
        let cells = width.div_ceil(4);
        let min = i32::from(self.config.min_disparity);
        let wide = 4 * cells as i32;
        while self.answered < (2 * end).min(self.rows) {
            let q = (self.answered / 2) as i32;
            let at = |dq: i32, c: i32| -> Option<Cell> {
                let qq = q + dq;
                (qq >= 0 && qq <= end as i32 && c >= 0 && c < cells as i32).then(|| self.cells[qq as usize % 8][c as usize])
            };
            let value = |c: Cell| i32::from(c.disp) - 128;
            let jump = t(50, 384);
            // centre, slopes in 1/256 px: per cell
            let mut mid = [(0i32, 0i32, 0i32); BLOCKS];
            let mut conf = [0i32; BLOCKS];
            for c in 0..cells as i32 {
                let own = at(0, c).unwrap();
                let mut v = [0i32; 9];
                let mut n = 0;
                for dq in -1..=1 {
                    for dc in -1..=1 {
                        v[n] = value(at(dq, c + dc).unwrap_or(own));
                        n += 1;
                    }
                }
                v.sort_unstable();
                let m = if t(40, 1) == 2 {
                    let mut b = [0u32; 9];
                    let mut n = 0;
                    for dq in -1..=1 { for dc in -1..=1 { b[n] = u32::from(at(dq, c + dc).unwrap_or(own).disp >> 8); n += 1; } }
                    b.sort_unstable();
                    let o = u32::from(own.disp >> 8);
                    if b[4].abs_diff(o) <= t(9, 1) as u32 { value(own) } else { (b[4] << 8) as i32 }
                } else if t(40, 1) != 0 { v[4] } else { value(own) };
                let near = |dq, dc| at(dq, c + dc).map(value).filter(|v| (v - m).abs() < jump);
                let mut centre = m;
                let (l, r, u, d) = (near(0, -1), near(0, 1), near(-1, 0), near(1, 0));
                let slope = |a: Option<i32>, b: Option<i32>| match (a, b) {
                    (Some(a), Some(b)) => (b - a) / 2,
                    (Some(a), None) if t(53, 0) != 0 => m - a,
                    (None, Some(b)) if t(53, 0) != 0 => b - m,
                    _ => 0,
                };
                let (sx, sy) = (slope(l, r), slope(u, d));
                match t(51, 2) {
                    1 => {
                        let second = |a: Option<i32>, b: Option<i32>| match (a, b) {
                            (Some(a), Some(b)) => a + b - 2 * m,
                            _ => 0,
                        };
                        centre += (second(l, r) + second(u, d)) * t(52, 4) / 16;
                    }
                    2 => {
                        let (mut sum, mut n) = (t(52, 2) * m, t(52, 2));
                        for (a, b) in [((0, -1), (0, 1)), ((-1, 0), (1, 0)), ((-1, -1), (1, 1)), ((-1, 1), (1, -1))] {
                            if let (Some(a), Some(b)) = (near(a.0, a.1), near(b.0, b.1)) {
                                sum += a + b;
                                n += 2;
                            }
                        }
                        centre = sum / n;
                    }
                    3 => {
                        let sm = |dq: i32| -> i32 {
                            let m0 = at(dq, c).map(value).unwrap_or(m);
                            let m0 = if dq == 0 { m } else { m0 };
                            let nr = |dc: i32| at(dq, c + dc).map(value).filter(|v| (v - m0).abs() < jump);
                            match (nr(-1), nr(1)) { (Some(a), Some(b)) => (a + b + 2 * m0) / 4, _ => m0 }
                        };
                        let (h, hu, hd) = (sm(0), sm(-1), sm(1));
                        let ok = |v: i32| (v - h).abs() < jump;
                        centre = if ok(hu) && ok(hd) { (hu + hd + 2 * h) / 4 } else { h };
                    }
                    _ => {}
                }
                mid[c as usize] = if t(51, 2) == 0 { (m, 0, 0) } else { (centre, sx, sy) };
                let (mut sum, mut n) = (0, 0);
                for dq in -1..=1 {
                    for dc in -1..=1 {
                        if let Some(o) = at(dq, c + dc) {
                            sum += i32::from(o.merit);
                            if (value(o) - value(own)).abs() > 384 {
                                sum -= t(55, 10);
                            }
                            n += 1;
                        }
                    }
                }
                conf[c as usize] = sum / n;
            }
            // quarters
            let mut quarter = [(0i32, 0u8); BLOCKS];
            let y0 = 2 * i64::from(q);
            let (lf, rf): ([&[u8]; 4], [&[u8]; 4]) = (self.left.features.window(y0 - 1), self.right.features.window(y0 - 1));
            let mut src = [[0i8; 2]; BLOCKS];
            if t(54, 0) != 0 {
                for c in 0..cells as i32 {
                    let own = mid[c as usize].0;
                    for h in 0..2i32 {
                        let beside = c + 2 * h - 1;
                        let cost = |v: i32| -> Option<u32> {
                            let d = (v + 128 >> 8) + min;
                            let x = 4 * c + 2 * h - 1 + 4;
                            let xr = x - d;
                            if xr < 0 || xr + 4 > wide + 8 { return None; }
                            let mut s = 0;
                            for r in if t(29, 0) == 1 { 1..3 } else { 0..4 } { s = lanes::sad_add(word(lf[r], x as usize), word(rf[r], xr as usize), s); }
                            Some(s)
                        };
                        let mut best: Option<u32> = None;
                        for (k, o) in [(1i8, (beside >= 0 && beside < cells as i32).then(|| mid[beside as usize].0)), (2, at(-1, c).map(value)), (3, at(1, c).map(value))] {
                            let Some(o) = o else { continue };
                            if k > t(23, 3) as i8 { continue; }
                            if (o - own).abs() <= t(56, 384) { continue; }
                            if best.is_none() { best = cost(own).map(|c| c * t(57, 12) as u32 / 16); }
                            if let (Some(b), Some(x)) = (best, cost(o)) && x < b {
                                best = Some(x);
                                src[c as usize][h as usize] = k;
                            }
                        }
                    }
                }
            }
            // value of a pixel
            let pixel = |x: i32, y: i32| -> i32 {
                let c = x / 4;
                let h = x % 4 / 2;
                let plane = |c: i32| {
                    let (m, sx, sy) = mid[c as usize];
                    m + sx * (2 * (x - 4 * c) - 3) / 8 + sy * (2 * y - 1) / 4
                };
                match src[c as usize][h as usize] {
                    1 => { let (m, sx, sy) = mid[(c + 2 * h - 1) as usize]; if t(58, 1) != 0 { plane(c + 2 * h - 1) } else { m } }
                    2 => value(at(-1, c).unwrap()),
                    3 => value(at(1, c).unwrap()),
                    _ => plane(c),
                }
            };
            // claims
            let mut claims = [[i16::MIN; 4]; BLOCKS];
            let claims = claims.as_flattened_mut();
            for x in 0..width as i32 {
                let d = (pixel(x, 0) + pixel(x, 1) + 256 >> 9);
                let xr = x - d - min;
                if xr >= 0 && xr < width as i32 { claims[xr as usize] = claims[xr as usize].max(d as i16); }
            }
            let mut hidden = [[false; 4]; BLOCKS];
            let hidden = hidden.as_flattened_mut();
            let tol = t(59, 1);
            for x in 0..width as i32 {
                let d = (pixel(x, 0) + pixel(x, 1) + 256 >> 9);
                let xr = x - d - min;
                let out = xr < 0 || xr >= width as i32;
                let near = |o: i32| { let k = xr + o; k < 0 || k >= width as i32 || i32::from(claims[k as usize]) > d + tol };
                hidden[x as usize] = out || t(60, 1) != 0 && near(-1) && near(0) && near(1);
            }
            let mut disparity = [[Disparity::UNKNOWN; 4]; BLOCKS];
            let mut confidence = [[0u8; 4]; BLOCKS];
            let (d, cf) = (disparity.as_flattened_mut(), confidence.as_flattened_mut());
            for y in 0..2 {
                if self.answered >= self.rows { break; }
                for x in 0..width {
                    let mut v = pixel(x as i32, y);
                    let mut k = (128 + conf[x / 4] * t(61, 2)).clamp(16, 255);
                    if hidden[x] && t(62, 1) != 0 {
                        let a = (0..x).rev().find(|&i| !hidden[i]).map(|i| pixel(i as i32, y));
                        let b = (x + 1..width).find(|&i| !hidden[i]).map(|i| pixel(i as i32, y));
                        v = match (a, b) { (Some(a), Some(b)) => a.min(b), (Some(a), None) => a, (None, Some(b)) => b, _ => v };
                    }
                    if hidden[x] { k = 8; }
                    let bits = (v + min * 256 + 8) >> 4;
                    d[x] = Disparity::from_bits(bits as i16);
                    cf[x] = k as u8;
                }
                sink(DisparityRow { y: self.answered, disparity: &d[..width], confidence: &cf[..width] });
                self.answered += 1;
            }
        }
    }

    fn advance(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let width = usize::from(self.config.width);
        let newest = self.left.raw.len() - 1;
        if newest >= SMOOTH_LAG {
            let gain = self.exposure.gain();
            self.left.smooth_row(self.noise.level, gain, width);
            self.right.smooth_row(self.noise.level, gain, width);
        }
        if newest >= SMOOTH_LAG + 1 {
            let noisy = self.noisy();
            Self::feature_row(&mut self.left, noisy, width);
            Self::feature_row(&mut self.right, noisy, width);
            let n = self.left.features.len();
            if n % 4 == 0 {
                let tile_row = n / 4 - 1;
                self.find_seeds(tile_row);
                self.lists(tile_row);
                if self.full { self.paths(tile_row) } else { self.greedy(tile_row) }
                self.tile_rows = tile_row + 1;
                // cell rows up to 2 * tile_row are final; the median needs the next one
                self.deliver(2 * tile_row + if self.full { 0 } else { 1 }, sink);
            }
        }
    }
}

#[inline]
fn message(prev: u32, q: u32, d: u32, p1: u32, p2: u32) -> u32 {
    if q == d { fast(prev, up(d, p1), p2) } else { slow(prev, q, d, p1, p2) }
}

fn up(d: u32, p1: u32) -> u32 {
    // P1 where the next label is one more, else 255
    lanes::select_ge(0, lanes::wrapping_sub(d >> 8, d) ^ 0x0101_0101, p1, !0) | 0xff00_0000
}

fn fast(prev: u32, up: u32, p2: u32) -> u32 {
    let a = lanes::add(prev >> 8 | 0xff00_0000, up);
    let b = lanes::add(prev << 8 | 255, up << 8 | 255);
    lanes::min(lanes::min(lanes::min(a, b), prev), p2)
}

fn slow(prev: u32, q: u32, d: u32, p1: u32, p2: u32) -> u32 {
    let mut m = p2;
    for k in 0..4 {
        let (qk, pk) = (lanes::splat(lanes::lane(q, k)), lanes::splat(lanes::lane(prev, k)));
        let ad = lanes::difference(d, qk);
        let price = lanes::select_ge(lanes::ONES, ad, (ad & lanes::ONES).wrapping_mul(p1 & 0xff), !0);
        m = lanes::min(m, lanes::add(pk, price));
    }
    m
}

fn step(cost: u32, m: u32) -> u32 {
    let v = lanes::add(cost, m);
    lanes::sub(v, lanes::least(v))
}

fn winner(s: u32, labels: u32, cost: u32) -> Cell {
    let s = lanes::sub(s, lanes::least(s));
    let mut k = 0;
    while k < 3 && lanes::lane(s, k) != 0 {
        k += 1;
    }
    let d = lanes::lane(labels, k);
    let own = lanes::lane(cost, k) as i32;
    let mut frac = 0;
    let mut weight = 0;
    if k > 0 && k < 3 && lanes::lane(labels, k - 1) + 1 == d && lanes::lane(labels, k + 1) == d + 1 {
        let v = |i: u32| (t(41, 1) * lanes::lane(s, i) as i32 + t(42, 1) * lanes::lane(cost, i) as i32);
        let (b, m, a) = (v(k - 1), v(k), v(k + 1));
        let top = b.max(a) - m;
        if top > 0 {
            frac = ((b - a) * 128 / top).clamp(-127, 127);
            weight = top.min(255);
        }
    }
    let mut margin = t(43, 64);
    for i in 0..4 {
        let l = lanes::lane(labels, i);
        if l.abs_diff(d) > 1 {
            margin = margin.min(lanes::lane(s, i) as i32);
        }
    }
    Cell { disp: ((d << 8) as i32 + 128 + frac) as u16, merit: (margin - 2 * own) as i16, weight: weight as u8 }
}

impl<const BLOCKS: usize> StereoMethod for Tiles<BLOCKS> {
    fn config(&self) -> &Config {
        &self.config
    }

    fn start(&mut self) {
        self.left.clear();
        self.right.clear();
        self.exposure = Exposure::new();
        self.noise = Noise::default();
        (self.rows, self.answered, self.tile_rows) = (0, 0, 0);
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        pair.check(self.config.width)?;
        self.left.raw.push_pixels(pair.left);
        self.right.raw.push_pixels(pair.right);
        self.left.measure_noise(pair.left.len());
        self.right.measure_noise(pair.right.len());
        self.exposure.add(pair.left);
        self.exposure.add(pair.right);
        self.noise = Noise::of(&self.left.noise, &self.right.noise, self.exposure.gain());
        self.rows += 1;
        self.advance(sink);
        Ok(())
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.left.raw.push_again();
        self.right.raw.push_again();
        self.rows += 1;
        self.advance(sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let tile_rows = self.rows.div_ceil(4);
        while self.tile_rows < tile_rows {
            self.left.raw.push_again();
            self.right.raw.push_again();
            self.advance(sink);
        }
        self.deliver(2 * tile_rows, sink);
        self.start();
    }
}
