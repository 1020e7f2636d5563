//! The correction of disparities, fitted to what a rig saw of a plane at a known distance.

use anyhow::{Result, bail, ensure};
use haarline::Correction;
use nalgebra::{DMatrix, DVector};

use crate::DisparityMap;

/// Cells across and down in which residuals are gathered.
const CELLS: [usize; 2] = [32, 24];
/// Nodes across, and down where the rows differ.
const NODES: [usize; 2] = [9, 5];
/// Residuals that are told apart, 1/16 px on either side of 0.
const MOST_BITS: i32 = 32 * 16;
/// Fewest residuals that make a cell's median.
const LEAST_OF_CELL: u32 = 12;
/// Price of the square of a second difference between nodes, of a mean square residual.
const BEND_PRICE: f64 = 0.01;
/// And of a first one, so that it goes on level where nothing was seen.
const SLOPE_PRICE: f64 = 0.0001;
/// Nearer to the left border of the right view windows are cut off, px.
const BORDER_PX: f64 = 8.0;
/// Part of the view's rows that must have been seen for rows of nodes: beyond, they would be guessed.
const ROWS_SEEN: f64 = 0.75;
/// Part of the one row's scatter that rows of nodes must not exceed to be taken.
const ROWS_PAY: f64 = 0.9;
/// Greatest scatter of the cells about the fit, px: the plane is not where it was told to be.
const MOST_SCATTER_PX: f64 = 0.5;
/// By how much disparities may be wrong in the median, px: lenses leave less, other mistakes more.
const MOST_WRONG_PX: f64 = 4.0;

/// Where a plane stands, square before the left camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Its disparity, px, as a rig without error would measure it.
    pub disparity_px: f64,
    /// First and last column of the left view in which it stands.
    pub columns: [usize; 2],
    /// First and last row.
    pub rows: [usize; 2],
}

/// How far measured disparities are from those of planes, by column and row; of every second frame apart.
#[derive(Debug, Clone)]
pub struct Residuals {
    size: [usize; 2],
    /// Histograms of the cells, row by row, of even and of odd frames.
    counts: [Vec<u32>; 2],
    frames: usize,
}

const BINS: usize = 2 * MOST_BITS as usize + 1;

/// What was fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Nodes as a rig description has them, px.
    pub nodes: Vec<Vec<f64>>,
    /// First and last column in which the plane was seen.
    pub columns: [usize; 2],
    /// First and last row.
    pub rows: [usize; 2],
    /// Median distance of the cells' medians from 0 and from the fit, px.
    pub error_px: [f64; 2],
}

/// A cell: its place from 0 to 1 across and down, and the median of its residuals.
#[derive(Debug, Clone, Copy)]
struct Cell {
    at: [f64; 2],
    median: f64,
}

impl Residuals {
    /// None yet, of views of `size` px.
    #[must_use]
    pub fn new(size: [usize; 2]) -> Self {
        let counts = vec![0; CELLS[0] * CELLS[1] * BINS];
        Self { size, counts: [counts.clone(), counts], frames: 0 }
    }

    /// Takes the answers of a frame that are on the plane; how many they are.
    pub fn add(&mut self, map: &DisparityMap, min_confidence: u8, plane: &Plane) -> usize {
        let counts = &mut self.counts[self.frames % 2];
        self.frames += 1;
        let [[left, right], [top, bottom]] = [plane.columns, plane.rows];
        let mut taken = 0;
        // What the right camera does not see beside its view is no measurement.
        let last = map.width as f64 - 1.0;
        let is_in_both = |x: &usize| (BORDER_PX..last).contains(&(*x as f64 - plane.disparity_px));
        for y in top..=bottom.min(map.height - 1) {
            for x in (left..=right.min(map.width - 1)).filter(is_in_both) {
                let is_sure = map.confidence[y * map.width + x] >= min_confidence;
                let Some(bits) = map.at(x, y).known().filter(|_| is_sure) else { continue };
                let residual = (16.0 * plane.disparity_px).round() as i32 - i32::from(bits);
                if residual.abs() > MOST_BITS {
                    continue;
                }
                let cell = [0, 1].map(|k| [x, y][k] * CELLS[k] / self.size[k]);
                counts[(cell[1] * CELLS[0] + cell[0]) * BINS + (residual + MOST_BITS) as usize] += 1;
                taken += 1;
            }
        }
        taken
    }

    /// The cells' medians, of even frames, of odd ones or of both.
    fn cells(&self, parts: &[usize]) -> Vec<Cell> {
        let mut cells = Vec::new();
        for index in 0..CELLS[0] * CELLS[1] {
            let count = |bin: usize| parts.iter().map(|&part| self.counts[part][index * BINS + bin]).sum::<u32>();
            let total: u32 = (0..BINS).map(count).sum();
            if total < LEAST_OF_CELL {
                continue;
            }
            let mut below = 0;
            for bin in 0..BINS {
                let here = count(bin);
                if 2 * (below + here) >= total {
                    // Between the bin's borders, as if its residuals were spread over it.
                    let inside = (f64::from(total) / 2.0 - f64::from(below)) / f64::from(here);
                    let median = (bin as f64 - f64::from(MOST_BITS) - 0.5 + inside) / 16.0;
                    let at = [index % CELLS[0], index / CELLS[0]];
                    cells.push(Cell { at: [0, 1].map(|k| (at[k] as f64 + 0.5) / CELLS[k] as f64), median });
                    break;
                }
                below += here;
            }
        }
        cells
    }

