//! Semi-global matching by its definition: the whole frame at once, costs instead of merits.

use haarline::Config;

use crate::common::frame::Frame;

const P1: i32 = 3;
const P2: i32 = 14;
/// Of eight signs half differ where the right view has no pixel.
const OUTSIDE: i32 = 4;
/// The diamond around a pixel.
const NEIGHBOURS: [(i32, i32); 8] = [(0, -2), (0, 2), (-2, 0), (2, 0), (-1, -1), (-1, 1), (1, -1), (1, 1)];

/// A frame and how it is searched.
pub struct Oracle<'a> {
    frame: &'a Frame,
    width: i32,
    height: i32,
    /// Disparities, px.
    labels: Vec<i32>,
}

impl<'a> Oracle<'a> {
    pub fn new(frame: &'a Frame, config: &Config) -> Self {
        let min = i32::from(config.min_disparity);
        let labels = (min..min + i32::from(config.num_disparities)).collect();
        let size = [frame.width, frame.left.len() / frame.width].map(|px| i32::try_from(px).unwrap());
        Self { frame, width: size[0], height: size[1], labels }
    }

    /// Disparities, 1/16 px, row by row.
    pub fn map(&self) -> Vec<i16> {
        let winners: Vec<i32> = self.sums().iter().map(|sums| winner(&self.labels, sums)).collect();
        self.pixels().map(|(x, y)| self.median(&winners, x, y)).collect()
    }

    /// Confidences, row by row.
    pub fn confidence(&self) -> Vec<u8> {
        let sums = self.sums();
        let least: Vec<i32> = sums.iter().map(|sums| *sums.iter().min().unwrap()).collect();
        let whole: Vec<i32> = sums.iter().map(|sums| (winner(&self.labels, sums) + 8).div_euclid(16)).collect();
        let of = |(x, y): (i32, i32)| {
            let at = self.index(x, y);
            let confidence = u8::try_from(255 - 5 * least[at]).unwrap();
            let column = x - whole[at];
            // All pixels of the row that are seen in that column of the right view.
            let rivals = (0..self.width).map(|x| (x, self.index(x, y))).filter(|&(x, at)| x - whole[at] == column);
            let best = rivals.map(|(_, at)| at).min_by_key(|&at| (least[at], -whole[at]));
            let is_mutual =
                (0..self.width).contains(&column) && best.is_some_and(|best| whole[best].abs_diff(whole[at]) <= 1);
            if is_mutual { confidence } else { confidence / 16 }
        };
        self.pixels().map(of).collect()
    }

    /// Costs of the three paths together, by pixel and label.
    fn sums(&self) -> Vec<Vec<i32>> {
        let costs: Vec<Vec<i32>> = self.pixels().map(|(x, y)| self.costs(x, y)).collect();
        let paths = [(1, 0), (-1, 0), (0, 1)].map(|step| self.paths(&costs, step));
        let sum = |at: usize, label: usize| paths.iter().map(|path| path[at][label]).sum::<i32>();
        (0..costs.len()).map(|at| (0..self.labels.len()).map(|label| sum(at, label)).collect()).collect()
    }

    fn pixels(&self) -> impl Iterator<Item = (i32, i32)> {
        let width = self.width;
        (0..self.height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    /// The place of a pixel; outside the frame that of the nearest one.
    fn index(&self, x: i32, y: i32) -> usize {
        usize::try_from(y.clamp(0, self.height - 1) * self.width + x.clamp(0, self.width - 1)).unwrap()
    }

    fn is_darker(&self, view: &[u8], x: i32, y: i32, (dx, dy): (i32, i32)) -> bool {
        view[self.index(x + dx, y + dy)] < view[self.index(x, y)]
    }

    /// Signs that differ, by label.
    fn costs(&self, x: i32, y: i32) -> Vec<i32> {
        let cost = |&disparity: &i32| {
            let other = x - disparity;
            if !(0..self.width).contains(&other) {
                return OUTSIDE;
            }
            let differs = |&&at: &&(i32, i32)| {
                self.is_darker(&self.frame.left, x, y, at) != self.is_darker(&self.frame.right, other, y, at)
            };
            i32::try_from(NEIGHBOURS.iter().filter(differs).count()).unwrap()
        };
        self.labels.iter().map(cost).collect()
    }

    /// Costs of the paths that go on by `step`, by pixel and label: the least of each pixel is 0.
    fn paths(&self, costs: &[Vec<i32>], (dx, dy): (i32, i32)) -> Vec<Vec<i32>> {
        let mut paths: Vec<Vec<i32>> = vec![Vec::new(); costs.len()];
        let mut pixels: Vec<(i32, i32)> = self.pixels().collect();
        if dx < 0 {
            pixels.reverse();
        }
        for (x, y) in pixels {
            let at = self.index(x, y);
            let is_first = !(0..self.width).contains(&(x - dx)) || y < dy;
            let mut path = costs[at].clone();
            if !is_first {
                let before = &paths[self.index(x - dx, y - dy)];
                for (label, cost) in path.iter_mut().enumerate() {
                    let step = |other: &i32| other + P1;
                    let below = label.checked_sub(1).and_then(|below| before.get(below)).map(step);
                    let above = before.get(label + 1).map(step);
                    *cost += before[label].min(P2).min(below.unwrap_or(P2)).min(above.unwrap_or(P2));
                }
            }
            let least = *path.iter().min().unwrap();
            paths[at] = path.iter().map(|cost| cost - least).collect();
        }
        paths
    }

    fn median(&self, winners: &[i32], x: i32, y: i32) -> i16 {
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
        let mut nine: Vec<i32> = around.map(|(dx, dy)| winners[self.index(x + dx, y + dy)]).collect();
        nine.sort_unstable();
        i16::try_from(nine[4]).unwrap()
    }
}

/// The least of the sums, of equal ones that of the greatest disparity, and where the parabola through its
/// neighbours is least: 1/16 px, rounded, halves up.
fn winner(labels: &[i32], sums: &[i32]) -> i32 {
    let least = sums.iter().min().unwrap();
    let label = sums.iter().rposition(|sum| sum == least).unwrap();
    if label == 0 || label + 1 == labels.len() {
        return 16 * labels[label];
    }
    let [below, here, above] = [sums[label - 1], sums[label], sums[label + 1]].map(f64::from);
    let curvature = below - 2.0 * here + above;
    let offset = if curvature == 0.0 { 0.0 } else { (below - above) / (2.0 * curvature) };
    #[expect(clippy::cast_possible_truncation, reason = "-8..=8")]
    let offset = (16.0 * offset + 0.5).floor() as i32;
    16 * labels[label] + offset
}