    /// Fits nodes to all that was taken.
    ///
    /// # Errors
    /// If too little was seen, or it lies on no smooth correction.
    pub fn fit(&self) -> Result<Fit> {
        let cells = self.cells(&[0, 1]);
        let columns: std::collections::BTreeSet<usize> =
            cells.iter().map(|cell| (cell.at[0] * CELLS[0] as f64) as usize).collect();
        ensure!(
            columns.len() >= CELLS[0] / 8,
            "not observable: the plane was seen in {} of {} parts of the view's width; move it or the rig so that it passes over \
             all columns, and see that it has texture",
            columns.len(),
            CELLS[0]
        );
        let rows = self.rows_of_nodes();
        let nodes = solve(&cells, [NODES[0], rows]);
        let scatter = median(cells.iter().map(|cell| (cell.median - value(&nodes, [NODES[0], rows], cell.at)).abs()));
        let before = median(cells.iter().map(|cell| cell.median.abs()));
        if scatter > MOST_SCATTER_PX {
            bail!(
                "contradictory: disparities are {scatter:.2} px from every smooth correction, where {MOST_SCATTER_PX} px are allowed: \
                 the plane does not stand where it was told to, or something else was seen"
            );
        }
        ensure!(
            before <= MOST_WRONG_PX,
            "contradictory: disparities are {before:.1} px wrong in the median, where {MOST_WRONG_PX} px are allowed: the distance, \
             focal_px, baseline_mm or column_offset is wrong, or something else than such a plane was seen"
        );
        let most = f64::from(Correction::MAX_NODE) / 256.0;
        ensure!(
            nodes.iter().all(|node| node.abs() <= most),
            "the correction would exceed {most:.0} px: focal_px, baseline_mm or the distance is wrong"
        );
        let reach = |k: usize| {
            let places = cells.iter().map(|cell| (cell.at[k] * CELLS[k] as f64) as usize);
            let [first, last] = [places.clone().min().unwrap_or(0), places.max().unwrap_or(0)];
            [first * self.size[k] / CELLS[k], (last + 1) * self.size[k] / CELLS[k] - 1]
        };
        let nodes = nodes.chunks(NODES[0]).map(<[f64]>::to_vec).collect();
        Ok(Fit { nodes, columns: reach(0), rows: reach(1), error_px: [before, scatter] })
    }

    /// How many rows of nodes predict the odd frames best from the even ones.
    fn rows_of_nodes(&self) -> usize {
        let [even, odd] = [self.cells(&[0]), self.cells(&[1])];
        let seen: std::collections::BTreeSet<usize> = self.cells(&[0, 1]).iter().map(row_of).collect();
        if even.is_empty() || odd.is_empty() || (seen.len() as f64) < ROWS_SEEN * CELLS[1] as f64 {
            return 1;
        }
        let error = |rows: usize| {
            let size = [NODES[0], rows];
            let nodes = solve(&even, size);
            median(odd.iter().map(|cell| (cell.median - value(&nodes, size, cell.at)).abs()))
        };
        if error(NODES[1]) <= ROWS_PAY * error(1) { NODES[1] } else { 1 }
    }
}

fn row_of(cell: &Cell) -> usize {
    (cell.at[1] * CELLS[1] as f64) as usize
}

/// The nodes around a place, and their weights.
fn around(size: [usize; 2], at: [f64; 2]) -> [(usize, f64); 4] {
    let [across, down] = [0, 1].map(|k| {
        let place = at[k] * (size[k] - 1) as f64;
        let first = (place as usize).min(size[k].saturating_sub(2));
        (first, place - first as f64)
    });
    let below = usize::from(size[1] > 1);
    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| {
        let weight = |t: f64, side: usize| if side == 0 { 1.0 - t } else { t };
        ((down.0 + j * below) * size[0] + across.0 + i, weight(across.1, i) * weight(down.1, j))
    })
}

fn value(nodes: &[f64], size: [usize; 2], at: [f64; 2]) -> f64 {
    around(size, at).iter().map(|(index, weight)| nodes[*index] * weight).sum()
}

/// Nodes by least squares, cells that are far off counting less and less, smooth across and down.
fn solve(cells: &[Cell], size: [usize; 2]) -> Vec<f64> {
    let count = size[0] * size[1];
    let mut smooth = DMatrix::<f64>::zeros(count, count);
    let mut price = |nodes: &[(usize, f64)], by: f64| {
        for &(i, a) in nodes {
            for &(j, b) in nodes {
                smooth[(i, j)] += by * a * b / count as f64;
            }
        }
    };
    for (j, i) in (0..size[1]).flat_map(|j| (0..size[0]).map(move |i| (j, i))) {
        for (place, side, step) in [(i, size[0], 1), (j, size[1], size[0])] {
            let node = j * size[0] + i;
            // In units of the whole side, so that the number of nodes does not matter.
            let parts = (side - 1) as f64;
            if place + 1 < side {
                price(&[(node, 1.0), (node + step, -1.0)], SLOPE_PRICE * parts);
            }
            if place + 2 < side {
                price(&[(node, 1.0), (node + step, -2.0), (node + 2 * step, 1.0)], BEND_PRICE * parts);
            }
        }
    }
    let mut nodes = vec![0.0; count];
    let mut weights = vec![1.0; cells.len()];
    for _ in 0..12 {
        let total: f64 = weights.iter().sum();
        let (mut matrix, mut wanted) = (smooth.clone(), DVector::<f64>::zeros(count));
        for (cell, weight) in cells.iter().zip(&weights) {
            let around = around(size, cell.at);
            for (i, a) in around {
                wanted[i] += weight / total * a * cell.median;
                for (j, b) in around {
                    matrix[(i, j)] += weight / total * a * b;
                }
            }
        }
        let Some(solution) = matrix.cholesky().map(|factors| factors.solve(&wanted)) else { break };
        nodes = solution.iter().copied().collect();
        let off: Vec<f64> = cells.iter().map(|cell| (cell.median - value(&nodes, size, cell.at)).abs()).collect();
        let scale = 2.0 * median(off.iter().copied()).max(1.0 / 32.0);
        weights = off.iter().map(|off| 1.0 / (1.0 + (off / scale).powi(2))).collect();
    }
    nodes
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::Disparity;

    const SIZE: [usize; 2] = [128, 96];

    /// What a rig with bent lenses is wrong by, px.
    fn bent(x: usize, y: usize, down: f64) -> f64 {
        let [x, y] = [2.0 * x as f64 / 127.0 - 1.0, 2.0 * y as f64 / 95.0 - 1.0];
        0.3 + 0.4 * x - 0.9 * x * x + down * y
    }

    /// Frames of a plane of 6 px that passes over the view, a tenth of the answers wrong.
    fn residuals(down: f64, columns: [usize; 2]) -> Residuals {
        let mut residuals = Residuals::new(SIZE);
        for first in (columns[0]..columns[1]).step_by(6) {
            let pixel = |index: usize| {
                let (x, y) = (index % SIZE[0], index / SIZE[0]);
                let wrong = if (x * 7 + y * 13 + first) % 10 == 0 { 3.0 } else { 0.0 };
                let rounding = ((x * 31 + y * 17 + first * 5) % 16) as f64 / 16.0 - 0.5;
                Disparity::from_bits((16.0 * (6.0 - bent(x, y, down) + wrong + rounding / 4.0)).round() as i16)
            };
            let pixels = SIZE[0] * SIZE[1];
            let map = DisparityMap {
                width: SIZE[0],
                height: SIZE[1],
                disparity: (0..pixels).map(pixel).collect(),
                confidence: vec![100; pixels],
            };
            let plane = Plane { disparity_px: 6.0, columns: [first, (first + 20).min(columns[1])], rows: [10, 90] };
            assert!(residuals.add(&map, 64, &plane) > 0 && residuals.add(&map, 101, &plane) == 0);
        }
        residuals
    }

    #[test]
    fn lenses_are_followed_where_the_plane_was_seen() {
        for (down, rows) in [(0.0, 1), (0.6, NODES[1])] {
            let mut all = residuals(down, [0, 127]);
            // Every second call took nothing.
            all.counts[1] = all.counts[0].clone();
            let fit = all.fit().unwrap();
            assert_eq!((fit.nodes.len(), fit.columns, fit.rows), (rows, [12, 127], [8, 91]));
            let nodes: Vec<f64> = fit.nodes.concat();
            for (x, y) in [(16, 50), (40, 20), (64, 48), (100, 80), (123, 50)] {
                let found = value(&nodes, [NODES[0], rows], [(x as f64 + 0.5) / 128.0, (y as f64 + 0.5) / 96.0]);
                assert!((found - bent(x, y, down)).abs() < 0.07, "{x}, {y}: {found} {}", bent(x, y, down));
            }
            assert!(fit.error_px[1] < 0.05 && fit.error_px[0] > 0.1, "{:?}", fit.error_px);
        }
    }

    #[test]
    fn what_shows_no_plane_makes_no_correction() {
        let told = |residuals: &Residuals| residuals.fit().unwrap_err().to_string();
        assert!(told(&Residuals::new(SIZE)).starts_with("not observable"));
        assert!(told(&residuals(0.0, [60, 66])).starts_with("not observable"));
        let mut scattered = residuals(0.0, [0, 127]);
        for (index, counts) in scattered.counts[0].chunks_mut(BINS).enumerate() {
            counts.rotate_right(index * 37 % 64);
        }
        assert!(told(&scattered).starts_with("contradictory"), "{}", told(&scattered));
    }
}
